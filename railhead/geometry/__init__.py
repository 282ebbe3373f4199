"""Profiles, outlines and surfaces of rail and wheel, and where they meet; knows no scene."""
