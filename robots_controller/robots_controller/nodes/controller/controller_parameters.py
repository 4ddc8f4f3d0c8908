"""Parameters of the controller's node: its settings, and in which launch it is started."""

from typing import Final

from robots_controller.control.controller_settings import ControllerSettings
from robots_controller.runtime_folder import first_time
from robots_core.defaults import RATE
from robots_core.errors import RobotsError
from robots_core.ros.robot_node import RobotNode

PARAMETERS: Final = {
    'smoothing_time': ((0.0, 1.0), 'window of the moving average, s; 0 switches it off'),
    'ramp_time': ((1e-3, 60.0), 'shortest time from standstill to full path speed after a pause, s'),
    'feedback_timeout': ((1e-3, 3600.0), 'joint_states older than this are lost, s'),
    'goal_tolerance': ((1e-9, 1.0), 'the robot stands at its target when every axis is this close, rad'),
    'settling_time': ((1e-3, 3600.0), 'longest time from the end of the reference until it stands there, s'),
    'following_error': ((1e-6, 1e3), 'largest distance of an axis to its reference, rad'),
    'stream_timeout': ((1e-3, 60.0), 'a stream of single points is stale without one for this long, s'),
}
"""By name: lowest and highest values, in the unit of the text, and the text."""


def settings_by_parameters(node: RobotNode) -> ControllerSettings:
    """Declare them, and `rate`.

    Raises:
        InvalidInputError: one is out of its range.
    """
    rate = node.parameter('rate', RATE, 'references per second, Hz', bounds=(10.0, 2000.0))
    default = ControllerSettings()
    values = {
        name: node.parameter(name, getattr(default, name), text, bounds=bounds)
        for name, (bounds, text) in PARAMETERS.items()
    }
    return ControllerSettings(period=1.0 / rate, **values)


def earlier_start(node: RobotNode) -> str:
    """What a person is to know of an earlier start of a node in its launch.

    Returns:
        '' for the first start; another text also if that cannot be found out.

    Parameters:
        launch: Names the launch; '' for one that begins with this node.
    """
    text = 'within each of these names, every start but the first stays stopped until ~/reset'
    launch = node.parameter('launch', '', text)
    name = node.get_fully_qualified_name()
    try:
        again = bool(launch) and not first_time(f'{name} {launch}')
    except RobotsError as error:
        return f'whether {name} has been started before is not known: {error}'
    return f'{name} has been started anew since the launch' if again else ''
