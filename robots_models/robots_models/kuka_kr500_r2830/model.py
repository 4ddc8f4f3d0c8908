"""KUKA KR 500 R2830 (KR FORTEC, first generation), the robot of the paper's motion simulator."""

from robots_models.families.kuka_kr import KukaKr, KukaKrData


class KukaKr500R2830(KukaKr):
    """KUKA's FORTEC robot for 500 kg and 2.83 m reach; its dynamics are those of a sibling."""

    DATA = KukaKrData(
        source=(
            'github.com/kroshu/kuka_robot_descriptions @7766e92 (KUKA, Apache-2.0): kuka_fortec_support, '
            'kr600_r2830 and kr360_r2830, siblings with the same kinematics; position limits agree with an '
            "independent modified Denavit-Hartenberg table of this robot (a student's project, compared "
            "there with RoboDK). Velocities: A1-A3 from KUKA's assembly manual of the KR 500 FORTEC (2021) "
            'as cited by ISW, University of Stuttgart; A4-A6 unconfirmed data-sheet figures. Of the sibling '
            'KR 600 R2830, not of this robot: accelerations, efforts, masses and inertias (roughly estimated '
            'there for base, link_1, link_5 and link_6, the wrist lumped into link_4). Estimated: jerk '
            '(acceleration / 0.1 s). Not published: gear ratios, rotor inertias, counterbalance'
        ),
        axis_1_to_axis_2=0.5,
        axis_2_height=1.045,
        upper_arm=1.3,
        elbow_offset=-0.055,
        forearm=1.025,
        flange=0.29,
        rated_payload_kg=500.0,
        payload_held_everywhere_kg=123.0,
        reach=2.826,
        effort_estimate=(14700.0, 37390.0, 10100.0, 2373.0, 2370.0, 295.7),
    )
