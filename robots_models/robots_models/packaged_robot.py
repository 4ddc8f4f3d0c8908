"""PackagedRobot: a robot whose folder holds `robot.urdf`, `joint_limits.yaml` and `meshes/`."""

from importlib.resources import as_file, files
from typing import ClassVar

from numpy.typing import ArrayLike

from robots_core import StructuralData, UrdfRobotModel
from robots_core.robot_model.urdf_robot_model import EARTH_GRAVITY


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
