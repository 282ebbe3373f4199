"""Extensions of profile files. Scenes read this module, so it imports no numerical library."""

BODY_BY_EXTENSION = {".ban": "rail", ".whl": "wheel", ".prr": "rail", ".prw": "wheel"}
EXTENSIONS = (".csv", ".txt", ".dat", ".asc", ".tsv", *BODY_BY_EXTENSION)
