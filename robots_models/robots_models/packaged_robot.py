"""PackagedRobot: a robot whose folder holds `robot.urdf`, `joint_limits.yaml` and `meshes/`."""

from __future__ import annotations

from importlib.resources import as_file, files
from typing import ClassVar

from robots_core import StructuralData, UrdfRobotModel


class PackagedRobot(UrdfRobotModel):
    """Base of the robots of this package: a subclass is data plus a line of description.

    The robot's name is the name of its folder.

    Attributes:
        DATA: Its structural data.
        HOME: Posture to start from, rad.
        ORIENTATION_CONVENTION: Orientation-angle convention of its maker.
    """

    DATA: ClassVar[StructuralData]
    HOME: ClassVar[tuple[float, ...]]
    ORIENTATION_CONVENTION: ClassVar[str] = 'zyx'

    def __init__(self) -> None:
        package = type(self).__module__.rpartition('.')[0]
        with as_file(files(package)) as folder:
            super().__init__(
                folder / 'robot.urdf',
                name=package.rpartition('.')[2],
                structural_data=self.DATA,
                home=self.HOME,
                orientation_convention=self.ORIENTATION_CONVENTION,
            )
