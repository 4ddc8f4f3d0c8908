"""RealtimeMovement among the blocks of path planning, as in the paper; it is in `robots_core`."""

from robots_core.blocks.following.realtime_movement import MovementState, RealtimeMovement, RealtimeStep

__all__ = ['MovementState', 'RealtimeMovement', 'RealtimeStep']
