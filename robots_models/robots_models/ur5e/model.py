"""Universal Robots UR5e."""

from robots_models.families.universal_robots import UniversalRobots, UniversalRobotsData


class Ur5e(UniversalRobots):
    """Universal Robots' arm for 5 kg and 0.85 m reach."""

    DATA = UniversalRobotsData(
        source=(
            'github.com/UniversalRobots/Universal_Robots_ROS2_Description @2221ec0 (Universal Robots): '
            "config/ur5e and urdf/ur_macro.xacro; the maker's article on DH parameters for kinematics and "
            'dynamics. Published: nominal kinematics (every arm has its own calibration), limits of position '
            '(elbow limited to half a turn by software) and velocity, efforts, masses and centres of mass. '
            'Approximated there by cylinders: inertias. '
            "Accelerations: the maker's MoveIt default; it states limits of torque only. Estimated: jerks "
            '(acceleration / 0.05 s). Not published: gear ratios, rotor inertias'
        ),
        d1=0.1625,
        a2=-0.425,
        a3=-0.3922,
        d4=0.1333,
        d5=0.0997,
        d6=0.0996,
        rated_payload_kg=5.0,
        reach=0.85,
    )
