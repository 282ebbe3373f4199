"""Where and how the bodies of a scene touch: solids, half-spaces and sections."""
