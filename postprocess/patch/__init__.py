"""The contact patch: outline, separate patches, pressure, and how well it is resolved."""
