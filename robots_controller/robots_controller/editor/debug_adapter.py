"""DebugAdapter: an editor debugs a robot program, by the Debug Adapter Protocol.

The few messages that a robot program needs stand here in full: the libraries on PyPI are either clients or
type definitions that bring pydantic with them (dap-python, dap-types), or debug Python (debugpy).
Protocol: https://microsoft.github.io/debug-adapter-protocol/specification
"""

import hmac
import itertools
import json
import os
import re
import threading
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any, BinaryIO, Final

from robots_controller.interpreter.debugger import CallStack, HoldReason, Step, Variable
from robots_controller.interpreter.lua_program import LuaProgram
from robots_controller.interpreter.lua_source import chunk_name
from robots_controller.program.run_state import RunState
from robots_core.errors import InvalidInputError, ProgramError
from robots_core.files.user_file import read_text

THREAD: Final = 1
MAX_MESSAGE: Final = 1_000_000  # bytes
HEADERS: Final = ('content-length', 'content-type')
# What is served before the editor has given the token.
_OF_STRANGERS: Final = ('initialize', 'launch', 'attach', 'disconnect')
_NO_CODE = re.compile(r'\s*(--.*)?$')
_CAPABILITIES: Final = {
    'supportsConfigurationDoneRequest': True,
    'supportsTerminateRequest': True,
    'supportsEvaluateForHovers': True,
}
_STEPS: Final[dict[str, Step]] = {'next': 'over', 'stepIn': 'in', 'stepOut': 'out'}
_STOP_TEXTS: Final[dict[HoldReason, str]] = {
    'entry': 'Held before the first line',
    'breakpoint': 'Held at a breakpoint',
    'step': 'Held after a step',
    'pause': 'Paused',
    'release': 'Held until run is held',
}

Message = dict[str, Any]


def read_messages(stream: BinaryIO) -> Iterator[Message]:
    """Messages of a stream until it ends: a header with the length, an empty line, JSON.

    Raises:
        InvalidInputError: what comes is no such message.
    """
    while True:
        length = -1
        while line := stream.readline(1000):
            if line == b'\r\n':
                break
            key, _, value = line.decode('ascii', errors='replace').partition(':')
            if (header := key.strip().lower()) not in HEADERS:  # of HTTP, say, from a page in a browser
                raise InvalidInputError(f'{key[:40]!r} is no header of the Debug Adapter Protocol')
            if header == 'content-length' and value.strip().isdecimal():
                length = int(value)
        else:
            return
        if not 0 <= length <= MAX_MESSAGE:
            raise InvalidInputError(f'a message needs a Content-Length of at most {MAX_MESSAGE}')
        data = stream.read(length)
        if len(data) < length:
            return
        try:
            message = json.loads(data)
        except (ValueError, RecursionError) as error:
            raise InvalidInputError(f'a message is JSON: {error}') from None
        if not isinstance(message, dict) or message.get('type') != 'request':
            raise InvalidInputError('a message is an object of type request')
        yield message


def message_bytes(message: Message) -> bytes:
    """A message as it travels."""
    data = json.dumps(message).encode()
    return b'Content-Length: %d\r\n\r\n' % len(data) + data


