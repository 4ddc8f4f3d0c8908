"""What tests share: a ROS domain of their own, and nodes spun in the background."""

from __future__ import annotations

import gc
import os
import threading
import time
from collections.abc import Callable, Generator, Iterator
from contextlib import closing, contextmanager
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import pytest
from hypothesis import HealthCheck, settings

import blas_threads  # noqa: F401  # before NumPy is loaded
from late_drives import PATIENT
from package_of_test import PACKAGES, package_of_test
from robots_core.ros.running.middleware import PROFILES, QOS_FROM_PROFILE, TRANSPORTS
from ros_domains import reserved_domain

if TYPE_CHECKING:
    from rclpy.context import Context  # noqa: TID251
    from rclpy.node import Node  # noqa: TID251

    from robots_core.ros.lockstep.coordinator import Coordinator

# The same examples in every run: a failure is one of the change at hand, and comes again. How long one takes
# depends on the machine.
settings.register_profile(
    'robots', derandomize=True, deadline=None, suppress_health_check=[HealthCheck.too_slow]
)
# More of them: pytest --hypothesis-profile=many ...; and others each time: --hypothesis-profile=fuzz
settings.register_profile('many', settings.get_profile('robots'), max_examples=1_500)
settings.register_profile('fuzz', settings.get_profile('many'), derandomize=False, print_blob=True)
settings.load_profile('robots')

AnyNode = TypeVar('AnyNode')

WAIT_DEADLINE = 240.0  # s, for a machine that is slow and busy
SPIN_PERIOD = 0.02  # s, how soon spinning ends
# s between two looks at a condition, which become longer: a look after every callback takes a fifth of the
# processor time of a cell.
SHORTEST_PAUSE, LONGEST_PAUSE = 0.0005, 0.01
WAITING = {'bag', 'cell', 'node', 'page'}  # folders of tests that start nodes
INTERLEAVED = 0.85  # part of the other tests of a share


def pytest_addoption(parser: pytest.Parser) -> None:
    """The choice of robots and of a package; pytest takes options from this folder's conftest alone."""
    parser.addoption(
        '--robot-model',
        action='append',
        metavar='NAME',
        help='run the contract suite on this robot alone (an installed one, or urdf:/path/robot.urdf); '
        'may be given several times',
    )
    parser.addoption('--package', choices=PACKAGES, help='run only the tests of this package')


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Leave out the tests of other packages than the chosen one."""
    package = config.getoption('--package')
    if package is None or not collection_path.match('test_*.py'):
        return None
    return True if package_of_test(collection_path) != package else None


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, Any, Any]:
    """What is made while tests are collected stays: looking through it for garbage takes seconds."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


def pytest_unconfigure() -> None:
    """What was frozen is looked through at the end: nanobind prints what was not."""
    gc.unfreeze()


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """In the share that each of the parallel processes begins with, tests that wait stand between others.

    Whole cells and single nodes wait for each other most of the time, and take up to half a minute. While
    one process waits, others compute. None of them stand in the last part of a share: begun last, they would
    run on while other processes have nothing left to do.
    """
    processes = int(os.environ.get('PYTEST_XDIST_WORKER_COUNT', '1'))
    longest = [item for item in items if item.get_closest_marker('longest')]
    rest = [item for item in items if item not in longest]
    waiting, others = (
        [item for item in rest if (item.path.parent.name in WAITING) is waits] for waits in (True, False)
    )
    items.clear()
    modules, computing = _modules(waiting), _modules(others)
    for number in range(processes):
        share = slice(number, None, processes)
        items += longest[share] + _interleaved(modules[share], computing[share])


def _modules(items: list[pytest.Item]) -> list[list[pytest.Item]]:
    return [[*tests] for _, tests in groupby(items, lambda item: item.path)]


def _interleaved(waiting: list[list[pytest.Item]], others: list[list[pytest.Item]]) -> list[pytest.Item]:
    """Modules that wait, with about equal numbers of other tests before each of them and more at the end."""
    between = INTERLEAVED * sum(map(len, others)) / max(len(waiting), 1)
    found: list[pytest.Item] = []
    due = 0.0
    for module in others:
        while waiting and len(found) >= due:
            due += between + len(waiting[0])
            found += waiting.pop(0)
        found += module
    return found + [item for module in waiting for item in module]


