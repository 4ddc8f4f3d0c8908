"""How the suite's processes use the middleware."""

import os

TRANSPORTS = 'FASTDDS_BUILTIN_TRANSPORTS'


def choose_transports() -> None:
    """Let Fast DDS use UDP alone, unless the environment says otherwise; call it before `rclpy.init`.

    With its shared-memory transport a publisher can stand still for 333 ms when a process joins
    (github.com/eProsima/Fast-DDS/issues/6535): longer than any control loop may. It also leaves locks behind
    when a process is killed. For messages as small as ours UDP on one machine costs no more.

    With ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST, rmw_fastrtps of Jazzy adds shared memory itself and does not
    ask; the controller's feedback timeout is longer than such a pause.
    """
    os.environ.setdefault(TRANSPORTS, 'UDPv4')
