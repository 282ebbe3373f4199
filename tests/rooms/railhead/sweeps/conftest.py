"""A sweep that several modules read."""

import shutil
from pathlib import Path

import pytest
from sweep_command import ROLLER, SIX, solved_sweep


@pytest.fixture(scope="session")
def swept(tmp_path_factory) -> Path:
    """Six combinations, with pictures."""
    return solved_sweep(tmp_path_factory.mktemp("sweep") / "out", *ROLLER, *SIX)


@pytest.fixture
def copied(swept: Path, tmp_path: Path) -> Path:
    """A copy of it, to be changed."""
    return Path(shutil.copytree(swept, tmp_path / "sweep"))
