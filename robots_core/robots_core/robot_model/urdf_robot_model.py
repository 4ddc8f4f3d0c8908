"""UrdfRobotModel: a robot model derived from a URDF and a file of limits."""

from collections.abc import Callable, Mapping
from functools import cached_property, partial
from importlib import import_module
from math import isfinite
from pathlib import Path
from typing import Any, Final, Literal

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from robots_core.errors import InvalidInputError, UnknownRobotError
from robots_core.files.user_file import read_text
from robots_core.pose import Pose, valid_pose
from robots_core.robot_model.allowed_pairs import AllowedPairs
from robots_core.robot_model.analytic.analytic_solver import AnalyticSolver
from robots_core.robot_model.axes_data import AxesData
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.robot_model.model_parts import (
    CollisionModel,
    KinematicModel,
    RigidDynamicsModel,
    RobotVisualization,
    StructuralData,
)
from robots_core.robot_model.shapes import Shape
from robots_core.robot_model.urdf.effort_estimate import with_known_efforts
from robots_core.robot_model.urdf.kept_shapes import kept_shapes
from robots_core.robot_model.urdf.substitutions import Substitutions, note_other_base
from robots_core.robot_model.urdf.urdf_chain import UrdfChain, pinocchio_xml, read_urdf_chain
from robots_core.robot_model.urdf.urdf_meshes import with_absolute_meshes
from robots_core.robot_model.urdf.urdf_place import placed_in
from robots_core.robot_model.urdf.xacro_file import expanded_xacro
from robots_core.validation import FLOAT64, Array, finite_state, finite_vector, read_only

EARTH_GRAVITY: Final = (0.0, 0.0, -9.81)  # m/s^2, of a base that stands upright
_WORLD: Final = pin.LOCAL_WORLD_ALIGNED


