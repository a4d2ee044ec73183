# SPDX-License-Identifier: MIT
"""Sphinx's configuration. `raycaster docs` runs it, after it has put what is drawn beside the pages."""

from raycaster.docs.facts import facts

project = "RayCaster"
html_title = "RayCaster"
extensions = ["myst_parser"]
myst_enable_extensions = ["substitution"]
myst_substitutions = facts()
myst_heading_anchors = 2
html_theme = "furo"
html_static_path = ["style"]
html_css_files = ["wide.css"]
html_extra_path = ["extra"]
html_copy_source = False
