"""KUKA KR 210 R3100-2 (KR QUANTEC-2), the robot of the paper's terramechanics laboratory."""

from robots_models.families.kuka_kr import KukaKr, KukaKrData


class KukaKr210R3100(KukaKr):
    """KUKA's QUANTEC robot for 210 kg and 3.1 m reach."""

    DATA = KukaKrData(
        source=(
            'github.com/kroshu/kuka_robot_descriptions @7766e92 (KUKA, Apache-2.0): '
            'kuka_quantec_support/urdf/kr210_r3100_2_macro.xacro and config/kr210_r3100_2_joint_limits.yaml; '
            'home: kuka_kr_moveit_config/srdf/kr_arm_macro.xacro. Published: kinematics, limits of position, '
            'velocity, acceleration and effort, masses and inertias (principal axes rotated into link '
            'frames). Estimated: jerk (acceleration / 0.1 s). Unconfirmed data-sheet figure: reach. Not '
            'published: gear ratios, rotor inertias, counterbalance'
        ),
        axis_1_to_axis_2=0.33,
        axis_2_height=0.645,
        upper_arm=1.35,
        elbow_offset=0.115,
        forearm=1.42,
        flange=0.24,
        rated_payload_kg=210.0,
        payload_held_everywhere_kg=104.0,
        reach=3.1,
        effort_estimate=(6770.0, 16420.0, 6253.0, 1058.0, 1068.0, 129.0),
    )
