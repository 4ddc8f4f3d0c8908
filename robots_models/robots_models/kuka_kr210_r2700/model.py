"""KUKA KR 210 R2700-2 (KR QUANTEC-2), the welding robot of the paper's section 4.4."""

from robots_models.families.kuka_kr import KukaKr, KukaKrData


class KukaKr210R2700(KukaKr):
    """KUKA's QUANTEC robot for 210 kg and 2.7 m reach."""

    DATA = KukaKrData(
        source=(
            'github.com/kroshu/kuka_robot_descriptions @7766e92 (KUKA, Apache-2.0): '
            'kuka_quantec_support/urdf/kr210_r2700_2_macro.xacro and config/kr210_r2700_2_joint_limits.yaml; '
            'home: kuka_kr_moveit_config/srdf/kr_arm_macro.xacro. Published: kinematics, limits of position, '
            'velocity, acceleration and effort, masses and inertias (principal axes rotated into link '
            'frames). Estimated: jerk (acceleration / 0.1 s). Not published: gear ratios, rotor inertias, '
            'counterbalance'
        ),
        axis_1_to_axis_2=0.33,
        axis_2_height=0.645,
        upper_arm=1.15,
        elbow_offset=0.115,
        forearm=1.22,
        flange=0.215,
        rated_payload_kg=210.0,
        payload_held_everywhere_kg=177.0,
        reach=2.701,
        effort_estimate=(6711.0, 14900.0, 5911.0, 967.5, 835.8, 124.7),
    )
