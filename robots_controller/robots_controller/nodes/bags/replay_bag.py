"""replay_bag: publish a recorded bag onto real topics."""

import argparse
import os
import sys

from rich.console import Console

from robots_controller.nodes.bags.bag_player import BagPlayer
from robots_controller.recording.bag_file import Bag, read_bag
from robots_controller.recording.bag_replay import replay_plan
from robots_core.errors import BagError, InvalidInputError
from robots_core.exit_codes import ExitCode
from robots_core.ros.messages import message_class
from robots_core.ros.running.run import run


def replay_bag(options: argparse.Namespace, _console: Console) -> int:
    """Publish a bag; its time is the node's: `--ros-args -p use_sim_time:=true`.

    Returns:
        An exit code, INTERRUPTED after Ctrl-C.

    Raises:
        RobotsError: a bag that cannot be read, or options that do not fit it.
    """
    os.environ.setdefault('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
    bag = read_bag(options.bag)
    if bag.problem:
        print(f'{bag.path} is incomplete: {bag.problem}', file=sys.stderr)
    plan = replay_plan(
        bag,
        rate=options.rate,
        start=options.start,
        topics=options.topics or _installed(bag),
        remaps=dict(_remap(text) for text in options.remap),
    )
    players: list[BagPlayer] = []

    def make_player() -> BagPlayer:
        players.append(BagPlayer(plan, wait=options.wait))
        return players[0]

    code = run(make_player, ['--ros-args', *options.ros_args])
    return code or (ExitCode.OK if players[0].complete else ExitCode.INTERRUPTED)


def _installed(bag: Bag) -> list[str]:
    """The topics whose message types are installed here; prints the others."""
    found = []
    for name, topic in bag.topics.items():
        try:
            message_class(topic.type)
        except InvalidInputError as error:
            print(f'{name} is not published: {error}', file=sys.stderr)
        else:
            found.append(name)
    if not found:
        raise BagError(f'{bag.path} has no topic of a message type that is installed here')
    return found


def _remap(text: str) -> tuple[str, str]:
    old, separator, new = text.partition(':=')
    if not (old and separator and new):
        raise BagError(f'{text!r} is no remap; remaps are like /plc/inputs:=/press/inputs')
    return old, new
