"""Staubli RX160."""

from robots_models.families.staubli import Staubli, StaubliData


class StaubliRx160(Staubli):
    """Staubli's arm for 20 kg (34 kg at most) and 1.7 m reach."""

    DATA = StaubliData(
        source=(
            'github.com/ros-industrial/staubli @367d92e (Apache-2.0): staubli_rx160_support, after Staubli '
            'RX series 160 Instruction Manual D28086504A (2012). Published: kinematics, position limits, '
            'velocities (maximum speeds). Of a third party: masses and inertias, from CAD shells, with a '
            'warning (155 kg of about 248 kg; link_5 and link_6 far too light). Estimated: accelerations '
            '(maximum speed within 0.3 s), jerks (acceleration / 0.05 s), efforts (1.2 times the largest '
            'gravity torque plus the largest M_ii times acceleration, rated payload at (0.05, 0, 0.10) m '
            'from the flange, over 4000 random postures, of an arm of 248 kg). Not published: gear ratios, '
            'rotor inertias'
        ),
        shoulder_height=0.55,
        shoulder_offset=0.15,
        lateral_offset=0.0,
        upper_arm=0.825,
        forearm=0.625,
        flange=0.11,
        rated_payload_kg=20.0,
        maximum_payload_kg=34.0,
        manual_torque_limits=(692.0, 574.0, 242.0, 58.0, 29.0, 29.0),
    )
