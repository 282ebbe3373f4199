"""A sweep that several modules read."""

import shutil
from pathlib import Path

import pytest
from sweep_command import ROLLER, SIX, one_after_the_other, sweep

from railhead.sweeps import worker_pool


@pytest.fixture(scope="session")
def swept(tmp_path_factory) -> Path:
    """Six combinations, two meshes, with pictures."""
    folder = tmp_path_factory.mktemp("sweep") / "out"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(worker_pool, "submitting", one_after_the_other)
        assert sweep(*ROLLER, *SIX, "--out", str(folder)) == 0
    return folder


@pytest.fixture
def copied(swept: Path, tmp_path: Path) -> Path:
    """A copy of it, to be changed."""
    return Path(shutil.copytree(swept, tmp_path / "sweep"))
