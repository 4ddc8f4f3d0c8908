"""What is created to stay, without a collector that looks through it again and again."""

import gc
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

MANY: Final = 20_000  # objects, which the collector looks through in some milliseconds


@contextmanager
def garbage_kept() -> Iterator[None]:
    """Collect no garbage while much is created that stays."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            if gc.get_count()[0] > MANY:
                _let_new_objects_be_old()
            gc.enable()


def _let_new_objects_be_old() -> None:
    """Spare the collector to look through what is new."""
    # All that is frozen is counted one by one: 50 ms in a process that has frozen what it has loaded.
    frozen = gc.get_freeze_count() > 0
    gc.freeze()
    if not frozen:
        gc.unfreeze()
