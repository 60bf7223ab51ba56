"""Sphinx settings of the documentation, which ``make docs`` builds into build/docs.

Warnings are errors.
"""

from __future__ import annotations

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "docs" / "_extensions")]

import alpha5_model  # noqa: E402

project = "alpha5-model"
author = "The alpha5-model authors"
copyright = "the alpha5-model authors; the printed numbers are Reach Robotics'"
release = version = alpha5_model.__version__

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.viewcode",
    "generated_text",
    "picture_page",
    "short_references",
]
exclude_patterns = ["_extensions"]
suppress_warnings = ["config.cache"]

# Markdown
myst_enable_extensions = ["colon_fence", "deflist"]
myst_heading_anchors = 3
# Notebooks are stored with outputs: a test compares them with what a run gives.
nb_execution_mode = "off"

# Docstrings: Google's sections; `name` is a reference, see short_references.py.
default_role = "py:obj"
nitpicky = True
napoleon_numpy_docstring = False
autodoc_member_order = "bysource"
autodoc_typehints = "none"
autodoc_default_options = {"members": True}
napoleon_attr_annotations = False
autodoc_preserve_defaults = True
python_use_unqualified_type_names = True
add_module_names = False
toc_object_entries = False
maximum_signature_line_length = 88

html_theme = "furo"
html_title = f"alpha5-model {release}"
html_static_path = ["_static"]
html_css_files = ["tables.css", "dark.css"]
html_copy_source = False
html_show_sphinx = False
