"""Studies of the checkout that this package runs from: the modules named in studies/__init__.py.

A study writes tables, pictures and a page into a folder that appears complete or not at all. The
installed package has no studies.
"""

import sys
from importlib import import_module
from pathlib import Path

from railhead.run import process
from railhead.scene.scene import SceneError

PAGE = "page.md"
ROOT = Path(__file__).resolve().parents[2]  # of the checkout


def modules() -> dict[str, tuple[str, str]]:
    """Module name of each study and what it shows, by the name of the study. The checkout
    is added to `sys.path`; the studies are not imported. Raises SceneError where the package
    does not lie in a checkout of the repository.
    """
    if not (ROOT / "studies" / "__init__.py").is_file():
        raise SceneError("study", "studies need a checkout of the repository; install it editable")
    if str(ROOT) not in sys.path:
        sys.path.append(str(ROOT))
    return dict(import_module("studies").STUDIES)


def run(name: str, folder: Path | None, *, quick: bool) -> tuple[Path, str]:
    """Run a study; returns its folder and the text of its page.

    name: name of the study, with - or _.
    folder: target folder; None for results/<study>.
    quick: whether only a small part of the study is done.
    Raises SceneError for an unknown name, a folder that holds other files, and under mpirun.
    """
    name, known = name.replace("-", "_"), modules()
    if name not in known:
        text = f"{name!r} is unknown; give one of {', '.join(sorted(known))}"
        raise SceneError("study", text)
    folder = folder if folder is not None else Path("results") / name
    study = import_module(known[name][0])

    from railhead.results import result_folder

    result_folder.check_folder(folder, getattr(study, "KEEPS", ()))
    if process.under_mpi():
        raise SceneError("study", f"{name} measures one process; start it without mpirun")
    with result_folder.claimed(folder), result_folder.replacing(folder) as work:
        study.main(work, quick=quick)
    return folder, (folder / PAGE).read_text(encoding="utf-8")
