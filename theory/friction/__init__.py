"""Closed forms and limits with friction: Cattaneo, Carter, Kalker, FASTSIM, shakedown, heat."""
