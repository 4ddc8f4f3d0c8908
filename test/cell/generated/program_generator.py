"""Random robot programs: motions, blends, tools, bases, speeds, outputs on the path, inputs, interrupts."""

import random
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from robots_core import load_robot_model

# Where programs start, deg or m, and how far motions lead away from there, m.
STARTS: Final = {
    'kuka_kr210_r2700': ((0, -90, 90, 0, 60, 0), 0.4),
    'ur5e': ((10, -80, 90, -70, -80, 15), 0.12),
    'staubli_tx2_90': ((10, 20, 70, 10, 60, 0), 0.15),
    'bello_bot': ((10, 30, 10, 70, 10, 40, 0), 0.1),
    'cello_bot': ((0.2, -45, 80, 10, 20), 0.1),
    'debris_arm': ((0, 30, 80), 0.4),
}
ANCHORS: Final = ('distance_before_end', 'distance_after_start', 'time_before_end', 'time_after_start')
FIRST_ON_PATH: Final = 11  # outputs from here on are switched on paths, each once
INTERRUPTED: Final = 9  # the input whose handler the program may have, and the output that it switches


@dataclass(frozen=True)
class GeneratedProgram:
    """A program and the PLC that it works with.

    Attributes:
        seed: What it was made from.
        robot: The robot's name.
        text: The program.
        io: The PLC's script; '' for none.
        impossible: Its last motion cannot be done.
    """

    seed: int
    robot: str
    text: str
    io: str
    impossible: bool

    def write(self, folder: Path) -> Path:
        """Write program and script into a folder; returns the program's path."""
        path = folder / f'generated_{self.seed}.lua'
        header = f'-- Robot: {self.robot}'
        if self.io:
            (folder / f'generated_{self.seed}.yaml').write_text(self.io)
            header += f'  IO: generated_{self.seed}.yaml'
        path.write_text(f'{header}\n{self.text}')
        return path


@dataclass
class _Writer:
    rng: random.Random
    reach: float
    num_axes: int
    lines: list[str] = field(default_factory=list)
    rules: list[str] = field(default_factory=list)
    tool: int = 0
    tools: int = 1
    output: int = FIRST_ON_PATH - 1
    asked: int = 0
    chained: bool = False

    def number(self, low: float, high: float) -> str:
        return f'{self.rng.uniform(low, high):.4g}'

    def say(self, line: str) -> None:
        self.lines.append(line)


def generate(seed: int) -> GeneratedProgram:
    """The program of a seed; always the same."""
    rng = random.Random(seed)  # noqa: S311  # no secret
    robot = rng.choice(sorted(STARTS))
    start, reach = STARTS[robot]
    writer = _Writer(rng, reach, load_robot_model(robot).num_axes)
    _begin(writer, start)
    if rng.random() < 0.4:
        _interrupt(writer)
    for _ in range(rng.randint(2, 5)):
        rng.choice([_chain, _chain, _chain, _settings, _inputs, _outputs, _joints])(writer)
    impossible = rng.random() < 0.1
    if impossible:
        writer.say('ptpCartesianSpace(at(50, 0, 0, 0, 0, 0))')
    rules = ''.join(f'  - {rule}\n' for rule in writer.rules)
    return GeneratedProgram(
        seed, robot, '\n'.join(writer.lines) + '\n', f'rules:\n{rules}' if rules else '', impossible
    )


def _begin(writer: _Writer, start: tuple[float, ...]) -> None:
    rng = writer.rng
    values = ', '.join(f'{value:g}' for value in start)
    writer.say(f'ptpJointSpaceAngles({values})')
    if rng.random() < 0.3:
        frame = ', '.join(writer.number(-0.5, 0.5) for _ in range(3))
        writer.say(f'setBase({frame}, {writer.number(-40, 40)}, 0, {writer.number(-40, 40)})')
    if writer.num_axes < 6 and rng.random() < 0.5:
        writer.say("setHold('position')")
    writer.say('local places = {getCartesianPosition()}')
    for index in range(2, rng.randint(1, 3) + 1):
        writer.tools = index
        writer.say(_tool(writer, index))
        writer.say(f'places[{index}] = getCartesianPosition()')
    writer.say('local tool = 1')
    writer.say('setTool(0, 0, 0, 0, 0, 0)')
    writer.say('local function at(x, y, z, a, b, c)')
    writer.say('  local p = places[tool]')
    writer.say('  return {p[1] + x, p[2] + y, p[3] + z, p[4] + a, p[5] + b, p[6] + c}')
    writer.say('end')


def _tool(writer: _Writer, index: int) -> str:
    del index
    offset = ', '.join(writer.number(-0.1, 0.2) for _ in range(3))
    angles = ', '.join(writer.number(-30, 30) for _ in range(3))
    return f'setTool({offset}, {angles})'


def _place(writer: _Writer) -> str:
    reach = writer.reach
    angle = 12.0 if writer.rng.random() < 0.6 else 0.0
    way = [writer.number(-reach, reach) for _ in range(3)]
    turn = [writer.number(-angle, angle) for _ in range(3)]
    return f'at({", ".join([*way, *turn])})'


def _switch(writer: _Writer) -> str:
    rng, reach = writer.rng, writer.reach
    writer.output += 1
    anchor = rng.choice(
        ['distance_before_end', 'distance_after_start', 'time_before_end', 'time_after_start']
    )
    at = writer.number(0.0, reach) if anchor.startswith('distance') else writer.number(0.0, 0.5)
    return f'{{{anchor} = {at}, output = {writer.output}, value = 1}}'


