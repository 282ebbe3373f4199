"""VTU files for ParaView, of half models or mirrored to whole ones."""
