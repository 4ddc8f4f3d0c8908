"""Manutec r3, as the Modelica Standard Library's RobotR3."""

from dataclasses import dataclass
from math import inf

from robots_core import StructuralData
from robots_core.robot_model.drive_data import DriveData
from robots_models.packaged_robot import PackagedRobot


@dataclass(frozen=True)
class ManutecR3Data(StructuralData):
    """Lengths in metres along the upright arm, drive data per axis.

    Attributes:
        shoulder_height: Base to axis 2.
        shoulder_offset: Horizontal distance of axis 2 from axis 1.
        upper_arm: Axes 2 to 3; 0.5 in the model of 1988.
        elbow_offset: Horizontal distance of axis 4 from axis 3; axis 4 lies on axis 1's side.
        forearm: Axis 3 to the wrist centre.
        flange: Wrist centre to tool0.
        position_gain: Of the position controllers, 1/s.
        speed_gain: Of the speed controllers, A s/rad.
        integral_time: Of the speed controllers, s.
        motor_frequency: Natural frequency of the current controls, rad/s.
        motor_damping: Their damping ratios.
        motor_resistance: Of the armatures, ohm.
        motor_speed: Highest speed of every motor, rad/s.
        motor_current: Highest current of every motor, A.
        torque_constant: N m/A, at the motor.
        spring_stiffness: N m/rad, of the gears, motor side; inf: rigid.
        spring_damping: N m s/rad, likewise.
        motor_friction: Coulomb friction (N m) and its slope (N m s) of axes 1-3, motor side.
        joint_friction: The same of axes 4-6, joint side.
        stiction: Ratio of stiction to Coulomb friction.
        load_mass: Load of the library's example FullRobot, kg; not part of the robot.
        load_centre: Its centre of mass in tool0.
    """

    source: str = (
        'github.com/modelica/ModelicaStandardLibrary @b756f9deed (BSD-3): '
        'Modelica/Mechanics/MultiBody/Examples/Systems/RobotR3. Published: kinematics (adapted there, not '
        'those of the original r3 of 1988), masses and inertias as printed (the one of link_5 very probably '
        '100 times too large, kept because the reference results use it), gear ratios, rotor inertias, '
        'accelerations (reference), position limits and velocities of r1-r3 (constraints of the original). '
        'Derived: velocities of r4-r6 (motor speed / gear ratio), efforts of r4-r6 (motor current times '
        'torque constant times gear ratio). Efforts of r1-r3: original model; the library does not enforce '
        'them. Unconfirmed: position limits of r4-r6. Estimated: jerks (acceleration / 0.05 s)'
    )
    shoulder_height: float = 0.675
    shoulder_offset: float = 0.3
    upper_arm: float = 0.65
    elbow_offset: float = 0.155
    forearm: float = 0.6
    flange: float = 0.125
    rated_payload_kg: float = 15.0
    position_gain: float = 5.0
    speed_gain: float = 0.5
    integral_time: float = 0.05
    motor_frequency: tuple[float, ...] = (4590.0, 5500.0, 5500.0, 6250.0, 6250.0, 7400.0)
    motor_damping: tuple[float, ...] = (0.6, 0.6, 0.6, 0.55, 0.55, 0.27)
    motor_resistance: float = 250.0
    motor_speed: float = 315.0
    motor_current: float = 9.0
    torque_constant: tuple[float, ...] = (1.1616, 1.1616, 1.1616, 0.2365, 0.2608, 0.0842)
    spring_stiffness: tuple[float, ...] = (43.0, 8.0, 58.0, inf, inf, inf)
    spring_damping: tuple[float, ...] = (0.005, 0.01, 0.04, 0.0, 0.0, 0.0)
    motor_friction: tuple[tuple[float, float], ...] = (
        (0.4, 0.13 / 160.0),
        (0.5, 0.1 / 130.0),
        (0.7, 0.2 / 130.0),
    )
    joint_friction: tuple[tuple[float, float], ...] = ((21.8, 9.8), (30.1, 0.03), (10.9, 3.92))
    stiction: tuple[float, ...] = (1.0, 1.0, 1.0, 26.7 / 21.8, 39.6 / 30.1, 16.8 / 10.9)
    load_mass: float = 15.0
    load_centre: tuple[float, float, float] = (0.1, -0.1, 0.25)


class ManutecR3(PackagedRobot):
    """The robot of Modelica's example; home is where its reference motion starts.

    `manutec_r3?joint_limits=full_robot_limits.yaml` has the reference speeds of that motion and next to no
    jerk limit, so that a motion with all axes in step takes as long as the example's.
    """

    DATA = ManutecR3Data()
    HOME = (-1.0471975512, 0.349065850399, 1.57079632679, 0.0, -1.91986217719, 0.0)
    ORIENTATION_CONVENTION = 'xyz'

    @property
    def drive_data(self) -> DriveData:
        """The example's controllers, motors and gears.

        The motors' highest current is kept here; the example names it, and passes it with 17.5 A.
        """
        data = self.DATA
        return DriveData.from_motors(
            self.axes_data,
            torque_constant=data.torque_constant,
            position_gain=data.position_gain,
            speed_gain=data.speed_gain,
            integral_time=data.integral_time,
            current_limit=data.motor_current,
            stiction=data.stiction,
            stiffness=data.spring_stiffness,
            damping=data.spring_damping,
            current_frequency=data.motor_frequency,
            current_damping=data.motor_damping,
            resistance=data.motor_resistance,
        )
