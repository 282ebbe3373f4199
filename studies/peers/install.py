"""Packages of the codes: Debian's by apt-get, the others by pip in a venv of their own."""

import subprocess
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path

from railhead.run.progress import Progress
from studies.peers.codes import Peer

DEBIAN_PYTHON = "/usr/bin/python3"
APT = ["apt-get", "install", "-q", "-y", "--no-install-recommends"]


def python(peer: Peer, venv: Path) -> str:
    """In which a code runs."""
    return DEBIAN_PYTHON if peer.DEBIAN else str(venv.absolute() / "bin" / "python")


def reason(peer: Peer, venv: Path, said: str) -> str:
    """Why a code that said so is not there, in one line: what its installation said, if it was
    tried; else how it is installed."""
    failed = _note(peer, venv)
    return failed.read_text(encoding="utf-8") if failed.exists() else f"{said} ({wanted(peer)})"


def wanted(peer: Peer) -> str:
    """The command that installs a code by hand."""
    program = "apt-get" if peer.DEBIAN else "pip"
    return f"{program} install {' '.join(peer.DEBIAN or peer.PIP)}"


def install(peers: Iterable[Peer], venv: Path, progress: Progress) -> None:
    """Install what each needs. What fails is noted for `reason`, and the others follow."""
    if not (venv / "bin" / "python").exists():
        _failure([sys.executable, "-m", "venv", "--clear", str(venv)])
    for peer in peers:
        progress.stage(f"installing {peer.TITLE}")
        _note(peer, venv).unlink(missing_ok=True)
        if not peer.DEBIAN:
            why = _failure([python(peer, venv), "-m", "pip", "install", "-q", *peer.PIP])
        elif why := _failure(["dpkg", "-s", *peer.DEBIAN]):
            why = _failure(["apt-get", "update", "-q"]) or _failure([*APT, *peer.DEBIAN])
        if why:
            _note(peer, venv).write_text(f"{wanted(peer)}: {why}", encoding="utf-8")
            print(f"railhead: not installed: {wanted(peer)}: {why}", file=sys.stderr)


def _note(peer: Peer, venv: Path) -> Path:
    """Where it is noted why a code could not be installed."""
    return venv / f"failed_{peer.TITLE}.txt"


def _failure(command: Sequence[str]) -> str:
    """Why a command failed, in one line; empty if it did not."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except OSError as error:
        return f"{command[0]}: {error.strerror}"
    said = [line.strip() for line in done.stderr.splitlines() if line.strip()]
    return (said or [f"status {done.returncode}"])[-1] if done.returncode else ""
