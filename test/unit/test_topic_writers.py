"""WriterWatch: writers keep their places, restarted nodes get theirs, others are named and dropped."""

from __future__ import annotations

from pathlib import Path

import pytest

from robots_core.cell_interface.topic_writers import CHECK_PERIOD, SILENCE, WRITERS, WriterWatch

PERIOD = 0.004  # s


class Graph:
    """A topic's publishers, and what was said of strangers."""

    def __init__(self, topic: str, **names: str) -> None:
        self.names = {identity.encode(): f'/cell/{name}' for identity, name in names.items()}
        self.checks = 0
        self.said: list[str] = []
        self.watch = WriterWatch(topic, '/cell/', self._check, self.said.append)

    def _check(self) -> dict[bytes, str]:
        self.checks += 1
        return self.names

    def accepts(self, identity: str, now: float = 0.0) -> bool:
        return self.watch.accepts(identity.encode(), now)


def test_the_first_writer_of_a_stream_keeps_its_place():
    graph = Graph('joint_states', driver='driver', other='other')
    for k in range(1000):
        assert graph.accepts('driver', k * PERIOD)
        assert not graph.accepts('other', k * PERIOD)
    assert set(graph.said) == {
        '/cell/other publishes joint_states beside /cell/driver; its messages are dropped'
    }
    assert graph.checks <= 1000 * PERIOD / CHECK_PERIOD + 2  # it costs next to nothing


def test_a_writer_without_a_name_yet_is_one():
    graph = Graph('joint_reference')
    assert graph.accepts('new')
    assert not graph.accepts('other')
    assert 'an unknown node publishes joint_reference beside controller_node' in graph.said[0]


def test_a_silent_writer_of_a_stream_loses_its_place():
    graph = Graph('joint_reference', first='controller_node', anew='controller_node')
    assert graph.accepts('first', 0.0)
    assert not graph.accepts('anew', SILENCE - CHECK_PERIOD)
    assert graph.accepts('anew', SILENCE + 0.01)
    assert not graph.accepts('first', SILENCE + 0.02)


def test_the_own_node_takes_its_place_from_a_stranger():
    graph = Graph('joint_reference', stranger='stranger', own='controller_node')
    assert graph.accepts('stranger')
    assert graph.accepts('own')
    assert not graph.accepts('stranger', 1e-3)


def test_where_all_writers_are_there_nobody_else_is_taken():
    graph = Graph('motion_result', first='controller_node', second='planning_node', other='other')
    for now in (0.0, 100.0):
        assert not graph.accepts('other', now)
        assert graph.accepts('first', now)
        assert graph.accepts('second', now)
    assert graph.said[-1] == (
        '/cell/other publishes motion_result beside /cell/controller_node and /cell/planning_node; '
        'its messages are dropped'
    )


def test_another_node_may_take_the_place_of_one_that_is_missing():
    graph = Graph('motion_result', planner='planning_node', own='controller_of_a_user')
    assert graph.accepts('planner')
    assert graph.accepts('own')
    graph.names[b'third'] = '/cell/third'
    assert not graph.accepts('third')
    graph.names[b'controller'] = '/cell/controller_node'
    assert graph.accepts('controller')  # the suite's own is taken always


@pytest.mark.parametrize('present', WRITERS['joint_trajectory'].nodes)
def test_trajectories_beside_a_planner_or_a_guide_are_dropped(present: str):
    graph = Graph('joint_trajectory', other='other', present=present)
    assert not graph.accepts('other')
    for node in WRITERS['joint_trajectory'].nodes:
        graph.names[node.encode()] = f'/cell/{node}'
        assert graph.accepts(node)
    alone = Graph('joint_trajectory', other='other')
    assert alone.accepts('other')


def test_a_node_that_is_started_anew_is_taken_beside_what_is_left_of_it():
    graph = Graph('motion_result', controller='controller_node', planner='planning_node')
    assert graph.accepts('controller')
    graph.names[b'anew'] = '/cell/controller_node'
    assert graph.accepts('anew')


def test_a_state_of_a_publisher_without_a_name_yet_waits_for_the_name():
    graph = Graph('commander', dead='controller_node')
    assert not graph.accepts('anew')
    assert graph.watch.waits(b'anew')
    assert not graph.said
    graph.names[b'anew'] = '/cell/controller_node'
    assert graph.accepts('anew', CHECK_PERIOD)
    assert not graph.watch.waits(b'anew')


def test_a_state_of_a_stranger_waits_for_nothing_once_it_has_its_name():
    graph = Graph('commander', controller='controller_node')
    assert not graph.accepts('stranger')
    graph.names[b'stranger'] = '/cell/stranger'
    assert not graph.accepts('stranger', CHECK_PERIOD)
    assert not graph.watch.waits(b'stranger')
    assert graph.said == [
        '/cell/stranger publishes commander beside controller_node; its messages are dropped'
    ]


def test_a_node_in_the_place_of_one_of_the_suite_loses_it_to_that():
    graph = Graph('commander', stranger='stranger')
    assert graph.accepts('stranger')
    graph.names[b'controller'] = '/cell/controller_node'
    assert graph.accepts('controller')
    assert not graph.accepts('stranger')


def test_the_same_names_of_another_cell_are_strangers():
    graph = Graph('motion_result', controller='controller_node', planner='planning_node')
    graph.names[b'other'] = '/other/controller_node'
    assert not graph.accepts('other')


def test_the_documentation_has_the_writers():
    _, _, section = (
        Path('docs/reference/stops.md').read_text().partition('## Publishers of what moves the robot')
    )
    rows = [line.split(' | ')[:2] for line in section.partition('\n## ')[0].splitlines() if '| `' in line]
    assert rows == [
        [f'| `{topic}`', ', '.join(f'`{node}`' for node in writers.nodes)]
        for topic, writers in WRITERS.items()
    ]


def test_other_nodes_are_foreign_where_no_place_is_free() -> None:
    results, drives = WRITERS['motion_result'], WRITERS['drives_on']
    assert results.foreign({'/cell/controller_node', '/cell/mine'}, '/cell/', places=True) == set()
    assert results.foreign({'/controller_node', '/cell/mine'}, '/cell', places=True) == set()
    both = {'/controller_node', '/planning_node'}
    assert results.foreign({*both, '/mine'}, '/', places=True) == {'/mine'}
    assert results.foreign(both, '/', places=True) == set()
    assert drives.foreign({'/mine'}, '/', places=True) == set()
    assert drives.foreign({'/mine'}, '/', places=False) == {'/mine'}
