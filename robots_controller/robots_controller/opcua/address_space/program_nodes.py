"""ProgramNodes: the folder of robot programs as a directory of files (OPC 10000-20) that clients may read."""

from __future__ import annotations

import asyncio
import stat
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from asyncua import ua

from robots_controller.opcua.address_space.companion_types import Member
from robots_controller.opcua.address_space.instances import Instances, answered, wrong_arguments
from robots_controller.pendant.programs import program_files
from robots_core.errors import InvalidInputError
from robots_core.files.user_file import read_bytes

REFRESH: Final = 2.0
"""How long after a scan of the folder the next one follows, s."""
MOST_SHARE: Final = 50.0
"""A search that takes long is repeated after so many times its own time."""
MOST_OPEN: Final = 100
"""Files open at a time; beyond it the one that was opened first is closed."""
PROPERTIES: Final = (
    Member('ua:Size', 0, 'property', 'ua:UInt64'),
    Member('ua:Writable', 0, 'property', 'ua:Boolean'),
    Member('ua:UserWritable', 0, 'property', 'ua:Boolean'),
    Member('ua:OpenCount', 0, 'property', 'ua:UInt16'),
)
"""Of a file."""
FILE_METHODS: Final = ('Open', 'Close', 'Read', 'Write', 'GetPosition', 'SetPosition')
DIRECTORY_METHODS: Final = ('CreateDirectory', 'CreateFile', 'DeleteFileSystemObject', 'MoveOrCopy')
READ_MODE: Final = 1
_HANDLE: Final = ua.VariantType.UInt32


@dataclass
class _OpenFile:
    """A file as it was when it was opened, and where the client reads next."""

    path: str
    data: bytes
    position: int = 0


