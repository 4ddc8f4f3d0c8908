"""The one place that spins: start a node, serve it, and end it cleanly."""

from __future__ import annotations

import signal
import sys
from collections.abc import Callable
from types import FrameType

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.utilities import try_shutdown

from robots_core.errors import RobotsError
from robots_core.nodes.middleware import choose_transports

EXIT_BAD_INPUT = 2


def run(make_node: Callable[[], Node], args: list[str] | None = None) -> int:
    """Run a node until it is interrupted.

    A mistake of the user (a `RobotsError`) is told in one line, without traceback.

    Args:
        make_node: Creates the node once ROS is initialised.
        args: Command line; `sys.argv` by default.

    Returns:
        Exit code: 0 after an interrupt, 2 if the node cannot start as configured.
    """
    choose_transports()
    signal.signal(signal.SIGINT, _interrupt_once)
    rclpy.init(args=args)
    node: Node | None = None
    try:
        node = make_node()
        # MultiThreadedExecutor is several times slower here and EventsExecutor is experimental;
        # what must not wait has a thread of its own.
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        return 0
    except RobotsError as error:
        print(f'error: {error}', file=sys.stderr)
        return EXIT_BAD_INPUT
    finally:
        if node is not None:
            node.destroy_node()
        try_shutdown()
    return 0


def _interrupt_once(number: int, frame: FrameType | None) -> None:
    """Ctrl-C in a terminal reaches a launched process twice; the second must not disturb its ending."""
    del frame
    signal.signal(number, signal.SIG_IGN)
    raise KeyboardInterrupt
