"""What is said wherever a stop, a watchdog, an operating mode, a speed limit or a zone is offered."""

from typing import Final

NOT_CERTIFIED: Final = 'no certified safety function'
