"""Tangential tractions of a pressed contact by Coulomb's law, and what they displace."""
