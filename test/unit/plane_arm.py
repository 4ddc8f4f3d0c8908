"""A URDF of an arm that turns in a plane, and its files."""

from __future__ import annotations

from pathlib import Path

import trimesh

INERTIAL = (
    '<inertial><origin xyz="0.5 0 0"/><mass value="{mass}"/>'
    '<inertia ixx="0.01" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial>'
)
# Two links of 1 m that turn about z, a fixed pole on the first one, a spinning third axis.
ARM = f"""
<robot name="arm">
  <material name="green"><color rgba="0 1 0 0.5"/></material>
  <link name="base">{INERTIAL.format(mass=7)}</link>
  <link name="upper">{INERTIAL.format(mass=2)}
    <visual><origin xyz="0.5 0 0"/><geometry><box size="1 0.1 0.1"/></geometry>
      <material name="green"/></visual>
  </link>
  <link name="pole">{INERTIAL.format(mass=1)}
    <visual name="stick"><geometry><cylinder radius="0.1" length="0.5"/></geometry></visual>
    <collision><geometry><sphere radius="0.2"/></geometry></collision>
  </link>
  <link name="lower">{INERTIAL.format(mass=3)}
    <visual><geometry><mesh filename="MESH" scale="2 2 2"/></geometry>
      <material name="own"><color rgba="1 0 0 1"/></material></visual>
  </link>
  <link name="hand">{INERTIAL.format(mass=0.5)}</link>
  <link name="tool0"/>
  <joint name="one" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/>
    <limit lower="0.5" upper="1.5" velocity="1" effort="100"/></joint>
  <joint name="holder" type="fixed"><parent link="upper"/><child link="pole"/><origin xyz="1 0 0.25"/></joint>
  <joint name="two" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="1 0 0"/>
    <axis xyz="0 0 1"/><limit lower="-2" upper="2" velocity="1" effort="100"/></joint>
  <joint name="three" type="continuous"><parent link="lower"/><child link="hand"/><origin xyz="1 0 0"/>
    <axis xyz="1 0 0"/><limit velocity="1" effort="10"/></joint>
  <joint name="flange" type="fixed"><parent link="hand"/><child link="tool0"/><origin xyz="0.2 0 0"/></joint>
</robot>
"""


def write_arm(folder: Path, *, mesh: str = 'meshes/cube.stl', text: str = ARM) -> Path:
    (folder / 'meshes').mkdir(parents=True, exist_ok=True)
    trimesh.creation.box((1.0, 1.0, 1.0)).export(folder / 'meshes' / 'cube.stl')
    file = folder / 'arm.urdf'
    file.write_text(text.replace('MESH', mesh))
    return file
