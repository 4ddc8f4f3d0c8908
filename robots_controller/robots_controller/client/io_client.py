"""IoClient: the inputs and outputs of a cell."""

import time
from typing import Final

import numpy as np
from rcl_interfaces.msg import Parameter as ParameterMessage
from rcl_interfaces.msg import ParameterType, ParameterValue
from rcl_interfaces.srv import GetParameters, ListParameters, SetParameters
from rclpy.parameter import Parameter

from robots_controller.client.cell_services import CellServices
from robots_core.errors import InvalidInputError

POLL: Final = 0.02  # s
LARGEST: Final = 2**63  # integers of a parameter are below it


class IoClient:
    """Channels by name: `io['gripper'] = True`, `io['digital_input.3']`, as robot programs name them.

    Reading gives the value that the program reads, of outputs the value that they have. An unknown name, or a
    value that a channel cannot have, raises an InvalidInputError.
    """

    def __init__(self, connection: CellServices) -> None:
        self._connection = connection

    @property
    def names(self) -> tuple[str, ...]:
        """All channels."""
        answer = self._connection.answer('lua_program_node/list_io', ListParameters, ListParameters.Request())
        return tuple(answer.result.names)

    def __getitem__(self, name: str) -> bool | float:
        request = GetParameters.Request(names=[name])
        (value,) = self._connection.answer('lua_program_node/get_io', GetParameters, request).values
        if value.type == ParameterType.PARAMETER_NOT_SET:
            raise InvalidInputError(value.string_value)
        if value.type == ParameterType.PARAMETER_BOOL:
            return bool(value.bool_value)
        return float(value.double_value)

    def __setitem__(self, name: str, value: bool | float) -> None:
        self._set(_parameter(name, value))

    def force(self, name: str, value: bool | float) -> None:  # noqa: FBT001  # as in `io[name] = value`
        """Give an input a value regardless of what arrives from outside, until `release`."""
        self._set(_parameter(f'{name}.force', value))

    def release(self, name: str) -> None:
        """End `force`."""
        self._set(ParameterMessage(name=f'{name}.force', value=ParameterValue()))

    def wait_for(self, name: str, value: bool | float, timeout: float | None = None) -> bool:  # noqa: FBT001
        """Wait until a channel has a value; it is read 50 times a second.

        Args:
            name: Of the channel.
            value: Waited for.
            timeout: Longest wait, s; without end by default.

        Returns:
            False if it does not have it.
        """
        deadline = None if timeout is None else time.monotonic() + timeout
        while self[name] != value:
            if deadline is not None and time.monotonic() > deadline:
                return False
            time.sleep(POLL)
        return True

    def _set(self, parameter: ParameterMessage) -> None:
        request = SetParameters.Request(parameters=[parameter])
        (result,) = self._connection.answer('lua_program_node/set_io', SetParameters, request).results
        if not result.successful:
            raise InvalidInputError(result.reason)


def _parameter(name: str, value: object) -> ParameterMessage:
    number = value.item() if isinstance(value, np.generic) else value
    if isinstance(number, float) or (isinstance(number, int) and abs(number) < LARGEST):
        return Parameter(name, value=number).to_parameter_msg()
    raise InvalidInputError(f'{name} got {value!r}; valid is a bool or a number')
