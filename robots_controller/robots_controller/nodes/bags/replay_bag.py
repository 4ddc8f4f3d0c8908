"""replay_bag: publish a recorded bag onto real topics."""

import argparse
import itertools
import os
import sys
from collections.abc import Sequence
from pathlib import Path

from robots_controller.cell_arguments import EXIT_INTERRUPTED, exit_code
from robots_controller.nodes.bags.bag_player import BagPlayer
from robots_controller.recording.bag_file import Bag, read_bag
from robots_controller.recording.bag_replay import replay_plan
from robots_core.errors import InvalidInputError, RobotsError
from robots_core.ros.message_class import message_class
from robots_core.ros.run import run


def main() -> None:
    """Run from the command line."""
    os.environ.setdefault('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
    sys.exit(exit_code(lambda _: replay_bag(sys.argv[1:])))


def replay_bag(arguments: Sequence[str]) -> int:
    """Publish the bag of a command line; its time is the node's: `--ros-args -p use_sim_time:=true`.

    Returns:
        Exit code: 0, or 130 after Ctrl-C.

    Raises:
        RobotsError: a bag that cannot be read, or options that do not fit it.
    """
    parser = argparse.ArgumentParser(
        prog='replay_bag',
        description='Publish the messages of a bag at their times, the last state of latched topics first.',
    )
    parser.add_argument('bag', type=Path, help='a folder, or a .mcap or .db3 file')
    parser.add_argument('--rate', type=float, default=1.0, help='speed relative to the recording')
    parser.add_argument(
        '--start', type=float, default=0.0, help='time after the first message at which to begin, s'
    )
    parser.add_argument('--topics', nargs='+', default=(), help='publish only these topics')
    parser.add_argument(
        '--remap', nargs='+', default=(), metavar='FROM:=TO', help='publish topics under other names'
    )
    parser.add_argument('--wait', type=float, default=1.0, help='longest wait for subscribers, s')
    # rclpy would take FROM:=TO for its own.
    ours = [*itertools.takewhile(lambda word: word != '--ros-args', arguments)]
    options = parser.parse_args(ours)
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

    code = run(make_player, list(arguments[len(ours) :]))
    return code or (0 if players[0].complete else EXIT_INTERRUPTED)


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
        raise RobotsError(f'{bag.path} has no topic of a message type that is installed here')
    return found


def _remap(text: str) -> tuple[str, str]:
    old, separator, new = text.partition(':=')
    if not (old and separator and new):
        raise RobotsError(f'{text!r} is no remap; remaps are like /plc/inputs:=/press/inputs')
    return old, new


if __name__ == '__main__':
    main()
