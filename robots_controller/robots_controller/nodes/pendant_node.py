"""pendant_node: a page in the browser to operate the cell: jog, programs, inputs and outputs, messages."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path
from threading import Lock
from typing import Any, Final

from rcl_interfaces.msg import Log

from robots_controller.nodes.ports.cell_reader import PLANNER, PROGRAM, CellReader
from robots_controller.nodes.ports.pendant_link import PendantLink
from robots_controller.pendant.message_log import Level
from robots_controller.pendant.page_access import THIS_MACHINE, PageAccess, read_access
from robots_controller.pendant.pendant_operator import PendantOperator
from robots_controller.pendant.pendant_state import JogSpeeds
from robots_controller.pendant.recording import Recording
from robots_controller.pendant.trends import PERIOD
from robots_core.blocks.collision.scene import Scene
from robots_core.blocks.collision_detection import CollisionDetection
from robots_core.errors import InstallationError
from robots_core.nodes.watched_scene import WatchedScene
from robots_core.ros.messages import seconds
from robots_core.ros.qos import subscribe
from robots_core.ros.robot_node import PORTS, RobotNode
from robots_core.ros.running.run import run
from robots_planning.pathplanning import PathPlanning

MOVERS: Final = (PLANNER, 'controller_node')
"""What they report belongs to the motion that was sent last."""
LEVELS: Final = ((Log.ERROR, Level.ERROR), (Log.WARN, Level.WARNING))


class PendantNode(RobotNode):
    """Serves the operator's page, and passes on what is pressed there.

    The page does nothing that other nodes could not do over the same topics and services.
    """

    diagnostics_group = 'program'
    takes_part = False  # a person does not hold time
    alone = True  # two would give the robot to two people

    def __init__(self, **options: Any) -> None:
        super().__init__('pendant_node', **options)
        port = self.parameter(
            'port', 8090, 'first port to try for the page; 0 lets the system choose', bounds=PORTS
        )
        host = self.parameter(
            'host',
            THIS_MACHINE,
            'address to listen at; 127.0.0.1: this machine alone, others need a password',
        )
        password_file = self.parameter(
            'password_file', '', 'its first line is what a viewer must give; empty: nothing'
        )
        access = read_access(host, password_file)
        connection_timeout = self.parameter(
            'connection_timeout',
            4.0,
            'silence of a browser after which its connection is lost, s; longer for networks that pause',
            bounds=(2.0, 60.0),
        )
        folder = self.parameter('programs', 'programs', 'folder of the robot programs that can be chosen')
        recordings = self.parameter(
            'recordings', 'out', 'folder of the bags that are recorded and reported on'
        )
        self._changing_scene = Lock()  # the page makes the planner of previews in another thread
        self._collision_scene = Scene()
        self._preview: PathPlanning | None = None
        self._margin = 0.0
        self.operator = PendantOperator(
            self.robot,
            PendantLink(self),
            self.now,
            self._make_planning,
            Recording(Path(recordings).resolve(), self.robot_name, self.get_namespace()),
        )
        self.operator.desk.log = self.journal.info
        WatchedScene(self, self._on_scene)
        reader = CellReader(self, self.operator)
        asked = ('teach_speed', 'teach_tool_speed', 'collision_margin')
        reader.ask(PLANNER, asked, self._on_planner_parameters)
        self.create_timer(PERIOD, lambda: self.operator.trends.add(self.now(), self.operator.state))
        subscribe(self, Log, '/rosout', self._on_log)
        self.closing.callback(self.operator.recording.end)
        self._server = self._serve(port, Path(folder).resolve(), access, connection_timeout)
        self.closing.callback(self._server.close)
        self.journal.info(f'the robot is operated at {self.url}')
        self.ready(url=self.url)

    def _serve(self, port: int, folder: Path, access: PageAccess, connection_timeout: float) -> Any:
        try:
            from robots_controller.pendant.page.access.page_server import PageServer  # noqa: PLC0415
            from robots_controller.pendant.page.pendant_page import PendantPage  # noqa: PLC0415
        except ImportError as error:
            raise InstallationError(
                f"the operator's page needs NiceGUI ({error}): pip install -r requirements-pendant.txt"
            ) from error
        build = partial(PendantPage, self.operator, folder)
        return PageServer(
            build,
            port=port,
            title=self.robot.name,
            access=access,
            log=self.journal.warning,
            report=self.operator.recording.report,
            scene=lambda: self.operator.state.scene_url,
            connection_timeout=connection_timeout,
        )

    @property
    def url(self) -> str:
        """Address of the page."""
        return str(self._server.url)

    # -- previews of motions ------------------------------------------------------------------------------

    def _make_planning(self) -> PathPlanning:
        collision = CollisionDetection(self.robot)
        planning = PathPlanning(self.robot, collision=collision, collision_margin=self._margin)
        with self._changing_scene:
            planning.set_scene(self._collision_scene)
            self._preview = planning
        return planning

    def _on_scene(self, scene: Scene) -> None:
        with self._changing_scene:
            self._collision_scene = scene
            if self._preview is not None:
                self._preview.set_scene(scene)

    # -- what the nodes report ----------------------------------------------------------------------------

    def _on_planner_parameters(self, values: list[Any]) -> None:
        *speeds, self._margin = values
        if self._preview is not None:
            self._preview.collision_margin = self._margin
        self.operator.state = replace(self.operator.state, jog_speeds=JogSpeeds(*speeds))

    def _on_log(self, message: Log) -> None:
        prefix = self.get_namespace().strip('/').replace('/', '.')
        if prefix and not message.name.startswith(f'{prefix}.'):
            return
        name = message.name.removeprefix(f'{prefix}.')
        if name == f'{PROGRAM}.print':
            self.operator.prints.append(message.msg)
            return
        level = next((one for number, one in LEVELS if message.level >= number), Level.INFO)
        if message.level >= Log.INFO:
            place = self.operator.state.program.place(of_motion=name in MOVERS)
            self.operator.messages.add(seconds(message.stamp), level, name, message.msg, place)


main: Final = partial(run, PendantNode)
