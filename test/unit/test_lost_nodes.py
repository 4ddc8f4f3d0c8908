"""What the loss of planner and controller is to a program and its outputs."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from robots_controller.cell.lost_nodes import CONTROLLER, PLANNER, watched_node_changed


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
    watched_node_changed(host, CONTROLLER, 'silent')  # type: ignore[arg-type]
    assert calls == ['fails: silent', *(['safe'] if not running else [])]
    calls.clear()
    watched_node_changed(host, PLANNER, 'silent')  # type: ignore[arg-type]
    watched_node_changed(host, PLANNER, '')  # type: ignore[arg-type]
    watched_node_changed(host, CONTROLLER, '')  # type: ignore[arg-type]
    assert calls == ['planner: silent', 'fails: silent', 'planner: ']
