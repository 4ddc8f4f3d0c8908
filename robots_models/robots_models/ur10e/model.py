"""Universal Robots UR10e."""

from robots_models.families.universal_robots import UniversalRobots, UniversalRobotsData


class Ur10e(UniversalRobots):
    """Universal Robots' arm for 12.5 kg and 1.3 m reach."""

    DATA = UniversalRobotsData(
        source=(
            'github.com/UniversalRobots/Universal_Robots_ROS2_Description @2221ec0 (Universal Robots): '
            "config/ur10e and urdf/ur_macro.xacro; the maker's article on DH parameters for kinematics and "
            'dynamics. Published: nominal kinematics (every arm has its own calibration), limits of position '
            '(elbow limited to half a turn by software) and velocity, efforts, masses, centres of mass and '
            'inertias. '
            "Accelerations: the maker's MoveIt default; it states limits of torque only. Estimated: jerks "
            '(acceleration / 0.05 s). Not published: gear ratios, rotor inertias'
        ),
        d1=0.1807,
        a2=-0.6127,
        a3=-0.57155,
        d4=0.17415,
        d5=0.11985,
        d6=0.11655,
        rated_payload_kg=12.5,
        reach=1.3,
    )
