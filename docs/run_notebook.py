"""Run the cells of a notebook, and store what they print and draw in it. Needs no Jupyter.

Run by `make notebook`.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import json
from base64 import b64encode
from pathlib import Path
from typing import Any, Final

import matplotlib as mpl
from matplotlib import pyplot as plt

DPI: Final = 70


def main() -> None:
    """Run the notebooks of the command line, and write them with their outputs."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('notebook', type=Path, nargs='+')
    for path in parser.parse_args().notebook:
        notebook = run_notebook(path)
        path.write_text(json.dumps(notebook, indent=1, ensure_ascii=False) + '\n', encoding='utf-8')
        print(f'{path}: {path.stat().st_size / 1024:.0f} kB')


def run_notebook(path: Path) -> dict[str, Any]:
    """The notebook with new outputs; an exception in a cell is raised."""
    mpl.use('agg')
    notebook: dict[str, Any] = json.loads(path.read_text(encoding='utf-8'))
    names: dict[str, Any] = {'__name__': '__main__'}
    count = 0
    for cell in notebook['cells']:
        if cell['cell_type'] != 'code':
            continue
        count += 1
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile(''.join(cell['source']), f'cell {count}', 'exec'), names)  # noqa: S102  # our own
        cell['execution_count'] = count
        cell['outputs'] = [*_texts(printed.getvalue()), *_pictures()]
    return notebook


def _texts(printed: str) -> list[dict[str, Any]]:
    lines = printed.splitlines(keepends=True)
    return [{'output_type': 'stream', 'name': 'stdout', 'text': lines}] if lines else []


def _pictures() -> list[dict[str, Any]]:
    found = []
    for number in plt.get_fignums():
        picture = io.BytesIO()
        plt.figure(number).savefig(picture, dpi=DPI)
        data = {'image/png': b64encode(picture.getvalue()).decode(), 'text/plain': ['<Figure>']}
        found.append({'output_type': 'display_data', 'metadata': {}, 'data': data})
    plt.close('all')
    return found


if __name__ == '__main__':
    main()
