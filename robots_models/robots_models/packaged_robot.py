"""PackagedRobot: a robot whose folder holds `robot.urdf`, `joint_limits.yaml` and `meshes/`."""

from importlib.resources import as_file, files
from typing import Any, ClassVar, Final, Literal

from numpy.typing import ArrayLike

from robots_core import StructuralData, UrdfRobotModel
from robots_core.robot_model.shapes import Shape
from robots_core.robot_model.urdf_robot_model import EARTH_GRAVITY
from robots_core.validation import finite_vector

# Nothing of it changes, and programs that load a robot several times need its files and meshes once.
_READ: Final[dict[tuple[type, str, tuple[float, ...]], dict[str, Any]]] = {}  # and limits file, and gravity
_SHAPES: Final[dict[tuple[str, str], tuple[Shape, ...]]] = {}  # by URDF and kind


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
        if key not in _READ:
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
            _READ[key] = self.__getstate__()
        # A new dict: Python finds attributes in it faster than in that of the first robot.
        self.__dict__ = dict(_READ[key])
        self._use_own_memory()

    def _shapes(self, kind: Literal['visual', 'collision'], *, hulls: bool = False) -> tuple[Shape, ...]:
        """Read once for all robots of one description."""
        key = self.description, kind
        if key not in _SHAPES:
            _SHAPES[key] = super()._shapes(kind, hulls=hulls)
        return _SHAPES[key]
