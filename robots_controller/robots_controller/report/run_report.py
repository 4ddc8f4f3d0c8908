"""RunReport: the analysis of a recorded run, which terminal, page, comparison and study show."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

from robots_controller.recording.motion_record import MotionRecord
from robots_controller.report.clearance import Clearance, clearance
from robots_controller.report.line_times import ACTIVITIES, LineTime, Span, line_times, time_spans
from robots_controller.report.motion_figures import MotionFigures, WorstUse, motion_figures, worst_use
from robots_controller.report.recorded_run import RecordedRun, read_run
from robots_controller.report.run_signals import RunSignals, energy
from robots_core.blocks.collision.scene import Scene
from robots_core.blocks.collision.scene_file import read_scene
from robots_core.validation import Array, read_only


@dataclass(frozen=True, eq=False)
class RunReport:
    """A run and its figures: signals over its time, times by line, figures by motion.

    Without a scene there are no distances.
    """

    run: RecordedRun
    signals: RunSignals
    motions: tuple[MotionFigures, ...]
    clearance: Clearance | None
    scene: Scene | None

    @cached_property
    def spans(self) -> tuple[Span, ...]:
        """What every moment was used for, in order."""
        return time_spans(self.run)

    @cached_property
    def lines(self) -> tuple[LineTime, ...]:
        """Times by line, in the program's order."""
        return line_times(self.run, self.spans)

    @cached_property
    def uses(self) -> Mapping[str, WorstUse]:
        """By limit of `QUANTITIES`, the axis that uses most of it, in motions and between them."""
        return {quantity: worst_use(self.run, use) for quantity, use in self.signals.use.items()}

    @cached_property
    def energy(self) -> Array:
        """Mechanical energy that each axis takes up, (n,) J."""
        return read_only(energy(self.run.time, self.signals.power))

    @cached_property
    def times(self) -> dict[str, float]:
        """Time by activity, s; together the cycle time."""
        return {activity: sum(getattr(line, activity) for line in self.lines) for activity in ACTIVITIES}

    @property
    def moved(self) -> tuple[MotionFigures, ...]:
        """Figures of the motions that began."""
        return tuple(item for item in self.motions if item.motion.moved)

    @property
    def farthest(self) -> MotionFigures | None:
        """The motion on which the tool was farthest from its planned path; None if none began."""
        return max(self.moved, key=lambda item: item.path_deviation, default=None)

    @property
    def ok(self) -> bool:
        """The program finished, every target was reached or passed in its zone, every limit kept."""
        return self.run.finished and all(motion.ok for motion in self.motions)

    @property
    def problems(self) -> tuple[str, ...]:
        """What went wrong: with the bag, in motions, in the program."""
        problems = [self.run.problem]
        problems += [f'line {self.place(m.motion)}: {m.problem}' for m in self.motions if not m.ok]
        return tuple(text for text in dict.fromkeys([*problems, self.run.program_error]) if text)

    def place(self, item: LineTime | MotionRecord) -> str:
        """The line's number, with its file if that is a subprogram; '' for none."""
        if not item.line:
            return ''
        own = item.file in ('', self.run.program_name)
        return str(item.line) if own else f'{Path(item.file).name}:{item.line}'

    @property
    def title(self) -> str:
        """Program and robot."""
        return f'{self.run.program_name or self.run.source} on {self.run.robot.name}'


def run_report(
    bag: Path | str,
    *,
    robot: str = '',
    scene: Path | str | None = None,
    namespace: str = '/',
    source: str = '',
) -> RunReport:
    """Report on a recorded run, live or simulated.

    Args:
        bag: A rosbag2 folder, or one .mcap or .db3 file; what was cut off is read up to the cut.
        robot: The robot's name; by default the one that the bag names.
        scene: YAML file of what stands around the robot; with it, distances are reported.
        namespace: Namespace of the recorded cell.
        source: Where the run comes from, for a person; the bag's path by default.

    Raises:
        RobotsError: not a readable bag, no references in it, an unknown robot, or a scene that is not valid.
    """
    run = read_run(bag, robot=robot, namespace=namespace, source=source)
    signals = RunSignals.of(run)
    surroundings = read_scene(scene) if scene else None
    distances = clearance(run, surroundings) if surroundings is not None else None
    motions = motion_figures(run, signals)
    if distances is not None:
        motions = tuple(
            replace(item, closest=closest) for item, closest in zip(motions, distances.motions, strict=True)
        )
    return RunReport(
        run=run,
        signals=signals,
        motions=motions,
        clearance=distances,
        scene=surroundings,
    )
