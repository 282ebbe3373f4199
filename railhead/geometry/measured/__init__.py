"""Measured profiles: from a file of points to a smooth profile in the axes of the project.

Scenes read the extensions of the files from here, so nothing is imported.
"""

BODY_BY_EXTENSION = {
    **{".ban": "rail", ".whl": "wheel", ".prr": "rail", ".prw": "wheel"},
    **{".rail": "rail", ".wheel": "wheel"},
}
MINIPROF, SIMPACK = (".ban", ".whl", ".mpt"), (".prr", ".prw")
EXTENSIONS = (".csv", ".txt", ".dat", ".asc", ".tsv", ".mpt", *BODY_BY_EXTENSION)
