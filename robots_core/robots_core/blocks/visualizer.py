"""Visualizer: any robot in a browser page (the paper's Visualizer block)."""

import contextlib
import io
from collections import deque
from collections.abc import Sequence
from typing import Any

import numpy as np
import trimesh
import viser

from robots_core.blocks.collision.robot_solids import flange
from robots_core.blocks.collision.scene import AttachedObject, Scene, SceneObject
from robots_core.blocks.page_camera import FIELD_OF_VIEW, VIEWS, CameraView, PlacedBounds, View, camera_view
from robots_core.blocks.tool_trace import LONGEST_TRACE, SPACING, ToolTrace
from robots_core.blocks.zones.zone import HalfSpace, PlacedBox, Zone
from robots_core.free_port import free_port
from robots_core.orientation import quaternion_of
from robots_core.pose import Pose
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.robot_model.shapes import Box, Geometry, Shape
from robots_core.robot_model.stretched_length import stretched_length
from robots_core.robot_model.urdf.triangle_mesh import shaded, triangle_mesh
from robots_core.validation import Array

BRAND = (0, 150, 136)
COLLISION_COLOUR = (30, 120, 255)
GHOST_COLOUR = (0.0, 0.59, 0.53, 0.35)
ZONE_COLOUR = (0.95, 0.60, 0.10, 0.20)
PLATE = 2e-3  # m; thickness of a half-space's plane


def zone_solid(zone: Zone, size: float) -> tuple[Box, Pose]:
    """The box of a zone, or a plate of this edge length (m) on its plane."""
    match zone.region:
        case PlacedBox(box, pose):
            return box, pose
        case HalfSpace(point, normal):
            across = np.linalg.svd(normal[None])[2][1:]
            T = np.column_stack([across[0], np.cross(normal, across[0]), normal])
            return Box((size, size, PLATE)), Pose(point, T)