class DebugAdapter:
    """One editor's session with the program; its events come from any thread.

    Args:
        program: The program, which the editor may open, run, hold and stop.
        send: Sends a message to the editor; called by one thread at a time.
        token: What `launch` or `attach` must give before anything else is done.
        folder: Programs that the editor may launch are in it or below.
    """

    def __init__(
        self, program: LuaProgram, send: Callable[[Message], None], *, token: str, folder: Path
    ) -> None:
        self._program = program
        self._send_message = send
        self._token, self._launch_folder = token, folder.resolve()
        self._lock = threading.Lock()
        self._numbers = itertools.count(1)
        self._launch: Message | None = None
        self._breakpoints: dict[Path, set[int]] = {}
        self._stack = CallStack()
        self._references: list[tuple[Variable, ...]] = []
        self._released = False
        self._asked: HoldReason = ''
        self.admitted = False
        """The editor has shown the token."""
        self.ended = False
        """The session is over: the editor has disconnected, or is refused."""

    # -- the editor's requests ----------------------------------------------------------------------

    def handle(self, request: Message) -> None:
        """Answer a request."""
        command, arguments = str(request.get('command', '')), request.get('arguments') or {}
        announced = self.admitted
        response: Message = {
            'type': 'response',
            'request_seq': request.get('seq', 0),
            'command': command,
            'success': True,
        }
        after: Callable[[], None] | None = None
        try:
            answer = self._handler(command)(arguments)
            if callable(answer):
                after = answer
            elif answer is not None:
                response['body'] = answer
        except Exception as error:  # noqa: BLE001  # whatever an editor sends, the next request is served
            response |= {'success': False, 'message': str(error) or type(error).__name__}
        self._send(response)
        if self.admitted and not announced:
            self._event('initialized')
        if after is not None:
            after()

    def _handler(self, command: str) -> Callable[[Message], Any]:
        handler: Callable[[Message], Any] | None = getattr(self, f'_do_{_snake(command)}', None)
        if step := _STEPS.get(command):
            handler = partial(self._make_step, step)
        if handler is None:
            raise InvalidInputError(f'the request {command!r} is not known here')
        if not self.admitted and command not in _OF_STRANGERS:
            raise InvalidInputError(f'{command} comes after launch or attach with the token')
        return handler

    def _do_initialize(self, _: Message) -> Message:
        return dict(_CAPABILITIES)

    def _do_launch(self, arguments: Message) -> None:
        self._do_attach(arguments)
        path = Path(str(arguments['program'])).resolve()
        if not path.is_relative_to(self._launch_folder):
            raise InvalidInputError(f'{path} is not below {self._launch_folder}, where programs are launched')
        self._program.open(path)
        self._launch = arguments

    def _do_attach(self, arguments: Message) -> None:
        self.admitted = hmac.compare_digest(str(arguments.get('token', '')).encode(), self._token.encode())
        if not self.admitted:
            self.ended = True
            raise InvalidInputError('the token is wrong: it is the one that the cell shows when it starts')

    def _do_configuration_done(self, _: Message) -> Callable[[], None] | None:
        if self._launch is not None:
            if self._launch.get('noDebug'):
                self.leave()
            stop_on_entry = bool(self._launch.get('stopOnEntry'))
            self._asked = 'entry' if stop_on_entry else ''
            self._program.run(hold=stop_on_entry)
            return None
        return self.on_held  # the program may be held already

    def _do_set_breakpoints(self, arguments: Message) -> Message:
        path = Path(os.path.abspath(str(arguments['source']['path'])))  # noqa: PTH100  # as the editor has it
        wanted = [int(item['line']) for item in arguments.get('breakpoints', ())]
        allowed = path.resolve().is_relative_to(self._launch_folder)
        lines = [_code_line(path, line) if allowed else None for line in wanted]
        self._breakpoints[path] = {line for line in lines if line is not None}
        self._apply_breakpoints()
        return {
            'breakpoints': [
                {'verified': line is not None, 'line': line or line_wanted}
                for line, line_wanted in zip(lines, wanted, strict=True)
            ]
        }

    def _do_set_exception_breakpoints(self, _: Message) -> Message:
        return {'breakpoints': []}

    def _do_threads(self, _: Message) -> Message:
        return {'threads': [{'id': THREAD, 'name': self._program.file or 'no program'}]}

    def _do_stack_trace(self, arguments: Message) -> Message:
        frames = [
            {
                'id': number,
                'name': frame.name,
                'line': frame.line,
                'column': 1,
                'source': {'name': frame.chunk, 'path': self._path(frame.chunk)},
            }
            for number, frame in enumerate(self._stack.frames, 1)
        ]
        start = int(arguments.get('startFrame') or 0)
        count = int(arguments.get('levels') or len(frames))
        return {'stackFrames': frames[start : start + count], 'totalFrames': len(frames)}

    def _do_scopes(self, arguments: Message) -> Message:
        frame = self._stack.frames[int(arguments['frameId']) - 1]
        scopes = {**frame.scopes, 'Globals': self._stack.globals}
        return {
            'scopes': [
                {'name': name, 'variablesReference': self._reference(variables), 'expensive': False}
                for name, variables in scopes.items()
            ]
        }

    def _do_variables(self, arguments: Message) -> Message:
        variables = self._references[int(arguments['variablesReference']) - 1]
        return {'variables': [{'name': variable.name, **self._shown(variable)} for variable in variables]}

    def _do_evaluate(self, arguments: Message) -> Message:
        expression = str(arguments['expression']).strip()
        frame = self._stack.frames[int(arguments.get('frameId') or 1) - 1]
        for variables in (*frame.scopes.values(), self._stack.globals):
            for variable in variables:
                if variable.name == expression:
                    shown = self._shown(variable)
                    return {'result': shown.pop('value'), **shown}
        raise InvalidInputError(f'no variable is named {expression!r} here')

    def _do_continue(self, _: Message) -> Message:
        self._release(self._program.resume, '')
        return {'allThreadsContinued': True}

    def _make_step(self, step: Step, _: Message) -> None:
        self._release(lambda: self._program.step(step), 'step')

    def _do_pause(self, _: Message) -> None:
        self._asked = 'pause'
        if not self._program.pause():
            raise ProgramError('no program is running')

    def _do_terminate(self, _: Message) -> None:
        self._program.stop()

    def _do_disconnect(self, arguments: Message) -> None:
        self.ended = True
        if not self.admitted:
            return
        held = self._holds()
        self.leave()
        if arguments.get('terminateDebuggee', self._launch is not None):
            self._program.stop()
        elif held and not arguments.get('suspendDebuggee'):
            self._program.resume()

    # -- what the program does ----------------------------------------------------------------------

    def on_held(self) -> None:
        """The program is held, or continues."""
        stack, reason = self._program.call_stack, self._program.hold_reason
        self._references = []
        self._stack = stack
        if stack.frames:
            body = {'reason': reason, 'description': _STOP_TEXTS.get(reason, ''), 'threadId': THREAD}
            self._event('stopped', **body, allThreadsStopped=True)
        elif self._released:
            self._released = False
        elif self._program.run_state is RunState.RUNNING:
            self._event('continued', threadId=THREAD, allThreadsContinued=True)

    def on_print(self, text: str, line: int) -> None:
        """The program has printed."""
        self._event('output', category='stdout', output=f'{text}\n', line=line)

    def on_finished(self, error: ProgramError | None) -> None:
        """The program has ended."""
        if error is not None:
            self._event('output', category='stderr', output=f'{error}\n{error.details.get("stack", "")}\n')
        self._event('exited', exitCode=0 if error is None else 1)
        self._event('terminated')

    def leave(self) -> None:
        """The editor is gone, and its breakpoints with it; a program that is held stays held."""
        self._breakpoints = {path: set() for path in self._breakpoints}
        self._apply_breakpoints()

    # -- inside ---------------------------------------------------------------------------------------

    def _holds(self) -> bool:
        """The program is held by this editor: its breakpoint, step or pause."""
        reason, frames = self._program.hold_reason, self._program.call_stack.frames
        if reason == 'breakpoint' and frames:
            return frames[0].line in self._breakpoints.get(Path(self._path(frames[0].chunk)), ())
        return reason != '' and reason == self._asked

    def _release(self, release: Callable[[], bool], asked: HoldReason) -> None:
        self._released, self._asked = True, asked
        if not release():
            self._released = False
            raise ProgramError('the program is not held')

    def _folder(self) -> Path | None:
        path = self._program.path
        return None if path is None else Path(os.path.abspath(path)).parent  # noqa: PTH100  # see above

    def _path(self, chunk: str) -> str:
        path, folder = self._program.path, self._folder()
        if path is None or folder is None:
            return chunk
        return str(folder / (path.name if chunk == chunk_name(path.name) else chunk))

    def _apply_breakpoints(self) -> None:
        folder = self._folder()
        if folder is None:
            return
        for path, lines in self._breakpoints.items():
            if path.is_relative_to(folder):
                self._program.debugger.set_breakpoints(chunk_name(path.relative_to(folder).as_posix()), lines)

    def _reference(self, variables: tuple[Variable, ...]) -> int:
        self._references.append(variables)
        return len(self._references)

    def _shown(self, variable: Variable) -> Message:
        reference = self._reference(variable.entries) if variable.entries else 0
        return {'value': variable.value, 'type': variable.type, 'variablesReference': reference}

    def _event(self, event: str, **body: object) -> None:
        if self.admitted:
            self._send({'type': 'event', 'event': event, 'body': body})

    def _send(self, message: Message) -> None:
        with self._lock:
            self._send_message({'seq': next(self._numbers), **message})


def _snake(command: str) -> str:
    return re.sub(r'[A-Z]', lambda match: f'_{match.group().lower()}', command)


def _code_line(path: Path, line: int) -> int | None:
    """The first line with code from `line` on; None where there is none."""
    try:
        lines = read_text(path).split('\n')
    except InvalidInputError:
        return None
    return next((n for n in range(line, len(lines) + 1) if not _NO_CODE.fullmatch(lines[n - 1])), None)
