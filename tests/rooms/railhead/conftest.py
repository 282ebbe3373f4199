"""Half-spaces that have no answer."""

import pytest

from railhead.half_spaces.pressing import HalfSpacePair


@pytest.fixture
def half_spaces_fail(monkeypatch: pytest.MonkeyPatch) -> None:
    """Boundary elements find no contact, whatever the scene."""

    def fail(*_: object) -> None:
        raise ValueError("no bounded contact found")

    monkeypatch.setattr(HalfSpacePair, "solve", fail)