def _options(writer: _Writer, *, last: bool, joint: bool = False) -> str:
    rng = writer.rng
    options = []
    if not last and rng.random() < 0.75:
        name = 'jointBlend' if joint else 'blend'
        zone = writer.number(1.0, 10.0) if joint else writer.number(0.05 * writer.reach, 0.4 * writer.reach)
        options.append(f'{name} = {zone}')
    if writer.output < 32 and rng.random() < 0.5:
        switches = [_switch(writer) for _ in range(min(rng.randint(1, 2), 32 - writer.output))]
        options.append(f'on_path = {{{", ".join(switches)}}}')
    return f'{{{", ".join(options)}}}' if options else ''


def _chain(writer: _Writer) -> None:
    rng, count = writer.rng, writer.rng.randint(1, 5)
    for index in range(count):
        last = index == count - 1
        if rng.random() < 0.2:
            _change(writer)
        kind = rng.choice(['line', 'line', 'line', 'arc', 'spline', 'joint', 'pose', 'relative'])
        options = _options(writer, last=last, joint=kind in {'joint', 'pose'})
        arguments = f', {options}' if options else ''
        if kind == 'line':
            writer.say(f'ptpCartesianSpace({_place(writer)}{arguments})')
        elif kind == 'arc':
            writer.say(f'circCartesianSpace({_place(writer)}, {_place(writer)}{arguments})')
        elif kind == 'spline':
            poses = ', '.join(_place(writer) for _ in range(rng.randint(1, 3)))
            writer.say(f'splineCartesianSpace({poses}{arguments})')
        elif kind == 'pose':
            writer.say(f'ptpJointSpacePosition({_place(writer)}{arguments})')
        elif kind == 'joint':
            way = ', '.join(writer.number(-6, 6) if i else '0' for i in range(writer.num_axes))
            writer.say(f'ptpJointSpaceAnglesRelative({way}{arguments})')
        else:
            way = ', '.join(writer.number(-0.3 * writer.reach, 0.3 * writer.reach) for _ in range(3))
            frame = rng.choice(['', ", 'tool'", ", 'base'"])
            writer.say(f'linearRelative({way}, 0, 0, 0{frame}{arguments})')


def _change(writer: _Writer) -> None:
    """What holds for the next motion, in a chain too."""
    rng = writer.rng
    what = rng.randint(0, 3)
    if what == 0:
        writer.say(f'setSpeed({writer.number(0.2, 1)}, {writer.number(0.1, 1.5)}, {writer.number(20, 200)})')
    elif what == 1:
        writer.say(f'setAcceleration({writer.number(0.3, 1)}, {writer.number(0.5, 4)})')
    elif what == 2 and writer.tools > 1:
        writer.say('setTool(0, 0, 0, 0, 0, 0) tool = 1')
    else:
        writer.say(f'setDigitalOutput(1, {rng.randint(0, 1)})')


def _settings(writer: _Writer) -> None:
    rng = writer.rng
    what = rng.randint(0, 3)
    if what == 0:
        writer.say(f'setJerkLimited({rng.choice(["true", "false"])})')
    elif what == 1:
        cartesian = rng.choice(['limited', 'dynamic_programming'])
        writer.say(f"setPlanner('{rng.choice(['linear_joint', 'linear_joint_axes'])}', '{cartesian}')")
    elif what == 2:
        writer.say(f'setOverride({writer.number(0.3, 1)})')
    else:
        _change(writer)


def _inputs(writer: _Writer) -> None:
    """Ask the PLC for something, and wait for it."""
    writer.asked += 1
    asked = writer.asked
    if asked > 4:
        return
    output, delay = 1 + asked, writer.number(0.05, 1.0)
    writer.rules.append(
        f'{{when: digital_output.{output} rises, after: {delay}, set: {{digital_input.{asked}: 1}}}}'
    )
    writer.say(f'setDigitalOutput({output}, 1)')
    if writer.rng.random() < 0.5:
        _chain(writer)
    writer.say(f'if not waitDigitalInput({asked}, 1, 5) then error("input {asked} did not come") end')


def _outputs(writer: _Writer) -> None:
    rng = writer.rng
    if rng.random() < 0.5:
        writer.say(f'pulseDigitalOutput(7, {writer.number(0.05, 0.6)})')
    else:
        writer.say(f'setAnalogOutput(1, {writer.number(-5, 5)})')
    writer.say(f'wait({writer.number(0, 0.4)})')


def _joints(writer: _Writer) -> None:
    way = ', '.join(writer.number(-15, 15) if i else '0' for i in range(writer.num_axes))
    options = _options(writer, last=True, joint=True)
    writer.say(f'ptpJointSpaceAnglesRelative({way}{", " + options if options else ""})')


def _interrupt(writer: _Writer) -> None:
    rng = writer.rng
    writer.rules.append(
        f'{{when: start, after: {writer.number(0.5, 6)}, set: {{digital_input.{INTERRUPTED}: 1}}}}'
    )
    abort = rng.random() < 0.3
    writer.say(f'onDigitalInput({INTERRUPTED}, true, function()')
    writer.say(f'  setDigitalOutput({INTERRUPTED}, 1)')
    if rng.random() < 0.5:
        writer.say(f'  wait({writer.number(0.05, 0.5)})')
    if abort:
        writer.say("  return 'abort'")
    writer.say('end)')
