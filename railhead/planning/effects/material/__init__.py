"""Effects of the materials: deformable bodies, nearly incompressible ones, yield."""
