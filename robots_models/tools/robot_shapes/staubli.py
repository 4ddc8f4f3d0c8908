"""What Staubli's arms look like: our own drawing, arm upright (all joints at zero)."""

from robots_models.families.staubli import StaubliData
from solids import Drawing, block, body, enlarged, fork, hub, tapered_arm, trim, tube, upright

_YELLOW = (0.98, 0.8, 0.12)
_PALE = (0.93, 0.93, 0.9)
_GREY = (0.42, 0.44, 0.46)
_BLACK = (0.12, 0.12, 0.13)
_STEEL = (0.78, 0.79, 0.8)

_ASIDE = 0.19  # m, how far the upper arm stands beside the shoulder's middle


def staubli_parts(data: StaubliData, *, bulk: float = 1.0, pale: bool = False) -> Drawing:
    """The parts of a Staubli arm.

    Args:
        data: Its dimensions.
        bulk: How much thicker it is than a TX2-90.
        pale: White with grey caps, instead of yellow.
    """
    paint, caps = (_PALE, _GREY) if pale else (_YELLOW, _BLACK)
    shoulder = data.shoulder_height / bulk
    x, y = data.shoulder_offset / bulk, data.lateral_offset / bulk
    elbow = shoulder + data.upper_arm / bulk
    wrist = elbow + data.forearm / bulk
    flange = wrist + data.flange / bulk
    parts: Drawing = {
        trim('foot', 'base_link', _GREY): [
            block((-0.02, 0.0, 0.015), (0.34, 0.32, 0.03), rounding=0.05, chamfer=0.004),
            block((-0.15, 0.0, 0.09), (0.12, 0.16, 0.12)),
        ],
        body('base', 'base_link', paint): [
            upright(0.03, 0.16, 0.15, 0.135, chamfer=0.02),
            upright(0.14, shoulder - 0.17, 0.135, 0.13, chamfer=0.02),
        ],
        trim('turntable', 'link_1', _BLACK): [
            upright(shoulder - 0.17, shoulder - 0.155, 0.125, 0.125, chamfer=0.003)
        ],
        body('shoulder', 'link_1', paint): [
            tube((0.0, 0.0, shoulder - 0.155), (0.4 * x, 0.0, shoulder), 0.135, 0.12, chamfer=0.02),
            hub((x, 0.01, shoulder), 'y', 0.13, 0.21, chamfer=0.03),
        ],
        trim('shoulder_cap', 'link_1', caps): [hub((x, -0.105, shoulder), 'y', 0.09, 0.04)],
        body('upper_arm', 'link_2', paint): [
            tapered_arm(
                (x, _ASIDE, shoulder), (x, _ASIDE, elbow), 0.125, 0.095, axis='y', width=0.13, chamfer=0.03
            )
        ],
        trim('upper_arm_caps', 'link_2', caps): [
            hub((x, _ASIDE + 0.068, shoulder), 'y', 0.085, 0.02, chamfer=0.006),
            hub((x, _ASIDE + 0.068, elbow), 'y', 0.065, 0.02, chamfer=0.006),
        ],
        body('elbow', 'link_3', paint): [
            tube((x, _ASIDE - 0.07, elbow), (x, y - 0.08, elbow), 0.095, 0.09, chamfer=0.02),
            upright(elbow - 0.1, elbow + 0.13, 0.075, 0.085, at=(x, y), chamfer=0.025),
        ],
        trim('elbow_cap', 'link_3', caps): [hub((x, y - 0.085, elbow), 'y', 0.06, 0.02, chamfer=0.006)],
        trim('forearm_ring', 'link_4', _BLACK): [
            upright(elbow + 0.13, elbow + 0.142, 0.075, 0.075, at=(x, y), chamfer=0.003)
        ],
        body('forearm', 'link_4', paint): [
            upright(elbow + 0.142, wrist - 0.115, 0.082, 0.06, at=(x, y), chamfer=0.015),
            *fork((x, y, wrist - 0.14), (x, y, wrist), 0.045, 0.04, axis='y', aside=0.05, width=0.025),
        ],
        body('hand', 'link_5', caps): [
            hub((x, y, wrist), 'y', 0.038, 0.07),
            upright(wrist + 0.01, flange - 0.028, 0.035, 0.032, at=(x, y)),
        ],
        body('flange', 'link_6', _STEEL): [
            upright(flange - 0.028, flange, 0.03, 0.03, at=(x, y), chamfer=0.003)
        ],
    }
    return enlarged(parts, bulk)
