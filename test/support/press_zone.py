"""The zone of a press beside the KR 210, for tests of cells."""

PRESS_ZONE = """\
zones:
  - name: press
    box: {size: [1.0, 1.0, 4.0]}
    pose: {position: [1.4, 1.2, 1.0]}
    keep: out
    what: bodies
"""
