"""RunSignals: what is computed from the arrays of a run: tool, torques, powers, uses of limits."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from robots_controller.report.recorded_run import RecordedRun
from robots_core.blocks.multibody.loaded_robot import loaded_robot
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import Array, read_only
from robots_planning.motion_settings import MotionSettings

LIMITS: Final = ('velocity', 'acceleration', 'torque')
QUANTITIES: Final = ('position', *LIMITS)


@dataclass(frozen=True, eq=False)
class RunSignals:
    """Signals over the run's time, (m,) rows; the tool is the one that the last motion was commanded with.

    What a drive makes of the time between two references is its own business: an interpolation that does not
    take the steps of acceleration in between into account may pass a limit that all values and steps keep.

    Attributes:
        flange_reference: Position (m, 3) m and orientation (m, 3, 3) of tool0 that the references ask for.
        tool: Position of the tool by the drives, (m, 3) m.
        lag: Distance of the tool to where its reference is at that time, (m,) m.
        tool_speed: Speed of the tool by the drives, (m,) m/s.
        reference_speed: Speed of the tool that the references ask for, (m,) m/s.
        torque: Torques, (m, n) N m (N): those of the drives, or those that the references need.
        measured: The torques are those of the drives.
        power: Mechanical power of each axis, (m, n) W; below 0 it brakes.
        use: By limit of `QUANTITIES`, how much of it the references use, (m, n): absolute value over limit,
            of velocities and accelerations also as steps from one reference to the next, of torques by
            inverse dynamics; of positions the distance from the middle of the range over its half.
    """

    flange_reference: tuple[Array, Array]
    tool: Array
    lag: Array
    tool_speed: Array
    reference_speed: Array
    torque: Array
    measured: bool
    power: Array
    use: dict[str, Array]

    @classmethod
    def of(cls, run: RecordedRun) -> RunSignals:
        """The signals of a run."""
        robot, axes = run.robot, run.robot.axes_data
        q_ref, q_dot_ref, q_ddot_ref = run.reference
        q, q_dot = run.feedback
        needed, offset = _carried(run)
        torque = needed if run.effort is None else run.effort
        (r, T), (r_ref, T_ref) = robot.tool_poses(q), robot.tool_poses(q_ref)
        lever, lever_ref = (np.einsum('mij,mj->mi', turned, offset) for turned in (T, T_ref))
        tool = r + lever
        middle, half = axes.middle_and_half
        rate, change = _steps(run)
        return cls(
            flange_reference=(read_only(r_ref), read_only(T_ref)),
            tool=read_only(tool),
            lag=read_only(np.linalg.norm(tool - (r_ref + lever_ref), axis=1)),
            tool_speed=_speed(robot, q, q_dot, lever),
            reference_speed=_speed(robot, q_ref, q_dot_ref, lever_ref),
            torque=read_only(torque),
            measured=run.effort is not None,
            power=read_only(torque * (q_dot_ref if run.effort is None else q_dot)),
            use={
                'position': read_only(np.abs(q_ref - middle) / half),
                'velocity': read_only(np.maximum(np.abs(q_dot_ref), np.abs(rate)) / axes.velocity),
                'acceleration': read_only(np.maximum(np.abs(q_ddot_ref), np.abs(change)) / axes.acceleration),
                'torque': read_only(np.abs(needed) / axes.effort),
            },
        )


def _carried(run: RecordedRun) -> tuple[Array, Array]:
    """Torques that the references need, (m, n) N m (N), and positions of the tool in tool0, (m, 3) m.

    Payload and tool are those of the last motion.
    """
    moved = [motion for motion in run.motions if motion.moved]
    last = np.searchsorted([motion.start for motion in moved], run.time, side='right')
    settings = [MotionSettings(), *(motion.settings for motion in moved)]
    payloads = [one.payload for one in settings]
    models = {payload: loaded_robot(run.robot, payload).rigid_dynamics_model for payload in set(payloads)}
    states = zip(last, *run.reference, strict=True)
    torques = np.array([models[payloads[row]].torques(*state) for row, *state in states])
    return torques, np.array([one.tool_pose.r for one in settings])[last]


def energy(time: Array, power: Array) -> Array:
    """Mechanical energy that each axis takes up, (n,) J, of powers (m, n) W at times (m,) s, by trapezoids.

    What comes back while an axis brakes is lost: common drives burn it in a resistor.
    """
    return np.asarray(np.trapezoid(np.maximum(power, 0.0), time, axis=0))


def _steps(run: RecordedRun) -> tuple[Array, Array]:
    """Velocities and accelerations as steps, at the reference that ends each, (m, n) rad/s, rad/s^2.

    No acceleration is made of steps over a gap.
    """
    q = run.reference[0]
    # A controller that was held up continues from where it was: to the drives that is one period.
    ticks = np.maximum(np.round(np.diff(run.time) / run.period), 1.0)
    step = (run.period * ticks - run.late[1:])[:, None]
    rate = np.diff(q, axis=0) / step
    whole = step < 1.5 * run.period
    change = np.diff(rate, axis=0) / run.period * (whole[1:] & whole[:-1])
    none = np.zeros((min(2, len(q)), q.shape[1]))
    return np.concatenate([none[:1], rate]), np.concatenate([none, change])


def _speed(robot: BaseRobotModel, q: Array, q_dot: Array, lever: Array) -> Array:
    """Speed of the tool, (m,) m/s, which is at `lever` from tool0, (m, 3) m, base frame."""
    twist = np.array([robot.jacobian(row) @ rate for row, rate in zip(q, q_dot, strict=True)])
    return read_only(np.linalg.norm(twist[:, :3] + np.cross(twist[:, 3:], lever), axis=1))
