"""Contact for a mesh of one's own, in the words of the field: bodies, contacts, supports, loads."""
