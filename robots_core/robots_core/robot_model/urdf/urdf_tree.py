"""The tree of links in a URDF, and the serial chain that a robot is made of."""

from typing import Final

from lxml import etree

from robots_core.errors import UnknownRobotError
from robots_core.robot_model.urdf.urdf_place import line_of

MOVING_JOINTS: Final = ('revolute', 'continuous', 'prismatic')
TOOL: Final = 'tool0'
# A serial robot has about ten links in a row; functions that read the tree call themselves once per link.
MAX_DEPTH: Final = 200


class LinkTree:
    """Links and joints of a URDF.

    Attributes:
        links: Names of the links, as they stand in the file.

    Raises:
        UnknownRobotError: a joint without parent, child or a name of its own, a link that is missing, or
            links in a closed loop.
    """

    def __init__(self, root: etree._Element) -> None:
        self.links = [str(link.get('name')) for link in root.findall('link')]
        self._children: dict[str, list[etree._Element]] = {}
        self._parent_joint: dict[str, etree._Element] = {}
        names: set[str | None] = {None}
        for joint in root.findall('joint'):
            for role in ('parent', 'child'):
                if link_of(joint, role) not in self.links:
                    raise UnknownRobotError(
                        f'{role} link {link_of(joint, role)!r} of joint {joint.get("name")!r} is missing',
                        **line_of(joint),
                    )
            child = link_of(joint, 'child')
            if child in self._parent_joint:
                other = self._parent_joint[child].get('name')
                raise UnknownRobotError(
                    f'link {child!r} has two parents, by joints {other!r} and {joint.get("name")!r}: a '
                    f'closed loop is no tree',
                    **line_of(joint),
                )
            name = joint.get('name')
            if name in names:
                fault = 'has no name' if name is None else f'is named {name!r}, as another joint is'
                raise UnknownRobotError(
                    f'the joint between links {link_of(joint, "parent")!r} and {child!r} {fault}',
                    **line_of(joint),
                )
            names.add(name)
            self._children.setdefault(link_of(joint, 'parent'), []).append(joint)
            self._parent_joint[child] = joint
        for link in self.links:
            self._refuse_circle(link)

    def below(self, link: str) -> tuple[set[str], set[str]]:
        """Names of all links (itself too) and joints that hang on a link."""
        links, joints, pending = {link}, set(), [link]
        while pending:
            for joint in self._children.get(pending.pop(), []):
                joints.add(str(joint.get('name')))
                links.add(link_of(joint, 'child'))
                pending.append(link_of(joint, 'child'))
        return links, joints

    def base(self, base: str | None) -> str:
        """The base link: `base` if it exists, by default the root.

        Raises:
            UnknownRobotError: no such link, or not exactly one root.
        """
        if base is not None:
            return self._known(base, 'base')
        if not self.links:
            raise UnknownRobotError('the URDF has no links: a xacro file that only defines some?')
        roots = [link for link in self.links if link not in self._parent_joint]
        if len(roots) > 1:
            raise UnknownRobotError(
                f'the URDF has {len(roots)} root links, {", ".join(roots)}: choose one as base'
            )
        return roots[0]

    def tip(self, base: str, tip: str | None) -> str:
        """The tool link: `tip` if it exists, by default the one that the rule of `read_urdf_chain` finds.

        Raises:
            UnknownRobotError: no such link, or several branches that are equally good.
        """
        if tip is not None:
            return self._known(tip, 'tip')
        if TOOL in self.below(base)[0]:
            return TOOL
        link, axes = base, 0
        while True:
            branches = [(self._axes_from(joint), joint) for joint in self._children.get(link, [])]
            branches = [(count, joint) for count, joint in branches if count > 0]
            if not branches:
                return self._end(link)
            most = max(count for count, _ in branches)
            if len(branches) > 1 and axes > most:
                return link  # the branches are the fingers of a hand
            branch, *others = [joint for count, joint in branches if count == most]
            if others:
                equal = [link_of(joint, 'child') for joint in (branch, *others)]
                raise UnknownRobotError(
                    f'behind link {link!r} the URDF branches into {len(equal)} equally long chains, '
                    f'beginning with {", ".join(equal)}: choose a tip, as in urdf:/path/robot.urdf?tip=LINK',
                    **line_of(branch),
                )
            axes += _moves(branch)
            link = link_of(branch, 'child')

    def chain(self, base: str, tip: str) -> list[etree._Element]:
        """The joints from `base` to `tip`, each one that a serial robot can have.

        Raises:
            UnknownRobotError: the links are not connected, or a joint that a serial robot cannot have.
        """
        joints: list[etree._Element] = []
        link = tip
        while link != base:
            if link not in self._parent_joint:
                raise UnknownRobotError(f'no chain of joints leads from {base!r} to {tip!r}')
            joints.append(self._parent_joint[link])
            link = link_of(joints[-1], 'parent')
        for joint in joints:
            if joint.get('type') not in (*MOVING_JOINTS, 'fixed'):
                raise UnknownRobotError(
                    f'joint {joint.get("name")!r} is {joint.get("type")!r}; joints of a chain are fixed, '
                    f'{", ".join(MOVING_JOINTS)}; choose base={link_of(joint, "child")} to begin behind it',
                    **line_of(joint),
                )
            if (mimic := joint.find('mimic')) is not None:
                raise UnknownRobotError(
                    f'joint {joint.get("name")!r} mimics {mimic.get("joint")!r}, a chain needs its own axes; '
                    f'choose tip={link_of(joint, "parent")} to end before it',
                    **line_of(mimic),
                )
        return joints[::-1]

    def _refuse_circle(self, start: str) -> None:
        link, passed = start, {start}
        while link in self._parent_joint:
            joint = self._parent_joint[link]
            link = link_of(joint, 'parent')
            if link in passed:
                raise UnknownRobotError(
                    f'link {link!r} hangs on itself: a closed loop is no tree', **line_of(joint)
                )
            passed.add(link)
            if len(passed) > MAX_DEPTH:
                raise UnknownRobotError(
                    f'over {MAX_DEPTH} links hang on each other, down to link {start!r}', **line_of(joint)
                )

    def _known(self, link: str, role: str) -> str:
        if link not in self.links:
            raise UnknownRobotError(f'{role} link {link!r} not found; links are {", ".join(self.links)}')
        return link

    def _axes_from(self, joint: etree._Element) -> int:
        """Largest number of axes on a path from `joint`, itself included, to a leaf."""
        child = link_of(joint, 'child')
        beyond = max((self._axes_from(following) for following in self._children.get(child, [])), default=0)
        return _moves(joint) + beyond

    def _end(self, link: str) -> str:
        """The last of the links that are fixed to `link`, along the longest path."""

        def longest_path(link: str) -> list[str]:
            paths = [longest_path(link_of(joint, 'child')) for joint in self._children.get(link, [])]
            return [link, *max(paths, key=len, default=[])]

        return longest_path(link)[-1]


def link_of(joint: etree._Element, role: str) -> str:
    """Name of a joint's `parent` or `child` link.

    Raises:
        UnknownRobotError: the joint names none.
    """
    element = joint.find(role)
    if element is None:
        raise UnknownRobotError(f'joint {joint.get("name")!r} has no <{role}> link', **line_of(joint))
    return str(element.get('link'))


def _moves(joint: etree._Element) -> int:
    return int(joint.get('type') != 'fixed')
