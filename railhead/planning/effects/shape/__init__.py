"""Effects that change which bodies are meshed: symmetry, sections, profiles, extent, far field."""
