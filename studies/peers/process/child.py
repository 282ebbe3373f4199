"""Run in another Python as `python -P child.py CODE.py JOB.json`: the version of a code, or one of
its solves; writes found.json. Nothing of railhead is there."""

import importlib.util
import json
import sys
from pathlib import Path


def main(code: Path, job: Path) -> None:
    """Job: null for the version, or case, mesh (a file or null) and run for a solve."""
    # By its path: the module tamaas.py must not hide the package tamaas.
    spec = importlib.util.spec_from_file_location("peer", code)
    module = importlib.util.module_from_spec(spec)  # type: ignore[arg-type]
    spec.loader.exec_module(module)  # type: ignore[union-attr]
    asked = json.loads(job.read_text(encoding="utf-8"))
    if asked is None:
        found = module.version()
    else:
        mesh = None
        if asked["mesh"]:
            import numpy as np

            with np.load(asked["mesh"]) as file:
                mesh = dict(file)
        found = module.solve(asked["case"], mesh, **asked["run"])
    Path("found.json").write_text(json.dumps(found, default=_plain), encoding="utf-8")


def _plain(value):  # type: ignore[no-untyped-def]
    """Arrays and numbers of numpy."""
    return value.tolist()


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
