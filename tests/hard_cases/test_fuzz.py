"""No input makes a traceback, no result holds a NaN without a failed check."""

import contextlib
import io
import json
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from strategies import broken_toml, scenes

from cases.hard.random_scenes import plans, runnable
from railhead import results
from railhead.cli import main
from railhead.run import run
from railhead.scene import Scene

patient = settings(
    max_examples=50,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)


@given(scenes)
@patient
def test_every_valid_scene_is_planned_or_refused_in_one_line(scene: Scene) -> None:
    plans(scene)


@given(broken_toml)
@patient
def test_broken_files_end_in_one_line(tmp_path: Path, content: bytes) -> None:
    file = tmp_path / "scene.toml"
    file.write_bytes(content)
    errors = io.StringIO()
    with (
        contextlib.redirect_stderr(errors),
        contextlib.redirect_stdout(io.StringIO()),
        pytest.raises(SystemExit) as ended,
    ):
        main(["plan", str(file)])
    if ended.value.code != 0:
        assert ended.value.code == 2
        assert len(errors.getvalue().strip().splitlines()) == 1


@pytest.mark.parametrize("scene", runnable(6, seed=7, most=15_000), ids=str)
def test_random_scenes_are_solved_and_balanced(scene: Scene) -> None:
    result = run(scene)
    assert result.passed, result.summary["newton"]["reason"]
    assert result.summary["checks"]["force_balance"] < 1e-6
    assert "NaN" not in json.dumps(json.loads(results.as_json(result)))
