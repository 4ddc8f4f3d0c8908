"""CommandAuthority: one commander at a time, in the modes that have it."""

from __future__ import annotations

from pathlib import Path

import hypothesis.strategies as st
import pytest
from hypothesis import given

from robots_controller.control.command_authority import HOLD_TIMEOUT, CommandAuthority
from robots_core.blocks.following.guide import Guide
from robots_core.cell_interface.operating_modes import (
    MODES,
    Commander,
    OperatingMode,
    check_command,
    sensor_guides,
)
from robots_core.errors import CommandRefusedError, InvalidInputError

DOCS = Path(__file__).parents[2] / 'docs' / 'how_to' / 'operating_modes.md'
SOMEBODY = [commander for commander in Commander if commander is not Commander.NOBODY]
LAW = {
    OperatingMode.AUTOMATIC: {Commander.PROGRAM, Commander.REMOTE, Commander.SENSOR},
    OperatingMode.T1: {Commander.PROGRAM, Commander.PENDANT},
    OperatingMode.T2: {Commander.PROGRAM, Commander.PENDANT},
    OperatingMode.REMOTE: {Commander.REMOTE, Commander.SENSOR},
}

steps = st.lists(
    st.one_of(
        st.tuples(st.just('take'), st.sampled_from(SOMEBODY), st.booleans()),
        st.tuples(st.just('give back'), st.sampled_from(SOMEBODY), st.booleans()),
        st.tuples(st.just('take over'), st.sampled_from(SOMEBODY), st.booleans()),
        st.tuples(st.just('mode'), st.sampled_from(list(OperatingMode)), st.booleans()),
    ),
    max_size=20,
)


@given(steps)
def test_whoever_has_the_robot_took_it_in_a_mode_that_permits_it(actions: list[tuple]) -> None:
    authority = CommandAuthority()
    for action, who, standing in actions:
        before = authority.commander
        try:
            match action:
                case 'take':
                    authority.take(who, standing=standing)
                    assert before in (who, Commander.NOBODY)
                    assert standing or before is who
                case 'give back':
                    authority.give_back(who)
                    assert before in (who, Commander.NOBODY)
                case 'take over':
                    authority.take_over(who)
                    assert authority.commander is who
                case 'mode':
                    authority.set_mode(who)
                    assert authority.commander in (before, Commander.NOBODY)
        except CommandRefusedError:
            assert authority.commander is before
        assert authority.commander in LAW[authority.mode] | {Commander.NOBODY}


def test_a_refusal_names_the_commander_and_how_to_take_the_robot_over() -> None:
    authority = CommandAuthority()
    authority.take(Commander.PROGRAM, standing=True)
    with pytest.raises(
        CommandRefusedError,
        match=r'^PROGRAM commands the robot, not REMOTE; REMOTE takes it over by '
        r'controller_node/take_over/remote$',
    ):
        authority.take(Commander.REMOTE, standing=True)
    with pytest.raises(CommandRefusedError, match='PROGRAM commands the robot, not REMOTE'):
        authority.give_back(Commander.REMOTE)


def test_a_refusal_names_the_modes_of_a_commander() -> None:
    with pytest.raises(
        CommandRefusedError,
        match=r'^PENDANT does not command the robot in operating mode AUTOMATIC, but in T1, T2$',
    ):
        CommandAuthority().take_over(Commander.PENDANT)


def test_nobody_takes_a_robot_that_moves() -> None:
    authority = CommandAuthority()
    with pytest.raises(CommandRefusedError, match='PROGRAM cannot take the robot while it moves'):
        authority.take(Commander.PROGRAM, standing=False)


@pytest.mark.parametrize('mode', OperatingMode)
def test_run_is_held_for_as_long_as_its_signs_come(mode: OperatingMode) -> None:
    authority = CommandAuthority(mode)
    assert authority.enabled(10.0) is not MODES[mode].held
    authority.hold(10.0, held=True)
    assert authority.enabled(10.0 + HOLD_TIMEOUT - 1e-9)
    assert authority.enabled(10.0 + HOLD_TIMEOUT + 1e-9) is not MODES[mode].held
    authority.hold(20.0, held=True)
    authority.hold(20.1, held=False)
    assert authority.enabled(20.1) is not MODES[mode].held
    authority.hold(30.0, held=True)
    authority.set_mode(mode)
    assert authority.enabled(30.0) is not MODES[mode].held, 'after a change of the mode it is held anew'


