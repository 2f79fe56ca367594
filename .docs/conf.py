"""Settings of the documentation site: ``sphinx-build -W .docs FOLDER`` makes it, without a network."""

from __future__ import annotations

import sys
from pathlib import Path

import shipid

sys.path.insert(0, str(Path(__file__).parent / "extensions"))

project = "shipid"
author = "The shipid developers"
copyright = author
version = release = shipid.__version__

extensions = [
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "numpydoc",
    "myst_parser",
    "accessible",
    "command_pages",
    "declared",
    "equations",
    "links",
    "public_api",
    "ship_models",
    "references",
]
exclude_patterns = ["extensions"]

# Pages are Markdown; the generated ones are reStructuredText, the language of autodoc.
myst_enable_extensions = ["colon_fence", "dollarmath"]
myst_heading_anchors = 3

# Two hyphens are an option of a command, and quotes belong to values: neither is typeset.
smartquotes = False
highlight_language = "none"

# Every reference that says what it refers to has to be found.
nitpicky = True
# A word between single backticks is a link where it names something of the API, and plain code elsewhere.
default_role = "py:obj"

# Types are read from the docstrings, where they stand with shapes and units, and not from the annotations.
autodoc_typehints = "none"
autodoc_member_order = "bysource"
autodoc_inherit_docstrings = False
autosummary_generate = False
numpydoc_show_class_members = False
numpydoc_xref_param_type = True
numpydoc_xref_ignore = "all"
maximum_signature_line_length = 88
python_display_short_literal_types = True
add_module_names = False
toc_object_entries_show_parents = "hide"

html_theme = "furo"
html_title = "shipid"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sourcelink = False
html_show_sphinx = False
html_show_copyright = False
html_math_renderer = "drawing"
html_theme_options = {"navigation_with_keys": True}
pygments_style = "a11y-high-contrast-light"
pygments_dark_style = "native"
