"""CommanderServices: the commander of the robot and the operating mode, as messages of controller_node."""

from collections.abc import Callable
from functools import partial
from typing import Final

from std_msgs.msg import Bool, String
from std_srvs.srv import SetBool

from robots_controller.control.command_authority import HOLD_TIMEOUT, CommandAuthority
from robots_controller.control.control_loop import ControlLoop
from robots_core.cell_interface.operating_modes import Commander, OperatingMode
from robots_core.ros.peers.commander_watch import PENDANT_LOST_AFTER
from robots_core.ros.peers.heartbeat import HeartbeatWatch
from robots_core.ros.qos import make_publisher, subscribe
from robots_core.ros.robot_node import RobotNode
from robots_core.wording.safety_note import NOT_CERTIFIED

COMMANDERS = tuple(commander for commander in Commander if commander is not Commander.NOBODY)


def authority_by_parameters(node: RobotNode) -> CommandAuthority:
    """The authority that a node's parameters `operating_mode` and `hold_timeout` describe."""
    mode = node.parameter(
        'operating_mode',
        OperatingMode.AUTOMATIC.value,
        f'one of {", ".join(OperatingMode)}; {NOT_CERTIFIED}',
        read=OperatingMode,
    )
    timeout = node.parameter(
        'hold_timeout',
        HOLD_TIMEOUT,
        'in T1 and T2, run counts as held for this long after hold_to_run was true, s; 0: not needed',
        bounds=(0.0, 2.0),
    )
    return CommandAuthority(mode, hold_timeout=timeout)


class CommanderServices:
    """Publishes `commander`, `operating_mode` and `run_enabled`, latched, and serves commanders.

    For each commander, `~/commander/<name>` takes the robot (true) or gives it back (false), and
    `~/take_over/<name>` stops the robot and takes it from the present commander.

    A pendant that gives no sign of life any more loses the robot, which stops on its path.

    Args:
        on_mode: Called when the mode has changed.
        on_lost: Called with the reason when the commander of the robot is lost.
        watched: Nodes are watched at all.
    """

    def __init__(
        self,
        node: RobotNode,
        control: ControlLoop,
        on_mode: Callable[[], None],
        on_lost: Callable[[str], None],
        *,
        watched: bool = True,
    ) -> None:
        self._node, self._control, self._on_mode, self._on_lost = node, control, on_mode, on_lost
        self._authority = control.controller.speed.authority
        self._commander_publisher = make_publisher(node, String, 'commander')
        self._mode_publisher = make_publisher(node, String, 'operating_mode')
        self._enabled_publisher = make_publisher(node, Bool, 'run_enabled')
        for commander in COMMANDERS:
            name = commander.lower()
            node.serve(f'commander/{name}', partial(self._take, commander), SetBool)
            node.serve(f'take_over/{name}', partial(self._take_over, commander))
        subscribe(node, Bool, 'hold_to_run', self._on_hold)
        node.on_change('operating_mode', self._set_mode)
        timeout = PENDANT_LOST_AFTER if watched else 0.0
        period = control.controller.settings.period
        self.watch: Final = HeartbeatWatch(
            node, ('pendant_node',), timeout, self._on_pendant, loop_period=period
        )
        """The signs of life of the pendant, for the loop."""
        self._publish()

    def run_enabled(self, *, enabled: bool) -> None:
        """Motions of programs may continue, or wait."""
        self._enabled_publisher.publish(Bool(data=enabled))

    def program_changed(self, reason: str) -> None:
        """The program's node is lost, or is back ('')."""
        if reason:
            self._lose(Commander.PROGRAM, reason)

    def _lose(self, commander: Commander, reason: str) -> None:
        if self._control.lose_commander(commander, reason):
            self._on_lost(reason)
        self._publish()

    def _take(self, commander: Commander, taken: bool) -> str:  # noqa: FBT001  # the value of a SetBool
        try:
            if taken:
                self._control.take(commander)
                return f'{commander} commands the robot'
            self._authority.give_back(commander)
            return 'nobody commands the robot'
        finally:
            self._publish()

    def _take_over(self, commander: Commander) -> str:
        self._control.take_over(commander)
        self._publish()
        return f'{commander} commands the robot'

    def _on_pendant(self, _name: str, lost: str) -> None:
        if lost:
            self._lose(Commander.PENDANT, lost)

    def _on_hold(self, message: Bool) -> None:
        self._authority.hold(self._node.now(), held=message.data)
        self._control.wake()

    def _set_mode(self, mode: OperatingMode) -> None:
        self._authority.set_mode(mode)
        self._publish()
        self._on_mode()

    def _publish(self) -> None:
        self._commander_publisher.publish(String(data=self._authority.commander.value))
        self._mode_publisher.publish(String(data=self._authority.mode.value))
        self._control.wake()
