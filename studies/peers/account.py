"""Run as `python -I account.py REPORT.json COMMAND...`: what the command costs, with all that it
waits for, as /usr/bin/time counts it.

A process of its own, and a small one: the peak memory that the system counts for a new process
begins with the memory of the one that starts it.
"""

import json
import os
import subprocess
import sys
import time

report, command = sys.argv[1], sys.argv[2:]
start = time.perf_counter()
process = subprocess.Popen(command, stdin=subprocess.DEVNULL)
_, status, usage = os.wait4(process.pid, 0)
seconds = time.perf_counter() - start
with open(report, "w", encoding="utf-8") as file:
    json.dump(
        {
            "seconds": seconds,
            "cpu_seconds": usage.ru_utime + usage.ru_stime,
            "peak_bytes": 1024 * usage.ru_maxrss,
            "status": os.waitstatus_to_exitcode(status),
        },
        file,
    )
