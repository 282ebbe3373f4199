"""Wear over a route of positions: the route, its runs, the answer with its files and pictures."""
