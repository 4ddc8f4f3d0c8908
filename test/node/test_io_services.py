"""The I/O services and topics of lua_program_node."""

from __future__ import annotations

from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import DescribeParameters, GetParameters, ListParameters, SetParameters
from std_msgs.msg import Float64MultiArray, UInt8MultiArray
from std_srvs.srv import SetBool

from bench import Bench
from robots_controller.nodes.lua_program_node import LuaProgramNode
from robots_core.errors import InvalidInputError
from robots_core.ros.messages import diagnostic_values
from robots_core.ros.qos import STATE

NO_VALUE = ParameterValue()


def on(value: bool = True) -> ParameterValue:  # noqa: FBT001, FBT002
    return ParameterValue(type=ParameterType.PARAMETER_BOOL, bool_value=value)


def whole(value: int) -> ParameterValue:
    return ParameterValue(type=ParameterType.PARAMETER_INTEGER, integer_value=value)


def double(value: float) -> ParameterValue:
    return ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=value)


class Panel(Bench):
    """A client of all services, and what the node publishes."""

    def __init__(self, runner: Any, **parameters: Any) -> None:
        super().__init__(runner, 'panel')
        for topic, kind in (
            ('digital_outputs', UInt8MultiArray),
            ('analog_outputs', Float64MultiArray),
            ('lua_program_node/digital_inputs', UInt8MultiArray),
            ('lua_program_node/analog_inputs', Float64MultiArray),
            ('forced_inputs', DiagnosticStatus),
        ):
            self.collect(topic, kind, STATE)
        self.lua = self.start_node(LuaProgramNode, **{'digital_size': 4, 'analog_size': 2, **parameters})
        self.wait(lambda: all(self._collected.values()), 'the first images')

    def newest(self, topic: str) -> Any:
        return self.collected(topic)[-1]

    def ask(self, kind: Any, name: str, **fields: Any) -> Any:
        return self.call(f'lua_program_node/{name}', kind.Request(**fields), kind)

    def set(self, *items: tuple[str, ParameterValue]) -> list[tuple[bool, str]]:
        parameters = [Parameter(name=name, value=value) for name, value in items]
        results = self.ask(SetParameters, 'set_io', parameters=parameters).results
        return [(result.successful, result.reason) for result in results]

    def get(self, *names: str) -> list[ParameterValue]:
        return list(self.ask(GetParameters, 'get_io', names=names).values)

    def wait_for(self, topic: str, data: list[float]) -> None:
        self.wait(lambda: list(self.newest(topic).data) == data, f'{data} on {topic}')


def test_a_batch_is_served_item_by_item_with_a_reason_each(ros_nodes: Any):
    panel = Panel(ros_nodes, digital_input_names=['press_ready', 'part_present'])
    results = panel.set(
        ('digital_input.press_ready', on()),
        ('digital_output.4', whole(1)),
        ('analog_output.2', double(2.5)),
        ('analog_input.1', whole(3)),
        ('digital_output.5', on()),
        ('digital_input.2', double(1.0)),
        ('digital_input.2', whole(2)),
        ('analog_input.2', double(float('nan'))),
        ('analog_input.2', NO_VALUE),
    )
    assert [successful for successful, _ in results] == [True] * 4 + [False] * 5
    reasons = [reason for _, reason in results]
    assert reasons[:4] == [''] * 4
    assert reasons[4].startswith("no channel is named 'digital_output.5'; channels are digital_input.1..4")
    assert reasons[5] == 'digital_input.2 got a double; valid is a bool, or an integer 0 or 1'
    assert reasons[6] == 'digital input 2 is 2; valid are 0 and 1'
    assert reasons[7] == 'analog input 2 is nan; valid is a finite number'
    assert reasons[8] == 'analog_input.2 got no value; valid is a double or an integer'
    assert panel.get('press_ready', 'digital_output.4', 'analog_output.2', 'analog_input.1') == [
        *(on(), on(), double(2.5), double(3.0))
    ]
    (missing,) = panel.get('digital_input.0')
    assert missing.type == ParameterType.PARAMETER_NOT_SET
    assert missing.string_value.startswith("no channel is named 'digital_input.0'")
    panel.wait_for('digital_outputs', [0, 0, 0, 1])
    panel.wait_for('analog_outputs', [0.0, 2.5])
    panel.wait_for('lua_program_node/digital_inputs', [1, 0, 0, 0])
    panel.wait_for('lua_program_node/analog_inputs', [3.0, 0.0])


