"""Diagrams as PNG files."""
