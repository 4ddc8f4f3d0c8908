"""RunState: what a robot program does, and what ends it."""

from robots_core.wording.named_choice import NamedChoice


class RunState(NamedChoice):
    """What the program does."""

    IDLE = 'IDLE'  # none is open
    OPENED = 'OPENED'
    RUNNING = 'RUNNING'
    PAUSED = 'PAUSED'
    STOPPED = 'STOPPED'
    FINISHED = 'FINISHED'
    FAILED = 'FAILED'


class ProgramStopped(BaseException):
    """Raised in the program's thread wherever it waits, once it shall stop; not an error."""
