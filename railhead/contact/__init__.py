"""The bodies of a scene in place: first contact, gap, sections and creepage of the wheelset."""
