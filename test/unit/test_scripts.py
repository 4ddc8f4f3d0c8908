"""Scripts that no test runs, as benchmarks, import only what the packages still have."""

from __future__ import annotations

import ast
from importlib import import_module
from pathlib import Path

import pytest

from package_of_test import PACKAGES

ROOT = Path(__file__).parents[2]
SCRIPTS = sorted(
    path
    for folder in ('test/benchmark', 'test/endurance', 'test/page', 'test/bag', 'docs', 'examples')
    for path in (ROOT / folder).glob('*.py')
    if not path.name.startswith('test_')
)


@pytest.mark.parametrize('script', SCRIPTS, ids=lambda path: f'{path.parent.name}/{path.stem}')
def test_a_script_imports_names_that_exist(script: Path) -> None:
    missing = [
        f'{node.lineno}: {node.module}.{name.name}'
        for node in ast.walk(ast.parse(script.read_text(encoding='utf-8')))
        if isinstance(node, ast.ImportFrom) and (node.module or '').partition('.')[0] in PACKAGES
        for name in node.names
        if not exported(str(node.module), name.name)
    ]
    assert not missing


def exported(module: str, name: str) -> bool:
    try:
        return hasattr(import_module(module), name) or bool(import_module(f'{module}.{name}'))
    except ModuleNotFoundError:
        return False
