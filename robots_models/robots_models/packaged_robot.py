"""PackagedRobot: a robot whose folder holds `robot.urdf`, `joint_limits.yaml` and `meshes/`."""

from functools import cached_property
from importlib.resources import as_file, files
from typing import Any, ClassVar, Final

from numpy.typing import ArrayLike

from robots_core import StructuralData, UrdfRobotModel
from robots_core.robot_model.model_parts import CollisionModel, RobotVisualization
from robots_core.robot_model.urdf_robot_model import EARTH_GRAVITY
from robots_core.validation import finite_vector

_Key = tuple[type, str]  # and URDF
# Nothing of it changes, and programs that load a robot several times need its files and meshes once.
_READ: Final[dict[tuple[type, str, tuple[float, ...]], dict[str, Any]]] = {}  # and limits file, and gravity
_VISUALIZATIONS: Final[dict[_Key, RobotVisualization]] = {}
_COLLISION_MODELS: Final[dict[_Key, CollisionModel]] = {}


class PackagedRobot(UrdfRobotModel):
    """Base of the robots of this package: a subclass is data plus a line of description.

    The robot's name is the name of its folder.

    Args:
        gravity: Acceleration of free fall in the base frame, (3,) m/s^2.
        joint_limits: Limits file in the robot's folder.

    Attributes:
        DATA: Its structural data.
        HOME: Posture to start from, rad.
        ORIENTATION_CONVENTION: Orientation-angle convention of its maker.
    """

    DATA: ClassVar[StructuralData]
    HOME: ClassVar[tuple[float, ...]]
    ORIENTATION_CONVENTION: ClassVar[str] = 'zyx'

    def __init__(
        self, *, gravity: ArrayLike = EARTH_GRAVITY, joint_limits: str = 'joint_limits.yaml'
    ) -> None:
        key = type(self), joint_limits, tuple(finite_vector(gravity, 3, 'gravity').tolist())
        if key in _READ:
            self.__dict__ |= _READ[key]
            self._data = self._model.createData()
            return
        package = type(self).__module__.rpartition('.')[0]
        with as_file(files(package)) as folder:
            super().__init__(
                folder / 'robot.urdf',
                name=package.rpartition('.')[2],
                joint_limits=folder / joint_limits,
                structural_data=self.DATA,
                home=self.HOME,
                orientation_convention=self.ORIENTATION_CONVENTION,
                gravity=gravity,
                hulls=False,
                strict=True,
                shapes_on_demand=True,
            )
        _READ[key] = dict(self.__dict__)

    @cached_property
    def visualization(self) -> RobotVisualization:
        """See `UrdfRobotModel.visualization`; read once for all robots of one description."""
        key = type(self), self.description
        found = _VISUALIZATIONS.get(key)
        if found is None:
            found = _VISUALIZATIONS[key] = super().visualization
        return found

    @cached_property
    def collision_model(self) -> CollisionModel:
        """See `UrdfRobotModel.collision_model`; read once for all robots of one description."""
        key = type(self), self.description
        found = _COLLISION_MODELS.get(key)
        if found is None:
            found = _COLLISION_MODELS[key] = super().collision_model
        return found
