"""Relative differences between a result and a reference."""

import pytest

from railhead.postprocess.patch import compare


def test_a_difference_is_relative_and_none_where_there_is_nothing_to_divide_by() -> None:
    result = {"a": 2.0, "b": 1.0, "c": "rail", "d": [3.0, None], "e": 5.0}
    exact = {"a": 1.0, "b": 0.0, "c": "rail", "d": [4.0, 1.0]}
    assert compare.difference(result, exact) == {
        "a": 1.0, "b": None, "c": None, "d": [pytest.approx(-0.25), None],
    }  # fmt: skip