class Visualizer:
    """Shows a robot in a browser page.

    Args:
        robot: The robot.
        host: Network address to serve at; '0.0.0.0' serves the whole network.
        port: First port to try; if it is busy the next free one is used; 0: chosen by the system.

    Raises:
        InvalidInputError: a host that this machine does not have, or a port outside 0..65535.
    """

    def __init__(self, robot: BaseRobotModel, *, host: str = '127.0.0.1', port: int = 8080) -> None:
        self._robot = robot
        self._host = host
        self._reach = stretched_length(robot)
        first = free_port(host, port)
        # The server has no option to suppress its output.
        with contextlib.redirect_stdout(io.StringIO()):
            self._server = viser.ViserServer(host, first, label=robot.name, verbose=False)
        self._show_surroundings()
        self._frames = [
            self._server.scene.add_frame(f'/robot/{index}_{name}', show_axes=False)
            for index, name in enumerate(('base', *robot.axes_data.names))
        ]
        size = 0.04 * self._reach
        for frame in self._frames:
            frame.axes_length, frame.axes_radius, frame.origin_radius = size, 0.05 * size, 0.08 * size
        self._tool_frame = self._server.scene.add_frame(
            '/tool', axes_length=1.5 * size, axes_radius=0.06 * size, origin_radius=0.1 * size
        )
        self._trace = ToolTrace(self._server, '/tool_path')
        for shape in robot.visualization.shapes:
            parent = self._frames[shape.frame].name
            self._add_solid(f'{parent}/{shape.name}', shape.geometry, shape.colour, shape.pose)
        self._collision = self._add_collision_shapes(robot.collision_model.shapes)
        self._scene: list[viser.MeshHandle] = []
        self._ghost: list[viser.FrameHandle] = []
        self._flange = flange(robot)
        self._bounds: list[PlacedBounds] = []
        self._add_panel()
        self._shown = np.full(robot.num_axes, np.nan)
        self._unseen: deque[Array] = deque(maxlen=LONGEST_TRACE)
        self.update(robot.home)
        self._aim()

    @property
    def url(self) -> str:
        """Address of the page."""
        host = '127.0.0.1' if self._host in ('', '0.0.0.0') else self._host  # noqa: S104  # compared only
        return f'http://{f"[{host}]" if ":" in host else host}:{self._server.get_port()}'

    def update(self, q: Array) -> None:
        """Show the robot at joint positions `q`, (n,) rad (m).

        Raises:
            InvalidInputError: `q` of another shape or not finite.
        """
        if np.array_equal(q, self._shown):
            return
        r, T = self._robot.kinematic_model.frame_axes(q)
        tool = self._robot.pose(q)
        with self._server.atomic():
            for frame, position, orientation in zip(self._frames[1:], r, T, strict=True):
                frame.position, frame.wxyz = position, _wxyz(orientation)
            self._tool_frame.position, self._tool_frame.wxyz = tool.r, _wxyz(tool.T)
            while self._unseen:
                self._trace.add(self._unseen.popleft())
            self._trace.add(tool.r)
        self._shown = np.array(q)

    def follow(self, q: Array) -> None:
        """As `update` while a browser shows the page; else only keep the tool path for the next one.

        Raises:
            InvalidInputError: `q` of another shape or not finite.
        """
        if self.watched:
            self.update(q)
        else:
            r = self._robot.pose(q).r
            if not self._unseen or float(np.linalg.norm(r - self._unseen[-1])) >= SPACING:
                self._unseen.append(r)

    @property
    def watched(self) -> bool:
        """A browser shows the page."""
        return bool(self._server.get_clients())

    def show_scene(self, scene: Scene) -> None:
        """Show obstacles, attached objects and zones of a scene in the place of those shown before."""
        for handle in self._scene:
            handle.remove()
        last = self._frames[-1].name
        shown: list[tuple[str, SceneObject | AttachedObject, Pose]] = [
            ('/scene', item, item.pose) for item in scene.objects
        ]
        shown += [(f'{last}/scene', item, self._flange @ item.pose) for item in scene.attached]
        self._scene = [
            self._add_solid(f'{parent}/{item.name}', item.geometry, item.colour, pose)
            for parent, item, pose in shown
        ]
        for zone in scene.zones:
            geometry, pose = zone_solid(zone, 4.0 * self._reach)
            self._scene.append(self._add_solid(f'/scene/{zone.name}', geometry, ZONE_COLOUR, pose))
        self._bounds = [
            PlacedBounds(np.asarray(triangle_mesh(item.geometry).bounds), item.pose) for item in scene.objects
        ]
        self._aim()

    def show_ghost(self, q: Array | None) -> None:
        """Show a ghost of the robot at joint positions `q`, (n,) rad (m); None: no more.

        Raises:
            InvalidInputError: `q` of another shape or not finite.
        """
        if q is None:
            for frame in self._ghost:
                frame.visible = False
            return
        r, T = self._robot.kinematic_model.frame_axes(q)
        with self._server.atomic():
            if not self._ghost:
                self._ghost = [
                    self._server.scene.add_frame(f'/ghost/{index}', show_axes=False)
                    for index in range(self._robot.num_axes + 1)
                ]
                for shape in self._robot.visualization.shapes:
                    if shape.frame > 0:  # the base stands where it stands
                        name = f'/ghost/{shape.frame}/{shape.name}'
                        self._add_solid(name, shape.geometry, GHOST_COLOUR, shape.pose)
            for frame, position, orientation in zip(self._ghost[1:], r, T, strict=True):
                frame.position, frame.wxyz = position, _wxyz(orientation)
            for frame in self._ghost:
                frame.visible = True

    def clear_trace(self) -> None:
        """Clear the displayed path of the tool."""
        self._unseen.clear()
        self._trace.clear()

    def close(self) -> None:
        """End the page."""
        with contextlib.redirect_stdout(io.StringIO()):
            self._server.stop()

    def _view(self, view: View) -> CameraView:
        joints, _ = self._robot.kinematic_model.frame_axes(self._shown)
        tool = np.asarray(self._tool_frame.position)
        return camera_view(view, reach=self._reach, joints=joints, tool=tool, scene=self._bounds)

    def _aim(self) -> None:
        """Let browsers begin with a camera that sees robot and scene."""
        found, camera = self._view('all'), self._server.initial_camera
        camera.look_at, camera.position, camera.fov = found.look_at, found.position, FIELD_OF_VIEW

    def _show_surroundings(self) -> None:
        scene, size = self._server.scene, self._reach
        scene.add_grid(
            '/ground',
            width=4.0 * size,
            height=4.0 * size,
            cell_size=0.1 if size < 2.0 else 0.25,
            section_size=0.5 if size < 2.0 else 1.0,
            cell_color=(224, 226, 228),
            section_color=(196, 200, 204),
            shadow_opacity=0.25,
            plane_color=(246, 247, 248),
            plane_opacity=1.0,
            fade_distance=6.0 * size,
            position=(0.0, 0.0, -0.001),
        )
        scene.world_axes.visible = True
        scene.world_axes.axes_length, scene.world_axes.axes_radius = 0.12 * size, 0.003 * size
        scene.configure_default_lights(enabled=True, cast_shadow=True)

    def _add_solid(
        self, name: str, geometry: Geometry, colour: tuple[float, float, float, float], pose: Pose
    ) -> viser.MeshHandle:
        red, green, blue, opacity = colour
        return self._add_mesh(
            name,
            shaded(geometry),
            pose,
            color=(round(255 * red), round(255 * green), round(255 * blue)),
            opacity=None if opacity >= 1.0 else opacity,
        )

    def _add_collision_shapes(self, shapes: Sequence[Shape]) -> list[viser.MeshHandle]:
        return [
            self._add_mesh(
                f'{self._frames[shape.frame].name}/collision/{shape.name}',
                triangle_mesh(shape.geometry),
                shape.pose,
                color=COLLISION_COLOUR,
                wireframe=True,
                cast_shadow=False,
                visible=False,
            )
            for shape in shapes
        ]

    def _add_mesh(self, name: str, mesh: trimesh.Trimesh, pose: Pose, **look: Any) -> viser.MeshHandle:
        vertices, faces = np.asarray(mesh.vertices, np.float32), np.asarray(mesh.faces, np.uint32)
        return self._server.scene.add_mesh_simple(
            name, vertices, faces, position=pose.r, wxyz=_wxyz(pose.T), **look
        )

    def _add_panel(self) -> None:
        gui = self._server.gui
        gui.configure_theme(
            control_layout='floating',
            control_width='small',
            show_logo=False,
            show_share_button=False,
            brand_color=BRAND,
        )
        tool, path = gui.add_checkbox('Tool frame', True), gui.add_checkbox('Tool path', True)
        axes = gui.add_checkbox('Axis frames', False)
        collision = gui.add_checkbox('Collision shapes', False)
        clear = gui.add_button('Clear tool path')
        views = gui.add_button_group('View', VIEWS)

        def show(_: object) -> None:
            self._tool_frame.visible = tool.value
            self._trace.show(visible=path.value)
            for frame in self._frames:
                frame.show_axes = axes.value
            for handle in self._collision:
                handle.visible = collision.value

        for box in (tool, path, axes, collision):
            box.on_update(show)
        clear.on_click(lambda _: self.clear_trace())

        def look(event: viser.GuiEvent[Any]) -> None:
            if event.client is None:
                return
            found = self._view(next(view for view in VIEWS if view == views.value))
            camera = event.client.camera
            with event.client.atomic():
                camera.up_direction, camera.position, camera.look_at = found.up, found.position, found.look_at

        views.on_click(look)


def _wxyz(T: Array) -> Array:
    return np.roll(quaternion_of(T), 1)
