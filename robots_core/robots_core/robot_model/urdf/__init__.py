"""URDF files: the tree of links, the arm in it, its meshes and shapes."""
