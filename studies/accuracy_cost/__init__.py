"""Error against time for each method and element, and what an asked accuracy costs."""
