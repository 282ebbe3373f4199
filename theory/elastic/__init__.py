"""Closed forms of elastic contact: Hertz, lines, stresses below a patch, finite bodies."""
