# Sphinx: the pages of docs/ as a site that opens from disk, with search. Built by scripts/site.sh.
import pathlib
import sys

project = "Withy"
author = "the authors of Withy"
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
# The reference of Python is made from the module that is built, that of C and C++ by Doxygen beside the pages.
_sources = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(_sources / "build/release/lib/python3/dist-packages"))
autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
html_extra_path = [str(_sources / "build/reference")]
source_suffix = {".md": "markdown"}
root_doc = "index"
myst_heading_anchors = 4
html_theme = "alabaster"
html_theme_options = {"description": "Dynamics of trees of rigid and flexible bodies", "page_width": "1180px", "body_max_width": "none"}
html_sidebars = {"**": ["about.html", "searchbox.html", "navigation.html"]}
html_show_sourcelink = False
# Pages write formulas, signs and formats as plain text: none of them is a language that is highlighted.
highlight_language = "text"
# Blocks that show a part of a file, or options in the place of values, are no whole program.
suppress_warnings = ["misc.highlighting_failure"]
