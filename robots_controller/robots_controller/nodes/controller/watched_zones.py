"""WatchedZones: the zones of controller_node, from its scene, and the inputs that close them."""

from __future__ import annotations

import secrets
from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING, Any, Final

from diagnostic_msgs.msg import DiagnosticStatus
from rclpy.publisher import Publisher

from robots_controller.control.control_loop import ControlLoop
from robots_controller.control.zones.shared_zone import LARGEST, ZoneState, parse_zone_state
from robots_controller.io.stopping_inputs import Closing, parse_closing
from robots_core.blocks.collision.scene import Scene
from robots_core.nodes.watched_scene import WatchedScene, scene_by_parameter
from robots_core.ros.messages import diagnostic_status, diagnostic_values
from robots_core.ros.qos import make_publisher, subscribe
from robots_core.ros.robot_node import RobotNode
from robots_core.wording.safety_note import NOT_CERTIFIED

if TYPE_CHECKING:
    from robots_controller.control.zones.zone_guard import ZoneGuard

TOPIC: Final = 'zone_claims'


class WatchedZones:
    """Declares the parameters `scene` and `zone_inputs`, and passes on what concerns zones.

    Raises:
        InvalidInputError: a scene file that is missing or wrong, or inputs that are none.
    """

    def __init__(self, node: RobotNode) -> None:
        self._node = node
        self._control: ControlLoop | None = None
        self._publisher: Publisher | None = None
        self._scene = scene_by_parameter(node)
        self.inputs: Closing = node.parameter(
            'zone_inputs',
            [''],
            "digital inputs that close the borders of zones, as 'digital_input.3=off press'; "
            f'{NOT_CERTIFIED}',
            read=parse_closing,
        )
        """Those that close zones."""
        self.guard = self._make_guard() if self._scene.zones else None
        """For the controller; None without zones."""

    def _make_guard(self) -> ZoneGuard:
        # It loads compiled functions which a controller without zones does not need.
        from robots_controller.control.zones.zone_guard import ZoneGuard  # noqa: PLC0415

        # In simulated time there is no other robot.
        name = '' if self._node.simulated_time else self._node.get_namespace()
        guard = ZoneGuard(self._node.robot, self._scene, name=name, life=secrets.randbelow(LARGEST))
        WatchedScene(self._node, self._on_scene, self._scene)
        return guard

    def watch(self, control: ControlLoop) -> None:
        """Report the claims of other robots to a control loop from now on."""
        self._control = control
        if self.guard is None or not self.guard.states:
            return
        self._publisher = make_publisher(self._node, DiagnosticStatus, TOPIC)
        for other in {name for zone in self._scene.zones for name in zone.shared_with}:
            subscribe(
                self._node, DiagnosticStatus, f'{other.rstrip("/")}/{TOPIC}', partial(self._on_claims, other)
            )

    def publish_claims(self, states: Mapping[str, ZoneState]) -> None:
        """Publish the claims to shared zones; from the loop's thread."""
        if self._publisher is not None:
            texts: dict[str, Any] = {name: state.text() for name, state in states.items()}
            robot = self._node.robot_name
            self._publisher.publish(diagnostic_status('shared zones', '', hardware_id=robot, **texts))

    def _on_claims(self, other: str, message: DiagnosticStatus) -> None:
        assert self._control is not None
        texts = diagnostic_values(message)
        self._control.receive_zones(other, {name: parse_zone_state(text) for name, text in texts.items()})

    def _on_scene(self, scene: Scene) -> None:
        changed = scene.attached != self._scene.attached
        self._scene = scene
        if changed and self._control is not None and self.guard is not None:
            self.guard.set_scene(scene)
            self._control.search_paths()
