"""The process of the command: memory that is free is given back when somebody may need it."""

import subprocess
import sys

GIVEN_BACK = """
import psutil
from railhead import process

process.prepare()
taken = [bytearray(100_000) for _ in range(3000)]
del taken
size = psutil.Process().memory_info().rss
process.trim()
print(size - psutil.Process().memory_info().rss)
"""


def test_free_memory_is_given_back() -> None:
    told = subprocess.run(
        [sys.executable, "-c", GIVEN_BACK], capture_output=True, text=True, check=True
    )
    assert int(told.stdout) > 200e6
