"""A sweep that several modules read."""

from pathlib import Path

import pytest
from sweep_command import ROLLER, SIX, sweep


@pytest.fixture(scope="session")
def swept(tmp_path_factory) -> Path:
    """Six combinations, two meshes, with pictures."""
    folder = tmp_path_factory.mktemp("sweep") / "out"
    assert sweep(*ROLLER, *SIX, "--out", str(folder)) == 0
    return folder
