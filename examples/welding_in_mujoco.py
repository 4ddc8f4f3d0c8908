"""Run a robot program on a robot that MuJoCo simulates, and print how closely it follows.

ControllerSixAxes runs the program; MuJoCo moves the bodies; computed torque (Siciliano et al. 2009, section
8.5.2) turns references into torques of the joints.
"""

import argparse
import sys
from pathlib import Path

import mujoco
import numpy as np

from mujoco_model import mujoco_model
from robots_controller.controller_six_axes import ControllerSixAxes
from robots_controller.program.files.program_header import read_program_header
from robots_controller.simulation.record.events import TextPrinted
from robots_core import load_robot_model
from robots_core.blocks.multibody.function_dynamics import FunctionDynamics
from robots_core.errors import RobotsError
from robots_core.validation import Array

WELDING = Path(__file__).parents[1] / 'programs' / 'welding.lua'
PERIOD = 0.004  # s, of the controller
SUBSTEPS = 16  # of MuJoCo in a period; its integrator is of first order
BANDWIDTH = 2.0 * np.pi * 15.0  # rad/s, of errors that die away, with damping 1


def main() -> int:
    """Run a program; returns an exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('program', nargs='?', type=Path, default=WELDING, help='Lua robot program')
    parser.add_argument('--robot', default='', help='in the place of the one that the program names')
    options = parser.parse_args()
    try:
        return run(options.program, options.robot)
    except RobotsError as error:
        print(error, file=sys.stderr)
        return 2


def run(program: Path, robot_name: str) -> int:
    """Connect controller and MuJoCo, and print the tracking errors at the ends of the periods.

    Args:
        program: Lua robot program.
        robot_name: The robot; '' for the one that the program names.
    """
    header = read_program_header(program).replaced_by(robot=robot_name)
    robot = load_robot_model(header.robot)
    dynamics = FunctionDynamics(robot, friction=False)
    errors, tool_errors = [], []

    model = mujoco_model(robot, timestep=PERIOD / SUBSTEPS)
    data = mujoco.MjData(model)
    data.qpos[:] = robot.home
    with ControllerSixAxes(
        robot, program=program, scene=header.scene, io=header.io, period=PERIOD
    ) as controller:
        step = controller.step(data.qpos)
        while step.running:
            for substep in range(1, SUBSTEPS + 1):
                before_end = PERIOD * (1.0 - substep / SUBSTEPS)
                data.ctrl[:] = computed_torque(dynamics, step.references, before_end, data)
                mujoco.mj_step(model, data)
            errors.append(data.qpos - step.references[0])
            tool, wanted = (robot.direct_kinematics(q)[0] for q in (data.qpos, step.references[0]))
            tool_errors.append(tool - wanted)
            step = controller.step(data.qpos, velocities=data.qvel)
            for event in step.events:
                if isinstance(event, TextPrinted):
                    print(event.text)

    print(f'{step.run_state} after {step.time:.3f} s: {step.error or "no error"}')
    for name, error in zip(robot.axes_data.names, np.abs(errors).max(axis=0), strict=True):
        print(f'{name}: at most {error:.2e} from its reference')
    print(f'tool: at most {1e3 * np.linalg.norm(tool_errors, axis=1).max():.3f} mm from its reference')
    return 0 if step.error is None else 1


def computed_torque(
    dynamics: FunctionDynamics, references: Array, before_end: float, data: mujoco.MjData
) -> Array:
    """Torques that let errors of position and velocity die away, (n,), N m (N).

    Args:
        dynamics: The robot's.
        references: (3, n) at the end of the period.
        before_end: Time of these torques' effect before the end of the period, s.
        data: State of the simulation.
    """
    q, q_dot, q_ddot = references
    q_now = q - before_end * q_dot + 0.5 * before_end**2 * q_ddot
    q_dot_now = q_dot - before_end * q_ddot
    correction = 2.0 * BANDWIDTH * (q_dot_now - data.qvel) + BANDWIDTH**2 * (q_now - data.qpos)
    return dynamics.torques(data.qpos, data.qvel, q_ddot + correction)


if __name__ == '__main__':
    sys.exit(main())
