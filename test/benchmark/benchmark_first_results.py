"""Time until the first result of every block and planner in a process of its own, as one table.

Run by `make benchmark-first-results`; OPTIONS=--markdown prints the table of docs/explanation/benchmarks.md.
The time begins with the start of the process, before Python's own start, and ends with the result; imports,
the robot and the loading of compiled code from its cache are included. Below stands what bare NumPy, Numba
with a function of one line from its cache, and Pinocchio take in the same run.
"""

from __future__ import annotations

import argparse
import re
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

ROBOT = 'kuka_kr210_r2700'
FLOATING = 'debris_arm?gravity=0,0,0'
GOAL = 0.6  # s
LOAD = (
    f"from robots_core import Pose, load_robot_model; robot = load_robot_model('{ROBOT}'); "
    'home = robot.home; '
)
POSE = 'pose = Pose(*robot.direct_kinematics(home + 0.1)); '
NEAR = 'r, T = robot.direct_kinematics(home + 0.1); near = Pose(r + 0.02, T); '
FLOAT = (
    f"from robots_core import load_robot_model; robot = load_robot_model('{FLOATING}'); home = robot.home; "
)
NUMPY = 'import numpy as np; '

BLOCKS = {
    'robot: direct_kinematics': LOAD + 'robot.direct_kinematics(home)',
    'robot: jacobian': LOAD + 'robot.jacobian(home)',
    'robot: rigid_dynamics': LOAD + 'robot.rigid_dynamics(home, home, home)',
    'DirectKinematics': LOAD + 'DirectKinematics(robot).forward(home)',
    'AnalyticalInverseKinematic': LOAD + POSE + 'AnalyticalInverseKinematic(robot).solve(pose, home)',
    'DampedLeastSquares': LOAD + POSE + 'DampedLeastSquares(robot).solve(pose, home)',
    'ConstrainedInverseKinematics': LOAD
    + POSE
    + 'ConstrainedInverseKinematics(robot, 0.004).step(pose, home, 0.0 * home)',
    'FunctionDynamics': LOAD + 'FunctionDynamics(robot).accelerations(home, home, home)',
    'NumericalDynamics': LOAD + 'NumericalDynamics(robot).accelerations(home, home, home)',
    'IdealDrive': LOAD + 'IdealDrive(home, period=0.004).step(home)',
    'SecondOrderDrive': LOAD + 'SecondOrderDrive(home, period=0.004).step(home)',
    'RigidBodyDrive': LOAD + 'RigidBodyDrive(robot, home, period=0.004).step(home)',
    'CollisionDetection': LOAD + 'CollisionDetection(robot).distance(home)',
    'JointPath': LOAD + 'JointPath.straight(home, home + 0.1).sample(0.5)',
    'read_scene': "read_scene('programs/scenes/car_frame.yaml')",
    'ZoneDetection': LOAD + 'from robots_core.robot_model.shapes import Box; '
    'from robots_core.blocks import PlacedBox, Zone, Scene, JointPath; '
    "zone = Zone('in', PlacedBox(Box((9.0, 9.0, 9.0)), Pose.identity()), 'in', 'tool'); "
    'ZoneDetection(robot, Scene(zones=(zone,))).passages(zone, JointPath.straight(home, home + 0.01))',
    'FreeFloatingDynamics': FLOAT + 'FreeFloatingDynamics(robot).accelerations(home, 0.0 * home, home)',
    'FreeFloatingRobot': FLOAT + 'FreeFloatingRobot(robot, home).step(0.0 * home, 0.004)',
    'FloatingBase': FLOAT + 'FloatingBase(robot, home).step(home, 0.0 * home, 0.004)',
    'read_orbit': "read_orbit('programs/debris_removal/orbit.yaml')",
    'MotionCueing': 'from robots_core.blocks import VehicleMotion, read_cabin; '
    "cabin = read_cabin('programs/motion_simulator/cabin.yaml'); "
    'MotionCueing(cabin.washout, cabin.envelope, 0.004).step(VehicleMotion.at_rest())',
    'WheelSoilModel': NUMPY
    + 'from robots_core.blocks import Soil, Wheel; soil = Soil(k_c=900.0, k_phi=1e6, n=1.0, cohesion=0.0, '
    'friction=0.6, shear_modulus=0.01, c1=0.4, c2=0.2); '
    'WheelSoilModel(Wheel(radius=0.09, width=0.11), soil).forces(0.01, 0.3)',
    'measure_base': 'measure_base((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))',
}
_TEACH = 'box = TeachBox(robot, 0.004, home); box.jog_axes(0.1 + 0.0 * home, time=0.0); box.step(0.0)'
PLANNERS = {
    'LinearJoint': LOAD + 'LinearJoint(robot).generate(home, home + 0.1)',
    'LinearJointAxes': LOAD + 'LinearJointAxes(robot).generate(home, home + 0.1)',
    'LinearCartesianLimited': LOAD + NEAR + 'LinearCartesianLimited(robot).generate(home + 0.1, near)',
    'LinearCartesianDynamicProgramming': LOAD
    + NEAR
    + 'LinearCartesianDynamicProgramming(robot).generate(home + 0.1, near)',
    'CircularCartesian': LOAD
    + NEAR
    + 'via = Pose(r + (0.02, 0.0, 0.0), T); CircularCartesian(robot).generate(home + 0.1, [via, near])',
    'SplineCartesian': LOAD
    + NEAR
    + 'via = Pose(r + (0.02, 0.0, 0.0), T); SplineCartesian(robot).generate(home + 0.1, [via, near])',
    'CollisionFreeJoint': LOAD + 'CollisionFreeJoint(robot).generate(home, home + 0.1)',
    'verify': LOAD
    + 'from robots_planning import LinearJoint; verify(LinearJoint(robot).generate(home, home + 0.1), robot)',
    'RealtimeMovement': LOAD + 'RealtimeMovement(robot, 0.004, home).step(0.0)',
    'TeachBox': LOAD + _TEACH,
}
CACHED_FUNCTION = """
import numpy as np, numba

@numba.njit(cache=True)
def first(values):
    return values[0]

first(np.zeros(3))
"""
RESULT = '\nimport time; print(time.process_time(), flush=True)\n'


