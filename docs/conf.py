"""How `make docs` builds the site: the pages as they are on GitHub, and the Python API from docstrings.

Lists of links in the index page become the sidebar, and each name in the tables of `reference/python_*.md` is
followed by its docstring. The pages therefore need no directives, which GitHub would show as code.
"""

from __future__ import annotations

import inspect
import re
from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

from latex2mathml.converter import convert

if TYPE_CHECKING:
    from docutils import nodes
    from sphinx.application import Sphinx
    from sphinx.writers.html5 import HTML5Translator

project = 'Robots'
author = 'The Robots developers'
project_copyright = 'The Robots developers, Apache-2.0'

extensions = ['myst_parser', 'sphinx.ext.autodoc', 'sphinx.ext.napoleon', 'sphinx.ext.viewcode']
root_doc = 'docs/index'
include_patterns = ['docs/*.md', 'docs/*/*.md', 'README.md', 'CONTRIBUTING.md', 'SECURITY.md', 'CHANGELOG.md']
exclude_patterns = ['.venv', '.git', 'build', 'install', 'log', 'out', 'robots_*', 'test']
nitpicky = False

myst_enable_extensions = ['dollarmath']
myst_heading_anchors = 4
suppress_warnings = ['myst.header']

autodoc_default_options = {'members': True}
autodoc_member_order = 'bysource'
autodoc_typehints = 'signature'
autodoc_class_signature = 'separated'
napoleon_use_ivar = True
python_use_unqualified_type_names = True
default_role = 'code'
add_module_names = False

html_theme = 'furo'
html_title = 'Robots'
html_show_sphinx = False
html_math_renderer = 'mathml'

INDEX: Final = 'docs/index'
API: Final = 'docs/reference/python_'


def add_directives(_app: Sphinx, page: str, source: list[str]) -> None:
    """Add to a page what the site has and GitHub has not."""
    if page == INDEX:
        source[0] += ''.join(
            f'\n```{{toctree}}\n:hidden:\n:caption: {title}\n\n' + '\n'.join(_linked_pages(text)) + '\n```\n'
            for title, text in re.findall(r'^## (.+)\n((?:(?!## ).*\n?)*)', source[0], re.MULTILINE)
        )
    elif page.startswith(API):
        (module,) = re.findall(r'^# `([\w.]+)`', source[0])
        names = re.findall(r'^\| `([\w.]+)` \|', source[0], re.MULTILINE)
        source[0] += '\n## Docstrings\n\n' + ''.join(_documented(f'{module}.{name}') for name in names)


def _linked_pages(text: str) -> list[str]:
    return ['/' + _from_root(target) for target in re.findall(r'\]\(([^)#]+)\.md\)', text)]


def _from_root(target: str) -> str:
    return target.removeprefix('../') if target.startswith('../') else f'docs/{target}'


def _documented(name: str) -> str:
    module, _, attribute = name.rpartition('.')
    kind = 'class' if inspect.isclass(getattr(import_module(module), attribute)) else 'function'
    return f'```{{eval-rst}}\n.. auto{kind}:: {name}\n```\n\n'


class _MathML:
    """Renders equations as MathML, which browsers show without a script from the network."""

    @staticmethod
    def inline(translator: HTML5Translator, node: nodes.math) -> None:
        translator.body.append(convert(node.astext()))

    @staticmethod
    def block(translator: HTML5Translator, node: nodes.math_block) -> None:
        translator.body.append(convert(node.astext(), display='block'))


def _nothing(_translator: HTML5Translator, _node: Any) -> None:
    pass


def setup(app: Sphinx) -> None:
    """Connect the above with Sphinx."""
    app.add_html_math_renderer('mathml', (_MathML.inline, _nothing), (_MathML.block, _nothing))
    app.connect('source-read', add_directives)
