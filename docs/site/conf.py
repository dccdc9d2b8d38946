# Sphinx: the pages of docs/ as a site that opens from disk, with search. Built by scripts/site.sh.
project = "Withy"
author = "the authors of Withy"
extensions = ["myst_parser"]
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
