"""Laws of motions around obstacles: whatever stands there, a plan is free by an engine of others."""

from __future__ import annotations

from functools import cache

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from robots_core import BaseRobotModel, Pose, load_robot_model
from robots_core.blocks import CollisionDetection, Scene, SceneObject
from robots_core.errors import PlanningError
from robots_core.orientation import rotation_from_vector
from robots_core.robot_model.shapes import Box, Capsule
from robots_planning import CollisionFreeJoint, verify

SAMPLES = 400  # postures of a motion that coal is asked about
MARGIN = 0.004  # m


@cache
def robot() -> BaseRobotModel:
    return load_robot_model('ur5e')


def scene(rng: np.random.Generator) -> Scene:
    items = []
    for k in range(int(rng.integers(1, 7))):
        r = rng.uniform([-0.8, -0.8, 0.0], [0.8, 0.8, 1.0])
        turn = rotation_from_vector(rng.uniform(-3.0, 3.0, 3))
        wide = rng.uniform(0.005, 0.25, 3)
        geometry = Box(tuple(wide)) if k % 2 else Capsule(float(wide[0]) / 4.0, float(wide[1]) * 3.0)
        items.append(SceneObject(f'item_{k}', geometry, Pose(r, turn)))
    return Scene(tuple(items))


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=25)
def test_a_plan_is_free_and_keeps_all_limits(seed: int):
    rng = np.random.default_rng(seed)
    around = scene(rng)
    collision = CollisionDetection(robot(), scene=around)
    start, target = robot().home + rng.uniform(-1.5, 1.5, (2, 6))
    generator = CollisionFreeJoint(robot(), collision=collision, margin=MARGIN, budget=0.05)
    try:
        plan = generator.generate(start, target)
    except PlanningError:
        return  # start or target blocked, or no way within the budget
    by_coal = CollisionDetection(robot(), scene=around, engine='coal')
    at_start = collision.distance(start)
    assert at_start is not None
    for q in plan.sample(np.linspace(0.0, plan.duration, SAMPLES))[0]:
        assert not by_coal.in_contact(q)
        closest = collision.distance(q)
        assert closest is not None
        assert closest.distance >= min(MARGIN, at_start.distance - 3e-4)
    assert verify(plan, robot(), torque=True).ok
