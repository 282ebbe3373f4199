"""Every claim of the 2012 thesis, computed again: exact theory, geometry and finite elements."""
