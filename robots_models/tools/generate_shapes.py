"""Draws robots' shapes: `python robots_models/tools/generate_shapes.py kuka_kr210_r2700`.

Writes the parts of its drawing to `meshes/` in the robot's folder and names them in its URDF. What was drawn
before is replaced. The meshes are installed, these tools are not.
"""

import argparse
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Final

import numpy as np
import pinocchio as pin
from lxml import etree

from robot_shapes import (
    bello_bot,
    cello_bot,
    debris_arm,
    franka_fr3,
    kinova_j2n6s300,
    kuka_lbr_iiwa14,
    manutec_r3,
    mitsubishi_rv7frl,
)
from robot_shapes.kuka_kr import kuka_kr_parts
from robot_shapes.staubli import staubli_parts
from robot_shapes.universal_robots import universal_robots_parts
from robots_core.robot_model.shapes import Mesh
from robots_core.validation import Array
from robots_models.kuka_kr210_r2700.model import KukaKr210R2700
from robots_models.kuka_kr210_r3100.model import KukaKr210R3100
from robots_models.kuka_kr500_r2830.model import KukaKr500R2830
from robots_models.staubli_rx160.model import StaubliRx160
from robots_models.staubli_tx2_90.model import StaubliTx290
from robots_models.ur5e.model import Ur5e
from robots_models.ur10e.model import Ur10e
from solids import Drawing, Part, stl

MESHES = 'meshes'
PACKAGE = Path(__file__).parents[1] / 'robots_models'
DRAWINGS: Final[Mapping[str, Drawing]] = MappingProxyType(
    {
        'bello_bot': bello_bot.PARTS,
        'cello_bot': cello_bot.PARTS,
        'debris_arm': debris_arm.PARTS,
        'franka_fr3': franka_fr3.PARTS,
        'kinova_j2n6s300': kinova_j2n6s300.PARTS,
        'kuka_kr210_r2700': kuka_kr_parts(KukaKr210R2700.DATA),
        'kuka_kr210_r3100': kuka_kr_parts(KukaKr210R3100.DATA),
        'kuka_kr500_r2830': kuka_kr_parts(KukaKr500R2830.DATA, bulk=1.3),
        'kuka_lbr_iiwa14': kuka_lbr_iiwa14.PARTS,
        'manutec_r3': manutec_r3.PARTS,
        'mitsubishi_rv7frl': mitsubishi_rv7frl.PARTS,
        'staubli_rx160': staubli_parts(StaubliRx160.DATA, bulk=1.35),
        'staubli_tx2_90': staubli_parts(StaubliTx290.DATA, pale=True),
        'ur10e': universal_robots_parts(Ur10e.DATA, bulk=1.28),
        'ur5e': universal_robots_parts(Ur5e.DATA),
    }
)
"""The parts by robot, with all joints at `drawn_at`."""


def drawn_at(robot: str) -> float:
    """Angle of all joints in the drawing, rad (m)."""
    return math.pi if robot == 'kinova_j2n6s300' else 0.0


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
