"""The whole-program check: walks a robot program in simulation with every combination of its inputs."""

from robots_controller.program_walk.walk import WalkResult, walk_program

__all__ = ['WalkResult', 'walk_program']
