"""What goes wrong is said on the page in its language, by code and facts, and in English otherwise."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pendant_desk import ME, READY, Desk
from robots_controller.commands.error_catalogue import error_catalogue
from robots_controller.measuring.frame_measuring import FrameMeasuring
from robots_controller.pendant.pendant_state import ShownProgram
from robots_controller.pendant.recording import Recording
from robots_controller.pendant.texts import read_texts
from robots_controller.program.files.cell_frames import CellFrames, Tool, check_frame
from robots_controller.program.files.file_history import FileHistory
from robots_controller.program.run_state import RunState
from robots_controller.program.teaching import Teaching
from robots_core import Pose, load_robot_model
from robots_core.blocks import MotionSamples, NumericalDynamics, Payload, identify_payload
from robots_core.blocks.calibration.three_points import measure_base
from robots_core.blocks.calibration.tool_center import measure_tool_center
from robots_core.cell_interface.motion_result import MotionResult
from robots_core.errors import InvalidInputError, JointLimitError, NotNowError, RobotsError
from robots_core.orientation import rotation_from_vector

ROOT = Path(__file__).parents[2]
ROBOT = load_robot_model('kuka_kr210_r2700')
TURNS = ([0.5, 0.0, 0.0], [-0.5, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.3, 0.6])
GERMAN = read_texts('de')


def said(work: Callable[[], object]) -> str:
    """What the German page says of what goes wrong; the English page says what the error does."""
    with pytest.raises(RobotsError) as refused:
        work()
    error = refused.value
    assert read_texts('en').error(error) == str(error)
    text = GERMAN.error(error)
    assert text != str(error)
    return text


def flanges(off: float = 0.0) -> list[Pose]:
    tool, found = np.array([0.0, 0.0, 0.2]), []
    for number, turn in enumerate(TURNS):
        T = rotation_from_vector(np.array(turn))
        found.append(Pose(np.array([off if number == 2 else 0.0, 0.0, 0.0]) - T @ tool, T))
    return found


def motion(mass: float, scale: float = 1.0, seconds: float = 8.0) -> MotionSamples:
    carried = Payload(mass, np.array([0.05, -0.1, 0.25])) if mass else Payload(0.0, np.zeros(3))
    dynamics = NumericalDynamics(ROBOT, payload=carried)
    t = np.arange(0.0, seconds, 0.02)
    speed, swing = np.array([0.5, 0.6, 0.7, 1.0, 1.3, 1.6]), np.array([0.1, 0.1, 0.1, 0.6, 0.6, 0.6]) * scale
    q, q_dot, q_ddot = (swing * speed**k * np.sin(speed * t[:, None] + k * np.pi / 2) for k in (0, 1, 2))
    q = q + ROBOT.home
    tau = np.array([dynamics.torques(*one) for one in zip(q, q_dot, q_ddot, strict=True)])
    return MotionSamples.from_recording(t, q, tau + np.random.default_rng(0).normal(size=tau.shape))


def test_refused_measurements_are_said_in_german() -> None:
    assert said(lambda: measure_tool_center(flanges()[:3])).startswith('3 Punkte; ')
    apart = said(lambda: measure_tool_center(flanges(0.01)))
    assert re.search(r'größte Abstand ist \d+\.\d\d mm, erlaubt 1\.00 mm\. Punkt 3 passt', apart)
    assert 'entlang [' in said(lambda: measure_tool_center([flanges()[0]] * 4))
    base = said(lambda: measure_base([0, 0, 0], [0.01, 0, 0], [0, 1, 0]))
    assert (
        base
        == 'Der Punkt auf der Achse x ist 10.00 mm vom Ursprung entfernt; mindestens 20.00 mm sind nötig.'
    )
    assert '5.00 mm von der Achse x' in said(lambda: measure_base([0, 0, 0], [1, 0, 0], [1, 0.005, 0]))
    few = said(lambda: MotionSamples.from_recording([0.0, 0.5], np.zeros((2, 6)), np.zeros((2, 6))))
    assert few.startswith('2 Werte in 0.5 s sind keine Aufnahme')
    assert 'nicht von 0 zu unterscheiden' in said(lambda: identify_payload(ROBOT, motion(0.0)))
    assert 'das ist zu kurz' in said(lambda: identify_payload(ROBOT, motion(60.0, seconds=0.5)))


def test_steps_that_are_missing_are_said_in_german(tmp_path: Path) -> None:
    measuring, home = FrameMeasuring(ROBOT), np.array(ROBOT.home)
    measuring.touch('base', home)
    assert said(lambda: measuring.base(Pose.identity())) == '1 von 3 Punkten sind angetastet.'
    for _ in range(2):
        measuring.touch('base', home)
    assert said(lambda: measuring.touch('base', home)).startswith('Alle 3 Punkte')
    measuring.points['tool'] += flanges()
    measuring.touch('orientation', home)
    assert 'zweite Punkt' in said(lambda: measuring.tool('-z'))
    frames = CellFrames()
    assert 'Werkzeug braucht' in said(lambda: frames.with_tool(' ', Tool(Pose.identity())))
    assert 'Basis braucht' in said(lambda: frames.with_base('', Pose.identity()))
    file = tmp_path / 'frames.yaml'
    assert said(lambda: check_frame(file, 'tool', '007')) == 'Kein Werkzeug heißt 007; es gibt none.'
    assert said(lambda: check_frame(file, 'base', 'x')).startswith('Keine Basis heißt x')


def test_files_and_recordings_are_refused_in_german(tmp_path: Path) -> None:
    history, program = FileHistory(), tmp_path / 'a.lua'
    assert said(history.undo) == 'Es gibt nichts rückgängig zu machen.'
    program.write_text('wait(1)\n')
    shown = ShownProgram(str(program), RunState.OPENED, program.name)
    operator = Desk(replace(READY, program=shown)).operator
    changed = said(lambda: operator.save_program(ME, program.name, '', 'wait(2)\n'))
    assert changed.startswith('a.lua: Jemand anders')
    teaching, points = Teaching(ROBOT), tmp_path / 'a.points.yaml'
    assert 'Punkt braucht' in said(lambda: teaching.teach(points, ' ', np.array(ROBOT.home)))
    assert str(tmp_path) in said(Recording(tmp_path, 'r').report)


def test_errors_of_other_nodes_are_said_by_their_code() -> None:
    error = JointLimitError('A1', 4.0, -3.2, 3.2)
    assert GERMAN.error(error) == 'A1 = 229.2° liegt außerhalb der Grenzen -183.3° bis 183.3°.'
    sent = MotionResult.refused('1', error).error  # as it comes in a message: facts are texts
    assert sent is not None
    assert GERMAN.error(sent) == GERMAN.error(error)
    rail = JointLimitError('rail', 2.0, 0.0, 1.5, unit='m')
    assert GERMAN.error(rail).startswith('rail = 2000.00 mm')
    assert GERMAN.error(NotNowError('a motion runs')) == 'Das geht jetzt nicht: a motion runs'


def test_what_has_no_text_is_english() -> None:
    assert GERMAN.error(InvalidInputError('x = 3')) == 'x = 3'
    old = JointLimitError('A1', 4.0, -3.2, 3.2)
    del old.details['value']
    assert GERMAN.error(old) == str(old)


def test_every_translated_error_can_happen() -> None:
    sources = [file.read_text() for file in ROOT.glob('robots_co*/robots_co*/**/*.py')]
    keys = {key for text in sources for key in re.findall(r"\bkey=f?'([\w{}]+)'", text)}
    kinds = {'tool', 'base'}
    known = {key.replace('{kind}', kind) for key in keys for kind in kinds}
    for key in (key.removeprefix('errors.') for key in GERMAN.texts if key.startswith('errors.')):
        code, _, rest = key.partition('_')
        assert code in error_catalogue()
        assert not rest or rest in known, key
    for key in known:
        assert any(text.endswith(f'_{key}') for text in GERMAN.texts), key
