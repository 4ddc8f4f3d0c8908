"""URDF files: the tree of links, the serial chain in it, its meshes and shapes."""
