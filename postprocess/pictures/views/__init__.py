"""Three-dimensional pictures: bodies, stresses in a cut, views that turn."""
