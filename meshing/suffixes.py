"""Endings of the files of profiles: read by scenes, which load no arithmetic for them."""

BODIES = {".ban": "rail", ".whl": "wheel", ".prr": "rail", ".prw": "wheel"}
SUFFIXES = (".csv", ".txt", ".dat", ".asc", ".tsv", *BODIES)
