"""Tools and bases by name: the file, what is wrong with one, and programs that choose from it."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from robots_controller.commands.command_table import CHECK_PROGRAM
from robots_controller.interpreter.argument_kinds import Sizes
from robots_controller.program.files.cell_frames import CellFrames, Tool, read_frames, write_frames
from robots_controller.program_check.program_check import check_program
from robots_core import Pose, load_robot_model
from robots_core.errors import InvalidInputError, ProgramError

from .simulated_program import ROBOT, run_text

FRAMES = """\
tools:
  gripper:
    position: [0.1, 0.0, 0.25]
    angles: [0.0, 0.5, 0.0]
    payload: [12.5, 0.0, 0.0, 0.1]
  pen: {position: [0, 0, 0.1]}
bases:
  table: {position: [1.0, 0.2, 0.5], angles: [0.3, 0, 0]}
"""
numbers = st.floats(-10.0, 10.0, allow_subnormal=False)
poses = st.builds(
    Pose.from_angles,
    arrays(np.float64, 3, elements=numbers),
    arrays(np.float64, 3, elements=st.floats(-3.0, 3.0)),
)
payloads = st.one_of(st.just(()), st.tuples(st.floats(0.0, 100.0), numbers, numbers, numbers))
names = st.text(min_size=1, max_size=12).filter(lambda text: text.isprintable() and text == text.strip())


tools_by_name = st.dictionaries(names, st.builds(Tool, poses, payloads), max_size=4)


@given(tools_by_name, st.dictionaries(names, poses, max_size=4))
@settings(max_examples=40)
def test_what_is_written_is_read_again(tools: dict[str, Tool], bases: dict[str, Pose]) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / 'frames.yaml'
        write_frames(path, CellFrames(tools, bases))
        read = read_frames(path)
        assert list(path.parent.iterdir()) == [path]  # nothing else is left behind
    assert read.tools.keys() == tools.keys()
    assert read.bases.keys() == bases.keys()
    for name, tool in tools.items():
        assert read.tools[name].pose.distance_to(tool.pose) == pytest.approx((0.0, 0.0), abs=1e-7)
        assert read.tools[name].payload == tool.payload
    for name, base in bases.items():
        assert read.bases[name].distance_to(base) == pytest.approx((0.0, 0.0), abs=1e-7)


@pytest.mark.parametrize('text', [None, '', '# nothing yet\n', 'bases: {}\n'])
def test_no_file_and_an_empty_one_have_no_frames(tmp_path: Path, text: str | None) -> None:
    path = tmp_path / 'frames.yaml'
    if text is not None:
        path.write_text(text)
    read = read_frames(path)
    assert (read.names('tool'), read.names('base')) == ((), ())


@pytest.mark.parametrize(
    ('text', 'message'),
    [
        ('tools: [', 'frames.yaml:1: not YAML'),
        (
            'tools:\n  a: {postion: [0, 0, 0]}',
            "frames.yaml:2: unknown key 'postion'; did you mean",
        ),
        ('tools:\n  a: {}\n  a: {}', "frames.yaml:3: 'a' stands here and in line 2"),
        ('tools:\n  a: 3', 'frames.yaml:2: a must be a mapping'),
        ('tools:\n  a:\n    payload: [-1, 0, 0, 0]', 'frames.yaml:3: mass = -1.0 kg'),
        ('tools:\n  a:\n    payload: heavy', "frames.yaml:3: payload is 'heavy'"),
        ('tools:\n  a:\n    payload: [1]', 'frames.yaml:3: payload has 1 numbers'),
        ('bases:\n  a: {payload: [1, 0, 0, 0]}', "frames.yaml:2: unknown key 'payload'"),
        ('bases:\n  a:\n    position: [1400, 0, 0]', 'frames.yaml:3: position has 1400 m'),
        ('tool:\n  a: {}', "frames.yaml:1: unknown key 'tool'; did you mean 'tools'?"),
    ],
)
def test_a_wrong_file_is_named_with_its_line_and_not_overwritten(
    tmp_path: Path, text: str, message: str
) -> None:
    path = tmp_path / 'frames.yaml'
    path.write_text(text)
    with pytest.raises(InvalidInputError) as caught:
        read_frames(path)
    assert message in str(caught.value)


def test_a_frame_needs_a_name(tmp_path: Path) -> None:
    with pytest.raises(InvalidInputError, match='name of the tool is empty'):
        CellFrames().with_tool(' ', Tool(Pose.identity()))
    with pytest.raises(ProgramError, match='the frames file cannot be written'):
        write_frames(tmp_path / 'gone' / 'frames.yaml', CellFrames().with_base('a', Pose.identity()))


# -- in programs ------------------------------------------------------------------------------------------


def test_a_program_chooses_tool_base_and_payload_by_name(tmp_path: Path) -> None:
    (tmp_path / 'frames.yaml').write_text(FRAMES)
    run = run_text(
        tmp_path,
        """
        local function line(values) print(string.format(("%.4f "):rep(#values), table.unpack(values))) end
        setTool('gripper') setBase("table")
        line(getTool()) line(getBase()) line(getPayload())
        ptpJointSpaceAngles(5, -90, 90, 0, 45, 0)
        line(getCartesianPosition())
        setTool('pen')
        line(getTool()) line(getPayload())
        setTool(0, 0, 0.2, 0, 0, 0) line(getTool())
        """,
    )
    assert run.error is None
    tool, base, payload, reached, pen, kept, numbers_alone = (
        [float(part) for part in text.split()] for text in run.printed
    )
    np.testing.assert_allclose(tool, [0.1, 0.0, 0.25, 0.0, np.degrees(0.5), 0.0], atol=1e-3)
    np.testing.assert_allclose(base, [1.0, 0.2, 0.5, np.degrees(0.3), 0.0, 0.0], atol=1e-3)
    assert payload == [12.5, 0.0, 0.0, 0.1]
    frames = read_frames(tmp_path / 'frames.yaml')
    flange = Pose(*load_robot_model(ROBOT).direct_kinematics(run.position[-1]))
    seen = frames.bases['table'].inverse() @ flange @ frames.tools['gripper'].pose
    np.testing.assert_allclose(reached[:3], seen.r, atol=1e-3)
    assert pen == [0.0, 0.0, 0.1, 0.0, 0.0, 0.0]
    assert kept == payload  # the pen has none of its own
    assert numbers_alone == [0.0, 0.0, 0.2, 0.0, 0.0, 0.0]
    (motion,) = run.motions
    assert motion.settings.payload == (12.5, 0.0, 0.0, 0.1)
    assert motion.settings.tool[:3] == (0.1, 0.0, 0.25)


def test_another_file_may_be_given(tmp_path: Path) -> None:
    (tmp_path / 'frames.yaml').write_text('tools: {}\n')
    other = tmp_path / 'cell_2.yaml'
    other.write_text(FRAMES)
    run = run_text(tmp_path, "setTool('pen') print(getTool()[3])", frames=other)
    assert run.error is None
    assert run.printed == ('0.1',)


@pytest.mark.parametrize(
    ('call', 'reason'),
    [
        ("setTool('griper')", "no tool is named 'griper' in frames.yaml; tools are gripper, pen"),
        ("setBase('gripper')", "no base is named 'gripper' in frames.yaml; bases are table"),
        ("setTool('')", "name = the string ''; valid is the name of a tool"),
        (
            "setTool('pen', 1)",
            'got 2 arguments, needed are 6: x (m), y (m), z (m), phi1 (deg), phi2',
        ),
    ],
)
def test_a_name_that_is_not_there_is_refused_with_those_that_are(
    tmp_path: Path, call: str, reason: str
) -> None:
    (tmp_path / 'frames.yaml').write_text(FRAMES)
    run = run_text(tmp_path, f'print(1)\n{call}')
    assert run.error is not None
    assert run.error.line == 2
    assert reason in run.error.reason
    (problem,) = check_program(tmp_path / 'program.lua', Sizes(6, 32, 8))
    assert problem.line == 2
    assert reason in problem.reason


def test_the_check_reads_the_file_that_is_given(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    program, other = tmp_path / 'program.lua', tmp_path / 'cell_2.yaml'
    program.write_text(f"-- Robot: {ROBOT}\nsetTool('pen')\n")
    (problem,) = check_program(program, Sizes(6, 32, 8))
    assert problem.reason == (
        "setTool: no tool is named 'pen' in frames.yaml, which does not exist; tools are none"
    )
    other.write_text(FRAMES)
    assert CHECK_PROGRAM.run([str(program), '--frames', str(other)]) == 0
    assert 'no findings' in capsys.readouterr().out
    other.write_text('tools:\n  pen: {position: [0, 0]}\n')
    assert CHECK_PROGRAM.run([str(program), '--frames', str(other)]) == 1
    assert 'cell_2.yaml:2: position must have shape (3,)' in capsys.readouterr().out
