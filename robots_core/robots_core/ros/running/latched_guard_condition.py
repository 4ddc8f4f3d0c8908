"""LatchedGuardCondition: a guard condition whose triggers are not lost."""

from typing import Any

from rclpy.guard_condition import GuardCondition


class LatchedGuardCondition(GuardCondition):
    """Keeps that it was triggered until an executor takes it.

    With Fast DDS, a wait that ends resets all guard conditions after it has checked each of them: one that
    is triggered in between has never been triggered (ros2/rmw_fastrtps#895). As such a wait ends anyway,
    `LeanExecutor` takes what was triggered from here.
    """

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)  # type: ignore[no-untyped-call]
        self._triggered = False

    def trigger(self) -> None:
        """As `GuardCondition.trigger`; from any thread."""
        self._triggered = True
        super().trigger()  # type: ignore[no-untyped-call]

    def take(self) -> bool:
        """It was triggered since the last call."""
        if not self._triggered:
            return False
        self._triggered = False
        return True
