"""VTU files for ParaView, of the modelled part or with its mirror images."""
