"""Jobs in processes: lost ones end alone."""

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from railhead.sweeps import worker_pool
from studies.processes import attempts

pytestmark = pytest.mark.system


def job(what: str) -> str:
    if what == "raise":
        raise ValueError("two\nlines")
    if what == "crash":
        os.abort()
    if what == "hang":
        time.sleep(60)
    return what + os.environ["OMP_NUM_THREADS"]


def test_lost_jobs_have_a_reason_and_the_others_their_result() -> None:
    jobs = [(what,) for what in ("a", "raise", "crash", "b", "hang", "c")]
    found = list(attempts(job, jobs, [30.0, 30.0, 30.0, 30.0, 2.0, 30.0]))
    assert [each.value for each in found] == ["a1", None, None, "b1", None, "c1"]
    assert found[1].fault == "ValueError: two lines" and found[2].fault == "the process crashed"
    assert found[4].fault == "not back after 2 s" and found[4].seconds < 10


def mark(file: str) -> None:
    """Say who works, and go on for long."""
    Path(file).write_text(str(os.getpid()))
    time.sleep(60)


def test_jobs_end_with_the_process_that_asked_for_them(tmp_path: Path) -> None:
    file = tmp_path / "pid"
    script = "import sys; sys.path[:0] = sys.argv[1].split(chr(58))\nimport test_worker_pool\n"
    script += "from studies.processes import attempts\n"
    script += "if __name__ == '__main__': list(attempts(test_worker_pool.mark, [(sys.argv[2],)]))"
    (tmp_path / "ask.py").write_text(script)
    here = ":".join(str(Path(__file__).parents[up]) for up in (0, 4))
    asking = subprocess.Popen([sys.executable, str(tmp_path / "ask.py"), here, str(file)])
    while not (file.exists() and file.read_text()):
        assert asking.poll() is None
        time.sleep(0.1)
    asking.kill()
    asking.wait()
    time.sleep(1.0)
    state = Path("/proc") / file.read_text() / "stat"
    assert not state.exists() or state.read_text().split()[2] == "Z"


def crash_once(file: str) -> str:
    if not Path(file).exists():
        Path(file).write_text("seen")
        os.abort()
    return "back"


def test_a_job_that_crashed_is_tried_once_more(tmp_path: Path) -> None:
    """One that planned for a sweep ended it with a traceback."""
    with worker_pool.submitting(1) as submit:
        found = list(worker_pool.together(submit, crash_once, [(str(tmp_path / "seen"),)]))
    assert found == ["back"]
