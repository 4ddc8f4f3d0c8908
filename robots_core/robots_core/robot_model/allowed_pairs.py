"""AllowedPairs: pairs of a robot's shapes that collision checks omit, with the reasons."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Final

from robots_core.errors import InvalidInputError
from robots_core.files.yaml_section import read_yaml_data

REASONS: Final = {
    'adjacent': 'bodies with one axis between them: its limits keep them apart',
    'always': 'always in contact: the shapes overlap',
    'never': 'proven to be apart for all joint positions inside the limits',
}
Pair = tuple[str, str]


@dataclass(frozen=True, eq=False)
class AllowedPairs:
    """Pairs of shapes that need no check.

    Attributes:
        reasons: For each pair of shape names, in alphabetical order, one of `REASONS`.

    Raises:
        InvalidInputError: an unknown reason.
    """

    reasons: Mapping[Pair, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for pair, reason in self.reasons.items():
            if reason not in REASONS:
                raise InvalidInputError(
                    f'allowed pair {" - ".join(pair)}: unknown reason {reason!r}; reasons are '
                    f'{", ".join(REASONS)}'
                )
        ordered = {ordered_pair(*pair): reason for pair, reason in self.reasons.items()}
        object.__setattr__(self, 'reasons', MappingProxyType(ordered))

    def allows(self, first: str, second: str) -> bool:
        """Whether a pair of shapes, in any order, needs no check."""
        return ordered_pair(first, second) in self.reasons

    @classmethod
    def read(cls, path: Path) -> AllowedPairs:
        """The table of a file made by `write`.

        Raises:
            InvalidInputError: not such a file; names the mistake.
        """
        content = read_yaml_data(path, 'table of allowed pairs')
        if not isinstance(content, dict):
            raise InvalidInputError(f'{path}: expected lists of pairs under {", ".join(REASONS)}')
        reasons: dict[Pair, str] = {}
        for reason, pairs in content.items():
            if not isinstance(pairs or [], list):
                raise InvalidInputError(f'{path}: {reason} must be a list of pairs')
            for pair in pairs or ():
                if not (isinstance(pair, list) and len(pair) == 2):
                    raise InvalidInputError(f'{path}: {reason}: {pair!r} is no pair of shape names')
                reasons[str(pair[0]), str(pair[1])] = str(reason)
        return cls(reasons)

    def write(self, path: Path, header: str) -> None:
        """Write the table as YAML, with a comment before it."""
        lines = [f'# {line}' for line in header.splitlines()]
        for reason, meaning in REASONS.items():
            pairs = sorted(pair for pair, why in self.reasons.items() if why == reason)
            lines += ['', f'# {meaning}', f'{reason}:' + ('' if pairs else ' []')]
            lines += [f'  - [{first}, {second}]' for first, second in pairs]
        path.write_text('\n'.join(lines) + '\n')


def ordered_pair(first: str, second: str) -> Pair:
    """The two names in alphabetical order."""
    return (first, second) if first < second else (second, first)
