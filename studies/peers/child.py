"""Run in another Python as `python -P child.py CODE.py JOB.json`: the version of a code, or one of
its solves; writes found.json. Nothing of railhead is there."""

import importlib.util
import json
import subprocess
import sys
from importlib import metadata
from pathlib import Path


def version(module) -> str:  # type: ignore[no-untyped-def]
    """Version of the first package of a code. Raises ImportError where it, or
    a module of MODULES, is not there.
    """
    for name in module.MODULES:
        importlib.import_module(name)
    if not module.DEBIAN:
        return metadata.version(module.PIP[0].partition("==")[0])
    command = ["dpkg-query", "-W", "-f", "${Version}", module.DEBIAN[0]]
    found = subprocess.run(command, capture_output=True, text=True, check=False).stdout
    if not found:
        raise ModuleNotFoundError(f"no package {module.DEBIAN[0]}")
    return found


def main(code: str, job: str) -> None:
    """Job: null for the version, or case, mesh (a file or null) and run for a solve."""
    # By its path: the module tamaas.py must not hide the package tamaas.
    spec = importlib.util.spec_from_file_location("peer", code)
    module = importlib.util.module_from_spec(spec)  # type: ignore[arg-type]
    spec.loader.exec_module(module)  # type: ignore[union-attr]
    asked, mesh = json.loads(Path(job).read_text(encoding="utf-8")), None
    if asked and asked["mesh"]:
        import numpy as np

        mesh = dict(np.load(asked["mesh"]))
    found = module.solve(asked["case"], mesh, **asked["run"]) if asked else version(module)
    # Arrays and numbers of numpy have tolist
    text = json.dumps(found, default=lambda value: value.tolist())
    Path("found.json").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
