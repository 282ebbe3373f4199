"""Friction of half-spaces: closed forms, boundary elements, FASTSIM, shakedown and wear."""