class UrdfRobotModel(BaseRobotModel):
    """A serial robot from a URDF file; kinematics and dynamics by Pinocchio, shapes by yourdfpy.

    Where `allowed_pairs.yaml` lies beside the URDF, collision checks leave out the pairs that it names.
    A link without <inertial> has no mass; a robot without any mass has torques of zero.

    Args:
        urdf: The URDF file; relative mesh names start in its folder.
        name: The robot's name; the URDF's own by default.
        base: Base link; the root link by default.
        tip: Tool link; by default `tool0` if there is one, else found (see `read_urdf_chain`).
        joint_limits: YAML file with acceleration, jerk, gear and rotor data; by default
            `joint_limits.yaml` beside the URDF if it exists.
        structural_data: The robot's own record of dimensions.
        home: Joint positions to start from, (n,) rad; by default zero, or mid-range where zero is not
            allowed, some axes turned from there where it is near a singularity or in contact with itself.
        orientation_convention: Orientation-angle convention of the maker.
        gravity: Acceleration of free fall in the base frame, (3,) m/s^2; zero for a robot in orbit.
        hulls: Check collisions with convex bodies around collision meshes with many triangles, instead
            of with the meshes (see `outer_hull`).
        strict: Refuse a URDF that lacks a mesh or a speed, or an effort that carries the robot, instead of
            substituting them (see `substitutions`).
        xacro_arguments: The file is a xacro file that is expanded with these arguments.
        shapes_on_demand: Read meshes, and import the libraries for them, on first use of the shapes: for
            files that are known to be valid.

    Raises:
        UnknownRobotError: the file is missing, or holds no serial chain.
        InvalidInputError: `gravity` or `home` are not finite vectors of their length.
        JointLimitError: `home` lies outside the limits.
    """

    def __init__(
        self,
        urdf: Path | str,
        *,
        name: str | None = None,
        base: str | None = None,
        tip: str | None = None,
        joint_limits: Path | str | None = None,
        structural_data: StructuralData | None = None,
        home: ArrayLike | None = None,
        orientation_convention: str = 'zyx',
        gravity: ArrayLike = EARTH_GRAVITY,
        hulls: bool = True,
        strict: bool = False,
        xacro_arguments: Mapping[str, str] | None = None,
        shapes_on_demand: bool = False,
    ) -> None:
        path = Path(urdf)
        substitutions = Substitutions(strict=strict)
        limits = Path(joint_limits) if joint_limits is not None else path.with_name('joint_limits.yaml')
        xml = _urdf_text(path) if xacro_arguments is None else expanded_xacro(path, xacro_arguments)
        placed = partial(placed_in, path.name, xml, expanded=xacro_arguments is not None)
        free_fall = finite_vector(gravity, 3, 'gravity')
        with placed():
            chain = read_urdf_chain(
                xml,
                base=base,
                tip=tip,
                joint_limits=limits if joint_limits or limits.is_file() else None,
                beside=not joint_limits,
                substitutions=substitutions,
            )
            model = _pinocchio_model(chain)
            model.gravity.linear = free_fall
            chain = with_known_efforts(chain, model, substitutions)
            self._description = with_absolute_meshes(
                chain.xml, path.parent, None if substitutions.strict else substitutions
            )
            note_other_base(model, chain.base, substitutions)
        self._structural_data = structural_data or StructuralData(source=path.name)
        self._orientation_convention = orientation_convention
        self._name = name or model.name
        self._axes_data = chain.axes_data
        self._substitutions = substitutions
        self._model = model
        self._n = model.nv
        self._tool0 = model.getFrameId(chain.tip, pin.FrameType.BODY)
        self._use_own_memory()
        self._allowed_pairs_file = path.with_name('allowed_pairs.yaml')
        self._hulls = hulls
        self._given_home = None if home is None else read_only(self._axes_data.check_position(home, 'home'))
        if not shapes_on_demand:
            with placed():
                self._load_shapes(path.parent)

    def _use_own_memory(self) -> None:
        """Make the scratch memory of Pinocchio, and views of the pose of tool0 in it."""
        self._data = self._model.createData()
        placement = self._data.oMf[self._tool0]
        self._r, self._T = placement.translation, placement.rotation

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in self.__dict__.items() if name not in {'_data', '_r', '_T'}}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__ |= state
        self._use_own_memory()

    def _load_shapes(self, folder: Path) -> None:
        while True:
            try:
                _ = self.visualization, self.collision_model
                break
            except UnknownRobotError as error:
                if 'mesh' not in error.details or self._substitutions.strict:
                    raise
                self._description = with_absolute_meshes(
                    self._description, folder, self._substitutions, unreadable=error
                )

    @property
    def name(self) -> str:
        """The robot's name."""
        return self._name

    @property
    def axes_data(self) -> AxesData:
        """Limits and drive data per axis."""
        return self._axes_data

    @property
    def substitutions(self) -> tuple[str, ...]:
        """What the URDF lacks, and what was taken in its place, one sentence each."""
        return tuple(self._substitutions.sentences)

    @property
    def structural_data(self) -> StructuralData:
        """Mechanical dimensions."""
        return self._structural_data

    @cached_property
    def kinematic_model(self) -> KinematicModel:
        """The chain of axis frames."""
        return KinematicModel(self._model)

    @cached_property
    def rigid_dynamics_model(self) -> RigidDynamicsModel:
        """The chain with masses and inertias."""
        return RigidDynamicsModel(self._model)

    @cached_property
    def visualization(self) -> RobotVisualization:
        """The URDF's visual shapes."""
        return RobotVisualization(self._shapes('visual'))

    @cached_property
    def collision_model(self) -> CollisionModel:
        """The URDF's collision shapes."""
        file = self._allowed_pairs_file
        shapes = self._shapes('collision', hulls=self._hulls)
        return CollisionModel(shapes, AllowedPairs.read(file) if file.is_file() else None)

    @cached_property
    def base_link(self) -> Pose:
        """The link `base_link` where it is fixed to the base, and otherwise the base."""
        model = self._model
        if model.existFrame('base_link', pin.FrameType.BODY):
            frame = model.frames[model.getFrameId('base_link', pin.FrameType.BODY)]
            if frame.parentJoint == 0:
                return Pose(frame.placement.translation, frame.placement.rotation)
        return Pose.identity()

    @property
    def description(self) -> str:
        """The robot as URDF: from its base to all that hangs on it, `tool0` its tip, meshes absolute."""
        return self._description

    @cached_property
    def _links(self) -> tuple[Array, Callable[..., bool]]:
        """The chain for compiled code, see `ChainArrays`, and its `tool_poses`."""
        # Imported on first use: without it no compiled code is needed.
        chain = import_module('robots_core.kernels.serial_chain')
        return chain.SerialChain.of(self).arrays, chain.tool_poses

    @cached_property
    def home(self) -> Array:
        """Joint positions to start from, (n,) rad."""
        if self._given_home is not None:
            return self._given_home
        axes = self._axes_data
        middle, _ = axes.middle_and_half
        start = np.where((axes.lower <= 0.0) & (axes.upper >= 0.0), 0.0, middle)
        default_home = import_module('robots_core.blocks.collision.default_home').default_home
        return read_only(default_home(self, start))

    @property
    def orientation_convention(self) -> str:
        """Orientation-angle convention of the maker."""
        return self._orientation_convention

    def direct_kinematics(self, q: Array) -> tuple[Array, Array]:
        """See `BaseRobotModel.direct_kinematics`."""
        # Pinocchio rejects arrays of another size, but misreads another byte order; the sum detects NaN and
        # infinity.
        try:
            pin.framesForwardKinematics(self._model, self._data, q)
            finite = q.dtype is FLOAT64 and isfinite(sum(q.tolist()))
        except (AttributeError, TypeError, ValueError):
            finite = False
        if not finite:
            pin.framesForwardKinematics(self._model, self._data, finite_vector(q, self._n, 'q'))
        return self._r.copy(), self._T.copy()

    def pose(self, q: Array) -> Pose:
        """See `BaseRobotModel.pose`."""
        return valid_pose(*self.direct_kinematics(q))

    def tool_poses(self, q: Array) -> tuple[Array, Array]:
        """See `BaseRobotModel.tool_poses`."""
        r, T = np.empty((len(q), 3)), np.empty((len(q), 3, 3))
        links, poses = self._links
        if poses(links, np.array(q, dtype=np.float64, order='C'), r, T):
            return r, T
        return super().tool_poses(q)  # which names what is not finite

    def jacobian(self, q: Array) -> Array:
        """See `BaseRobotModel.jacobian`."""
        try:  # as above
            J: Array = pin.computeFrameJacobian(self._model, self._data, q, self._tool0, _WORLD)
            finite = q.dtype is FLOAT64 and isfinite(sum(q.tolist()))
        except (AttributeError, TypeError, ValueError):
            finite = False
        if not finite:
            q = finite_vector(q, self._n, 'q')
            J = pin.computeFrameJacobian(self._model, self._data, q, self._tool0, _WORLD)
        return J if self._n > 1 else J.reshape(6, 1)  # Pinocchio returns a single column as a vector

    def jacobian_der(self, q: Array, q_dot: Array) -> Array:
        """See `BaseRobotModel.jacobian_der`."""
        self._compute_jacobians(q, q_dot)
        J_der: Array = pin.getFrameJacobianTimeVariation(self._model, self._data, self._tool0, _WORLD)
        return J_der if self._n > 1 else J_der.reshape(6, 1)

    def orientation_and_jacobians(self, q: Array, q_dot: Array) -> tuple[Array, Array, Array]:
        """See `BaseRobotModel.orientation_and_jacobians`."""
        model, data, tool0 = self._model, self._data, self._tool0
        self._compute_jacobians(q, q_dot)
        pin.updateFramePlacement(model, data, tool0)
        J: Array = pin.getFrameJacobian(model, data, tool0, _WORLD)
        J_der: Array = pin.getFrameJacobianTimeVariation(model, data, tool0, _WORLD)
        return self._T.copy(), J.reshape(6, self._n), J_der.reshape(6, self._n)

    def _compute_jacobians(self, q: Array, q_dot: Array) -> None:
        """Let Pinocchio compute the Jacobians of all joints and their derivatives in its memory."""
        try:  # as above
            pin.computeJointJacobiansTimeVariation(self._model, self._data, q, q_dot)
            finite = q.dtype is q_dot.dtype is FLOAT64 and isfinite(sum(q.tolist(), sum(q_dot.tolist())))
        except (AttributeError, TypeError, ValueError):
            finite = False
        if not finite:
            motion = finite_state(q, q_dot, self._n)
            pin.computeJointJacobiansTimeVariation(self._model, self._data, *motion)

    def rigid_dynamics(self, q: Array, q_dot: Array, q_ddot: Array) -> tuple[Array, Array, Array]:
        """See `BaseRobotModel.rigid_dynamics`."""
        return self.rigid_dynamics_model.rigid_dynamics(q, q_dot, q_ddot)

    def inverse_kinematics_analytic(self, r: Array, T: Array, *, q_near: Array | None = None) -> Array:
        """See `BaseRobotModel.inverse_kinematics_analytic`; the form is found from the lines of the axes."""
        return self._analytic_solver.solve(r, T, q_near)

    def _shapes(self, kind: Literal['visual', 'collision'], *, hulls: bool = False) -> tuple[Shape, ...]:
        def read() -> tuple[Shape, ...]:
            # Imported on demand: without new shapes no mesh library is needed.
            urdf_shapes = import_module('robots_core.robot_model.urdf.urdf_shapes').urdf_shapes
            shapes: tuple[Shape, ...] = urdf_shapes(self._description, self._model, kind, hulls=hulls)
            return shapes

        return kept_shapes(self._description, read, kind, hulls)

    @cached_property
    def _analytic_solver(self) -> AnalyticSolver:
        return AnalyticSolver(self)


def _pinocchio_model(chain: UrdfChain) -> pin.Model:
    try:
        model = pin.buildModelFromXML(pinocchio_xml(chain))
    except (ValueError, RuntimeError) as error:
        raise UnknownRobotError(f'not a URDF that Pinocchio reads: {error}') from error
    names = chain.axes_data.names
    if tuple(model.names)[1:] != names:
        raise UnknownRobotError(f'joints {list(model.names)[1:]} do not form one chain {list(names)}')
    return model


def _urdf_text(path: Path) -> str:
    try:
        return read_text(path, 'URDF file')
    except InvalidInputError as error:
        raise UnknownRobotError(error.message, **error.details) from None
