"""Friction of half-spaces: closed forms, boundary elements, linear theory, shakedown and wear."""
