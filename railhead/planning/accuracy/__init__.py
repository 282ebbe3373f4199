"""Error envelopes over the resolution, and what measured profiles leave uncertain."""
