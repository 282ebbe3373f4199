"""Profiles and stress-strain curves that a script gives as arrays: files in the cache of the user.

A scene names its files, so an array is written once, under a name made of its content; from there
it is read, and copied into the result folder, as any other file.
"""

import os
import tempfile
import time
from hashlib import sha256
from numbers import Real
from pathlib import Path
from typing import Any

from railhead.scene.units import show

KEPT = 90 * 24 * 3600.0  # s: an array that no scene was given for so long is removed


def cache_folder() -> Path:
    """The folder of the program in the cache of the user, which need not exist."""
    root = os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    return Path(root) / "railhead"


def is_array(value: object) -> bool:
    """Whether a value of a key is neither a word nor a path nor a number: an array, if anything."""
    return value is not None and not isinstance(value, str | os.PathLike | Real)


def file_of(value: object, kind: str, columns: dict[str, str]) -> str:
    """Absolute path of a .csv file with the rows of an array (n, 2); its name is `kind` and twelve
    digits of the content's SHA-256. Writing a new one removes files older than 90 days (KEPT).

    value: numbers, or a quantity of pint where both columns have one unit.
    columns: header of each column, and its unit, empty for none.
    Raises ValueError (one line) for anything else, numbers that are not finite, and a cache that
    cannot be written.
    """
    import numpy as np

    try:
        if hasattr(value, "m_as"):  # of pint
            value = value.m_as(next(iter(columns.values())))
        given: Any = np.ma.asarray(value)
        rows = np.ma.filled(given.astype(float), np.nan) if given.dtype.kind in "biuf" else given
    except (TypeError, ValueError, OverflowError):
        rows = np.empty(0)
    numbers = rows.dtype.kind == "f"
    if not (numbers and rows.ndim == 2 and rows.shape[1] == 2 and np.isfinite(rows).all()):
        text = f"an array of shape (n, 2), {' and '.join(columns)}, with finite numbers"
        raise ValueError(f"{show(value)} is not allowed; give {text}")
    lines = (",".join(map(repr, row)) for row in rows.tolist())
    content = "\n".join([",".join(columns), *lines, ""]).encode()
    path = cache_folder() / "arrays" / f"{kind}-{sha256(content).hexdigest()[:12]}.csv"
    try:
        if not path.is_file() or path.read_bytes() != content:
            path.parent.mkdir(parents=True, exist_ok=True)
            for old in path.parent.iterdir():
                if old.stat().st_mtime < time.time() - KEPT:
                    old.unlink(missing_ok=True)
            part, name = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
            with open(part, "wb") as file:
                file.write(content)
            Path(name).replace(path)
        path.touch()
    except OSError as error:
        raise ValueError(f"the array cannot be kept in {path}: {error.strerror}") from None
    return str(path)
