"""Whether a node has been started before in its launch."""

from robots_controller.runtime_folder import first_time
from robots_core.errors import RobotsError
from robots_core.ros.robot_node import RobotNode


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
