"""Scenes that ship: one short script a case, and the studies."""
