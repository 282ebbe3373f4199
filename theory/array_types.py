"""Types of arrays by what they hold, and files of them."""

import io
import zlib
from collections.abc import Mapping
from pathlib import Path
from zipfile import BadZipFile

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Mask = NDArray[np.bool_]
Complex = NDArray[np.complex128]


def packed(arrays: Mapping[str, ArrayLike]) -> bytes:
    """Content of a compressed .npz file of arrays by name. Written by numpy itself, a full disk
    ends in an error that nothing can catch.
    """
    content = io.BytesIO()
    np.savez_compressed(content, **arrays)
    return content.getvalue()


def read_arrays(path: Path) -> dict[str, NDArray[np.generic]]:
    """Arrays of real numbers by name of a .npz file. Raises ValueError (one line) for another file
    and other arrays, OSError where it cannot be read.
    """
    try:
        with np.load(path, allow_pickle=False) as file:
            found = {name: file[name] for name in file.files}
    except (
        AttributeError,
        EOFError,
        LookupError,
        TypeError,
        ValueError,
        BadZipFile,
        zlib.error,
        NotImplementedError,
        MemoryError,
    ):
        text = "is no whole .npz file of numbers; write it again by numpy.savez"
        raise ValueError(f"{path.name} {text}") from None
    for name, array in found.items():
        if array.dtype.kind not in "biuf":
            raise ValueError(f"{path.name}: {name} is {array.dtype}; give real numbers")
    return found
