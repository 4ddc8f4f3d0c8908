"""Counts generated cases in the file that COUNTED_CASES names: what `make fuzz` says it has tried."""

import os
from collections import Counter
from pathlib import Path
from typing import Final

FILE: Final = 'COUNTED_CASES'


def count_cases(kind: str, number: int = 1) -> None:
    """Add some cases, if anybody counts; from any process."""
    path = os.environ.get(FILE)
    if path:
        with Path(path).open('a', encoding='utf-8') as file:  # short lines are appended whole
            file.write(f'{number} {kind}\n')


def counted_cases(path: Path) -> Counter[str]:
    """How many of each kind there were."""
    found: Counter[str] = Counter()
    for line in path.read_text(encoding='utf-8').splitlines() if path.exists() else ():
        number, _, kind = line.partition(' ')
        found[kind] += int(number)
    return found
