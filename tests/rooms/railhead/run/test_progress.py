"""What a run says while it works."""

import time

from railhead.run.progress import Progress


def test_the_bar_says_how_long_it_takes(capsys) -> None:
    with Progress(quiet=False) as progress:
        progress.jobs(1, 4)
        time.sleep(0.05)
        progress.jobs(2, 4)
        progress.jobs(2, 4)
        progress.jobs(4, 4)
    first, second, last = capsys.readouterr().err.splitlines()
    assert "1 of 4 done" in first
    assert "2 of 4 done, 0:00:00 left" in second and "4 of 4 done" in last
