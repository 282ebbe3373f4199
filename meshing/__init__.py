"""From bodies to a mesh: element sizes, gmsh blocks and sections."""
