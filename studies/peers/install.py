"""Packages of the codes: Debian's by apt-get, the others by pip in a venv of their own."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path

from railhead.run.progress import Progress
from studies.peers.codes import Peer

DEBIAN_PYTHON = "/usr/bin/python3"
FAILED = "failed_{}.txt"  # in the venv: why a code could not be installed


def python(peer: Peer, venv: Path) -> str:
    """In which a code runs."""
    return DEBIAN_PYTHON if peer.DEBIAN else str(venv.absolute() / "bin" / "python")


def reason(peer: Peer, venv: Path, said: str) -> str:
    """Why a code that said so is not there, in one line: what its installation said, if it was
    tried; else how it is installed."""
    if (failed := venv / FAILED.format(peer.TITLE)).exists():
        return failed.read_text(encoding="utf-8")
    return f"{said} ({wanted(peer)})"


def wanted(peer: Peer) -> str:
    """The command that installs a code by hand."""
    if peer.DEBIAN:
        return f"apt-get install {' '.join(peer.DEBIAN)}"
    return f"pip install {' '.join(peer.PIP)}"


def install(peers: Iterable[Peer], venv: Path, progress: Progress) -> None:
    """Install what each needs. What fails is noted for `reason`, and the others follow."""
    if not (venv / "bin" / "python").exists():
        progress.stage(f"making {venv}")
        _failure([sys.executable, "-m", "venv", "--clear", str(venv)])
    for peer in peers:
        progress.stage(f"installing {peer.TITLE}")
        failed = venv / FAILED.format(peer.TITLE)
        failed.unlink(missing_ok=True)
        if why := _install(peer, venv):
            failed.write_text(f"{wanted(peer)}: {why}", encoding="utf-8")
            print(f"railhead: not installed: {wanted(peer)}: {why}", file=sys.stderr)


def _install(peer: Peer, venv: Path) -> str:
    if not peer.DEBIAN:
        return _failure([python(peer, venv), "-m", "pip", "install", "-q", *peer.PIP])
    if not _failure(["dpkg", "-s", *peer.DEBIAN]):
        return ""
    if os.geteuid() != 0:
        return "only root can"
    asked = ["apt-get", "install", "-q", "-y", "--no-install-recommends", *peer.DEBIAN]
    return _failure(["apt-get", "update", "-q"]) or _failure(asked)


def _failure(command: Sequence[str]) -> str:
    """Why a command failed, in one line; empty if it did not."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except OSError as error:
        return f"{command[0]}: {error.strerror}"
    said = [line.strip() for line in done.stderr.splitlines() if line.strip()]
    return (said or [f"status {done.returncode}"])[-1] if done.returncode else ""
