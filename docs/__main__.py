# SPDX-License-Identifier: MIT
"""`raycaster docs`: build the manual for a browser, with diagrams drawn from the design."""

from __future__ import annotations

import re
import shutil
import tempfile
from collections.abc import Sequence
from pathlib import Path

from sphinx.cmd.build import build_main

from raycaster.convert.register_views import write_page
from raycaster.design.decide import configure
from raycaster.design.options import CommandParser
from raycaster.docs import timing
from raycaster.docs.drawings import draw_all
from raycaster.errors import UserError
from raycaster.output import printable, replaced
from raycaster.runs.waits import announce
from raycaster.sim import ensure_tools
from raycaster.sim.simulator import BUILD, SimulationError
from raycaster.web.site import main as build_page

HERE = Path(__file__).resolve().parent
REFERENCE = (
    "raycaster.scene",
    "raycaster.configuration",
    "raycaster.design.decide",
    "raycaster.design.for_scene",
    "raycaster.golden.model",
    "raycaster.program",
    "raycaster.golden.exact",
    "raycaster.golden.engines",
    "raycaster.golden.picture",
    "raycaster.convert.write",
    "raycaster.sim.register_bus",
    "raycaster.sim.avalon",
    "raycaster.sim.buses",
    "raycaster.sim.monitor",
    "raycaster.sim.simulator",
    "raycaster.errors",
)
"""Modules for programs that use the package, in the order in which they need them."""


def draw_timing(build: Path) -> None:
    """Repeat the simulation, and store the timing diagrams with the sources.

    Raises:
        UserError: as for `timing.simulate`, or if the simulated design is wrong.
    """
    timing.SOURCES.mkdir(exist_ok=True)
    try:
        drawn = dict(timing.simulate(build))
    except SimulationError as error:
        raise UserError(str(error)) from None
    for name, source in drawn.items():
        partial = timing.SOURCES / f".{name}.partial"
        partial.write_text(source)
        partial.replace(timing.SOURCES / f"{name}.json")


LIVE = """```{image} \\2
:alt: \\1
:target: web/index.html#room
:class: live
```

*Click the picture: the hardware runs in your browser.*"""
"""Link from the first page's picture to the page that runs the hardware, which takes seconds to load."""


def write_site(output: Path, web: Path | None = None) -> Path:
    """Write all pages, and return the path of the first one.

    Args:
        output: the directory, replaced as a whole once all pages are built.
        web: directory of the page that runs the hardware, to include in the manual.

    Raises:
        UserError: Sphinx has printed a warning or an error.
    """
    with replaced(output) as written, tempfile.TemporaryDirectory(prefix="raycaster-") as scratch:
        pages = Path(scratch) / "pages"
        shutil.copytree(HERE, pages, ignore=shutil.ignore_patterns("__pycache__", "timing"))
        _add_what_forges_would_not_show(pages)
        if web:
            shutil.copytree(web, pages / "extra" / "web")
            index = pages / "index.md"
            index.write_text(re.sub(r"(?m)^\[!\[(.*)\]\((.*)\)\]\(.*\)$", LIVE, index.read_text(), count=1))
        write_page(configure().rectangles, pages / "extra" / "register_map")
        if build_main(["-q", "-W", "--keep-going", "-d", f"{scratch}/doctrees", str(pages), str(written)]):
            raise UserError("the pages have faults, listed above")
    return output / "index.html"


def command_parser() -> CommandParser:
    """Return the command's parser."""
    parser = CommandParser("docs", __doc__, "")
    parser.add_argument("--output", type=Path, default=BUILD / "docs", help="directory (default: %(default)s)")
    parser.add_argument(
        "--keep-timing", action="store_true", help="use the stored timing diagrams, without a simulation"
    )
    parser.add_argument(
        "--no-web", action="store_true", help="leave out the page that runs the hardware, which takes minutes to build"
    )
    return parser


def _add_what_forges_would_not_show(pages: Path) -> None:
    """Add the page groups, the Python API from the docstrings, and the link to the interactive register map."""
    modules = [f"{module}\n{'-' * len(module)}\n\n.. automodule:: {module}\n" for module in REFERENCE]
    (pages / "python_api.rst").write_text("\n".join(["Python API\n==========\n", *modules]))
    index, registers = pages / "index.md", pages / "registers.md"
    toctrees = []
    for group, listed in re.findall(r"^## (.*)\n\n((?:- .*\n)+)", index.read_text(), re.MULTILINE):
        names = re.findall(r"\]\((\w+)\.md\)", listed)
        names += ["python_api"] if group == "Reference" else []
        toctrees += ["```{toctree}", ":hidden:", f":caption: {group}", "", *names, "```", ""]
    index.write_text("\n".join([index.read_text(), *toctrees]))
    link = '<a href="register_map/index.html">Interactive register map, which decodes words</a>'
    registers.write_text(f"{registers.read_text()}\n{link}\n")


def main(argv: Sequence[str] | None = None) -> None:
    """Run the command."""
    arguments = command_parser().parse_args(argv)
    announce("docs")
    if not arguments.keep_timing:
        ensure_tools.ensure("icarus")
        BUILD.mkdir(exist_ok=True)
        draw_timing(BUILD)
    for path in draw_all():
        print(printable(f"redrawn: {path}"))
    web = None
    if not arguments.no_web:
        web = BUILD / "web"
        build_page(["--output", str(web)])
    print(printable(f"documentation: {write_site(arguments.output, web)}"))