@pytest.fixture
def ros_domain(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """A ROS_DOMAIN_ID that no other test on this machine uses now, set in the environment."""
    yield from _reserve_domain(monkeypatch)


@pytest.fixture(scope='module')
def module_ros_domain() -> Iterator[int]:
    """The same for what all tests of a module share."""
    with pytest.MonkeyPatch.context() as monkeypatch:
        yield from _reserve_domain(monkeypatch)


@pytest.fixture(scope='session')
def session_ros_domain() -> Iterator[int]:
    """The same for what all tests share."""
    with pytest.MonkeyPatch.context() as monkeypatch:
        yield from _reserve_domain(monkeypatch)


def _reserve_domain(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    # What runs in the process of the tests chooses its transports by these: no test is to inherit that.
    for name in (TRANSPORTS, QOS_FROM_PROFILE, *PROFILES):
        monkeypatch.setenv(name, '')
        monkeypatch.delenv(name)
    with reserved_domain() as environment:
        for name, value in environment.items():
            monkeypatch.setenv(name, value)
        yield int(environment['ROS_DOMAIN_ID'])


@pytest.fixture
def ros_context(ros_domain: int) -> Iterator[Context]:
    """An rclpy context of this test's own, in its own domain.

    Nodes whose start was refused are in the network until they are collected as garbage: the next test in
    this domain would meet them.
    """
    with _context(ros_domain) as context:
        yield context


@pytest.fixture
def ros_nodes(ros_context: Context) -> Iterator[NodeRunner]:
    """Runs nodes in the background; ends and destroys them after the test."""
    with closing(NodeRunner(ros_context)) as runner:
        yield runner


@pytest.fixture(scope='module')
def module_ros_nodes(module_ros_domain: int) -> Iterator[NodeRunner]:
    """The same for what all tests of a module share."""
    with _context(module_ros_domain) as context, closing(NodeRunner(context)) as runner:
        yield runner


@contextmanager
def _context(domain: int) -> Iterator[Context]:
    import rclpy.node  # noqa: PLC0415, TID251  # tests without ROS need no rclpy

    gc.freeze()  # collecting what the test makes alone takes milliseconds
    context = rclpy.Context()
    rclpy.init(context=context, domain_id=domain)
    yield context
    for one in gc.get_objects():
        # Whose start was refused: a callback that the clock holds keeps it from being collected.
        if issubclass(type(one), rclpy.node.Node) and one.context is context:
            rclpy.node.Node.destroy_node(one)
    context.try_shutdown()
    gc.collect()
    gc.unfreeze()


class NodeRunner:
    """Spins nodes in one background thread; the test's own thread waits on conditions.

    Create nodes with `context=runner.context`. An exception in a callback ends the spinning and is
    raised again by `wait_for` and at the end of the test.
    """

    def __init__(self, context: Context) -> None:
        from robots_core.ros.running.lean_executor import LeanExecutor  # noqa: PLC0415

        self.context = context
        self._executor = LeanExecutor(context=context)
        self._stop = threading.Event()
        self._error: BaseException | None = None
        self._nodes: list[Any] = []
        self._thread = threading.Thread(target=self._spin, name='spin', daemon=True)
        self._thread.start()

    def add(self, node: AnyNode) -> AnyNode:
        """Spin a node from now on; it is destroyed at the end of the test."""
        self._nodes.append(node)
        self._executor.add_node(node)
        return node

    def create_node(self, name: str = 'test', **options: Any) -> Node:
        """A plain node to talk to the nodes under test with."""
        from rclpy.node import Node  # noqa: PLC0415, TID251

        return self.add(Node(name, context=self.context, **options))

    def options(self, **parameters: Any) -> dict[str, Any]:
        """Options of a node under test: its context and these parameters.

        Nodes that share the interpreter of a test are held up: unless a test sets `watchdog`, none is lost.
        """
        from rclpy.parameter import Parameter  # noqa: PLC0415, TID251

        parameters = {'watchdog': PATIENT, **parameters}
        overrides = [Parameter(name, value=value) for name, value in parameters.items()]
        return {'context': self.context, 'parameter_overrides': overrides}

    def coordinate(self, *names: str, **options: Any) -> Coordinator:
        """Advance the time of the lock-step nodes with these names as soon as all have joined."""
        from robots_core.ros.lockstep.coordinator import Coordinator  # noqa: PLC0415

        made: list[Coordinator] = []
        node = self.create_node('coordinator')
        expected = [f'/{name}' for name in names]
        options = {'patience': WAIT_DEADLINE, 'joining_patience': WAIT_DEADLINE, **options}
        self.call(lambda: made.append(Coordinator(node, expected, **options)))
        return made[0]

    def call(self, function: Callable[[], object]) -> None:
        """Call a function in the spinning thread: only there may entities end that it waits for."""
        done = threading.Event()

        def call() -> None:
            function()
            done.set()

        self._executor.create_task(call)
        self.wait_for(done.is_set, what='a call in the spinning thread')

    def destroy(self, node: Any) -> None:
        """Destroy a node before the end of the test."""

        def destroy() -> None:
            self._executor.remove_node(node)
            node.destroy_node()

        self._nodes.remove(node)
        self.call(destroy)
        self.call(lambda: None)  # in its next round the executor lets go of what it holds

    def wait_for(self, condition: Callable[[], Any], timeout: float = WAIT_DEADLINE, what: str = '') -> Any:
        """Wait until `condition()` is true and return its value.

        Args:
            condition: Looked at at once, and ever more seldom: in the end every 10 ms.
            timeout: s.
            what: Named in the failure.

        Raises:
            AssertionError: not true in time.
        """
        deadline = time.monotonic() + timeout
        pause = SHORTEST_PAUSE
        while True:
            self._raise_error()
            if value := condition():
                return value
            if time.monotonic() > deadline:
                raise AssertionError(f'not within {timeout:g} s: {what or condition}')
            time.sleep(pause)
            pause = min(1.5 * pause, LONGEST_PAUSE)

    def close(self) -> None:
        """End the thread, destroy the nodes, and raise what a callback raised."""
        self._stop.set()
        self._thread.join()
        self._executor.shutdown()
        for node in self._nodes:
            node.destroy_node()
        self._raise_error()

    def _raise_error(self) -> None:
        if self._error is not None:
            error, self._error = self._error, None
            raise error

    def _spin(self) -> None:
        try:
            while not self._stop.is_set():
                self._executor.spin_once(timeout_sec=SPIN_PERIOD)
        except BaseException as error:  # noqa: BLE001  # raised again in the test's thread
            self._error = error
