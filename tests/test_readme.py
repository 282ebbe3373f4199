"""What the README tells a newcomer to type exists and is accepted."""

import re
import shlex
import shutil
import subprocess
import tomllib
from pathlib import Path

import pytest

from railhead.cli import study
from railhead.scene import catalogue
from railhead.scene.scene import Scene
from railhead.sweeps.grid import ParameterGrid, parse_values

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
COMMANDS = re.findall(r"^    \.venv/bin/railhead (.+?)(?:\s+#.*)?$", README, re.MULTILINE)


@pytest.mark.parametrize("target", ["run", "test"])
def test_make_targets_exist(target: str) -> None:
    make = shutil.which("make")
    assert make is not None and f"    make {target} " in README
    done = subprocess.run(
        [make, "-n", target], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0
    assert "./setup.sh" in done.stdout


def test_setup_installs_nothing_the_second_time() -> None:
    done = subprocess.run(
        ["./setup.sh"], cwd=ROOT, capture_output=True, text=True, check=False, timeout=120
    )
    assert (done.returncode, done.stdout) == (0, "")


@pytest.mark.parametrize("line", COMMANDS)
def test_commands_are_accepted(line: str) -> None:
    command, *arguments = shlex.split(line)
    assert command in ("list", "locate", "plan", "run", "study", "sweep")
    if command == "study":
        study.canonical(arguments[0])
    elif command == "sweep":
        case, option, values = arguments
        assert option == "--over"
        assert len(ParameterGrid.combine(catalogue.find(case), parse_values([values])).scenes) > 1
    elif command != "list" and not arguments[0].endswith(".toml"):
        scene = catalogue.find(arguments[0])
        pairs = zip(arguments[1::2], arguments[2::2], strict=True)
        written = {
            "--set": "{}", "--with": "effects.{}=on", "--without": "effects.{}=off",
            "--shift": "wheelset.shift={}", "--yaw": "wheelset.yaw={}",
        }  # fmt: skip
        assigned = [
            written.get(option, f"{option[2:]}={{}}").format(value) for option, value in pairs
        ]
        assert isinstance(scene.replace(assigned), Scene)


def test_there_are_commands_to_check() -> None:
    assert len(COMMANDS) >= 4


def test_scene_in_the_readme_is_valid() -> None:
    block = re.search(r'(?ms)^    load = "25 kN"\n.*?(?=\n\n)', README)
    assert block is not None
    text = re.sub(r"(?m)^    ", "", block.group(0))
    assert Scene.from_mapping(tomllib.loads(text)).load == 25000


def test_pictures_and_pages_that_are_linked_exist() -> None:
    for target in re.findall(r"\]\(([^)]+)\)", README):
        assert (ROOT / target).is_file(), target
