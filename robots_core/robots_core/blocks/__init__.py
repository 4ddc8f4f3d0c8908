"""Functional blocks: robot-independent, ROS-free, numpy in and out."""

import lazy_loader

# The names are in the stub; each is imported when it is first asked for, with no other module of the package.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
