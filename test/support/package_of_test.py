"""The package that a test belongs to: `colcon test` runs the tests of each package with it."""

import re
from pathlib import Path
from typing import Final

PACKAGES: Final = ('robots_core', 'robots_models', 'robots_planning', 'robots_controller')
"""Each imports those before it."""
FOLDERS: Final = {'contract': 'robots_models'} | dict.fromkeys(
    ('bag', 'cell', 'endurance', 'page'), 'robots_controller'
)
"""Packages of tests whose imports do not say what they test: the installed robots, and whole cells."""
IMPORTS: Final = re.compile(r'^\s*(?:from|import) (robots_\w+)', re.MULTILINE)


def package_of_test(path: Path) -> str:
    """The last package that a file of tests imports.

    Args:
        path: In a folder of test/.
    """
    if path.parent.name in FOLDERS:
        return FOLDERS[path.parent.name]
    imported = set(IMPORTS.findall(path.read_text(encoding='utf-8')))
    return max(imported & set(PACKAGES), key=PACKAGES.index, default=PACKAGES[-1])
