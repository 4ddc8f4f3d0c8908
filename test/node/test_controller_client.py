"""ControllerClient: a program takes the robot, of a controller played by a test."""

from __future__ import annotations

from concurrent.futures import Future
from typing import Any
from unittest.mock import Mock

import pytest
from std_msgs.msg import String
from std_srvs.srv import SetBool

from robots_controller.nodes.ports.program.controller_client import ControllerClient


class Requests:
    """A client of a service that is there; the test answers."""

    def __init__(self, *_: Any) -> None:
        self.sent: list[tuple[bool, Future[Any]]] = []

    def service_is_ready(self) -> bool:
        return True

    def call_async(self, request: SetBool.Request) -> Future[Any]:
        self.sent.append((request.data, Future()))
        return self.sent[-1][1]

    def answer(self, message: str = '') -> None:
        self.sent[-1][1].set_result(SetBool.Response(success=not message, message=message))


class Program:
    """A program's client, and its requests to take the robot."""

    def __init__(self) -> None:
        clients: dict[str, Requests] = {}
        node = Mock(participant=None, simulated_time=True)
        node.create_client = lambda _, name: clients.setdefault(name, Requests())
        self.client = ControllerClient(node)
        self.host = Mock()
        self.takers: dict[str, Any] = {}
        node.create_subscription = lambda _, topic, take, *__, **___: self.takers.update({topic: take})
        self.client.report_to(self.host, lambda: None)
        self.requests = clients['controller_node/commander/program']

    def commander(self, name: str) -> None:
        self.takers['commander'](String(data=name))


@pytest.fixture
def program() -> Program:
    return Program()


def test_a_controller_that_was_restarted_is_asked_again(program: Program) -> None:
    program.client.command(taken=True)
    program.requests.answer()
    program.commander('NOBODY')
    assert [taken for taken, _ in program.requests.sent] == [True, True]
    program.host.lose_robot.assert_not_called()


def test_a_program_that_was_refused_does_not_ask_again_by_itself(program: Program) -> None:
    """A controller publishes its commander with each refusal: in lock-step no time would ever pass."""
    program.client.command(taken=True)
    program.requests.answer('it moves')
    program.host.lose_robot.assert_called_once_with('it moves')
    program.commander('NOBODY')
    assert len(program.requests.sent) == 1
    program.client.command(taken=True)  # by a person who resumes it
    assert len(program.requests.sent) == 2
