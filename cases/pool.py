"""Jobs of a study side by side, one process a core, each with one thread."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import Any, TypeVar

T = TypeVar("T")
ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")
JOBS_PER_PROCESS = 8  # memory that libraries keep is given back with the process


def spread(work: Callable[..., T], jobs: Sequence[tuple[Any, ...]]) -> Iterator[T]:
    """work(*job) for each job, in their order; an exception ends the study."""
    kept = {key: os.environ.get(key) for key in ONE_THREAD}
    os.environ.update(ONE_THREAD)
    try:
        with ProcessPoolExecutor(
            min(os.cpu_count() or 1, len(jobs)),
            mp_context=get_context("spawn"),
            max_tasks_per_child=JOBS_PER_PROCESS,
        ) as pool:
            for number, found in enumerate(pool.map(work, *zip(*jobs, strict=True)), 1):
                print(f"{number} of {len(jobs)}", file=sys.stderr)
                yield found
    finally:
        for key, value in kept.items():
            if value is None:
                del os.environ[key]
            else:
                os.environ[key] = value
