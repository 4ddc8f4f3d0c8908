"""PendantOperator: takes what viewers press, and commands what is permitted."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Final

import numpy as np

from robots_controller.interpreter.argument_kinds import Sizes
from robots_controller.interpreter.debugger import STEPS, CallStack, call_stack_from_json
from robots_controller.io.io_image import Channel, IoImage
from robots_controller.measuring.frame_measuring import FrameMeasuring
from robots_controller.measuring.frame_measuring import Sequence as Touched
from robots_controller.pendant.jog.held_button import HeldButton, Sign, standing
from robots_controller.pendant.jog.jog_prediction import JogPrediction, PredictedStop
from robots_controller.pendant.jog.pendant_motion import Preview, Way, motion_preview, target_command
from robots_controller.pendant.message_log import MessageLog
from robots_controller.pendant.motion_recording import MotionRecording
from robots_controller.pendant.pendant_port import PendantPort
from robots_controller.pendant.pendant_state import PendantState
from robots_controller.pendant.permissions import Action, NotPermittedError, refusal
from robots_controller.pendant.programs import program_file
from robots_controller.pendant.recording import Recording
from robots_controller.pendant.trends import Trends
from robots_controller.program.files.taught_points import TaughtPoint
from robots_controller.program.teaching import Motion, Teaching
from robots_controller.program_check.program_check import ProgramProblem, check_program
from robots_core.cell_interface.operating_modes import OperatingMode
from robots_core.errors import InvalidInputError, NotNowError, ProgramError
from robots_core.files.user_file import read_text
from robots_core.robot_model.base_robot_model import BaseRobotModel
from robots_core.validation import one_of
from robots_planning.pathplanning import PathPlanning

MOST_PRINTS: Final = 500
STANDING: Final = 0.002  # of the velocity limits

SERVICES: Final[Mapping[Action, str]] = {
    Action.RUN: 'lua_program_node/run',
    Action.PAUSE: 'lua_program_node/pause',
    Action.RESUME: 'lua_program_node/resume',
    Action.END: 'lua_program_node/stop',
    Action.REWIND: 'lua_program_node/reset',
    Action.RESET: 'controller_node/reset',
}


class ControlDesk:
    """Which viewer of the page operates the cell."""

    def __init__(self) -> None:
        self.holder = ''
        """The viewer in control; '' for none."""
        self.address = ''
        """Of its browser."""
        self.log: Callable[[str], object] = str
        """Gets who has taken control, for a log."""

    def take(self, viewer: str, *, address: str = '', from_other: bool = False) -> None:
        """Take control, with `from_other` also from a viewer that has it.

        Raises:
            NotPermittedError: another one has it.
        """
        if self.holder not in ('', viewer) and not from_other:
            raise NotPermittedError('controlled')
        if viewer != self.holder:
            self.log(f'the page at {address} operates the robot')
        self.holder, self.address = viewer, address

    def give_back(self, viewer: str) -> None:
        """Give control back, if the viewer has it."""
        if self.holder == viewer:
            self.holder = ''

    def check(self, viewer: str) -> None:
        """Check that a viewer is in control.

        Raises:
            NotPermittedError: it is not.
        """
        if self.holder != viewer:
            raise NotPermittedError('controlled' if self.holder else 'not_in_control')


class PendantOperator:
    """What all pages of a pendant share: the state, who operates, and the button that is held.

    `state` may be replaced from any thread; presses are taken in one thread. All commands raise a
    NotPermittedError if the viewer is not in control or the state does not permit them, and another
    RobotsError if a node refuses them or does not answer, or if a file is not valid or cannot be written.

    Args:
        robot: The robot.
        port: The cell.
        now: Time, s.
        planning: Makes the planner of previews when the first one is wanted; by default one without
            obstacles.
        recording: Of what happens in the cell; by default to the folder 'out'.
    """

    def __init__(
        self,
        robot: BaseRobotModel,
        port: PendantPort,
        now: Callable[[], float],
        planning: Callable[[], PathPlanning] | None = None,
        recording: Recording | None = None,
    ) -> None:
        planning = planning or (lambda: PathPlanning(robot))
        self.robot: Final = robot
        self.now: Final = now
        self.desk: Final = ControlDesk()
        self.messages: Final = MessageLog()
        self.teaching: Final = Teaching(robot)
        self.trends: Final = Trends(robot.axes_data)
        self.recording: Final = recording or Recording(Path('out'), robot.name)
        self.measuring: Final = FrameMeasuring(robot)
        self.motion: Final = MotionRecording(port.feedback)
        """For the payload."""
        self.prints: deque[str] = deque(maxlen=MOST_PRINTS)
        """What programs have printed, oldest first."""
        self.state = PendantState()
        self.held: Final = HeldButton(robot, port, now, self.check)
        self._port = port
        self._prediction = JogPrediction(robot)
        self._planning, self._planner = threading.Lock(), cache(planning)
        self._previewing = threading.Lock()
        self._targets: dict[str, object] = {}
        self._previews: dict[str, Preview] = {}

    # -- viewers ------------------------------------------------------------------------------------------

    def take_control(self, viewer: str, *, address: str = '', from_other: bool = False) -> None:
        """See `ControlDesk.take`; what the other viewer holds is released."""
        self.desk.take(viewer, address=address, from_other=from_other)
        if self.held.viewer != viewer:
            self.held.release()

    def give_back_control(self, viewer: str) -> None:
        """Release what the viewer holds, and give control back; called too when a viewer is gone."""
        self.release(viewer)
        self.forget_preview(viewer)
        self.desk.give_back(viewer)

    # -- what is held -------------------------------------------------------------------------------------

    def hold(self, sign: Sign) -> Action | None:
        """A viewer holds a button; see `HeldButton.hold`. What it returns is to be given to `act`."""
        return self.held.hold(sign, self.state, self._previews.get(sign.viewer))

    def release(self, viewer: str) -> None:
        """A viewer has released what it held, or the connection to it is lost."""
        if self.held.viewer == viewer:
            self.held.release()

    def ahead(self) -> PredictedStop | None:
        """What will stop the jog that is under way; None for nothing soon."""
        jog, state = self.held.jog, self.state
        if jog is None or state.q is None:
            return None
        return self._prediction.ahead(jog, state.q, state.jog_speeds, state.settings)

    def preview(self, viewer: str, way: Way, values: Sequence[float], speed: float) -> Preview | None:
        """Plan the motion to a typed target, see `target_command`, and show its end in the 3D view.

        Returns:
            The motion; None if the target was forgotten while it was planned.
        """
        self.forget_preview(viewer)
        self.check(viewer, Action.MOVE)
        target = self._targets[viewer] = object()
        state = self.state
        command = target_command(self.robot, way, values, speed, state)
        with self._planning:
            q = standing(self._port, state)
            found = motion_preview(self._planner(), command, q, state.settings, state.jog_speeds.tool)
        with self._previewing:
            if self._targets.get(viewer) is not target:
                return None
            self._previews[viewer] = found
            self._port.show_ghost(found.q)
        return found

    def play_preview(self, viewer: str, time: float) -> None:
        """Show where the robot will be a time (s) after the start of the motion that a viewer has planned."""
        if (found := self._previews.get(viewer)) is not None:
            self._port.show_ghost(found.at(time))

    def forget_preview(self, viewer: str) -> None:
        """The target of a viewer is another one now, or none."""
        with self._previewing:
            self._targets.pop(viewer, None)
            if self._previews.pop(viewer, None) is not None:
                self._port.show_ghost(None)

    # -- what is pressed once -----------------------------------------------------------------------------

    def stop(self) -> None:
        """Stop the program and the robot: any viewer may."""
        self.held.release()
        self._port.stop()

    def act(self, viewer: str, action: Action) -> None:
        """Do one of `SERVICES`; so this and what follows waits for the answer of the cell."""
        self.check(viewer, action)
        self._port.call(SERVICES[action])

    def open_program(self, viewer: str, path: str) -> None:
        """Open a robot program."""
        self.check(viewer, Action.OPEN)
        self._port.open_program(path)

    # -- points and programs ------------------------------------------------------------------------------

    def points(self) -> Mapping[str, TaughtPoint]:
        """The points of the program that is open, by name."""
        path = self.state.program.points_file
        return self.teaching.points(Path(path)) if path else {}

    def teach(self, viewer: str, name: str) -> None:
        """Store where the robot stands as a point of the program that is open."""
        self.check(viewer, Action.TEACH)
        self.teaching.teach(self._points_file, name, standing(self._port, self.state))

    def insert_motion(self, viewer: str, file: str, line: int, motion: Motion, names: Sequence[str]) -> int:
        """Teach where the robot stands, insert a motion to it after a line, and open the program again.

        Returns:
            The line of the motion; for the names of its points see `Teaching.insert`.
        """
        self.check(viewer, Action.EDIT)
        program, q = Path(self.state.program.path), standing(self._port, self.state)
        found = program_file(program, file)
        new = self.teaching.insert(self._points_file, found, line, motion=motion, names=names, q=q)
        self._reopen()
        return new

    def undo(self, viewer: str) -> None:
        """Take the newest change of a program or a points file back, and open the program again."""
        self.check(viewer, Action.EDIT)
        self.teaching.history.undo()
        self._reopen()

    def save_program(self, viewer: str, file: str, before: str, after: str) -> tuple[ProgramProblem, ...]:
        """Save a file of the program whose text was `before` when editing began, open it again, and check it.

        Returns:
            What is wrong with the program.

        Raises:
            ProgramError: somebody else has changed the file.
        """
        self.check(viewer, Action.EDIT)
        program = Path(self.state.program.path)
        path = program_file(program, file)
        if read_text(path, 'program') != before:
            raise ProgramError(
                'changed by another one while it was edited; it stays as it is',
                file=path.name,
                key='changed_since',
            )
        self.teaching.history.change({path: after})
        problems = self._findings(program)
        self._reopen()
        return problems

    def _findings(self, program: Path) -> tuple[ProgramProblem, ...]:
        """What `check_program` finds, with this robot and the names of its cell."""
        io, axes, frames_file = self.state.io, self.robot.axes_data, self.state.program.frames_file
        digital, analog = (len(io.values.get(f'{kind}_outputs', ())) for kind in ('digital', 'analog'))
        image = IoImage(digital=digital, analog=analog, labels=io.labels)
        sizes = Sizes.of(axes.num_axes, image, axes.prismatic)
        return check_program(program, replace(sizes, frames_file=Path(frames_file) if frames_file else None))

    def toggle_breakpoint(self, viewer: str, file: str, line: int) -> None:
        """Hold programs at a line of a file, or do not any more."""
        self.check(viewer, Action.BREAK)
        lines = {(name, one) for name, ones in self.state.breakpoints.items() for one in ones}
        places = [f'{name}:{one}' for name, one in sorted(lines ^ {(file, line)})]
        self._port.set_parameters('lua_program_node', breakpoints=places or [''])

    def step(self, viewer: str, step: str) -> None:
        """Let a held program make a step: over, in, out or motion."""
        self.check(viewer, Action.STEP)
        self._port.set_parameters('lua_program_node', step_mode=one_of('step', STEPS)(step))
        self._port.call('lua_program_node/step')

    def call_stack(self) -> CallStack:
        """The call stack of the program that is held, innermost first, with its variables."""
        return call_stack_from_json(self._port.call('lua_program_node/get_call_stack'))

    def measure(self, viewer: str, step: Callable[[], None]) -> None:
        """Do a step of `measuring`, if the viewer may now."""
        self.check(viewer, Action.TEACH)
        step()

    def touch(self, viewer: str, sequence: Touched) -> None:
        """Touch the next point of a sequence of `measuring`, where the robot stands."""
        self.check(viewer, Action.TEACH)
        q, q_dot = self.state.q, self.state.q_dot
        if q is None:
            raise NotPermittedError('no_position')
        if q_dot is not None and (np.abs(q_dot) > STANDING * self.robot.axes_data.velocity).any():
            raise NotPermittedError('moving')
        self.measuring.touch(sequence, q)

    def _reopen(self) -> None:
        """Open the program again, which has changed; what is wrong with it is shown with it."""
        with suppress(NotNowError):
            self._port.open_program(self.state.program.path)

    @property
    def _points_file(self) -> Path:
        if not self.state.program.points_file:
            raise NotPermittedError('no_program')
        return Path(self.state.program.points_file)

    # -- settings, inputs and outputs ---------------------------------------------------------------------

    def set_mode(self, viewer: str, mode: str) -> None:
        """Set the operating mode."""
        self.check(viewer, Action.MODE)
        self._port.set_parameters('controller_node', operating_mode=OperatingMode(mode).value)

    def set_override(self, viewer: str, value: float) -> None:
        """Set the speed override, 0..1."""
        self.check(viewer, Action.OVERRIDE)
        if not 0.0 <= value <= 1.0:
            raise InvalidInputError(f'override = {value:g} must be in [0, 1]')
        self._port.set_override(value)

    def set_output(self, viewer: str, channel: Channel, value: float) -> None:
        """Give an output a value."""
        self.check(viewer, Action.SWITCH)
        self._port.set_io(channel, channel.checked(value))

    def force_input(self, viewer: str, channel: Channel, value: float | None) -> None:
        """Force an input to a value; None releases it."""
        self.check(viewer, Action.SWITCH)
        self._port.force(channel, None if value is None else channel.checked(value))

    def check(self, viewer: str, action: Action) -> None:
        """Check that a viewer may do an action now.

        Raises:
            NotPermittedError: it is not in control, or the state does not permit the action.
        """
        self.desk.check(viewer)
        if (error := refusal(action, self.state)) is not None:
            raise error
