"""The robot as an OPC UA server, as clients of asyncua find it: nodes by the specification's names."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from asyncua import ua

from opcua_bench import (
    CHANNELS,
    CONTROLLER,
    DEVICE,
    MACHINE,
    ROBOT,
    SAFETY,
    STATE,
    SYSTEM,
    TASK,
    Cell,
    Served,
)
from opcua_client import ROBOTICS, Nodes
from opcua_partners import certificate
from plant_partners import DEADLINE
from robots_controller.opcua.robot_server import RobotServer
from robots_controller.opcua.server_settings import ServerSettings, read_server_settings
from robots_controller.pendant.pendant_state import ShownProgram
from robots_controller.program.run_state import RunState
from robots_core.errors import InvalidInputError, NoAnswerError, NotNowError

# As OPC 40010-1 names them: the path, the number of the type, and values where they are known.
OBJECTS = {
    SYSTEM: 1002,
    DEVICE: 1004,
    f'{DEVICE}/rob:Axes/A1': 16601,
    f'{DEVICE}/rob:PowerTrains/A1': 16794,
    f'{DEVICE}/rob:PowerTrains/A1/Motor': 1019,
    f'{DEVICE}/rob:FlangeLoad': 1018,
    CONTROLLER: 1003,
    f'{CONTROLLER}/rob:CurrentUser': 18175,
    TASK: 1011,
    f'{TASK}/rob:TaskControlOperation': 1008,
    MACHINE: 1025,
    f'{MACHINE}/rob:ReadySubstateMachine': 1012,
    SAFETY: 1013,
}
VALUES = {
    f'{DEVICE}/rob:MotionDeviceCategory': 1,
    f'{DEVICE}/di:ParameterSet/rob:InControl': True,
    f'{DEVICE}/di:ParameterSet/rob:SpeedOverride': 50.0,
    f'{DEVICE}/rob:Axes/A2/rob:MotionProfile': 1,
    f'{DEVICE}/rob:Axes/A2/di:ParameterSet/rob:ActualPosition': ROBOT.home[1],
    f'{DEVICE}/rob:Axes/A2/di:ParameterSet/rob:ActualSpeed': 0.1,
    f'{DEVICE}/rob:PowerTrains/A2/Motor/di:ParameterSet/rob:EffectiveLoadRate': 50,
    f'{DEVICE}/rob:PowerTrains/A2/Motor/di:ParameterSet/rob:MotorTemperature': None,
    f'{DEVICE}/rob:FlangeLoad/rob:Mass': 80.0,
    f'{DEVICE}/rob:FlangeLoad/rob:CenterOfMass/ua:CartesianCoordinates/ua:Z': 0.2,
    f'{CONTROLLER}/rob:CurrentUser/rob:Level': 'PROGRAM',
    f'{CONTROLLER}/rob:Software/robots_controller/di:SoftwareRevision': '0.1.0',
    f'{TASK}/di:ParameterSet/rob:TaskProgramName': 'welding.lua',
    f'{TASK}/di:ParameterSet/rob:TaskProgramLoaded': True,
    f'{SAFETY}/di:ParameterSet/rob:OperationalMode': 1,
    f'{SAFETY}/di:ParameterSet/rob:EmergencyStop': False,
    f'{SAFETY}/di:ParameterSet/rob:ProtectiveStop': False,
    f'{CHANNELS}/digital_input.1': True,
    f'{CHANNELS}/digital_output.2': True,
    f'{CHANNELS}/analog_output.1': 2.5,
}


@pytest.fixture(scope='module')
def programs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp('programs')
    (folder / 'press.lua').write_text('print(1)')
    return folder


@pytest.fixture(scope='module')
def plain(programs: Path) -> Iterator[Served]:
    served = Served(ServerSettings(), programs)
    served.show()
    yield served
    served.server.close()


@pytest.fixture(scope='module')
def secured_server(tmp_path_factory: pytest.TempPathFactory, programs: Path) -> Iterator[Served]:
    folder = tmp_path_factory.mktemp('certificates')
    keys = {name: certificate(folder, name) for name in ('server', 'plc', 'line', 'stranger')}
    (folder / 'password.txt').write_text('secret\n')
    access = folder / 'access.yaml'
    access.write_text(f"""
