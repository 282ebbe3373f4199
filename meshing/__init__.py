"""From profiles to meshes: where wheel and rail meet, how fine, and the gmsh blocks."""
