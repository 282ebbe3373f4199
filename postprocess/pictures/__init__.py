"""Pictures of results, sweeps and profiles: diagrams, and bodies in space."""
