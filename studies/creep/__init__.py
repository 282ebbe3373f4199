"""Creep curves, what friction costs and changes, and stresses under full sliding."""
