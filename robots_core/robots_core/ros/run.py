"""The one place that spins: start a node, serve it, and end it cleanly."""

import atexit
import gc
import inspect
import os
import sys
from collections.abc import Callable

import rclpy
from rclpy.executors import Executor, ExternalShutdownException, SingleThreadedExecutor
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import try_shutdown

from robots_core.errors import RobotsError
from robots_core.ros.heartbeat import Heartbeat
from robots_core.ros.interrupt import interrupt
from robots_core.ros.lean_executor import LeanExecutor
from robots_core.ros.middleware import choose_transports
from robots_core.ros.timed_node import TimedNode

EXIT_BAD_INPUT = 2


def run(make_node: Callable[[], TimedNode], args: list[str] | None = None) -> int:
    """Run a node until it is interrupted or has shut its context down.

    A mistake of the user (a `RobotsError`) is reported in one line, without traceback.

    Args:
        make_node: Creates the node once ROS is initialised.
        args: Command line; `sys.argv` by default.

    Returns:
        Exit code: 0 after Ctrl-C or terminate, 2 if the node cannot start as configured.
    """
    # A process that ends need not look through all that it has loaded: that takes half a second.
    atexit.register(gc.freeze)
    choose_transports()
    rclpy.init(args=args, signal_handler_options=SignalHandlerOptions.NO)
    node: TimedNode | None = None
    executor: Executor | None = None
    heartbeat: Heartbeat | None = None

    def wake() -> None:
        if executor is None:
            # Models and compiled code may take long to load, and there is nothing to close yet.
            sys.stdout.flush()
            os._exit(0)
        executor.create_task(lambda: None)  # woken alone, an executor with nothing to do waits on

    with interrupt(wake) as stopping:
        try:
            node = make_node()
            # A logger looks for its caller, the first time through all modules: not while a robot moves.
            inspect.stack()
            executor = _executor(node)
            executor.add_node(node)
            heartbeat = Heartbeat(node)
            gc.freeze()  # what is there now lives as long as the node
            while node.context.ok() and not stopping.is_set():
                executor.spin_once()
        except ExternalShutdownException:
            return 0
        except RobotsError as error:
            print(f'error: {error}', file=sys.stderr)
            return EXIT_BAD_INPUT
        finally:
            if heartbeat is not None:
                heartbeat.stop()
            # The page, the bag and the last messages are closed before another signal may end the process.
            if node is not None:
                node.destroy_node()  # type: ignore[no-untyped-call]
            if executor is not None:
                executor.shutdown()
            try_shutdown()
    return 0


def _executor(node: TimedNode) -> Executor:
    # MultiThreadedExecutor is several times slower here and EventsExecutor is experimental; what must not
    # wait has a thread of its own.
    return SingleThreadedExecutor() if node.participant is None else LeanExecutor()
