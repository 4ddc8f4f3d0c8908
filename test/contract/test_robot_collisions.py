"""Every robot: which of its shapes may touch, and that it stands free."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from robots_core import BaseRobotModel
from robots_core.blocks import CollisionDetection
from robots_core.blocks.collision.allowed_pair_sampling import find_allowed_pairs
from robots_core.robot_model.allowed_pairs import AllowedPairs


@cache
def detection_by(engine: str, robot: BaseRobotModel) -> CollisionDetection:
    return CollisionDetection(robot, engine=engine)


@pytest.fixture
def table(robot: BaseRobotModel) -> AllowedPairs:
    return detection_by('fcl', robot).allowed_pairs


@pytest.mark.parametrize('engine', ['fcl', 'coal'])
def test_home_is_in_no_contact(robot: BaseRobotModel, engine: str):
    detection = detection_by(engine, robot)
    assert detection.contacts(robot.home) == ()
    assert not detection.in_contact(robot.home)


def test_allowed_pairs_name_two_shapes_that_move_against_each_other(
    robot: BaseRobotModel, table: AllowedPairs
):
    frames = {shape.name: shape.frame for shape in robot.collision_model.shapes}
    for (first, second), reason in table.reasons.items():
        apart = abs(frames[first] - frames[second])
        assert apart > 0
        assert (apart == 1) == (reason == 'adjacent')


def test_pairs_that_never_meet_do_not(robot: BaseRobotModel, table: AllowedPairs, postures: np.ndarray):
    everything = CollisionDetection(robot, allowed_pairs=AllowedPairs({}))
    never = {pair for pair, reason in table.reasons.items() if reason == 'never'}
    for q in postures:
        assert never.isdisjoint(tuple(sorted(pair)) for pair in everything.contacts(q))


def test_libraries_find_no_contact_where_the_search_proves_a_distance(
    robot: BaseRobotModel, postures: np.ndarray
):
    fcl, coal = (detection_by(engine, robot) for engine in ('fcl', 'coal'))
    for q in postures:
        closest = fcl.distance(q)
        if closest is not None and closest.distance > 1e-5:  # up to which libraries may report a contact
            assert fcl.contacts(q) == coal.contacts(q) == ()


def test_the_stored_table_leaves_out_no_pair_that_is_not_proven(robot: BaseRobotModel, table: AllowedPairs):
    """Shapes, axes and limits are still those that the table was made for."""
    stored = robot.collision_model.allowed_pairs
    if stored is None:
        assert table.reasons.keys() == find_allowed_pairs(robot).reasons.keys()
        return
    assert dict(stored.reasons) == dict(find_allowed_pairs(robot).reasons)
