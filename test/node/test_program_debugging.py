"""Breakpoints, steps and editors at lua_program_node."""

from __future__ import annotations

import json
import socket
from pathlib import Path
from typing import Any

import pytest
from rclpy.parameter import Parameter

from robots_core.ros.messages import diagnostic_values

from .lua_bench import MOVE, LuaBench


def test_breakpoint_step_and_call_stack_by_services(ros_nodes: Any, tmp_path: Path):
    bench = LuaBench(ros_nodes, tmp_path, breakpoints=['test.lua:2'])
    assert not bench.ask('get_call_stack').success
    assert not bench.ask('step').success
    bench.start('local x = 5\nwait(0)\nwait(0)\nwait(0)')
    held = bench.wait_for_state('PAUSED')
    bench.wait(lambda: diagnostic_values(bench.status[-1]).get('stack'), 'the call stack')
    held = diagnostic_values(bench.status[-1])
    assert (held['hold'], held['line'], held['stack']) == ('breakpoint', '2', 'test.lua:2: in the program')
    stack = json.loads(bench.ask('get_call_stack').message)
    assert stack['frames'][0]['scopes']['Locals'][0]['name'] == 'x'
    assert bench.ask('step').success
    bench.wait(lambda: diagnostic_values(bench.status[-1])['line'] == '3', 'the next line')
    bench.wait(lambda: bench.node._program.hold_reason == 'step', 'the hold')
    bench.node.set_parameters([Parameter('breakpoints', value=['test.lua:4'])])
    assert bench.ask('resume').success
    bench.wait(lambda: diagnostic_values(bench.status[-1])['line'] == '4', 'the new breakpoint')
    bench.wait(lambda: bench.node._program.hold_reason == 'breakpoint', 'the hold')
    assert bench.ask('resume').success
    bench.wait_for_state('FINISHED')


def test_step_begins_a_program(ros_nodes: Any, tmp_path: Path):
    bench = LuaBench(ros_nodes, tmp_path, step_mode='motion')
    bench.write(f'wait(0)\n{MOVE}\nwait(0)')
    assert bench.ask('open').success
    assert bench.ask('step').success
    bench.wait(lambda: bench.node._program.call_stack.frames, 'the hold at the first line')
    assert bench.commands == []
    assert bench.ask('step').success
    bench.wait(lambda: bench.node._program.hold_reason == 'step', 'the end of the motion')
    assert len(bench.commands) == 1
    assert bench.ask('resume').success
    bench.wait_for_state('FINISHED')


@pytest.mark.parametrize(
    ('name', 'value', 'message'),
    [
        ('breakpoints', ['a.lua'], "a breakpoint is 'file.lua:12'"),
        ('step_mode', 'far', 'valid are over, in, out and motion'),
    ],
)
def test_wrong_debugging_parameters_are_refused(
    ros_nodes: Any, tmp_path: Path, name: str, value: Any, message: str
):
    bench = LuaBench(ros_nodes, tmp_path)
    (result,) = bench.node.set_parameters([Parameter(name, value=value)])
    assert not result.successful
    assert message in result.reason


def test_editor_connects_to_the_node(ros_nodes: Any, tmp_path: Path):
    bench = LuaBench(ros_nodes, tmp_path, debug_port=-1)
    request = json.dumps({'seq': 1, 'type': 'request', 'command': 'threads'}).encode()
    with socket.create_connection(('127.0.0.1', bench.node._debug_server.port), timeout=240.0) as editor:
        editor.sendall(b'Content-Length: %d\r\n\r\n%b' % (len(request), request))
        answer = editor.makefile('rb').readline()
    assert answer.startswith(b'Content-Length: ')
