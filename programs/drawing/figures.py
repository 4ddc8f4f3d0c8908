"""What the figures of the paper's applications share: how they look, and how they are made of a run."""

from __future__ import annotations

import argparse
import shutil
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

import matplotlib as mpl
import numpy as np
from matplotlib import pyplot as plt
from matplotlib.figure import Figure

COLOURS: Final = ('#2f6fb0', '#e08a2c', '#3d9a5f', '#b5464b', '#7b63a8', '#5b6672', '#2aa5a0')
STYLE: Final[dict[Any, Any]] = {
    'font.size': 10,
    'axes.edgecolor': '#b8bfc7',
    'axes.labelcolor': '#303840',
    'axes.spines.top': False,
    'axes.spines.right': False,
    'axes.grid': True,
    'grid.color': '#e8ebee',
    'xtick.color': '#606a74',
    'ytick.color': '#606a74',
    'lines.linewidth': 1.4,
}
DPI: Final = 100


def plot_parser(application: str, description: str | None) -> argparse.ArgumentParser:
    """Options of a command that draws an application: `--run` and `--folder`."""
    parser = argparse.ArgumentParser(prog=f'{application}.plots', description=description)
    parser.add_argument('--run', type=Path, metavar='BAG', help='recorded run; simulated by default')
    parser.add_argument('--folder', type=Path, default=Path('out') / application, help='of the pictures')
    return parser


def recorded(options: argparse.Namespace, simulate: Callable[[Path], object]) -> Path:
    """The bag that `--run` names; without it, one that `simulate` writes into the folder."""
    options.folder.mkdir(parents=True, exist_ok=True)
    if options.run is not None:
        return Path(options.run)
    bag = Path(options.folder / 'bag')
    shutil.rmtree(bag, ignore_errors=True)
    simulate(bag)
    return bag


@contextmanager
def drawing_style() -> Iterator[None]:
    """Figures that are made in this context look alike, and need no screen."""
    mpl.use('agg')
    with plt.rc_context(STYLE):
        yield


def save(figures: Iterable[tuple[str, Figure]], folder: Path) -> None:
    """Write figures by their names, and print the paths."""
    for name, figure in figures:
        path = folder / f'{name}.png'
        figure.savefig(path, dpi=DPI)
        plt.close(figure)
        print(path)


def title_and_legend(figure: Figure, rows: Any, title: str, *, ncols: int) -> None:
    """A title above, and below the legend of the first plot."""
    figure.suptitle(title, x=0.02, ha='left', fontsize=13, weight='bold')
    handles = np.ravel(rows)[0].get_legend_handles_labels()
    figure.legend(*handles, loc='outside lower center', ncols=ncols, frameon=False)
