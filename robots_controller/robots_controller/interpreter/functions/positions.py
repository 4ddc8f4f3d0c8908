"""Positions: where the robot is, and taught points."""

from typing import Final

from robots_controller.degrees import joints_to_program
from robots_controller.interpreter.functions.lua_function import Argument, LuaFunction
from robots_controller.interpreter.functions.run_context import Handlers, RunContext, Waits
from robots_controller.interpreter.lua_arguments import Arguments
from robots_controller.interpreter.lua_sandbox import Result, Waiting
from robots_controller.program.taught_points import TaughtPoint, read_points, write_points
from robots_core.errors import ProgramError

POSITIONS: Final = (
    LuaFunction(
        'getJointAngles',
        (),
        'Reads where the joints are, in degrees, in metres for sliding axes.',
        'a table of n numbers',
        'number[]',
    ),
    LuaFunction(
        'getJointSpeeds',
        (),
        'Reads how fast the joints move now, in degrees/s, in m/s for sliding axes; does not wait.',
        'a table of n numbers',
        'number[]',
    ),
    LuaFunction(
        'getJointTorques',
        (),
        'Reads the torques of the motors now, at the joints, in N m (N); does not wait.',
        'a table of n numbers',
        'number[]',
    ),
    LuaFunction(
        'getCartesianPosition',
        (),
        'Reads where the tool is, seen from the base: {x, y, z, phi1, phi2, phi3}.',
        'a pose',
        'Pose',
    ),
    LuaFunction(
        'teach',
        (Argument('name', 'name', '', 'name of the point'),),
        'Writes where the robot is to the points file under a name.',
    ),
    LuaFunction(
        'getTaughtPoint',
        (Argument('name', 'name', '', 'name of the point'),),
        'Reads a taught point: its joint angles, and the pose of the flange {x, y, z, phi1, phi2, phi3}.',
        'a table of n numbers, a pose',
        'number[], Pose',
    ),
)
"""Where the robot is, and taught points."""


class Positions:
    """Measures where the robot is, and keeps taught points.

    Args:
        run: The run.
        waits: How its functions wait.
    """

    def __init__(self, run: RunContext, waits: Waits) -> None:
        self._run, self._waits = run, waits
        self.handlers: Handlers = {
            'getJointAngles': self._get_joint_angles,
            'getJointSpeeds': self._get_joint_speeds,
            'getJointTorques': lambda _: (tuple(run.cell.joint_torques().tolist()),),
            'getCartesianPosition': self._get_cartesian_position,
            'teach': self._teach,
            'getTaughtPoint': self._get_taught_point,
        }

    def _get_joint_angles(self, _: Arguments) -> Waiting:
        yield from self._waits.standstill()
        return (joints_to_program(self._run.view.position(), self._run.view.prismatic),)

    def _get_joint_speeds(self, _: Arguments) -> Result:
        view = self._run.view
        return (joints_to_program(self._run.cell.joint_speeds(), view.prismatic),)

    def _get_cartesian_position(self, _: Arguments) -> Waiting:
        yield from self._waits.standstill()
        pose = self._run.target.seen(self._run.view.flange(self._run.view.position()))
        return (self._run.shown(pose),)

    def _teach(self, arguments: Arguments) -> Waiting:
        yield from self._waits.standstill()
        q = self._run.view.position()
        points = read_points(self._run.view.points_file, self._run.state.num_axes)
        points[arguments.values[0]] = TaughtPoint(q, self._run.view.flange(q))
        write_points(self._run.view.points_file, points)
        return None

    def _get_taught_point(self, arguments: Arguments) -> Result:
        name, file = arguments.values[0], self._run.view.points_file
        points = read_points(file, self._run.state.num_axes)
        if name not in points:
            known = ', '.join(sorted(points)) or 'none'
            raise ProgramError(f'no point is named {name!r} in {file.name}; points are {known}')
        point = points[name]
        return (
            joints_to_program(point.q, self._run.view.prismatic),
            self._run.shown(point.pose),
        )
