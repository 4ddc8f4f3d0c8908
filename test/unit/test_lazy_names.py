"""Packages export their names without loading modules that are not used."""

from __future__ import annotations

import sys
from functools import cache
from importlib import import_module
from importlib.metadata import entry_points
from pathlib import Path
from pkgutil import walk_packages
from subprocess import run
from types import ModuleType

import pytest

import robots_core
import robots_core.blocks
import robots_planning

WELDING = Path(__file__).parents[2] / 'programs' / 'welding.lua'
PACKAGES = (robots_core, robots_core.blocks, robots_planning)
# Reading meshes, SciPy and compiled functions take most of the time that a process needs to start.
MESHES = ('trimesh', 'yourdfpy', 'networkx')
SCIPY = ('scipy.spatial', 'scipy.linalg', 'scipy.interpolate')
COMPILER = ('numba',)
VIEW = ('viser',)
LUA = ('lupa',)
PLANT = ('asyncua', 'pymodbus', 'paho')
HEAVY = (*MESHES, *SCIPY, *COMPILER, *VIEW, *LUA, *PLANT)


@pytest.mark.parametrize('package', PACKAGES, ids=lambda package: package.__name__)
def test_every_name_is_what_its_module_defines(package: ModuleType):
    for module in walk_packages(package.__path__, f'{package.__name__}.'):
        if '.nodes' not in module.name:
            import_module(module.name)
    assert set(package.__all__) <= set(dir(package))
    for name in package.__all__:
        assert not isinstance(getattr(package, name), ModuleType), name


def test_a_name_that_no_module_has_is_refused():
    with pytest.raises(ImportError, match='NoBlock'):
        from robots_core.blocks import NoBlock  # noqa: F401, PLC0415


# By what they do not need. Those of one line are imported by one process, one after the other.
LEAN: dict[tuple[str, ...], tuple[str, ...]] = {
    (*HEAVY, 'numpy', 'pinocchio'): ('robots_core',),
    HEAVY: (
        'robots_core.nodes.drive_node',
        'robots_core.nodes.direct_kinematics_node',
        'robots_core.nodes.robot_state_node',
        'robots_core.nodes.hardware_node',
        'robots_controller.nodes.io_bridge_node',
        'robots_controller.nodes.plc_node',
        'robots_controller.nodes.force_control_node',
        'robots_controller.nodes.wheel_soil_node',
    ),
    (*MESHES, *SCIPY, *VIEW, *LUA, 'coverage'): (
        'robots_core.kernels.compiled',
        'robots_core.nodes.inverse_kinematics_node',
        'robots_core.nodes.dynamics_node',
        'robots_controller.nodes.controller_node',
        'robots_controller.nodes.guide_player_node',
        'robots_controller.nodes.opcua_node',
        'robots_core.nodes.collision_node',
        'robots_planning.nodes.planning_node',
    ),
    (*MESHES, *SCIPY, *VIEW): (
        'robots_controller.nodes.lua_program_node',
        'robots_controller.live_cell.cell_command',
        'robots_controller.simulation.command_line',
    ),
    (*LUA, *COMPILER): ('robots_core.nodes.visualizer_node',),
    (*VIEW, *PLANT): ('robots_controller.nodes.pendant_node',),
    (*MESHES, *VIEW, *LUA, *PLANT): ('robots_core.nodes.motion_cueing_node',),
}


def printed(program: str) -> list[str]:
    """What a process of its own prints, by words."""
    done = run([sys.executable, '-P', '-c', program], capture_output=True, text=True, check=True)
    return done.stdout.split()


@cache
def loaded(unneeded: tuple[str, ...]) -> dict[str, list[str]]:
    """Which of the modules that `LEAN` does not let them load were there after each import."""
    program = (
        'import sys; from importlib import import_module\n'
        f'for name in {LEAN[unneeded]!r}:\n'
        '    import_module(name)\n'
        f'    print(name, *sorted(set({unneeded!r}) & set(sys.modules)))'
    )
    done = run([sys.executable, '-P', '-c', program], capture_output=True, text=True, check=True)
    return {name: found for name, *found in map(str.split, done.stdout.splitlines())}


