"""Draws robots' shapes: `python robots_models/tools/generate_shapes.py kuka_kr210_r2700`.

Writes the parts of its drawing to `meshes/` in the robot's folder and names them in its URDF. What was drawn
before is replaced. The meshes are installed, these tools are not.
"""

import argparse
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pinocchio as pin
from lxml import etree

from drawings import DRAWINGS, drawn_at
from robots_core.robot_model.shapes import Mesh
from robots_core.validation import Array
from solids import Drawing, Part, stl

MESHES = 'meshes'
PACKAGE = Path(__file__).parents[1] / 'robots_models'


def generate_shapes(folder: Path, drawing: Drawing, posture: float) -> None:
    """Write the parts of a robot as meshes and name them in its URDF.

    Args:
        folder: The robot's folder; holds `robot.urdf`.
        drawing: What it looks like with all joints at `posture`.
        posture: rad (m).
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
    for part, solids in drawing.items():
        placement = data.oMf[model.getFrameId(part.link)]
        (meshes / f'{part.name}.stl').write_bytes(stl([_seen_from(placement, mesh) for mesh in solids]))
        for tag in ('visual', 'collision') if part.collision else ('visual',):
            _add_shape(links[part.link], tag, part)
    etree.indent(root)
    header = '<?xml version="1.0"?>\n'
    text = etree.tostring(root.getroottree(), encoding='unicode')
    urdf.write_text(header + text.replace('--><', '-->\n<') + '\n')


def _configuration(model: pin.Model, value: float) -> Array:
    configuration = pin.neutral(model)
    for joint in list(model.joints)[1:]:
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
    parser.add_argument('robots', nargs='+', choices=DRAWINGS, metavar='robot', help='its name')
    parser.add_argument(
        '--into',
        type=Path,
        default=PACKAGE,
        help="folder that holds the robots' folders; their own by default",
    )
    options = parser.parse_args(arguments)
    for robot in options.robots:
        generate_shapes(options.into / robot, DRAWINGS[robot], drawn_at(robot))
        print(f'{robot}: {len(DRAWINGS[robot])} parts')


if __name__ == '__main__':
    main()
