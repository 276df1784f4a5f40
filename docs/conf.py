"""How Sphinx makes the site of these pages: `make docs`."""

import os
import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE / "_ext"))
# Kernels of notebooks inherit these: they draw without a screen, and on one core.
os.environ.setdefault("PYVISTA_OFF_SCREEN", "true")
os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkOSOpenGLRenderWindow")
os.environ.setdefault("OMP_NUM_THREADS", "1")

from cdem._version import __version__  # noqa: E402

project = "cdem"
author = "The cdem developers"
copyright = "The cdem developers, Apache-2.0"
release = version = __version__

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_copybutton",
    "sphinxcontrib.bibtex",
    "benchmark_history",
    "case_reference",
    "command_reference",
    "mathml",
    "problem_pages",
    "repository_links",
    "contents",  # after repository_links: it reads the links
]
exclude_patterns = ["_ext"]
nitpicky = False  # types in signatures such as NDArray have no page of their own here

# Pages are plain Markdown that reads well on GitHub too.
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4
html_math_renderer = "mathml"

nb_execution_mode = "cache"
nb_execution_cache_path = str(HERE.parent / "build" / "notebooks")
nb_execution_timeout = 300
nb_execution_in_temp = True
nb_execution_raise_on_error = True
nb_merge_streams = True

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
napoleon_google_docstring = True
napoleon_numpy_docstring = False

bibtex_bibfiles = ["references.bib"]
bibtex_default_style = "plain"

smartquotes = False  # "--" is an option, not a dash

html_theme = "furo"
html_title = f"cdem {release}"
html_static_path = ["_static"]
html_css_files = ["cdem.css"]
html_copy_source = False
html_show_sourcelink = False