@pytest.mark.parametrize(
    ('module', 'unneeded'), [(module, unneeded) for unneeded in LEAN for module in LEAN[unneeded]]
)
def test_a_process_loads_nothing_that_it_does_not_need(module: str, unneeded: tuple[str, ...]):
    assert loaded(unneeded)[module] == []


def test_every_node_has_its_list():
    nodes = {
        point.module
        for point in entry_points(group='console_scripts')
        if point.name.endswith('_node') and point.value.startswith('robots_')
    }
    assert nodes <= {module for modules in LEAN.values() for module in modules}


def test_a_robot_with_its_kinematics_and_dynamics_needs_no_meshes_no_scipy_and_no_compiler():
    program = (
        'import sys; from robots_core import load_robot_model; robot = load_robot_model("kuka_kr210_r2700");'
        'robot.direct_kinematics(robot.home); robot.jacobian(robot.home);'
        'robot.rigid_dynamics(robot.home, robot.home, robot.home);'
        f'print(*sorted(set({(*MESHES, *SCIPY, *COMPILER)!r}) & set(sys.modules)))'
    )
    assert printed(program) == []


@pytest.mark.parametrize(
    'planned',
    [
        'LinearCartesianLimited(robot).generate(start, Pose(r + 0.02, T))',
        'SplineCartesian(robot).generate(start, [Pose(r + (0.02, 0.0, 0.0), T), Pose(r + 0.02, T)])',
    ],
    ids=['line', 'spline'],
)
def test_motions_of_the_tool_are_planned_without_scipy(planned: str):
    program = (
        'import sys; from robots_core import Pose, load_robot_model;'
        'from robots_planning import LinearCartesianLimited, SplineCartesian;'
        'robot = load_robot_model("kuka_kr210_r2700"); start = robot.home + 0.1;'
        f'r, T = robot.direct_kinematics(start); {planned};'
        f'print(*sorted(set({(*MESHES, *SCIPY)!r}) & set(sys.modules)))'
    )
    assert printed(program) == []


def test_a_program_is_simulated_and_recorded_without_scipy_and_meshes(tmp_path: Path):
    # What is computed from the meshes is kept from then on.
    printed(
        'from robots_core import load_robot_model; from robots_core.blocks import CollisionDetection;'
        'CollisionDetection(load_robot_model("kuka_kr210_r2700"))'
    )
    program = (
        'import sys; from pathlib import Path; from robots_controller.simulate import simulate;'
        f'bag = Path({str(tmp_path)!r}) / "bag";'
        f'simulate({str(WELDING)!r}, robot="kuka_kr210_r2700", bag=bag);'
        f'print(*sorted(set({(*MESHES, *SCIPY)!r}) & set(sys.modules)))'
    )
    assert printed(program) == []


def test_garbage_is_collected_after_numba_is_loaded_as_before():
    program = (
        'import gc; {}; before = gc.isenabled(); import robots_core.kernels.compiled;'
        'print(before == gc.isenabled())'
    )
    for choice in ('gc.enable()', 'gc.disable()'):
        assert printed(program.format(choice)) == ['True']


def test_scipy_and_numba_have_their_linear_algebra_all_the_same():
    program = (
        'import numba, numpy as np, robots_core.kernels.compiled, scipy.linalg;'
        'from scipy.linalg import cython_blas, cython_lapack;'
        'A = np.array([[2.0, 1.0], [1.0, 3.0]]); b = np.ones(2);'
        'solve = numba.njit(lambda A, b: np.dot(np.linalg.inv(A), b) + np.dot(A, b));'
        'print(np.allclose(solve(A, b), scipy.linalg.solve(A, b) + A @ b));'
        'print("dgemm" in cython_blas.__pyx_capi__, "dgesdd" in cython_lapack.__pyx_capi__)'
    )
    assert printed(program) == ['True'] * 3
