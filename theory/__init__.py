"""Closed forms and boundary elements that finite elements are held against."""
