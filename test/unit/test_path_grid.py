"""The grid along a path on which a speed profile is made."""

from __future__ import annotations

import numpy as np
import pytest

from robots_planning.paths.path_grid import (
    POINTS,
    SPLIT,
    TURN_POINTS,
    finer_grid,
    path_grid,
    with_places,
)

NODES = np.linspace(0.0, 1.0, 401)


def times_at_rest(distance: np.ndarray) -> np.ndarray:
    """Part of the time at a part of the distance, for acceleration to the middle and braking from there."""
    near = np.sqrt(0.5 * np.minimum(distance, 1.0 - distance))
    return np.where(distance < 0.5, near, 1.0 - near)


def test_it_goes_from_end_to_end() -> None:
    grid = path_grid(NODES + 2.0, 7.0 * NODES, np.zeros_like(NODES))
    assert (grid[0], grid[-1]) == (2.0, 3.0)
    assert (np.diff(grid) > 0.0).all()
    assert POINTS <= len(grid) <= POINTS + 10


def test_from_and_to_rest_it_is_even_in_time() -> None:
    steps = np.diff(times_at_rest(path_grid(NODES, NODES, np.zeros_like(NODES))))
    # The speed is anything between the highest throughout and the highest in the middle alone.
    assert steps.max() < 4.0 / POINTS
    np.testing.assert_allclose(steps, steps[::-1], rtol=1e-6)


@pytest.mark.parametrize('place', [0.0, 0.3, 1.0])
@pytest.mark.parametrize('width', [0.1, 1e-3, 1e-6])
def test_it_is_finer_where_the_direction_turns_and_grows_gradually(place: float, width: float) -> None:
    side = np.geomspace(1e-3 * width, 1.0, 400)
    nodes = np.unique(np.clip(np.concatenate([place - side, [place], place + side]), 0.0, 1.0))
    turn = np.arctan((nodes - place) / width) + 0.5 * np.pi
    grid = path_grid(nodes, nodes, turn)
    straight = path_grid(NODES, NODES, np.zeros_like(NODES))
    assert len(grid) > len(straight) + 0.9 * TURN_POINTS * (turn[-1] - turn[0])
    spacing = np.diff(grid)
    inner = spacing[4:-4]  # the outermost are split
    growth = inner[1:] / inner[:-1]
    # Both the intervals of time and those of distance grow gradually.
    assert max(growth.max(), 1.0 / growth.min()) < 2.0


def test_a_path_that_does_not_move_has_one_too() -> None:
    assert np.isfinite(path_grid(NODES, NODES, np.full_like(NODES, 3.0))).all()


def test_nodes_that_nearly_coincide_are_taken_for_one() -> None:
    nodes = np.concatenate([NODES[:200], NODES[199] + np.array([1e-14, 2e-14]), NODES[200:]])
    turn = np.linspace(0.0, 1e-6, len(nodes))
    straight = path_grid(NODES, NODES, np.zeros_like(NODES))
    assert abs(len(path_grid(nodes, nodes, turn)) - len(straight)) <= 2


def test_intervals_that_are_too_long_are_split_with_those_beside_them() -> None:
    grid = np.array([0.0, 1.0, 2.0, 4.0, 5.0, 6.0, 7.0])
    finer = finer_grid(grid, np.array([2.5, 3.9]))
    between = [1.25, 1.5, 1.75, 2.5, 3.0, 3.5, 4.25, 4.5, 4.75]
    np.testing.assert_array_equal(finer, np.sort([*grid, *between]))
    np.testing.assert_array_equal(finer_grid(grid, np.array([])), grid)


@pytest.mark.parametrize('place', [0.0, 1e-9, 6.9, 7.0])
def test_outermost_intervals_are_split_too(place: float) -> None:
    grid = np.arange(8.0)
    finer = finer_grid(grid, np.array([place]))
    assert (finer[0], finer[-1]) == (0.0, 7.0)
    assert len(finer) == len(grid) + 2 * (SPLIT - 1)


def test_places_are_points_of_the_grid_and_replace_those_that_nearly_coincide() -> None:
    grid = np.array([0.0, 0.1, 0.5, 1.0])
    np.testing.assert_array_equal(with_places(grid, np.array([0.3])), [0.0, 0.1, 0.3, 0.5, 1.0])
    np.testing.assert_array_equal(with_places(grid, np.array([0.11, 0.49])), [0.0, 0.11, 0.49, 1.0])
    np.testing.assert_array_equal(
        with_places(grid, np.array([0.01, 0.5, 0.99])), [0.0, 0.01, 0.1, 0.5, 0.99, 1.0]
    )
    np.testing.assert_array_equal(with_places(grid, np.empty(0)), grid)
