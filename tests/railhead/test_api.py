"""What a script sees: the public names, their examples, and a host that is left alone."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

import railhead

PAGE = Path(__file__).parents[2] / "docs" / "api.md"


def test_the_examples_of_the_page_run(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    blocks = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    assert len(blocks) > 5
    for block in blocks:
        exec(compile(block, str(PAGE), "exec"), names)
    result = names["result"]
    assert result.pressure.max == pytest.approx(result.hertz.pressure.max, rel=0.005)
    assert (tmp_path / "out" / "summary.json").exists()
    assert float(abs(result.displacement.x.array).max()) > 0.3 * result.approach


def test_every_public_name_has_an_example() -> None:
    page = PAGE.read_text(encoding="utf-8")
    assert dir(railhead) == sorted([*railhead.__all__, "__version__"])
    for name in railhead.__all__:
        assert f"rh.{name}" in page or name == "Result"
        assert getattr(railhead, name)


def test_importing_changes_nothing() -> None:
    code = """
import logging, os, signal, sys
before = dict(os.environ), logging.root.manager.disable, signal.getsignal(signal.SIGTERM)
import railhead
railhead.Scene, railhead.solve
after = dict(os.environ), logging.root.manager.disable, signal.getsignal(signal.SIGTERM)
print(before == after)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "True\n"


def test_importing_is_light() -> None:
    code = "import railhead, sys; print({'numpy', 'pydantic', 'dolfinx'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "set()\n"
