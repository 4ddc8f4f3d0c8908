"""Substitutions: what a URDF lacks, and what is taken in its place."""

from robots_core.errors import InvalidInputError, UnknownRobotError


class Substitutions:
    """Collects what was substituted, one sentence each.

    Args:
        strict: Refuse whatever is lacking.

    Raises:
        InvalidInputError: `strict` is no truth value.
    """

    def __init__(self, *, strict: bool) -> None:
        if not isinstance(strict, bool):
            raise InvalidInputError(f'strict = {strict!r} must be true or false')
        self.strict = strict
        self._sentences: list[str] = []

    @property
    def sentences(self) -> tuple[str, ...]:
        """What was substituted so far."""
        return tuple(self._sentences)

    def refuse(self, lacking: str) -> None:
        """Refuse what is lacking, where nothing may be substituted.

        Raises:
            UnknownRobotError: it is strict.
        """
        if self.strict:
            raise UnknownRobotError(lacking)

    def add(self, lacking: str, taken: str) -> None:
        """Note a substitution.

        Args:
            lacking: What the files lack, and what would be valid.
            taken: What is taken in its place.

        Raises:
            UnknownRobotError: it is strict.
        """
        self.refuse(lacking)
        self._sentences.append(f'{lacking}; taken in its place: {taken}')
