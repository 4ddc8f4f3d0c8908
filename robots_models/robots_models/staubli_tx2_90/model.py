"""Staubli TX2-90."""

from robots_models.families.staubli import Staubli, StaubliData


class StaubliTx290(Staubli):
    """Staubli's arm for 7 kg (14 kg at most) and 1 m reach."""

    DATA = StaubliData(
        source=(
            'github.com/ros-industrial/staubli_experimental @256a71a (Apache-2.0): staubli_tx2_90_support, '
            'after Staubli TX2 series 90 Instruction Manual D.280.943.04-E (2019). Published: kinematics, '
            'position limits, velocities (nominal speeds). Estimated: accelerations (nominal speed within '
            '0.2 s), jerks (acceleration / 0.05 s), masses and inertias (unconfirmed total of 114 kg split '
            'like the bodies of a KUKA KR 210 R2700-2, solid cylinders of 2000 kg/m^3 between the axes), '
            'efforts (1.2 times the largest gravity torque plus the largest M_ii times acceleration, rated '
            'payload at (0.05, 0, 0.10) m from the flange, over 4000 random postures). Not published: gear '
            'ratios, rotor inertias'
        ),
        shoulder_height=0.478,
        shoulder_offset=0.05,
        lateral_offset=0.05,
        upper_arm=0.425,
        forearm=0.425,
        flange=0.1,
        rated_payload_kg=7.0,
        maximum_payload_kg=14.0,
        manual_torque_limits=(318.0, 166.0, 76.0, 34.0, 29.0, 11.0),
    )
