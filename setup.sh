#!/bin/sh
# Install what is missing, from Debian and from PyPI; do nothing where all is there.
set -eu
cd "$(dirname "$0")"

packages="python3-dolfinx python3-scipy python3-venv libopenblas0-pthread
libglu1-mesa libgl1 libegl1 libxcursor1 libxft2 libxinerama1 libgomp1"

missing=""
for package in $packages; do
    status=$(dpkg-query -W -f '${db:Status-Abbrev}' "$package" 2>/dev/null || true)
    case "$status" in ii*) ;; *) missing="$missing $package" ;; esac
done
if [ -n "$missing" ]; then
    echo "setup: installing from Debian:$missing"
    sudo=""
    [ "$(id -u)" = 0 ] || sudo="sudo"
    $sudo apt-get update -q
    # shellcheck disable=SC2086
    DEBIAN_FRONTEND=noninteractive $sudo apt-get install -q -y --no-install-recommends $missing
fi

# Debian's numpy and scipy must stay: its petsc4py and dolfinx were built against them.
stamp=$(/usr/bin/python3 -c 'import numpy, scipy, sys; print(sys.version, numpy.__version__, scipy.__version__)'; cat pyproject.toml)
if [ "$(cat .venv/installed 2>/dev/null || true)" != "$stamp" ]; then
    echo "setup: installing from PyPI into .venv"
    # That of another Python (Debian was upgraded) has no pip any more.
    .venv/bin/python -m pip --version > /dev/null 2>&1 ||
        /usr/bin/python3 -m venv --clear --system-site-packages .venv
    /usr/bin/python3 -c 'import numpy, scipy; print(f"numpy=={numpy.__version__}\nscipy=={scipy.__version__}")' \
        > .venv/constraints.txt
    .venv/bin/python -m pip install -q -c .venv/constraints.txt -e '.[dev]'
    # mypy checks types by the stubs of one numpy, that of Debian 12.
    .venv/bin/python -m pip install -q --upgrade --no-deps --only-binary=:all: --python-version 3.11 \
        --target .venv/stubs numpy==1.24.4
    printf '%s' "$stamp" > .venv/installed
fi

# Where the environment forbids Python to keep compiled modules, every run would compile them anew.
.venv/bin/python -m compileall -q railhead cases meshing postprocess solver theory
