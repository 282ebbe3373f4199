"""Both bodies of a contact as half-spaces: pressed, sheared, worn; and how far off that may be."""
