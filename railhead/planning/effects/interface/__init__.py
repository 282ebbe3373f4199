"""Effects of the surfaces: friction, and the heat that it makes."""
