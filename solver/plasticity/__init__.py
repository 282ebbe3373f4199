"""Bodies that yield: their contact problem, load steps, response, and steady passes of a load."""
