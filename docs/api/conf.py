"""The API reference: Sphinx on the docstrings of the installed package. `scripts/docs` builds it."""

import graphdrl
from sphinx.util.inspect import TypeAliasForwardRef

project = "GraphDRL"
version = release = graphdrl.__version__
extensions = ["sphinx.ext.autodoc", "sphinx.ext.napoleon"]
default_role = "literal"  # `name` in a docstring
highlight_language = "python"

# Only what a class says itself, in the order of the source.
autodoc_member_order = "bysource"
autodoc_inherit_docstrings = False
_ALIASES = ("ArrayLike", "Budget", "NDArray", "Node", "OnMetrics", "OnProgress", "OwnPolicy")
autodoc_type_aliases = {name: name for name in _ALIASES}
TypeAliasForwardRef.__repr__ = lambda alias: alias.name  # else `Node | None` shows this class of Sphinx's
autodoc_typehints_format = "short"
python_use_unqualified_type_names = True
maximum_signature_line_length = 90
napoleon_google_docstring = True
napoleon_numpy_docstring = False

# References lead to names of this project; those of others have no page here.
nitpicky = True
nitpick_ignore_regex = [
    ("py:.*", r"(collections|gymnasium|numpy|np|os|pathlib|scipy|spaces|typing)\..*"),
    ("py:.*", r"(ArrayLike|NDArray|PathLike|Path|Any|Callable|Iterable|Mapping|NamedTuple|Sequence|Self)"),
]

html_theme = "alabaster"  # Sphinx's own; a page needs no network
html_theme_options = {
    "description": "Walks that visit as many nodes of a graph as a budget allows",
    "fixed_sidebar": True,
    "page_width": "1100px",
    "show_powered_by": False,
}
html_static_path = ["static"]  # custom.css, which the theme looks for
html_copy_source = False
html_show_copyright = False
