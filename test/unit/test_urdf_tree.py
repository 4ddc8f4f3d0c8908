"""Base, tip and chain of any tree of links: found where there is one answer, refused where there is none."""

from __future__ import annotations

import pytest
from lxml import etree

from robots_core.errors import UnknownRobotError
from robots_core.robot_model.urdf.urdf_tree import LinkTree


def tree(*joints: str) -> LinkTree:
    """Joints as `parent child` (turning) or `parent child type`; links in the order of their first use."""
    root = etree.Element('robot')
    links: list[str] = []
    for text in joints:
        parent, child, kind = (f'{text} revolute').split()[:3]
        links += [link for link in (parent, child) if link not in links]
        joint = etree.SubElement(
            root, 'joint', name=f'to_{child}', type='revolute' if kind == 'mimic' else kind
        )
        etree.SubElement(joint, 'parent', link=parent)
        etree.SubElement(joint, 'child', link=child)
        if kind == 'mimic':
            etree.SubElement(joint, 'mimic', joint='other')
    for link in links:
        etree.SubElement(root, 'link', name=link)
    return LinkTree(root)


ARM = ('base a1', 'a1 a2', 'a2 a3')
HAND = ('a3 hand fixed', 'hand thumb', 'thumb tip1', 'hand finger', 'hand finger2 mimic')
TWO_ARMS = ('base torso', 'torso l1', 'l1 l2', 'torso r1', 'r1 r2', 'torso head')


@pytest.mark.parametrize(
    ('joints', 'tip'),
    [
        (ARM, 'a3'),
        ((*ARM, 'a3 flange fixed', 'flange camera fixed', 'a3 plate fixed'), 'camera'),
        ((*ARM, *HAND), 'hand'),
        ((*ARM, *HAND, 'a1 tool0 fixed'), 'tool0'),
        (('base wheel1', 'base wheel2', 'base lift', 'lift arm', 'lift head'), None),
        (('base wheel1', 'base wheel2', 'base lift', 'lift arm', 'arm hand', 'lift head'), 'hand'),
        (('base pan', 'pan tilt', 'base a', 'a b', 'b c'), 'c'),
        (('base a', 'a jaw prismatic'), 'jaw'),
    ],
)
def test_default_tip(joints: tuple[str, ...], tip: str | None):
    if tip is None:
        with pytest.raises(UnknownRobotError, match='2 equally long chains'):
            tree(*joints).tip('base', None)
    else:
        assert tree(*joints).tip('base', None) == tip


def test_equal_arms_are_refused_with_their_names_unless_chosen():
    robot = tree(*TWO_ARMS)
    with pytest.raises(
        UnknownRobotError, match=r"behind link 'torso' .* 2 .* beginning with l1, r1: choose a tip"
    ):
        robot.tip('base', None)
    tip = robot.tip('base', 'r2')
    assert [joint.get('name') for joint in robot.chain('base', tip)] == ['to_torso', 'to_r1', 'to_r2']


def test_base_is_the_root_unless_chosen():
    robot = tree('world stand fixed', 'stand base fixed', *ARM)
    assert robot.base(None) == 'world'
    assert robot.base('a1') == 'a1'
    assert robot.below('a1') == ({'a1', 'a2', 'a3'}, {'to_a2', 'to_a3'})


@pytest.mark.parametrize('kind', ['floating', 'planar'])
def test_base_that_floats_is_refused_with_the_base_to_choose(kind: str):
    robot = tree(f'world base {kind}', *ARM)
    with pytest.raises(UnknownRobotError, match=f"'to_base' is '{kind}'.*choose base=base"):
        robot.chain('world', 'a3')
    assert len(robot.chain('base', 'a3')) == 3


def test_mimic_joint_in_the_chain_is_refused_with_the_tip_to_choose():
    robot = tree(*ARM, 'a3 jaw mimic')
    with pytest.raises(UnknownRobotError, match=r"'to_jaw' mimics 'other'.*choose tip=a3"):
        robot.chain('base', robot.tip('base', None))


@pytest.mark.parametrize(
    ('joints', 'message'),
    [
        (('base a', 'other b'), '2 root links, base, other: choose one'),
        (('base a', 'a b', 'other b'), "link 'b' has two parents, by joints 'to_b' and 'to_b'"),
        (('a b', 'b c', 'c a'), "link 'a' hangs on itself"),
    ],
)
def test_what_is_no_tree_is_refused(joints: tuple[str, ...], message: str):
    with pytest.raises(UnknownRobotError, match=message):
        tree(*joints).base(None)


def test_links_that_are_not_connected_are_refused():
    with pytest.raises(UnknownRobotError, match="no chain of joints leads from 'a2' to 'base'"):
        tree(*ARM).chain('a2', 'base')


def test_joint_to_a_missing_link_is_refused():
    text = '<robot><link name="a"/><joint name="j"><parent link="a"/><child link="b"/></joint></robot>'
    with pytest.raises(UnknownRobotError, match="child link 'b' of joint 'j' is missing"):
        LinkTree(etree.fromstring(text))


def test_no_links_at_all_are_refused():
    with pytest.raises(UnknownRobotError, match='the URDF has no links'):
        LinkTree(etree.fromstring('<robot/>')).base(None)
