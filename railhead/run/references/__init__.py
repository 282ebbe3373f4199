"""Other methods beside the finite elements: half-spaces, rolling, and what they may differ by."""
