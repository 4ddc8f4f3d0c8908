"""Positions: where the robot is, and taught points."""

from typing import Final

from robots_controller.degrees import joints_to_program
from robots_controller.interpreter import argument_kinds as kinds
from robots_controller.interpreter.functions.lua_function import (
    A_POSE,
    JOINT_NUMBERS,
    Argument,
    lua_function,
)
from robots_controller.interpreter.functions.run_context import Family
from robots_controller.interpreter.lua_sandbox import Result, Waiting
from robots_controller.program.files.taught_points import TaughtPoint, read_points, write_points
from robots_core.errors import ProgramError

_NAME: Final = Argument('name', kinds.NAME, '', 'name of the point')


class Positions(Family):
    """Measures where the robot is, and keeps taught points."""

    @lua_function(returns=JOINT_NUMBERS)
    def getJointAngles(self) -> Waiting:
        """Reads the joint positions, in degrees; in metres for sliding axes."""
        yield from self._run.waits.standstill()
        return (joints_to_program(self._run.joint_position(), self._run.view.prismatic),)

    @lua_function(returns=JOINT_NUMBERS)
    def getJointSpeeds(self) -> Result:
        """Reads the present joint speeds, in degrees/s, in m/s for sliding axes; does not wait."""
        return (
            joints_to_program(
                self._run.cell.robot.joint_feedback().measured_velocity, self._run.view.prismatic
            ),
        )

    @lua_function(returns=JOINT_NUMBERS)
    def getJointTorques(self) -> Result:
        """Reads the present motor torques at the joints, in N m (N); does not wait."""
        return (tuple(self._run.cell.robot.joint_feedback().measured_torque.tolist()),)

    @lua_function(returns=A_POSE)
    def getCartesianPosition(self) -> Waiting:
        """Reads the pose of the tool in the base frame: {x, y, z, phi1, phi2, phi3}."""
        yield from self._run.waits.standstill()
        return (self._run.shown(self._run.tool_pose()),)

    @lua_function(_NAME)
    def teach(self, name: str) -> Waiting:
        """Stores the present position of the robot in the points file, under a name."""
        yield from self._run.waits.standstill()
        q = self._run.joint_position()
        points = read_points(self._run.view.points_file, self._run.state.num_axes)
        points[name] = TaughtPoint(q, self._run.cell.kinematics.direct(q))
        write_points(self._run.view.points_file, points)
        return None

    @lua_function(_NAME, returns=A_POSE)
    def getTaughtPose(self, name: str) -> Result:
        """Reads where a taught point is for the tool and base that are set: {x, y, z, phi1, phi2, phi3}."""
        return (self._run.shown(self._run.target.seen(self._point(name).pose)),)

    @lua_function(_NAME, returns=('a table of n numbers, a pose', 'number[], Pose'))
    def getTaughtPoint(self, name: str) -> Result:
        """Reads a taught point: its joint angles, and the pose of the flange {x, y, z, phi1, phi2, phi3}."""
        point = self._point(name)
        return joints_to_program(point.q, self._run.view.prismatic), self._run.shown(point.pose)

    def _point(self, name: str) -> TaughtPoint:
        file = self._run.view.points_file
        points = read_points(file, self._run.state.num_axes)
        if name not in points:
            known = ', '.join(sorted(points)) or 'none'
            raise ProgramError(f'no point is named {name!r} in {file.name}; points are {known}')
        return points[name]