def test_a_forced_input_is_marked_and_keeps_its_value_until_released(ros_nodes: Any):
    panel = Panel(ros_nodes, digital_input_names=['press_ready'])
    assert panel.newest('forced_inputs').level == DiagnosticStatus.OK
    assert panel.set(('press_ready.force', on())) == [(True, 'forced')]
    panel.wait_for('lua_program_node/digital_inputs', [1, 0, 0, 0])
    panel.wait(lambda: panel.newest('forced_inputs').level == DiagnosticStatus.WARN, 'the mark')
    assert diagnostic_values(panel.newest('forced_inputs')) == {'digital_input.1 (press_ready)': 'true'}
    descriptors = panel.ask(DescribeParameters, 'describe_io', names=['press_ready', 'x']).descriptors
    assert descriptors[0].name == 'digital_input.1'
    assert descriptors[0].type == ParameterType.PARAMETER_BOOL
    assert descriptors[0].description == 'press_ready: digital input 1, forced to true'
    assert descriptors[1].type == ParameterType.PARAMETER_NOT_SET
    assert descriptors[1].description.startswith("no channel is named 'x'")

    panel.publish('digital_inputs', UInt8MultiArray(data=[0, 1]), STATE)
    panel.wait_for('lua_program_node/digital_inputs', [1, 1, 0, 0])
    ((successful, reason),) = panel.set(('digital_input.1', on(False)))
    assert successful
    assert reason == 'digital_input.1 is forced to true; the value shows once it is released'
    assert panel.get('digital_input.1', 'digital_input.1.force') == [on(), on()]
    assert panel.set(('digital_input.1.force', NO_VALUE)) == [(True, 'released')]
    panel.wait_for('lua_program_node/digital_inputs', [0, 1, 0, 0])
    panel.wait(lambda: panel.newest('forced_inputs').level == DiagnosticStatus.OK, 'no mark')
    (value,) = panel.get('digital_input.1.force')
    assert value.type == ParameterType.PARAMETER_NOT_SET
    assert value.string_value == 'digital_input.1 is not forced'


def test_an_input_may_be_called_force_and_be_forced(ros_nodes: Any):
    panel = Panel(ros_nodes, analog_input_names=['force'])
    assert panel.set(('analog_input.force', double(3.0))) == [(True, '')]
    assert panel.get('force', 'analog_input.force', 'analog_input.1') == [double(3.0)] * 3
    assert panel.set(('analog_input.force.force', double(5.0))) == [(True, 'forced')]
    assert panel.get('force', 'force.force') == [double(5.0)] * 2


def test_an_output_cannot_be_forced(ros_nodes: Any):
    panel = Panel(ros_nodes)
    for value in (on(), NO_VALUE):
        assert panel.set(('digital_output.1.force', value)) == [
            (False, 'digital_output.1 is an output; only inputs can be forced')
        ]


@pytest.mark.parametrize(
    ('prefixes', 'depth', 'expected'),
    [
        ([], 0, 13),
        (['digital_input'], 0, 5),
        (['digital_input'], 1, 4),
        (['digital_input.2'], 0, 2),
        (['analog_output', 'analog_input'], 0, 4),
        (['digital'], 0, 0),
        ([], 1, 0),
    ],
)
def test_channels_are_listed_as_parameters_are(
    ros_nodes: Any, prefixes: list[str], depth: int, expected: int
):
    panel = Panel(ros_nodes)
    panel.set(('digital_input.2.force', on()))
    result = panel.ask(ListParameters, 'list_io', prefixes=prefixes, depth=depth).result
    assert len(result.names) == expected
    assert ('digital_input.2.force' in result.names) == (expected in (13, 5, 2))
    assert set(result.prefixes) == {name.rpartition('.')[0] for name in result.names}


def test_one_channel_is_switched_by_a_service_of_its_own(ros_nodes: Any):
    panel = Panel(ros_nodes, channel_services=True)
    assert panel.ask(SetBool, 'digital_input_1/set', data=True).success
    assert panel.ask(SetBool, 'digital_output_4/set', data=True).success
    panel.wait_for('lua_program_node/digital_inputs', [1, 0, 0, 0])
    panel.wait_for('digital_outputs', [0, 0, 0, 1])
    assert panel.ask(SetBool, 'digital_input_1/set', data=False).success
    panel.wait_for('lua_program_node/digital_inputs', [0, 0, 0, 0])


def test_channels_have_no_services_of_their_own_by_default(ros_nodes: Any):
    panel = Panel(ros_nodes)
    assert not [one.service_name for one in panel.lua.services if one.service_name.endswith('/set')]


def test_the_images_say_how_they_count(ros_nodes: Any):
    panel = Panel(ros_nodes)
    (dimension,) = panel.newest('digital_outputs').layout.dim
    assert (dimension.label, dimension.size, dimension.stride) == ('digital_output.1..4', 4, 4)


def test_names_that_are_not_unique_are_refused_at_start(ros_nodes: Any):
    with pytest.raises(InvalidInputError, match=r"'a' names both digital_input\.1 and analog_output\.2"):
        Panel(ros_nodes, digital_input_names=['a'], analog_output_names=['', 'a'])
