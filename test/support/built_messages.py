"""Packages of messages and actions that the wheels of ROS 2 lack, built from definitions of the tests."""

from __future__ import annotations

import json
import subprocess
import sysconfig
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final

import numpy as np
import std_msgs  # noqa: TID251  # for its place

LIBRARIES: Final = (
    *('rosidl_runtime_c', 'rosidl_typesupport_c', 'rosidl_typesupport_fastrtps_c'),
    *('rosidl_typesupport_introspection_c', 'rcutils'),
)
SUPPORT: Final = 'rosidl_typesupport_fastrtps_c'
INTROSPECTION: Final = 'rosidl_typesupport_introspection_c'
HEADERS: Final = ('rosidl_generator_c', SUPPORT, INTROSPECTION)
"""Generators with a header for the visibility of symbols."""


def build_messages(
    folder: Path,
    package: str,
    messages: Mapping[str, str],
    uses: tuple[str, ...],
    actions: Mapping[str, str] = MappingProxyType({}),
) -> Path:
    """Build a package of messages and actions.

    Args:
        folder: An empty one.
        package: Its name.
        messages: Definitions, as in .msg files, by name.
        uses: Packages whose messages they have, and those that these have in turn.
        actions: Definitions, as in .action files, by name.

    Returns:
        The folder to import the package from.
    """
    prefix = Path(std_msgs.__file__).parents[4]  # of the wheels, and of ROS
    idl, made = folder / 'idl', folder / 'made' / package
    kinds = {'msg': messages, 'action': actions}
    for kind, definitions in kinds.items():
        _write_idl(idl, package, kind, definitions)
    names = [f'{kind}/{name}' for kind, definitions in kinds.items() for name in definitions]
    arguments = {
        'package_name': package,
        'output_dir': str(made),
        'idl_tuples': [f'{idl}:{name}.idl' for name in names],
        'ros_interface_dependencies': [],
        'target_dependencies': [],
        'include_paths': [f'{one}:{prefix}/share/{one}' for one in uses],
        'type_description_tuples': [f'{name}.idl:{made}/{name}.json' for name in names],
    }
    _generate(folder, prefix, arguments)
    _compile(prefix, made, package, uses)
    return made.parent


def _write_idl(idl: Path, package: str, kind: str, definitions: Mapping[str, str]) -> None:
    from rosidl_adapter.action import convert_action_to_idl  # noqa: PLC0415  # not where ROS is missing
    from rosidl_adapter.msg import convert_msg_to_idl  # noqa: PLC0415

    convert = convert_msg_to_idl if kind == 'msg' else convert_action_to_idl
    for name, text in definitions.items():
        source = Path(kind) / f'{name}.{kind}'
        (idl / kind).mkdir(parents=True, exist_ok=True)
        (idl / source).write_text(text)
        convert(idl, package, source, idl / kind)


def _generate(folder: Path, prefix: Path, arguments: dict[str, Any]) -> None:
    from rosidl_generator_c import generate_c  # noqa: PLC0415
    from rosidl_generator_py import generate_py  # noqa: PLC0415
    from rosidl_generator_type_description import generate_type_hash  # noqa: PLC0415
    from rosidl_typesupport_c import generate_c as generate_support  # noqa: PLC0415
    from rosidl_typesupport_fastrtps_c import generate_typesupport_fastrtps_c  # noqa: PLC0415
    from rosidl_typesupport_introspection_c import generate_c as generate_introspection  # noqa: PLC0415

    package, made = arguments['package_name'], Path(arguments['output_dir'])

    def written(generator: str, **more: str) -> str:
        path = folder / f'{generator}.json'
        template = {'template_dir': f'{prefix}/share/{generator}/resource'}
        path.write_text(json.dumps({**arguments, **template, **more}))
        return str(path)

    generate_type_hash(written('rosidl_generator_type_description'))
    generate_c(written('rosidl_generator_c'))
    generate_typesupport_fastrtps_c(written(SUPPORT))
    # Some of its files have the names of others.
    generate_introspection(written(INTROSPECTION, output_dir=str(folder / INTROSPECTION / package)))
    generate_support(written('rosidl_typesupport_c'), [SUPPORT, INTROSPECTION])
    generate_py(written('rosidl_generator_py'), ['rosidl_typesupport_c'])
    (made / '__init__.py').write_text('')
    for generator in HEADERS:
        name = f'{generator}__visibility_control.h'
        text = (prefix / 'share' / generator / 'resource' / f'{name}.in').read_text()
        text = text.replace('@PROJECT_NAME_UPPER@', package.upper()).replace('@PROJECT_NAME@', package)
        (made / 'msg').mkdir(exist_ok=True)
        (made / 'msg' / name).write_text(text)


def _compile(prefix: Path, made: Path, package: str, uses: tuple[str, ...]) -> None:
    """The libraries that the middleware asks for by name, and the module of Python that needs them."""
    folders = (
        made.parent,
        made.parent.parent / INTROSPECTION,
        sysconfig.get_path('include'),
        np.get_include(),
    )
    flags = [f'-I{path}' for path in folders]
    flags += [f'-I{path}' for path in (prefix / 'include', *(prefix / 'include').iterdir())]
    flags += ['-fPIC', '-O0', '-w']
    common = [f'-L{prefix}/lib', f'-L{made}', f'-Wl,-rpath,{prefix}/lib', '-Wl,-rpath,$ORIGIN']
    common += [f'-l{one}' for one in (*LIBRARIES, 'fastcdr')]

    def link(name: str, sources: list[Path], libraries: list[str]) -> None:
        # Sources in C++ at once: their headers take most of the time. Those in C have names in common.
        whole = made / f'{name}.cpp'
        whole.write_text(''.join(f'#include "{one}"\n' for one in sources if one.suffix == '.cpp'))
        objects = []
        for source in (*(one for one in sources if one.suffix == '.c'), whole):
            objects.append(source.with_suffix(f'{source.suffix}.o'))
            compiler = ['gcc'] if source.suffix == '.c' else ['g++', '-std=c++17']
            subprocess.run([*compiler, *flags, '-c', source, '-o', objects[-1]], check=True)
        options = ['-shared', '-Wl,--no-as-needed', f'-Wl,-soname,{name}', '-o', made / name]
        subprocess.run(['g++', *options, *objects, *(f'-l{one}' for one in libraries), *common], check=True)

    def of(kind: str) -> list[str]:
        return [f'{one}__{kind}' for one in uses]

    described, fast = f'{package}__{INTROSPECTION}', f'{package}__{SUPPORT}'
    link(
        f'lib{fast}.so',
        [*made.glob('*/detail/*.c'), *made.glob('*/detail/*.cpp')],
        [*of('rosidl_generator_c'), *of(SUPPORT)],
    )
    link(
        f'lib{described}.so',
        list((made.parent.parent / INTROSPECTION).rglob('*.c')),
        [fast, *of(INTROSPECTION)],
    )
    link(
        f'{package}_s__rosidl_typesupport_c.so',
        [*made.glob('*rosidl_typesupport_c.c'), *made.glob('*/*.c'), *made.glob('*/*.cpp')],
        [fast, described, *of('rosidl_typesupport_c'), *of('rosidl_generator_py')],
    )
