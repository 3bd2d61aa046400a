"""The documentation as a site: `scripts/docs` builds it into out/site, which needs no network to be read."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent / "site"))

import hydrolek_drake

project = "hydrolek_drake"
author = "the authors of hydrolek_drake"
html_show_copyright = False
version = release = hydrolek_drake.__version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_copybutton",
    "reference_pages",
]
source_suffix = {".md": "markdown"}
exclude_patterns = ["site"]

myst_heading_anchors = 4  # headings are linked to as on other readers of Markdown
suppress_warnings = ["myst.header"]  # a page may leave out a level of headings

autodoc_typehints = "description"
autodoc_member_order = "bysource"
napoleon_google_docstring = True

html_theme = "furo"
html_title = f"hydrolek_drake {release}"
html_static_path = ["site/static"]
html_css_files = ["tables.css"]
html_show_sphinx = False
html_copy_source = False
copybutton_prompt_text = "$ "
copybutton_only_copy_prompt_lines = True
