"""Contact problem of bodies that yield, its load steps, and the response to a load case."""
