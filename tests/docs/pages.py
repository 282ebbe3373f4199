"""Pages of docs/ that are programs: Python blocks that run in their order, in one namespace, and
blocks of shell commands (sh) with `railhead` and examples/ at hand.

What a block prints stands in a block of text right behind it, and a picture of the folder that is
named after the page is a file that the page writes.

    PYTHONPATH=. python -P tests/docs/pages.py docs/PAGE.md

runs a page and puts both in their places.
"""

import contextlib
import io
import os
import re
import subprocess
import sys
import sysconfig
import tempfile
from pathlib import Path

from PIL import Image

BLOCK = re.compile(r"(```(python|sh)\n(.*?)```\n)(\n```text\n(.*?)```\n)?", re.DOTALL)
NUMBER = re.compile(r"[+-]?\d+(?:\.\d+)?(?:e[+-]\d+)?")
SCATTER = 0.002  # meshes differ with the versions of gmsh and of numpy (docs/limits.md)
WIDEST = 800  # pixels of a picture in docs/: below 100 kB
EXAMPLES = Path(__file__).parents[2] / "examples"


def blocks(page: Path, kinds: str = "python sh") -> list[str]:
    """Its examples of some kinds."""
    every = BLOCK.finditer(page.read_text(encoding="utf-8"))
    return [found[3] for found in every if found[2] in kinds.split()]


def stated(page: Path) -> list[str]:
    """What the page says that each block prints, empty where it says nothing."""
    return [found[5] or "" for found in BLOCK.finditer(page.read_text(encoding="utf-8"))]


def run(page: Path) -> tuple[dict[str, object], list[str]]:
    """The names that its blocks leave behind in the current folder, and what each block prints."""
    names: dict[str, object] = {}
    printed = []
    for found in BLOCK.finditer(page.read_text(encoding="utf-8")):
        if found[2] == "sh":
            printed.append(_shell(found[3]))
            continue
        with contextlib.redirect_stdout(io.StringIO()) as out:
            exec(compile(found[3], str(page), "exec"), names)
        printed.append(out.getvalue())
    return names, printed


def _shell(commands: str) -> str:
    """What shell commands print in the current folder, 80 columns wide. AssertionError for a
    command outside a pipe that fails, unless the block says what then."""
    if not os.path.lexists("examples"):
        os.symlink(EXAMPLES, "examples")
    left = {key: value for key, value in os.environ.items() if not key.startswith(("OMPI", "PMIX"))}
    root = dict.fromkeys(("OMPI_ALLOW_RUN_AS_ROOT", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM"), "1")
    path = f"{sysconfig.get_path('scripts')}:{os.environ['PATH']}"
    done = subprocess.run(
        ["bash", "-ec", commands],
        env=left | root | {"PATH": path, "COLUMNS": "80", "OMP_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        raise AssertionError(f"{commands}\nends with status {done.returncode}: {done.stderr}")
    return done.stdout


def pictures(page: Path) -> list[str]:
    """The files of its own that the page shows, as it writes them."""
    return re.findall(rf"!\[[^]]*\]\({page.stem}/([^)]+)\)", page.read_text(encoding="utf-8"))


def unequal(said: str, printed: str) -> list[str]:
    """Lines that differ: in their words, or in a number by more than one in its last place and
    `SCATTER` of it."""
    pairs = list(zip(said.splitlines(), printed.splitlines(), strict=False))
    lines = [f"{one!r} is {two!r}" for one, two in pairs if not _same(one, two)]
    if len(said.splitlines()) != len(printed.splitlines()):
        lines.append(f"{len(said.splitlines())} lines are {len(printed.splitlines())}")
    return lines


def _same(one: str, two: str) -> bool:
    words = [" ".join(NUMBER.sub(" # ", line).split()) for line in (one, two)]
    numbers = [NUMBER.findall(line) for line in (one, two)]
    return words[0] == words[1] and all(map(_near, *numbers))


def _near(one: str, two: str) -> bool:
    mantissa, _, power = one.partition("e")
    last = 10.0 ** (int(power or 0) - len(mantissa.partition(".")[2]))
    return abs(float(one) - float(two)) <= max(1.01 * last, SCATTER * abs(float(one)))


def unsupported(page: Path) -> list[str]:
    """Numbers with decimals or a unit in the prose, sections of books apart, that no block has."""
    text = page.read_text(encoding="utf-8")
    told = {number.lstrip("+-") for number in NUMBER.findall(" ".join(blocks(page) + stated(page)))}
    prose = re.sub(r"```.*?```|`[^`\n]*`|\([^()\s]*\)", " ", text, flags=re.DOTALL)
    measured = re.findall(r"(?<!section )\b\d+\.\d+|\d+(?= (?:MPa|mm|um|kN|N)\b)|\d+(?= %)", prose)
    return [number for number in measured if number not in told]


def renew(page: Path) -> None:
    """Run the page in a folder of its own; write what it prints and its pictures."""
    page = page.resolve()
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        printed = iter(run(page)[1])
        for name in pictures(page):
            target = page.parent / page.stem / name
            target.parent.mkdir(parents=True, exist_ok=True)
            picture = Image.open(name).convert("RGB")
            picture.thumbnail((WIDEST, WIDEST))
            picture.quantize(method=Image.Quantize.FASTOCTREE).save(target, optimize=True)

    def filled(found: re.Match[str]) -> str:
        text = next(printed)
        return found[1] + (f"\n```text\n{text}```\n" if text else "")

    page.write_text(BLOCK.sub(filled, page.read_text(encoding="utf-8")), encoding="utf-8")


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    for name in sys.argv[1:]:
        renew(Path(name))