class FirstResult(NamedTuple):
    """Medians, in s."""

    name: str
    wall: float
    cpu: float


def measured(name: str, program: str, repetitions: int) -> FirstResult:
    """Once more than asked for: the first run fills the caches of the system."""
    walls, cpus = [], []
    with tempfile.TemporaryDirectory() as folder:
        script = Path(folder) / 'first_result.py'
        script.write_text(program + RESULT)
        for _ in range(repetitions + 1):
            start = time.perf_counter()
            with subprocess.Popen([sys.executable, '-P', script], stdout=subprocess.PIPE) as process:
                assert process.stdout is not None
                cpus.append(float(process.stdout.readline()))
                walls.append(time.perf_counter() - start)
    return FirstResult(name, statistics.median(walls[1:]), statistics.median(cpus[1:]))


def first_results(names: str, repetitions: int) -> list[FirstResult]:
    programs = {}
    for package, calls in (('robots_core.blocks', BLOCKS), ('robots_planning', PLANNERS)):
        for name, call in calls.items():
            load = '' if name.startswith('robot: ') else f'from {package} import {name}; '
            programs[name] = load + call
    return [
        measured(name, program, repetitions) for name, program in programs.items() if re.search(names, name)
    ]


def bare_results(repetitions: int) -> list[FirstResult]:
    programs = {
        'Python alone': '',
        'NumPy alone': 'import numpy',
        'Pinocchio alone': 'import pinocchio',
        'Numba alone, a function from its cache': CACHED_FUNCTION,
    }
    return [measured(name, program, repetitions) for name, program in programs.items()]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--repetitions', type=int, default=5)
    parser.add_argument('--only', default='', help='names to measure, as a regular expression')
    parser.add_argument('--markdown', action='store_true', help='print the table for the documentation')
    options = parser.parse_args()
    results = sorted(first_results(options.only, options.repetitions), key=lambda one: -one.cpu)
    results += bare_results(options.repetitions)
    line = '| {} | {} | {} |' if options.markdown else '{:42} {:>8} {:>8}'
    print(line.format('first result of', 'time', 'processor'))
    if options.markdown:
        print(line.format('---', '---', '---'))
    for name, wall, cpu in results:
        print(line.format(name, f'{wall:.2f} s', f'{cpu:.2f} s'))
    if not options.markdown:
        slow = [one.name for one in results if one.wall > GOAL]
        print(f'goal {GOAL} s' + (f', missed by {", ".join(slow)}' if slow else ''))


if __name__ == '__main__':
    main()