anonymous: false
certificate: {keys['server'][0]}
key: {keys['server'][1]}
security: basic256sha256
trusted: [{keys['plc'][0]}, {keys['line'][0]}]
users:
  scada: {{password_file: {folder / 'password.txt'}}}
  press: {{password_file: {folder / 'password.txt'}, operate: true}}
  line: {{certificate: {keys['line'][0]}, operate: true}}
nameplate: {{manufacturer: KUKA, serial_number: '4711'}}
""")
    served = Served(read_server_settings(access), programs)
    served.keys = keys
    yield served
    served.server.close()


@pytest.fixture
def secured(secured_server: Served) -> Served:
    return secured_server.renewed(io=replace(STATE.io))


OPERATOR = {'user': 'press', 'password': 'secret', 'key': 'plc'}


def test_robot_controller_and_safety_are_found_by_the_names_of_the_specification(plain: Served) -> None:
    async def work(nodes: Nodes) -> None:
        index = await nodes.client.get_namespace_index(ROBOTICS)
        for path, number in OBJECTS.items():
            kind = await (await nodes.node(path)).read_type_definition()
            assert kind == ua.NodeId(number, index), path
        for path, value in VALUES.items():
            assert await nodes.value(path) == value, path
        safety = await (await nodes.node(SAFETY)).read_attribute(ua.AttributeIds.Description)
        assert 'Not a safety function' in safety.Value.Value.Text
        position = await nodes.node(f'{DEVICE}/rob:Axes/A1/di:ParameterSet/rob:ActualPosition')
        unit = await (await position.get_child('0:EngineeringUnits')).read_value()
        assert (unit.UnitId, unit.DisplayName.Text) == (4405297, 'rad')  # C81 of UNECE
        span = await (await position.get_child('0:EURange')).read_value()
        assert (span.Low, span.High) == (ROBOT.axes_data.lower[0], ROBOT.axes_data.upper[0])
        gripper = await (await nodes.node(f'{CHANNELS}/digital_output.1')).read_display_name()
        assert gripper.Text == 'gripper'
        controls = ua.NodeId(4002, index)
        (device,) = await (await nodes.node(TASK)).get_referenced_nodes(controls)
        assert device == await nodes.node(DEVICE)

    plain.client(work)


def test_each_object_has_the_mandatory_members_of_its_type(plain: Served) -> None:
    seen: dict[Any, set[str]] = {}

    async def names(node: Any) -> set[str]:
        return {(await child.read_browse_name()).to_string() for child in await node.get_children()}

    async def mandatory(nodes: Nodes, kind: Any) -> set[str]:
        if kind.nodeid == ua.NodeId(ua.ObjectIds.BaseObjectType):
            return set()
        if kind not in seen:
            found = {*await mandatory(nodes, await kind.get_parent())}
            for declared in await kind.get_children():
                rules = await declared.get_referenced_nodes(ua.ObjectIds.HasModellingRule)
                if rules and rules[0].nodeid == ua.NodeId(ua.ObjectIds.ModellingRule_Mandatory):
                    found.add((await declared.read_browse_name()).to_string())
            seen[kind] = found
        return seen[kind]

    async def check(nodes: Nodes, node: Any) -> None:
        kind = nodes.client.get_node(await node.read_type_definition())
        assert await mandatory(nodes, kind) <= await names(node), node
        for child in await node.get_children(ua.ObjectIds.HasComponent, nodeclassmask=ua.NodeClass.Object):
            await check(nodes, child)

    async def work(nodes: Nodes) -> None:
        await check(nodes, await nodes.node(SYSTEM))

    plain.client(work)
    assert len(seen) > 12  # types


def test_without_settings_anyone_reads_and_nobody_commands(plain: Served) -> None:
    async def work(nodes: Nodes) -> None:
        with pytest.raises(ua.uaerrors.BadUserAccessDenied):
            await nodes.call(f'{MACHINE}/rob:Start')
        with pytest.raises(ua.uaerrors.BadUserAccessDenied):
            await nodes.write(f'{CHANNELS}/digital_output.1', value=True, kind=ua.VariantType.Boolean)
        assert await nodes.value(f'{CHANNELS}/digital_output.1') is False

    plain.client(work)
    assert plain.cell.calls == []


def test_states_of_the_program_are_those_of_the_task_control(plain: Served) -> None:
    ready = f'{MACHINE}/rob:ReadySubstateMachine'
    expected = {
        RunState.OPENED: ('Ready', 'AtProgramStart'),
        RunState.RUNNING: ('Executing', None),
        RunState.PAUSED: ('Ready', 'Suspended'),
        RunState.FAILED: ('Ready', 'AtProgramStart'),
        RunState.IDLE: ('Idle', None),
    }

    async def work(nodes: Nodes) -> None:
        machine = await nodes.node(f'{MACHINE}/ua:CurrentState')
        substate = await nodes.node(f'{ready}/ua:CurrentState')
        for state, (operation, below) in expected.items():
            await asyncio.to_thread(plain.show, program=ShownProgram('/cell/welding.lua', state))
            assert (await machine.read_value()).Text == operation
            found = await substate.read_data_value(raise_on_bad_status=False)
            if below is None:
                assert found.StatusCode.name == 'BadStateNotActive'
            else:
                assert found.Value.Value.Text == below
        last = f'{MACHINE}/ua:LastTransition'
        assert (await nodes.value(last)).Text == 'ReadyToIdle'
        index = await nodes.client.get_namespace_index(ROBOTICS)
        assert await (await machine.get_child('0:Id')).read_value() == ua.NodeId(5005, index)
        await asyncio.to_thread(plain.show, program=ShownProgram('/cell/welding.lua', RunState.RUNNING))
        assert (await nodes.value(last)).Text == 'ReadyToExecuting'  # Ready was too short to be seen

    plain.client(work)
    plain.show()


def test_transitions_of_the_program_are_events(plain: Served) -> None:
    machine = 'TaskControlOperation/TaskControlStateMachine'
    ready = f'{machine}/ReadySubstateMachine'
    wanted = [
        (machine, 'ReadyToExecuting', 'Ready', 'Executing'),
        (machine, 'ExecutingToReady', 'Executing', 'Ready'),
        (machine, 'ReadyToIdle', 'Ready', 'Idle'),
    ]
    events: asyncio.Queue[tuple[str, str, str, str]] = asyncio.Queue()

    class Listener:
        @staticmethod
        def event_notification(event: Any) -> None:
            source = event.SourceNode.Identifier
            below = ready if source.endswith(ready) else machine
            assert source.endswith(below)
            assert event.Message.Text == f'Robot program: {event.Transition.Text}'
            assert getattr(event, 'ToState/Id').NamespaceIndex > 0
            events.put_nowait((below, event.Transition.Text, event.FromState.Text, event.ToState.Text))

    async def work(nodes: Nodes) -> None:
        subscription = await nodes.client.create_subscription(10, Listener())
        await subscription.subscribe_events(evtypes=ua.ObjectIds.TransitionEventType)
        for state in (RunState.RUNNING, RunState.FINISHED, RunState.IDLE):
            await asyncio.to_thread(plain.show, program=ShownProgram('/cell/welding.lua', state))
        found: list[tuple[str, str, str, str]] = []
        async with asyncio.timeout(DEADLINE):
            while len(found) < len(wanted):
                found += [one for one in [await events.get()] if one[0] == machine]
        assert found == wanted

    plain.show()
    plain.client(work)
    plain.show()


def test_faults_are_emergency_or_protective_stops(plain: Served) -> None:
    async def stops(nodes: Nodes) -> list[bool]:
        return [
            await nodes.value(f'{SAFETY}/di:ParameterSet/rob:{n}Stop') for n in ('Emergency', 'Protective')
        ]

    plain.show(fault='emergency stop', fault_kind='emergency stop')
    assert plain.client(stops) == [True, False]
    plain.show(fault='zone violated', fault_kind='zone violated')
    assert plain.client(stops) == [False, True]
    plain.show()


def test_who_may_operate_loads_starts_and_stops_programs(secured: Served) -> None:
    async def work(nodes: Nodes) -> None:
        assert await nodes.call(f'{MACHINE}/rob:LoadByName', 'press.lua') == 0
        assert await nodes.call(f'{MACHINE}/rob:Start') == 0
        await asyncio.to_thread(secured.show, program=ShownProgram('', RunState.RUNNING))
        reason = await nodes.value(f'{MACHINE}/rob:LastTransitionReason/ua:ValueAsText')
        assert reason.Text == 'External'
        assert await nodes.call(f'{MACHINE}/rob:Stop', ua.Variant(1, ua.VariantType.Int64)) == 0
        await asyncio.to_thread(secured.show, program=ShownProgram('', RunState.PAUSED))
        assert await nodes.call(f'{MACHINE}/rob:Start') == 0
        assert await nodes.call(f'{MACHINE}/rob:Stop', ua.Variant(0, ua.VariantType.Int64)) == 0
        assert await nodes.call(f'{MACHINE}/rob:ReadySubstateMachine/rob:ResetToProgramStart') == 0
        assert await nodes.call(f'{MACHINE}/rob:UnloadProgram') == 0
        await nodes.write(f'{CHANNELS}/analog_output.1', 4.5, ua.VariantType.Double)
        assert await nodes.value(f'{CHANNELS}/analog_output.1') == 4.5
        assert await nodes.value(f'{DEVICE}/di:Manufacturer') == ua.LocalizedText('KUKA')

    secured.client(work, **OPERATOR)
    services = ['run', 'pause', 'resume', 'stop', 'reset', 'close']
    expected = ['press.lua', *(f'lua_program_node/{name}' for name in services), ('analog_output.1', 4.5)]
    assert secured.cell.calls == expected


def test_methods_that_the_cell_refuses_return_the_status_of_the_specification(secured: Served) -> None:
    async def work(nodes: Nodes) -> None:
        secured.cell.error = NotNowError('the cell is not ready')
        assert await nodes.call(f'{MACHINE}/rob:Start') == 1
        secured.cell.error = NoAnswerError('no answer')
        assert await nodes.call(f'{MACHINE}/rob:Start') == 2
        await asyncio.to_thread(secured.show, fault='zone violated')
        assert await nodes.call(f'{MACHINE}/rob:Start') == 3
        for name, argument in (
            ('Stop', ua.Variant(7, ua.VariantType.Int64)),
            ('Stop', 'now'),
            ('LoadByName', '../secret.lua'),
            ('LoadByName', 7),
        ):
            with pytest.raises(ua.uaerrors.BadInvalidArgument):
                await nodes.call(f'{MACHINE}/rob:{name}', argument)
        with pytest.raises(ua.uaerrors.BadArgumentsMissing):
            await nodes.call(f'{MACHINE}/rob:Stop')

    secured.client(work, **OPERATOR)
    assert secured.cell.calls == []
    assert secured.told == [
        'Start is refused: the cell is not ready',
        'Start: no answer',
        'Start is refused: zone violated',
    ]


def test_values_that_cannot_be_written_are_refused_and_the_outputs_keep_theirs(secured: Served) -> None:
    output = f'{CHANNELS}/digital_output.1'

    async def work(nodes: Nodes) -> None:
        with pytest.raises(ua.uaerrors.BadTypeMismatch):
            await nodes.write(output, 1.0, ua.VariantType.Double)
        with pytest.raises(ua.uaerrors.BadUserAccessDenied):
            await nodes.write(f'{CHANNELS}/digital_input.1', value=True, kind=ua.VariantType.Boolean)
        speed = f'{DEVICE}/di:ParameterSet/rob:SpeedOverride'
        with pytest.raises(ua.uaerrors.BadUserAccessDenied):
            await nodes.write(speed, 100.0, ua.VariantType.Double)
        with pytest.raises(ua.uaerrors.BadOutOfRange):
            await nodes.write(f'{CHANNELS}/analog_output.1', float('inf'), ua.VariantType.Double)
        secured.cell.error = NotNowError('outputs are fail-safe')
        with pytest.raises(ua.uaerrors.BadInvalidState):
            await nodes.write(output, value=True, kind=ua.VariantType.Boolean)
        assert await nodes.value(output) is False
        assert await nodes.value(f'{CHANNELS}/analog_output.1') == 2.5

    secured.client(work, **OPERATOR)
    assert secured.told[-1] == 'refused to write digital_output.1: outputs are fail-safe'


async def started(nodes: Nodes) -> Any:
    return await nodes.call(f'{MACHINE}/rob:Start')


def test_users_read_or_operate_as_the_settings_say(secured: Served) -> None:
    assert secured.client(started, key='line') == 0  # its certificate is that of a user
    with pytest.raises(ua.uaerrors.BadUserAccessDenied):
        secured.client(started, **{**OPERATOR, 'user': 'scada'})
    assert secured.cell.calls == ['lua_program_node/run']


@pytest.mark.parametrize(
    ('who', 'error'),
    [
        ({'user': 'nobody', 'password': 'secret', 'key': 'plc'}, "user 'nobody' is unknown"),
        ({'user': 'press', 'password': 'guess', 'key': 'plc'}, "user 'press' is unknown, or its password"),
        ({'key': 'plc'}, 'refused a client without a user'),
        ({**OPERATOR, 'key': 'stranger'}, 'the certificate of urn:stranger is not trusted'),
    ],
)
def test_whoever_is_not_known_is_refused(secured: Served, who: dict[str, str], error: str) -> None:
    with pytest.raises((ua.UaError, ConnectionError, TimeoutError)):
        secured.client(started, **who)
    assert error in secured.told[-1]


def test_without_encryption_a_server_with_a_certificate_serves_nothing(secured: Served) -> None:
    with pytest.raises((ua.UaError, ConnectionError)):
        secured.client(started, **{**OPERATOR, 'key': ''})
    assert secured.cell.calls == []


def test_a_port_that_is_taken_is_named(plain: Served, programs: Path) -> None:
    with pytest.raises(InvalidInputError, match=f'port {plain.port} of 127.0.0.1 is taken'):
        RobotServer(
            ROBOT,
            Cell(),
            ServerSettings(),
            programs=programs,
            host='127.0.0.1',
            tcp_port=plain.port,
            log=print,
        )


@pytest.mark.parametrize(
    ('text', 'error'),
    [
        ('users: {plc: {}}', 'user plc needs one of password_file and certificate'),
        ('users: {plc: {password_file: /none.txt}}', 'there is no password_file /none.txt'),
        ('security: [basic256sha256]', "security needs the server's certificate and key"),
        ('anonymous: perhaps', 'anonymous is'),
        ('user: {plc: {}}', "unknown key 'user'; did you mean 'users'"),
        ('users: {plc: {certificate: pyproject.toml}}', "users needs the server's certificate"),
        ('certificate: pyproject.toml', 'certificate and key need each other'),
    ],
)
def test_mistakes_in_the_settings_are_named_with_their_line(tmp_path: Path, text: str, error: str) -> None:
    path = tmp_path / 'access.yaml'
    path.write_text(text)
    with pytest.raises(InvalidInputError, match=r'access\.yaml:1: ') as caught:
        read_server_settings(path)
    assert error in str(caught.value)


def test_passwords_do_not_leave_this_machine_in_clear_text(tmp_path: Path) -> None:
    (tmp_path / 'password.txt').write_text('secret')
    (tmp_path / 'access.yaml').write_text(f'users: {{plc: {{password_file: {tmp_path}/password.txt}}}}')
    settings = read_server_settings(tmp_path / 'access.yaml')
    settings.check_host('127.0.0.1')
    with pytest.raises(InvalidInputError, match=r"host '192\.168\.0\.10' with users needs a certificate"):
        settings.check_host('192.168.0.10')
