"""Errors that people read: one line each."""

import pytest

from railhead.scene.scene import SceneError


def refusal(call, error: type[Exception] = SceneError) -> str:
    """The line of the error that a call raises."""
    with pytest.raises(error) as caught:
        call()
    (line,) = str(caught.value).splitlines()
    return line
