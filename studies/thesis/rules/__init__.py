"""The rule of each claim: a function of Facts that computes its checks."""

from studies.thesis.claims import Rule
from studies.thesis.rules import geometry, hertz, stress

RULES: dict[int, Rule] = geometry.RULES | hertz.RULES | stress.RULES
"""By the number of the claim."""
