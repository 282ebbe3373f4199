"""Random and broken scenes: none may break the program or get a wrong number signed."""