class ProgramNodes:
    """Adds a file for each program and a directory for each folder, and follows their changes.

    All files share the methods of their type.
    """

    def __init__(self, instances: Instances, path: str, folder: Path) -> None:
        self._made, self._path, self._folder = instances, path, folder
        self._sizes: dict[str, int] = {}
        """Of programs by name, bytes."""
        self._directories: set[str] = set()
        self._open: dict[int, _OpenFile] = {}
        self._last_handle = 0
        self._due = 0.0
        self._search: asyncio.Task[dict[str, int]] | None = None

    async def build(self) -> None:
        """Add what is there."""
        calls: dict[str, tuple[list[ua.VariantType], Callable[..., Any]]] = {
            'Open': ([ua.VariantType.Byte], self._open_file),
            'Close': ([_HANDLE], self._close),
            'Read': ([_HANDLE, ua.VariantType.Int32], self._read),
            'Write': ([_HANDLE, ua.VariantType.ByteString], self._write),
            'GetPosition': ([_HANDLE], self._get_position),
            'SetPosition': ([_HANDLE, ua.VariantType.UInt64], self._set_position),
        }
        session = self._made.writer.server.iserver.isession
        for name, (kinds, work) in calls.items():
            session.add_method_callback(_method('FileType', name), self._answering(kinds, work))
        for name in DIRECTORY_METHODS:
            session.add_method_callback(_method('FileDirectoryType', name), _deny)
        await self._share(self._path, 'FileDirectoryType', DIRECTORY_METHODS)

    async def update(self) -> None:
        """Look at the folder if it is time to; a search of many files goes on meanwhile."""
        if self._search is not None:
            if self._search.done():
                search, self._search = self._search, None
                await self._show(search.result())
        elif time.monotonic() >= self._due:
            self._search = asyncio.create_task(self._found())

    async def _found(self) -> dict[str, int]:
        began = time.monotonic()
        try:
            found = await asyncio.to_thread(_sizes, self._folder)
        except OSError:  # folders go while they are searched: the next scan finds what is left
            found = self._sizes
        ended = time.monotonic()
        self._due = ended + max(REFRESH, MOST_SHARE * (ended - began))
        return found

    async def _show(self, found: dict[str, int]) -> None:
        for name, size in found.items():
            if name not in self._sizes:
                await self._add(name)
            await self._made.write(f'{self._path}/{name}/Size', size)
        gone = [name for name in self._sizes if name not in found]
        used = {parent for name in found for parent in _parents(name)}
        empty = sorted(self._directories - used, reverse=True)
        self._sizes, self._directories = found, used
        for name in (*gone, *empty):
            await self._made.delete(f'{self._path}/{name}')

    def program(self, given: ua.NodeId) -> str:
        """The name of the program that a node is, in the folder.

        Raises:
            InvalidInputError: it is none.
        """
        node = self._made.writer.own_node(given)
        prefix = f'{self._path}/'
        name = str(node.Identifier).removeprefix(prefix) if node is not None else ''
        if name not in self._sizes or node != self._made.id(prefix + name):
            raise InvalidInputError(
                f'{given.to_string()} is no program; valid are the files below {self._path}'
            )
        return name

    async def _add(self, name: str) -> None:
        made = self._made
        for parent in _parents(name):
            if parent not in self._directories:
                self._directories.add(parent)
                path = await self._add_object(parent, 'FileDirectoryType')
                await self._share(path, 'FileDirectoryType', DIRECTORY_METHODS)
        path = await self._add_object(name, 'FileType')
        await self._share(path, 'FileType', FILE_METHODS)
        for member in PROPERTIES:
            await made.add_variable(f'{path}/{member.name.removeprefix("ua:")}', member)
        await made.write_all(path, {'Writable': False, 'UserWritable': False, 'OpenCount': 0})

    async def _add_object(self, name: str, kind: str) -> str:
        path = f'{self._path}/{name}'
        await self._made.add(path, f'ua:{kind}', reference='ua:Organizes')
        return path

    async def _share(self, path: str, kind: str, methods: tuple[str, ...]) -> None:
        node = self._made.writer.server.get_node(self._made.id(path))
        for name in methods:
            await node.add_reference(_method(kind, name), ua.ObjectIds.HasComponent, bidirectional=False)

    # -- methods of files -----------------------------------------------------------------------------

    def _answering(self, kinds: list[ua.VariantType], work: Callable[..., Any]) -> Callable[..., Any]:
        async def answer(node: ua.NodeId, *given: ua.Variant) -> Any:
            wrong = wrong_arguments(kinds, given)
            if wrong is not None:
                return wrong
            if kinds[0] is not _HANDLE:
                return await work(str(node.Identifier), given[0].Value)
            file = self._open.get(given[0].Value)
            if file is None or node != self._made.id(file.path):
                return ua.StatusCode(ua.StatusCodes.BadInvalidArgument)
            return await work(file, *(one.Value for one in given))

        return answer

    async def _open_file(self, path: str, mode: int) -> Any:
        codes = ua.StatusCodes
        name = path.removeprefix(f'{self._path}/')
        if name not in self._sizes:
            return ua.StatusCode(codes.BadNotFound)
        if mode != READ_MODE:
            return ua.StatusCode(codes.BadNotWritable)
        try:
            data = await asyncio.to_thread(read_bytes, self._folder / name, 'program')
        except InvalidInputError:
            return ua.StatusCode(codes.BadNotReadable)
        if len(self._open) >= MOST_OPEN:
            await self._forget(next(iter(self._open)))
        self._last_handle += 1
        self._open[self._last_handle] = _OpenFile(path, data)
        await self._count(path)
        return answered(ua.Variant(self._last_handle, _HANDLE))

    async def _close(self, _file: _OpenFile, handle: int) -> Any:
        await self._forget(handle)
        return answered()

    async def _read(self, file: _OpenFile, _handle: int, length: int) -> Any:
        if length < 0:
            return ua.StatusCode(ua.StatusCodes.BadInvalidArgument)
        part = file.data[file.position : file.position + length]
        file.position += len(part)
        return answered(ua.Variant(part, ua.VariantType.ByteString))

    async def _write(self, _file: _OpenFile, _handle: int, _data: bytes) -> Any:
        return ua.StatusCode(ua.StatusCodes.BadInvalidState)  # it is open for reading

    async def _get_position(self, file: _OpenFile, _handle: int) -> Any:
        return answered(ua.Variant(file.position, ua.VariantType.UInt64))

    async def _set_position(self, file: _OpenFile, _handle: int, position: int) -> Any:
        file.position = min(position, len(file.data))
        return answered()

    async def _forget(self, handle: int) -> None:
        await self._count(self._open.pop(handle).path)

    async def _count(self, path: str) -> None:
        if path.removeprefix(f'{self._path}/') in self._sizes:
            count = sum(file.path == path for file in self._open.values())
            await self._made.write(f'{path}/OpenCount', count)


async def _deny(_node: ua.NodeId, *_given: ua.Variant) -> Any:
    return ua.StatusCode(ua.StatusCodes.BadUserAccessDenied)


def _method(kind: str, name: str) -> ua.NodeId:
    return ua.NodeId(getattr(ua.ObjectIds, f'{kind}_{name}'))


def _parents(name: str) -> list[str]:
    """Folders that a program lies in, the outermost first."""
    return [str(parent) for parent in reversed(Path(name).parents) if parent.name]


def _sizes(folder: Path) -> dict[str, int]:
    sizes = {}
    for name in program_files(folder):
        with suppress(OSError):  # gone meanwhile
            file = (folder / name).stat()
            if stat.S_ISREG(file.st_mode):
                sizes[name] = file.st_size
    return sizes
