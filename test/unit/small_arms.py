"""Arms of three, four and five axes, as URDF."""

from functools import cache
from pathlib import Path
from tempfile import mkdtemp

import numpy as np

from robots_core import load_robot_model
from robots_core.robot_model.base_robot_model import BaseRobotModel

LINK = (
    '<link name="{name}"><inertial><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" '
    'ixy="0" ixz="0" iyz="0"/></inertial></link>'
)
JOINT = (
    '<joint name="J{i}" type="{type}"><parent link="{parent}"/><child link="{child}"/>'
    '<origin xyz="{xyz}"/><axis xyz="{axis}"/>'
    '<limit lower="{lower}" upper="{upper}" velocity="2" effort="300"/></joint>'
)
Z, Y = '0 0 1', '0 1 0'
AXES = {
    # turn, lift, bend: as the paper's arm; a fourth axis bends, a fifth rolls
    3: [('0 0 0.3', Z), ('0 0 0.2', Y), ('0.6 0 0', Y)],
    4: [('0 0 0.3', Z), ('0 0 0.2', Y), ('0.6 0 0', Y), ('0.5 0 0', Y)],
    5: [('0 0 0.3', Z), ('0 0 0.2', Y), ('0.6 0 0', Y), ('0.5 0 0', Y), ('0.1 0 0', '1 0 0')],
}
HOMES = {
    3: (0.2, -0.6, 1.2),
    4: (0.2, -0.6, 1.2, 0.5),
    5: (0.2, -0.6, 1.2, 0.5, 0.3),
    'scara': (0.4, 0.9, -0.2, 0.3),
}
TIPS = {3: '0.5 0 0', 4: '0.15 0 0', 5: '0.1 0 0.02', 'scara': '0 0 0'}


@cache
def name_of(which: int | str) -> str:
    """An arm with 3, 4 or 5 axes that turn, or 'scara': three about the vertical, one that slides."""
    joints = (
        [
            ('0 0 0.5', Z, 'revolute'),
            ('0.4 0 0', Z, 'revolute'),
            ('0.35 0 0', Z, 'prismatic'),
            ('0 0 0', Z, 'revolute'),
        ]
        if which == 'scara'
        else [(xyz, axis, 'revolute') for xyz, axis in AXES[int(which)]]
    )
    parts = [LINK.format(name='base')]
    for i, (xyz, axis, kind) in enumerate(joints, 1):
        reach = 0.4 if kind == 'prismatic' else 3.0
        parts += [
            LINK.format(name=f'L{i}'),
            JOINT.format(
                i=i, type=kind, parent=f'L{i - 1}' if i > 1 else 'base', child=f'L{i}', xyz=xyz, axis=axis,
                lower=-reach, upper=reach,
            ),
        ]  # fmt: skip
    parts.append('<link name="tool0"/>')
    parts.append(
        f'<joint name="tip" type="fixed"><parent link="L{len(joints)}"/><child link="tool0"/>'
        f'<origin xyz="{TIPS[which]}"/></joint>'
    )
    file = Path(mkdtemp()) / f'arm_{which}.urdf'
    file.write_text(f'<robot name="arm_{which}">{"".join(parts)}</robot>')
    return f'urdf:{file}'


@cache
def small_arm(which: int | str) -> BaseRobotModel:
    return load_robot_model(name_of(which))


def start_of(which: int | str) -> np.ndarray:
    return np.array(HOMES[which])


def to_the_start(which: int | str) -> str:
    """The motion of a program to the start posture."""
    robot, q = small_arm(which), start_of(which)
    values = [
        f'{value if slides else np.degrees(value):.12g}'
        for value, slides in zip(q, robot.axes_data.prismatic, strict=True)
    ]
    return f'ptpJointSpaceAngles({", ".join(values)})'
