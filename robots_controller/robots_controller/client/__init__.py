"""A live cell from Python: motions with their progress, inputs and outputs, and programs."""

from robots_controller.client.cell_client import CellClient
from robots_controller.client.motion import Motion

__all__ = ['CellClient', 'Motion']
