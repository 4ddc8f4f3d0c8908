"""Rendezvous: an arm on a floating satellite approaches a tumbling target, grasps it and steadies both."""

from __future__ import annotations

from typing import Final

import numpy as np
import pinocchio as pin

from robots_core.blocks.floating_base.floating_base import FloatingBase
from robots_core.blocks.floating_base.orbit import Orbit
from robots_core.blocks.floating_base.tumbling_body import TumblingBody
from robots_core.blocks.multibody.payload import NOTHING, Payload
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.status import Level, Status
from robots_core.validation import Array, read_only

# The tool moves with the target when it is this close to the point that it follows.
SYNCHRONISED: Final = 0.01  # m
AT_REST: Final = 1e-4  # rad/s of the base, rad/s (m/s) of the joints
CLOSE: Final = 1
"""Digital output that closes the gripper, counted from 1."""
WORLD_FRAME: Final = 'world'
"""Of the poses of base and target."""
SHOWN_RATE: Final = 25.0  # Hz, of poses and momentum for people
PARTS: Final = ('chaser', 'target', 'wheels')


class Rendezvous:
    """The bodies of an `Orbit`, stepped with the motion of the arm's drives.

    Until the grasp, satellite and target move on their own. The camera of the satellite measures where the
    ring of the target is, and leads the tool: first to a point before it, and along the ring's axis from when
    the tool moves with it. A gripper that is commanded to close grasps as soon as the ring is in its reach;
    what moves too fast to be held is refused. The grasp joins both as rigid bodies: their momentum is the sum
    of the momenta before. The load that it is for joints that hold, their impulse over the time in which the
    gripper closes, must be within their limits. Then reaction wheels on the satellite take over the angular
    momentum, until both bodies stand. The linear momentum stays: only thrusters would change it.

    Args:
        robot: The arm and its satellite, without gravity.
        q: Joint positions at the start, (n,), rad (m), at rest.
        orbit: What is there at the start.
        period: Of a step, s.
        payload: What the arm carries from the start.

    Raises:
        InvalidInputError: a robot with gravity, or whose base has no mass or no inertia.
    """

    def __init__(
        self, robot: BaseRobotModel, q: Array, orbit: Orbit, *, period: float, payload: Payload = NOTHING
    ) -> None:
        target = orbit.target
        self._orbit, self._period = orbit, period
        self.base = FloatingBase(robot, q, twist=orbit.twist, payload=payload)
        self.target = TumblingBody(
            target.body, target.pose, velocity=target.velocity, angular_velocity=target.angular_velocity
        )
        self.impact_inertia: Array | None = None
        """Of the drives, whose joints yield to the grasp; None for joints that hold."""
        self.guided = False
        """The camera leads the tool; the approach begins again when it does again."""
        self.grasped = self.refused = self.at_rest = False
        self.report = ''
        """What became of the grasp, with its numbers; '' before."""
        self.measured = (0.0, 0.0)
        """Speed (m/s) and angular velocity (rad/s) of the ring, seen by the gripper when it was to close."""
        self._every, self._count = max(1, round(1.0 / (SHOWN_RATE * period))), 0
        self._closing = self._touched = False
        self._distance = orbit.approach.distance
        self._gliding = False
        self._held = Pose.identity()  # the target's frame in tool0

    # -- what it is connected to ---------------------------------------------------------------------

    @property
    def digital_inputs(self) -> tuple[bool, bool, bool]:
        """Grasped, refused, and at rest together with the target."""
        return self.grasped, self.refused, self.at_rest

    @property
    def status(self) -> Status:
        """As it travels on `grasp_status`."""
        return Status('grasp', self.report, Level.ERROR if self.refused else Level.OK)

    @property
    def shown(self) -> bool:
        """Poses and momentum are to be published after this step."""
        return self._count % self._every == 0

    @property
    def momentum(self) -> Array:
        """Of the `PARTS`, (3, 6): linear (N s), and angular about the world's origin (N m s), world axes."""
        target = self.target.momentum
        wheels = np.concatenate([np.zeros(3), self.base.pose.T @ self.base.wheel_momentum])
        chaser = self.base.momentum - wheels - (target if self.grasped else 0.0)
        return read_only([chaser, target, wheels])

    @property
    def reference(self) -> tuple[Pose, Array] | None:
        """Where the tool is to be and how that moves, (6,) m/s and rad/s, in the base; None if not seen.

        Nothing is measured while the camera does not lead the tool, or when the target is grasped.
        """
        if not self.guided or self.grasped:
            return None
        base, ring = self.base.pose, self._ring()
        place = base.inverse() @ ring
        if np.linalg.norm(place.r) > self._orbit.approach.camera_range:
            return None
        point = ring.r - self._distance * ring.T[:, 2]
        velocity = self.target.velocity_at(point)
        if self._gliding and self._distance > 0.0:
            velocity = velocity + self._orbit.approach.speed * ring.T[:, 2]
        turn = base.T @ self.base.twist[3:]
        moving = velocity - base.T @ self.base.twist[:3] - pin.skew(turn) @ (point - base.r)
        twist = np.concatenate([base.T.T @ moving, base.T.T @ (self.target.angular_velocity - turn)])
        return Pose(base.T.T @ (point - base.r), place.T), twist

    def close(self, *, closing: bool) -> None:
        """Command the gripper to close at the ring, or to open; what it has grasped it keeps."""
        if closing == self._closing or self.grasped:
            return
        self._closing, self.refused = closing, False
        if closing:
            self.measured = self._seen()
            self._refuse(self._beyond())

    # -- the motion ------------------------------------------------------------------------------------

    def step(self, q: Array, q_dot: Array) -> None:
        """Advance by a period, in which the drives move the joints to a position and velocity, (n,) each."""
        self._count += 1
        self.base.step(q, q_dot, self._period, self._wheel_torque())
        if self.grasped:
            self._carry_target()
            still = np.abs(np.concatenate([self.base.twist[3:], q_dot])).max() <= AT_REST
            self.at_rest = bool(still)
            return
        self.target.step(self._period)
        self._approach()
        self._detect_contact(q)

    def _ring(self) -> Pose:
        return self.target.pose @ self._orbit.target.ring

    def _seen(self) -> tuple[float, float]:
        """Speed and angular velocity of the ring, from the gripper."""
        tool, twist = self.base.tool
        speed = np.linalg.norm(self.target.velocity_at(tool.r) - twist[:3])
        return float(speed), float(np.linalg.norm(self.target.angular_velocity - twist[3:]))

    def _approach(self) -> None:
        if not self.guided:
            self._distance, self._gliding = self._orbit.approach.distance, False
            return
        ring, (tool, _) = self._ring(), self.base.tool
        point = ring.r - self._distance * ring.T[:, 2]
        self._gliding = bool(np.linalg.norm(tool.r - point) <= SYNCHRONISED)
        if self._gliding:
            self._distance = max(0.0, self._distance - self._orbit.approach.speed * self._period)

    def _detect_contact(self, q: Array) -> None:
        tool, _ = self.base.tool
        touched = bool(np.linalg.norm(tool.r - self._ring().r) <= self._orbit.gripper.reach)
        if touched and self._closing and not self.refused:
            self.measured = self._seen()
            held = tool.inverse() @ self.target.pose
            impulse = self.base.impulse(self.target.body.seen_from(held), self.target.momentum)
            self._refuse('; '.join(filter(None, [self._beyond(touched=True), self._overload(impulse)])))
            if not self.refused:
                self._grasp(tool, held, impulse)
            return
        why = 'the ring touches the gripper, which is not closing' if touched else self._entered(q)
        if why and not self._touched and not self.refused:
            self._refuse(f'contact where none was planned: {why}')
        self._touched = bool(why)

    def _entered(self, q: Array) -> str:
        """Which part of the arm is inside the target's sphere; '' for none."""
        base, radius = self.base.pose, self._orbit.target.radius
        center = base.T.T @ (self.target.center_of_mass - base.r)
        frames, _ = self.base.robot.kinematic_model.frame_axes(q)
        points = np.array([np.zeros(3), *frames, self.base.robot.direct_kinematics(q)[0]])
        along = np.diff(points, axis=0)
        length = np.maximum(np.einsum('ij,ij->i', along, along), 1e-12)
        part = np.clip(np.einsum('ij,ij->i', center - points[:-1], along) / length, 0.0, 1.0)
        away = np.linalg.norm(points[:-1] + part[:, None] * along - center, axis=1)
        worst = int(away.argmin())
        if away[worst] >= radius:
            return ''
        names = ('base', *self.base.robot.axes_data.names)
        return (
            f"the arm behind {names[worst]} is {away[worst]:.3g} m from the target's centre, "
            f'which needs {radius:.3g} m'
        )

    def _beyond(self, *, touched: bool = False) -> str:
        """Why the target, as it was measured, cannot be held and steadied; '' if it can."""
        gripper, capacity = self._orbit.gripper, self._orbit.wheels.capacity
        (speed, rotation), reasons = self.measured, []
        if touched and speed > gripper.speed:
            reasons.append(f'the ring moves at {speed:.4g} m/s, the gripper holds {gripper.speed:.4g} m/s')
        if rotation > gripper.rotation:
            holds = f'the gripper holds {gripper.rotation:.4g} rad/s'
            reasons.append(f'the target turns at {rotation:.4g} rad/s, {holds}')
        mass, center = self.base.center_of_mass
        common = mass * center + self.target.body.mass * self.target.center_of_mass
        common /= mass + self.target.body.mass
        total = self.base.momentum + self.target.momentum
        spin = float(np.linalg.norm(total[3:] - pin.skew(common) @ total[:3]))
        if spin > capacity:
            reasons.append(
                f'both have an angular momentum of {spin:.4g} N m s, the wheels take {capacity:.4g} N m s'
            )
        return '; '.join(reasons)

    def _overload(self, impulse: Array) -> str:
        """Why the joints would not hold at the grasp, for their impulses (n,); '' if they do."""
        axes, duration = self.base.robot.axes_data, self._orbit.gripper.duration
        load = np.abs(impulse) / duration
        worst = int((load / axes.effort).argmax())
        if load[worst] <= axes.effort[worst]:
            return ''
        unit = axes.unit(worst, 'torque')
        return (
            f'the grasp within {duration:g} s would load {axes.names[worst]} with {load[worst]:.4g} {unit}, '
            f'its limit is {axes.effort[worst]:.4g} {unit}'
        )

    def _refuse(self, reason: str) -> None:
        if reason:
            self.refused, self.report = True, f'grasp refused: {reason}'

    def _grasp(self, tool: Pose, held: Pose, joints: Array) -> None:
        (speed, rotation), before, arm = self.measured, self.target.momentum, self.base.joint_velocity
        self._held = held
        self.base.take(self.target.body.seen_from(held), before, impact_inertia=self.impact_inertia)
        self.grasped = True
        self._carry_target()
        impulse = self.target.momentum - before
        turn = impulse[3:] - pin.skew(tool.r) @ impulse[:3]
        axes = self.base.robot.axes_data
        part = 100.0 * np.abs(joints) / self._orbit.gripper.duration / axes.effort
        worst = int(part.argmax())
        yielded = np.abs(self.base.joint_velocity - arm).max()
        self.report = (
            f'grasped at {speed:.4g} m/s and {rotation:.4g} rad/s: impulse on the target '
            f'{np.linalg.norm(impulse[:3]):.4g} N s, and {np.linalg.norm(turn):.4g} N m s about the gripper; '
            f'{axes.names[worst]} is loaded by {part[worst]:.3g} % of its limit if it holds; '
            f'joints yield by up to {yielded:.3g} rad/s'
        )

    def _carry_target(self) -> None:
        tool, twist = self.base.tool
        pose = tool @ self._held
        velocity = twist[:3] + pin.skew(twist[3:]) @ (pose.r - tool.r)
        self.target.carry(pose, np.concatenate([velocity, twist[3:]]))

    def _wheel_torque(self) -> Array:
        """Torque on the wheels, (3,), N m, that brakes what is grasped."""
        if not self.grasped:
            return np.zeros(3)
        wheels, stored = self._orbit.wheels, self.base.wheel_momentum
        wanted = self.base.inertia @ self.base.twist[3:] / wheels.time_constant
        room = (wheels.capacity - np.sign(wanted) * stored) / self._period
        most = np.clip(room, 0.0, wheels.torque)
        return np.asarray(np.clip(wanted, -most, most))
