"""Draws a robot's shapes: `python -m robots_models.generate_shapes kuka_kr210_r2700`.

Reads the parts from `robots_models/<robot>/shapes.py`, writes them to `meshes/` in the robot's folder and
names them in its URDF. What was drawn before is replaced.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path

import numpy as np
import pinocchio as pin
from lxml import etree

from robots_core.robot_model.shapes import Mesh
from robots_core.validation import Array
from robots_models.shape_generation import Part, stl

MESHES = 'meshes'


def generate_shapes(folder: Path, parts: Sequence[Part], posture: Sequence[float]) -> None:
    """Write the parts of a robot as meshes and name them in its URDF.

    Args:
        folder: The robot's folder; holds `robot.urdf`.
        parts: What it looks like, in base coordinates with its joints at `posture`.
        posture: (n,) rad (m).
    """
    urdf = folder / 'robot.urdf'
    root = etree.fromstring(urdf.read_bytes(), etree.XMLParser(remove_blank_text=True))
    for link in root.findall('link'):
        for tag in ('visual', 'collision'):
            for shape in link.findall(tag):
                link.remove(shape)
    for material in root.findall('material'):
        root.remove(material)

    model = pin.buildModelFromXML(etree.tostring(root, encoding='unicode'))
    data = model.createData()
    pin.framesForwardKinematics(model, data, _configuration(model, posture))
    meshes = folder / MESHES
    meshes.mkdir(exist_ok=True)
    for old in meshes.glob('*.stl'):
        old.unlink()
    links = {link.get('name'): link for link in root.findall('link')}
    for part in parts:
        placement = data.oMf[model.getFrameId(part.link)]
        (meshes / f'{part.name}.stl').write_bytes(stl([_seen_from(placement, mesh) for mesh in part.meshes]))
        for tag in ('visual', 'collision') if part.collision else ('visual',):
            _add_shape(links[part.link], tag, part)
    etree.indent(root)
    header = '<?xml version="1.0"?>\n'
    text = etree.tostring(root.getroottree(), encoding='unicode')
    urdf.write_text(header + text.replace('--><', '-->\n<') + '\n')


def _configuration(model: pin.Model, posture: Sequence[float]) -> Array:
    configuration = pin.neutral(model)
    for joint, value in zip(list(model.joints)[1:], posture, strict=True):
        # To Pinocchio a joint that turns without end is a point on the unit circle.
        configuration[joint.idx_q : joint.idx_q + joint.nq] = (
            value if joint.nq == 1 else (np.cos(value), np.sin(value))
        )
    return np.asarray(configuration)


def _seen_from(placement: pin.SE3, mesh: Mesh) -> Mesh:
    return Mesh((mesh.vertices - placement.translation) @ placement.rotation, mesh.faces)


def _add_shape(link: etree._Element, tag: str, part: Part) -> None:
    shape = etree.SubElement(link, tag, name=part.name)
    geometry = etree.SubElement(shape, 'geometry')
    etree.SubElement(geometry, 'mesh', filename=f'{MESHES}/{part.name}.stl')
    if tag == 'visual':
        rgba = ' '.join(f'{channel:g}' for channel in (*part.colour, 1.0))
        material = etree.SubElement(
            shape, 'material', name='colour_' + '_'.join(f'{round(255 * c):02x}' for c in part.colour)
        )
        etree.SubElement(material, 'color', rgba=rgba)


def main(arguments: Sequence[str] | None = None) -> None:
    """Draw the shapes of the robots that the command line names."""
    parser = argparse.ArgumentParser(description='Draw the shapes of robots.')
    parser.add_argument('robots', nargs='+', metavar='robot', help='name of a robot of this package')
    parser.add_argument(
        '--into', type=Path, help="folder that holds the robots' folders; this package's own by default"
    )
    options = parser.parse_args(arguments)
    for robot in options.robots:
        shapes = import_module(f'robots_models.{robot}.shapes')
        root = options.into or Path(__file__).parent
        generate_shapes(root / robot, shapes.PARTS, shapes.DRAWING_POSTURE)
        print(f'{robot}: {len(shapes.PARTS)} parts')


if __name__ == '__main__':
    main()