@pytest.mark.parametrize('run', ['held', 'released'])
def test_a_program_that_leaves_a_mode_with_run_held_waits_until_it_takes_the_robot_anew(run: str) -> None:
    authority = CommandAuthority(OperatingMode.T1)
    authority.take(Commander.PROGRAM, standing=True)
    authority.hold(1.0, held=run == 'held')
    authority.set_mode(OperatingMode.AUTOMATIC)
    assert not authority.enabled(1.0)
    assert authority.commander is Commander.PROGRAM
    authority.take(Commander.PROGRAM, standing=True)
    assert authority.enabled(1.0)


@pytest.mark.parametrize('action', ['give back', 'take over'])
def test_what_comes_after_a_program_does_not_wait_for_it(action: str) -> None:
    authority = CommandAuthority(OperatingMode.T1)
    authority.take(Commander.PROGRAM, standing=True)
    authority.set_mode(OperatingMode.REMOTE)
    assert authority.commander is Commander.NOBODY
    assert not authority.enabled(0.0), 'the program has not ended yet'
    if action == 'give back':
        authority.give_back(Commander.PROGRAM)
    else:
        authority.take_over(Commander.REMOTE)
    assert authority.enabled(0.0)


def test_who_jogs_needs_not_hold_run_but_what_a_program_lets_guide_does() -> None:
    authority = CommandAuthority(OperatingMode.T1)
    assert authority.stream_enabled(0.0)
    authority.take(Commander.PROGRAM, standing=True)
    assert not authority.stream_enabled(0.0)


def test_without_a_timeout_nobody_needs_to_hold_run() -> None:
    assert CommandAuthority(OperatingMode.T1, hold_timeout=0.0).enabled(0.0)


@pytest.mark.parametrize(
    ('mode', 'limit', 'expected'),
    [
        (OperatingMode.AUTOMATIC, 0.0, 0.0),
        (OperatingMode.AUTOMATIC, 0.7, 0.7),
        (OperatingMode.T1, 0.0, 0.25),
        (OperatingMode.T1, 0.7, 0.25),
        (OperatingMode.T1, 0.1, 0.1),
        (OperatingMode.T2, 0.0, 0.0),
    ],
)
def test_the_lower_limit_of_the_tool_speed_holds(mode: OperatingMode, limit: float, expected: float) -> None:
    assert CommandAuthority(mode).speed_limit(limit) == expected


@pytest.mark.parametrize('guide', Guide)
@pytest.mark.parametrize('sender', [Commander.SENSOR, Commander.PENDANT])
@pytest.mark.parametrize('mode', [OperatingMode.AUTOMATIC, OperatingMode.T1])
def test_a_program_lets_a_sensor_or_a_person_guide_its_robot(
    mode: OperatingMode, sender: Commander, guide: Guide
) -> None:
    lent = (guide, sender) in {(Guide.SENSOR, Commander.SENSOR), (Guide.PERSON, Commander.PENDANT)}
    if lent:
        check_command(sender, commander=Commander.PROGRAM, mode=mode, guide=guide)
    else:
        with pytest.raises(CommandRefusedError):
            check_command(sender, commander=Commander.PROGRAM, mode=mode, guide=guide)


def test_names_that_are_no_mode_or_commander_are_refused_with_those_that_are() -> None:
    with pytest.raises(InvalidInputError, match="unknown operating mode 'T3'; valid are AUTOMATIC, T1, T2"):
        OperatingMode('T3')
    with pytest.raises(InvalidInputError, match="unknown commander 'me'; valid are NOBODY, PROGRAM"):
        Commander('me')


def test_the_documentation_lists_the_modes() -> None:
    rows = [
        f'| `{mode}` | {", ".join(rules.commanders)} | '
        f'{f"at most {rules.tool_speed_limit:g} m/s" if rules.tool_speed_limit else "no limit"} | '
        f'{"held" if rules.held else "by itself"} | {rules.purpose} |'
        for mode, rules in MODES.items()
    ]
    assert '\n'.join(rows) in DOCS.read_text()


@pytest.mark.parametrize('commander', Commander)
@pytest.mark.parametrize('mode', [None, *OperatingMode])
@pytest.mark.parametrize('guide', [None, *Guide])
def test_a_sensor_guides_as_commander_or_where_the_program_lets_it(
    commander: Commander, mode: OperatingMode | None, guide: Guide | None
) -> None:
    permitted = mode is None or Commander.SENSOR in MODES[mode].commanders
    if commander is Commander.SENSOR:
        expected = permitted
    elif guide is Guide.SENSOR and commander in (Commander.PROGRAM, Commander.NOBODY):
        expected = True  # the program lends it its robot, in every mode
    else:
        expected = guide is None and commander is Commander.NOBODY and permitted
    assert sensor_guides(commander=commander, mode=mode, guide=guide) is expected
