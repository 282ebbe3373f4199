"""Input of a contact model."""

import pytest

from railhead.solver.system import setup


def test_the_former_name_of_a_body_works_and_warns() -> None:
    with pytest.warns(DeprecationWarning, match="ContactBody"):
        from railhead.solver.system.setup import Side
    assert Side is setup.ContactBody
    with pytest.raises(AttributeError, match="no attribute 'Body'"):
        setup.Body  # noqa: B018
