"""Sphinx makes the site of these pages: `make site`."""

import re
import site
from pathlib import Path

ROOT = Path(__file__).parents[1]
# Docstrings are read from railhead, which is installed there.
site.addsitedir(str(next(ROOT.glob(".venv/lib/python*/site-packages"))))

project = html_title = "railhead"
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.mathjax"]
exclude_patterns = ["README.md"]  # index.md includes it
html_theme = "furo"
html_copy_source = html_show_copyright = False
myst_heading_anchors = 4
myst_enable_extensions = ["html_image", "dollarmath"]
smartquotes = False  # options keep their two hyphens
default_role = "code"
autodoc_preserve_defaults = True
autodoc_member_order = "bysource"
autodoc_default_options = {"members": True, "exclude-members": "model_config"}


def fields(app, what, name, obj, options, lines) -> None:
    """Make field lists of the lines "name: meaning" or "name (shape): meaning" of a docstring."""
    kind = "ivar" if what in ("class", "exception") else "param"
    entry = re.compile(r"^(\w+(?:, \w+)*)( \(.*?\))?: (.*(?:\n +.*)*)", re.MULTILINE)

    def field(found: re.Match[str]) -> str:
        key = "raises" if found[1].endswith("Error") else kind
        return f"\n:{key} {found[1].replace(' ', '')}:{found[2] or ''} {found[3]}\n"

    lines[:] = entry.sub(field, "\n".join(lines)).split("\n")


def setup(app) -> None:
    """Called by Sphinx."""
    app.connect("autodoc-process-docstring", fields)
