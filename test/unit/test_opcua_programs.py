"""Robot programs as files of the OPC UA server, which clients load, unload and read."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from asyncua import ua
from asyncua.client.ua_file import UaFile

from opcua_bench import CONTROLLER, MACHINE, Served
from opcua_client import CELL, Nodes
from plant_partners import DEADLINE
from robots_controller.opcua.address_space import program_nodes
from robots_controller.opcua.server_settings import ServerSettings, ServerUser
from robots_controller.pendant.pendant_state import ShownProgram
from robots_controller.program.run_state import RunState
from robots_core.errors import NotNowError

PROGRAMS = f'{CONTROLLER}/rob:Programs'
NAME = 'rob:TaskControls/TaskControl/di:ParameterSet/rob:TaskProgramName'
OPERATOR = {'user': 'press', 'password': 'secret'}
TEXT = "print('\u00e4')\n"
PATH = 'MotionDeviceSystem/Controllers/Controller/Programs'


@pytest.fixture(scope='module')
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp('cell')
    (folder / 'programs' / 'io').mkdir(parents=True)
    (folder / 'programs' / 'press.lua').write_text(TEXT)
    (folder / 'programs' / 'io' / 'fill.lua').write_text(TEXT)
    (folder / 'programs' / 'io' / 'fill.yaml').write_text('')
    (folder / 'programs' / 'io' / 'folder.lua').mkdir()
    (folder / 'programs' / 'io' / 'folder.lua' / 'in.lua').write_text(TEXT)
    (folder / 'secret.lua').write_text(TEXT)
    (folder / 'password.txt').write_text('secret')
    return folder


@pytest.fixture(scope='module')
def server(folder: Path) -> Iterator[Served]:
    password = str(folder / 'password.txt')
    users = (
        ServerUser('press', operate=True, password_file=password),
        ServerUser('scada', operate=False, password_file=password),
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr('robots_controller.opcua.address_space.program_nodes.REFRESH', 0.02)
        served = Served(ServerSettings(users=users, anonymous=True), folder / 'programs')
        end = time.monotonic() + DEADLINE
        while not served.server._nodes._programs._sizes:
            assert time.monotonic() < end
            served.show()
        yield served
        served.server.close()


@pytest.fixture
def served(server: Served) -> Served:
    return server.renewed(program=ShownProgram('', RunState.IDLE))


def expanded(path: str, **of: Any) -> ua.Variant:
    return ua.Variant(ua.ExpandedNodeId(path, **of), ua.VariantType.ExpandedNodeId)


def test_programs_are_files_below_the_controller(served: Served) -> None:
    async def work(nodes: Nodes) -> None:
        directory = await nodes.node(PROGRAMS)
        assert await directory.read_type_definition() == ua.NodeId(ua.ObjectIds.FileDirectoryType)
        inner = await nodes.node(f'{PROGRAMS}/io')
        assert await inner.read_type_definition() == ua.NodeId(ua.ObjectIds.FileDirectoryType)
        file = await nodes.node(f'{PROGRAMS}/io/fill.lua')
        assert await file.read_type_definition() == ua.NodeId(ua.ObjectIds.FileType)
        names = {(await one.read_browse_name()).Name for one in await directory.get_children()}
        assert {'press.lua', 'io', 'CreateFile', 'Delete'} <= names
        names = {(await one.read_browse_name()).Name for one in await file.get_children()}
        assert names == {
            *('Open', 'Close', 'Read', 'Write', 'GetPosition', 'SetPosition'),
            *('Size', 'Writable', 'UserWritable', 'OpenCount'),
        }
        assert await nodes.value(f'{PROGRAMS}/press.lua/ua:Size') == len(TEXT.encode())
        assert await nodes.value(f'{PROGRAMS}/press.lua/ua:Writable') is False

    served.client(work)


def test_programs_are_loaded_and_unloaded_by_their_nodes_and_names(served: Served) -> None:
    async def work(nodes: Nodes) -> None:
        index = await nodes.client.get_namespace_index(CELL)
        path = f'{PATH}/io/fill.lua'
        assert await nodes.call(f'{MACHINE}/rob:LoadByNodeId', expanded(path, NamespaceIndex=index)) == 0
        assert await nodes.call(f'{MACHINE}/rob:UnloadByNodeId', expanded(path, NamespaceUri=CELL)) == 0
        assert await nodes.call(f'{MACHINE}/rob:LoadByName', 'io/fill.lua') == 0
        program = ShownProgram(str(served.programs / 'io' / 'fill.lua'), RunState.OPENED)
        await asyncio.to_thread(served.show, program=program)
        name = await nodes.value(f'{CONTROLLER}/{NAME}')
        assert await nodes.call(f'{MACHINE}/rob:UnloadByName', name) == 0

    served.client(work, **OPERATOR)
    assert served.cell.calls == ['fill.lua', 'lua_program_node/close'] * 2


def test_only_the_program_that_is_loaded_can_be_unloaded_by_its_name(served: Served) -> None:
    async def work(nodes: Nodes) -> None:
        assert await nodes.call(f'{MACHINE}/rob:UnloadByName', 'press.lua') == 1
        await asyncio.to_thread(served.show, program=ShownProgram('/cell/welding.lua', RunState.OPENED))
        assert await nodes.call(f'{MACHINE}/rob:UnloadByName', 'press.lua') == 1
        press = expanded(f'{PATH}/press.lua', NamespaceUri=CELL)
        assert await nodes.call(f'{MACHINE}/rob:UnloadByNodeId', press) == 1
        served.cell.error = NotNowError('the program runs')
        assert await nodes.call(f'{MACHINE}/rob:UnloadByName', 'welding.lua') == 1

    served.client(work, **OPERATOR)
    assert served.cell.calls == []
    assert served.told == [
        "Unload is refused: 'press.lua' is not loaded; none is",
        *["Unload is refused: 'press.lua' is not loaded; 'welding.lua' is"] * 2,
        'Unload is refused: the program runs',
    ]


@pytest.mark.parametrize(
    ('path', 'of'),
    [
        (f'{PATH}/none.lua', {'NamespaceUri': CELL}),
        (f'{PATH}/io', {'NamespaceUri': CELL}),
        (f'{PATH}/io/folder.lua', {'NamespaceUri': CELL}),
        (f'{PATH}/io/fill.yaml', {'NamespaceUri': CELL}),
        (f'{PATH}/press.lua/Size', {'NamespaceUri': CELL}),
        (f'{PATH}/../secret.lua', {'NamespaceUri': CELL}),
        ('MotionDeviceSystem', {'NamespaceUri': CELL}),
        ('press.lua', {'NamespaceUri': CELL}),
        (f'{PATH}/press.lua', {'NamespaceUri': 'urn:other'}),
        (f'{PATH}/press.lua', {'NamespaceUri': CELL, 'ServerIndex': 1}),
        (85, {}),
    ],
)
def test_nodes_that_are_no_programs_are_refused(served: Served, path: Any, of: dict[str, Any]) -> None:
    async def work(nodes: Nodes) -> None:
        for name in ('LoadByNodeId', 'UnloadByNodeId'):
            with pytest.raises(ua.uaerrors.BadInvalidArgument):
                await nodes.call(f'{MACHINE}/rob:{name}', expanded(path, **of))

    served.client(work, **OPERATOR)
    assert served.cell.calls == []


def test_arguments_of_another_type_are_refused(served: Served) -> None:
    async def work(nodes: Nodes) -> None:
        for name, argument in (
            ('LoadByNodeId', f'{PATH}/press.lua'),
            ('UnloadByNodeId', ua.NodeId(f'{PATH}/press.lua', 2)),
            ('UnloadByName', 7),
            ('UnloadByName', 'none.lua'),
        ):
            with pytest.raises(ua.uaerrors.BadInvalidArgument):
                await nodes.call(f'{MACHINE}/rob:{name}', argument)
        with pytest.raises(ua.uaerrors.BadArgumentsMissing):
            await nodes.call(f'{MACHINE}/rob:LoadByNodeId')

    served.client(work, **OPERATOR)
    assert served.cell.calls == []


@pytest.mark.parametrize('who', [{}, {'user': 'scada', 'password': 'secret'}])
def test_users_that_may_only_read_load_nothing(served: Served, who: dict[str, str]) -> None:
    async def work(nodes: Nodes) -> None:
        with pytest.raises(ua.uaerrors.BadUserAccessDenied):
            await nodes.call(f'{MACHINE}/rob:LoadByNodeId', expanded(f'{PATH}/press.lua', NamespaceUri=CELL))

    served.client(work, **who)
    assert served.cell.calls == []


def test_files_are_read_and_not_written(served: Served) -> None:
    async def work(nodes: Nodes) -> None:
        path = f'{PROGRAMS}/press.lua'
        async with UaFile(await nodes.node(path), 'r') as file:
            assert await nodes.value(f'{path}/ua:OpenCount') == 1
            assert await file.read() == TEXT.encode()
            handle = ua.Variant(file._handle, ua.VariantType.UInt32)
            assert await nodes.call(f'{path}/ua:GetPosition', handle) == len(TEXT.encode())
            await nodes.call(f'{path}/ua:SetPosition', handle, ua.Variant(7, ua.VariantType.UInt64))
            some = ua.Variant(3, ua.VariantType.Int32)
            assert await nodes.call(f'{path}/ua:Read', handle, some) == TEXT.encode()[7:10]
            with pytest.raises(ua.uaerrors.BadInvalidArgument):
                await nodes.call(f'{path}/ua:Read', handle, ua.Variant(-1, ua.VariantType.Int32))
            with pytest.raises(ua.uaerrors.BadInvalidArgument):  # that of another file
                await nodes.call(f'{PROGRAMS}/io/fill.lua/ua:Read', handle, some)
            with pytest.raises(ua.uaerrors.BadInvalidState):
                await file.write(b'x')
        assert await nodes.value(f'{path}/ua:OpenCount') == 0
        with pytest.raises(ua.uaerrors.BadInvalidArgument):
            await file.read()
        with pytest.raises(ua.uaerrors.BadNotWritable):
            await UaFile(await nodes.node(path), 'w').open(2)
        with pytest.raises(ua.uaerrors.BadUserAccessDenied):
            await nodes.call(f'{PROGRAMS}/ua:CreateFile', 'new.lua', False)
        with pytest.raises(ua.uaerrors.BadUserAccessDenied):
            await nodes.call(f'{PROGRAMS}/ua:Delete', (await nodes.node(path)).nodeid)

    served.client(work, **OPERATOR)
    assert (served.programs / 'press.lua').read_text() == TEXT


def test_files_that_clients_leave_open_are_closed(served: Served, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(program_nodes, 'MOST_OPEN', 2)

    async def work(nodes: Nodes) -> None:
        files = [UaFile(await nodes.node(f'{PROGRAMS}/press.lua'), 'r') for _ in range(3)]
        for file in files:
            await file.__aenter__()
        assert await nodes.value(f'{PROGRAMS}/press.lua/ua:OpenCount') == 2
        with pytest.raises(ua.uaerrors.BadInvalidArgument):
            await files[0].read()
        assert await files[1].read() == await files[2].read() == TEXT.encode()
        for file in files[1:]:
            await file.close()

    served.client(work, **OPERATOR)


def test_files_come_change_and_go(served: Served) -> None:
    new = served.programs / 'new' / 'weld.lua'

    async def names(nodes: Nodes, path: str) -> set[str]:
        children = await (await nodes.node(path)).get_children(ua.ObjectIds.Organizes)
        return {(await child.read_browse_name()).Name for child in children}

    async def until(nodes: Nodes, path: str, wanted: set[str]) -> None:
        async with asyncio.timeout(DEADLINE):
            while await names(nodes, path) != wanted:
                await asyncio.to_thread(served.show)

    async def work(nodes: Nodes) -> None:
        new.parent.mkdir()
        new.write_text(TEXT)
        await until(nodes, PROGRAMS, {'press.lua', 'io', 'new'})
        assert await names(nodes, f'{PROGRAMS}/new') == {'weld.lua'}
        new.write_text('')
        async with asyncio.timeout(DEADLINE):
            while await nodes.value(f'{PROGRAMS}/new/weld.lua/ua:Size'):
                await asyncio.to_thread(served.show)
        new.unlink()
        new.parent.rmdir()
        await until(nodes, PROGRAMS, {'press.lua', 'io'})
        new.parent.mkdir()
        new.write_text(TEXT)
        await until(nodes, PROGRAMS, {'press.lua', 'io', 'new'})
        assert await nodes.value(f'{PROGRAMS}/new/weld.lua/ua:Size') == len(TEXT.encode())

    served.client(work)
