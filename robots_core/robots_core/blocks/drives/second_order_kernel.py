"""The steps of second-order drives, compiled: for many periods at once."""

from robots_core.blocks.drives.drive_train import advance
from robots_core.kernels.compiled import compiled

advance_compiled = compiled()(advance)
