"""How the suite's processes use the middleware."""

import os
from pathlib import Path
from typing import Final

TRANSPORTS: Final = 'FASTDDS_BUILTIN_TRANSPORTS'
PROFILES: Final = ('FASTRTPS_DEFAULT_PROFILES_FILE', 'FASTDDS_DEFAULT_PROFILES_FILE')
QOS_FROM_PROFILE: Final = 'RMW_FASTRTPS_USE_QOS_FROM_XML'
DISCOVERY: Final = 'ROS_AUTOMATIC_DISCOVERY_RANGE'
LOOPBACK: Final = {
    DISCOVERY: 'SYSTEM_DEFAULT',
    PROFILES[0]: str(Path(__file__).with_name('loopback.xml')),
    QOS_FROM_PROFILE: '1',
}
"""Environment of processes whose sockets are all on the loopback interface."""
NETWORK: Final = {PROFILES[0]: str(Path(__file__).with_name('network.xml'))}
"""Environment of other processes."""


def choose_transports() -> None:
    """Let Fast DDS use UDP alone, unless the environment says otherwise; call it before `rclpy.init`.

    With its shared-memory transport a publisher can stand still for 333 ms when a process joins
    (github.com/eProsima/Fast-DDS/issues/6535): longer than any control loop may. It also leaves locks behind
    when a process is killed. For messages as small as ours UDP on one machine costs no more.

    Where discovery keeps to this machine (ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST), all sockets are on the
    loopback interface, and nothing outside reaches them. rmw_fastrtps of Jazzy would open them on all
    interfaces, and add shared memory without asking; so a profile of Fast DDS takes its place, which finds
    other processes with LOCALHOST and is found by them.

    The profile also lets readers and writers allocate each sample and free it. By default they keep each
    place of a queue at the size of the largest sample that it has had: where short and long trajectories wait
    together, the queue ends up with the memory of as many long ones.

    Its sockets hold more, and a lost message is asked for again within 0.1 s instead of 3 s: where processes
    wait for processors, the sockets of the system's own size overflow.

    With every range of discovery, processes announce themselves every 0.5 s instead of 3 s: a process that is
    restarted misses most answers to its first announcement, and waits for the next ones.
    """
    os.environ.setdefault(TRANSPORTS, 'UDPv4')
    chosen = {os.environ.get(name, '') for name in PROFILES} - {'', NETWORK[PROFILES[0]]}
    fast = os.environ.get('RMW_IMPLEMENTATION', 'rmw_fastrtps_cpp').startswith('rmw_fastrtps')
    if fast and not chosen:
        os.environ.update(LOOPBACK if os.environ.get(DISCOVERY) == 'LOCALHOST' else NETWORK)
