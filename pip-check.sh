#!/bin/sh
# Show that `pip install "railhead-contact[dolfinx]"` works where nothing of the system is used: sdist and wheel pass
# twine's check, the wheel is installed beside dolfinx from PyPI into an empty environment of the newest Python here
# (3.12 or later), numbers of two cases and two ranks are those of .venv to 1e-5, and the tests of this checkout run there.
set -eu
cd "$(dirname "$0")"

python=""
for each in python3.14 python3.13 python3.12 "$HOME"/.pyenv/versions/3.1[2-9]*/bin/python3; do
    "$each" -c 'import sys; sys.exit(sys.version_info < (3, 12))' 2>/dev/null && python=$each
done
[ -n "$python" ] || { echo "pip-check: no Python 3.12 or later on this machine" >&2; exit 2; }

work=$PWD/results/pip
rm -rf "$work" && mkdir -p "$work"
"$python" -m venv "$work/tools"
"$work/tools/bin/pip" install -q build==1.3.0 twine==6.2.0
"$work/tools/bin/python" -m build -o "$work/dist" . > "$work/build.log" 2>&1 || { tail -5 "$work/build.log" >&2; exit 1; }
"$work/tools/bin/twine" check --strict "$work"/dist/*

"$python" -m venv "$work/venv"
wheel=$(ls "$work"/dist/*.whl)
"$work/venv/bin/pip" install -q "$wheel[dolfinx]"
cd "$work"
export UCX_TLS=self,sm,tcp OMP_NUM_THREADS=1
for case in uic54_thesis long_roller; do
    venv/bin/railhead run $case --out pip/$case --no-pictures --quiet
    ../../.venv/bin/railhead run $case --out debian/$case --no-pictures --quiet
done
venv/bin/mpiexec -n 2 venv/bin/railhead run long_roller --out pip/ranks --no-pictures --quiet
cp -r debian/long_roller debian/ranks
venv/bin/python - << 'END'
import json, sys
from importlib.metadata import version
from pathlib import Path

off = 0.0
dolfinx, numpy = map(version, ("dolfinx-solver-real", "numpy"))
print(f"Python {sys.version.split()[0]}, dolfinx {dolfinx}, numpy {numpy}")
for case in ("uic54_thesis", "long_roller", "ranks"):
    one, other = (json.loads(Path(of, case, "summary.json").read_text())["result"] for of in ("pip", "debian"))
    for table, key in (("pressure", "max_MPa"), ("patch", "a_mm"), ("stress", "tau_max_MPa")):
        a, b = one[table][key], other[table][key]
        off = max(off, abs(a / b - 1))
        print(f"{case:14s} {key:12s} pip {a:.8g}  Debian {b:.8g}  {a / b - 1:+.1e}")
sys.exit(off > 1e-5)
END
cd ../..
"$work/venv/bin/pip" install -q -e '.[dolfinx,dev]'
"$work/venv/bin/python" -m pytest -n 2 --dist worksteal
