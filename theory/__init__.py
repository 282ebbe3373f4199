"""Closed forms of elastic contact that the finite-element results are held against."""
