"""Jobs in processes: lost ones end alone."""

import os
import time

from cases.pool import attempts


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
    limits = [30.0, 30.0, 30.0, 30.0, 2.0, 30.0]
    found = list(attempts(job, jobs, limits, processes=1))
    assert [each.found for each in found] == ["a1", None, None, "b1", None, "c1"]
    assert found[1].fault == "ValueError: two lines" and "Traceback" in found[1].trace
    assert found[2].fault == "the process crashed"
    assert found[4].fault == "not back after 2 s" and found[4].seconds < 10
