"""LinkFrames: the tree of a robot's frames."""

from __future__ import annotations

import numpy as np
import pytest

from robots_core import Pose, available_robot_models, load_robot_model
from robots_core.blocks.link_frames import FramePose, LinkFrames


def joint(name: str, kind: str, parent: str, child: str, more: str = '') -> str:
    return (
        f'<link name="{child}"/><joint name="{name}" type="{kind}"><parent link="{parent}"/>'
        f'<child link="{child}"/>{more}</joint>'
    )


SLIDE = '<axis xyz="0 1 0"/><limit lower="%s" upper="%s"/>'
URDF = '<robot name="r"><link name="world"/>{}</robot>'.format(
    ''.join(
        [
            joint('mount', 'fixed', 'world', 'a', '<origin xyz="0 0 1" rpy="0 0 1.5707963268"/>'),
            joint('J1', 'revolute', 'a', 'b', '<axis xyz="0 0 2"/><limit lower="-1" upper="1"/>'),
            joint('wrist', 'fixed', 'b', 'tool0'),
            joint('left', 'prismatic', 'tool0', 'finger_1', SLIDE % (0.01, 0.05)),
            joint(
                'right',
                'prismatic',
                'tool0',
                'finger_2',
                SLIDE % (-0.05, 0) + '<mimic joint="left" multiplier="-1" offset="0.002"/>',
            ),
        ]
    )
)


def in_root(frames: tuple[FramePose, ...], root: str) -> dict[str, Pose]:
    """Poses in the root, along the parents; each frame has one."""
    by_child = {frame.child: frame for frame in frames}
    assert len(by_child) == len(frames)
    found = {root: Pose.identity()}

    def pose(name: str) -> Pose:
        if name not in found:
            frame = by_child[name]
            found[name] = pose(frame.parent) @ frame.pose
        return found[name]

    return {name: pose(name) for name in by_child}


@pytest.mark.parametrize('name', available_robot_models())
def test_the_chain_leads_where_the_robots_own_kinematics_do(name: str):
    robot = load_robot_model(name)
    q = robot.home + 0.05
    frames = LinkFrames(robot.description)
    moving = tuple(frames.moving(dict(zip(robot.axes_data.names, q, strict=True))))
    found = (*frames.fixed, *moving)
    (root,) = {frame.parent for frame in found} - {frame.child for frame in found}
    assert root == 'base_link'
    poses = {root: Pose.identity(), **in_root(found, root)}
    base = poses['base'].inverse()
    poses = {frame: base @ pose for frame, pose in poses.items()}
    tool0 = Pose(*robot.direct_kinematics(q))
    assert poses['tool0'].distance_to(tool0) == pytest.approx((0.0, 0.0), abs=1e-9)
    r, T = robot.kinematic_model.frame_axes(q)
    for k, frame in enumerate(moving[: robot.num_axes]):
        assert poses[frame.child].distance_to(Pose(r[k], T[k])) == pytest.approx((0.0, 0.0), abs=1e-9)
    assert all(frame.parent not in (root, 'base') for frame in moving[1:])
    assert poses['base_link'].distance_to(robot.base_link) == pytest.approx((0.0, 0.0), abs=1e-9)
    # REP-199: the flange's x axis points away from the robot, as the z axis of tool0.
    np.testing.assert_allclose(poses['flange'].T[:, 0], tool0.T[:, 2], atol=1e-9)


def test_joints_beside_the_axes_are_taken_mimicked_or_at_rest():
    frames = LinkFrames(URDF)
    by_child = {frame.child: frame.pose for frame in frames.moving({'J1': 0.5})}
    assert by_child['finger_1'].r[1] == 0.01
    by_child = {frame.child: frame.pose for frame in frames.moving({'J1': 0.5, 'left': 0.03})}
    assert by_child['finger_1'].r[1] == 0.03
    assert by_child['finger_2'].r[1] == pytest.approx(-0.028)
    np.testing.assert_allclose(by_child['b'].T[:2, 0], [np.cos(0.5), np.sin(0.5)])


def test_the_root_of_a_description_gets_the_standard_names():
    fixed = {frame.child: frame.parent for frame in LinkFrames(URDF).fixed}
    assert fixed == {'a': 'world', 'tool0': 'b', 'base_link': 'world', 'base': 'world', 'flange': 'tool0'}
