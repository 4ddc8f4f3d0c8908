"""What the loss of planner and controller is to a program and its outputs."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from robots_controller.cell.program_host import ProgramHost
from robots_controller.program.motions.modal_settings import PLANNING_NODE


@pytest.mark.parametrize('running', [True, False])
def test_a_program_that_runs_fails_and_else_a_lost_controller_makes_outputs_safe(*, running: bool) -> None:
    calls: list[str] = []

    def lose_robot(reason: str) -> bool:
        calls.append(f'fails: {reason}')
        return running

    host = SimpleNamespace(
        motions=SimpleNamespace(lose_planner=lambda reason: calls.append(f'planner: {reason}')),
        lose_robot=lose_robot,
        make_outputs_safe=lambda: calls.append('safe'),
    )
    ProgramHost.node_changed(host, 'controller_node', 'silent')  # type: ignore[arg-type]
    assert calls == ['fails: silent', *(['safe'] if not running else [])]
    calls.clear()
    ProgramHost.node_changed(host, PLANNING_NODE, 'silent')  # type: ignore[arg-type]
    ProgramHost.node_changed(host, PLANNING_NODE, '')  # type: ignore[arg-type]
    ProgramHost.node_changed(host, 'controller_node', '')  # type: ignore[arg-type]
    assert calls == ['planner: silent', 'fails: silent', 'planner: ']
