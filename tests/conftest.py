"""The process of the tests; the thesis's contact, which several of them share."""

from railhead.run import process

process.prepare()  # as the command does: one thread of BLAS, before numpy loads

import hashlib
import json
import os
import pickle
from pathlib import Path

import pytest
from hypothesis import settings
from matplotlib.layout_engine import ConstrainedLayoutEngine
from sweep_command import one_after_the_other

from railhead.meshing import mesh
from railhead.planning import cost
from railhead.postprocess.pictures import diagrams
from railhead.sweeps import worker_pool
from railhead.theory.elastic.hertz import Ellipse, contact_modulus, point_contact

settings.register_profile("default", max_examples=20)
settings.register_profile("thorough", max_examples=200)
settings.load_profile("default")
LONG = {"verification", "studies"}
MESHED, LAY_OUT = mesh._meshed, ConstrainedLayoutEngine.execute


@pytest.fixture(autouse=True, scope="session")
def _own_speed(tmp_path_factory: pytest.TempPathFactory) -> None:
    """What runs of the tests take corrects no prediction of a person's runs."""
    file = tmp_path_factory.mktemp("cache") / "user" / "railhead" / "speed.json"
    file.parent.mkdir(parents=True)
    cost.cache_file = lambda: file


@pytest.fixture(autouse=True, scope="session")
def _small_pictures() -> None:
    """Pictures are drawn at 64 dots an inch and not laid out, in a fifth of the time; see
    `laid_out` and `sharp`."""
    diagrams.DPI = 64
    ConstrainedLayoutEngine.execute = lambda engine, figure: None


@pytest.fixture(autouse=True, scope="session")
def _meshed_once(tmp_path_factory: pytest.TempPathFactory) -> None:
    """gmsh meshes equal bodies once, whichever process of the tests asks: its meshes are kept as
    files of this run. `meshed_anew` is for tests of gmsh itself."""
    own = tmp_path_factory.getbasetemp()
    folder = (own.parent if "PYTEST_XDIST_WORKER" in os.environ else own) / "meshes"
    folder.mkdir(exist_ok=True)

    def meshed(bodies, grading, options):
        kept = folder / hashlib.sha256(pickle.dumps((bodies, grading, options))).hexdigest()
        if not kept.exists():
            part = kept.with_suffix(f".{os.getpid()}")
            part.write_bytes(pickle.dumps(MESHED(bodies, grading, options)))
            part.rename(kept)
        return pickle.loads(kept.read_bytes())

    mesh._meshed = meshed


@pytest.fixture
def meshed_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mesh, "_meshed", MESHED)


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder, which is the working directory."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def laid_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """Panels, titles and labels of pictures have the places in which people get them."""
    monkeypatch.setattr(ConstrainedLayoutEngine, "execute", LAY_OUT)


@pytest.fixture
def sharp(laid_out: None, monkeypatch: pytest.MonkeyPatch) -> None:
    """Pictures as people get them: laid out, with 160 dots an inch."""
    monkeypatch.setattr(diagrams, "DPI", 160)


@pytest.fixture
def in_this_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """Scenes of sweeps are solved in this process, one after the other."""
    monkeypatch.setattr(worker_pool, "submitting", one_after_the_other)


def pytest_configure(config: pytest.Config) -> None:
    """Of the processes that share all tests the second collects their files from the last one on:
    each reads what the other has compiled."""
    if os.environ.get("PYTEST_XDIST_WORKER") == "gw1" and config.args == ["tests"]:
        config.args = sorted(map(str, Path(__file__).parent.rglob("test_*.py")), reverse=True)


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """The folders of long tests first where several processes share them: what is left at the end
    is short."""
    if hasattr(config, "workerinput"):
        items.sort(key=lambda item: (LONG.isdisjoint(item.path.parts), item.path))


@pytest.fixture(scope="session")
def reference():
    """Exact numbers of the thesis case, a 30-digit Hertz evaluation; N, mm, MPa."""
    path = Path(__file__).parent / "rooms" / "theory" / "data" / "hertz_thesis.json"
    return json.loads(path.read_text(encoding="utf-8"))


@pytest.fixture(scope="session")
def thesis_ellipse() -> Ellipse:
    """Wheel R 420 mm on rail crown R 300 mm, both steel (207 GPa, 0.3), 25 kN."""
    return point_contact(1 / 420, 1 / 300, contact_modulus(207000, 0.3, 207000, 0.3), 25000)
