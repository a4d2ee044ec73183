# SPDX-License-Identifier: MIT
"""`raycaster docs`: the documentation for a browser, its pictures drawn from the design."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Sequence
from pathlib import Path

from sphinx.cmd.build import build_main

from raycaster.configuration import Configuration
from raycaster.docs import blocks, timing
from raycaster.errors import UserError
from raycaster.options import CommandParser
from raycaster.output import replaced
from raycaster.register_views import write_page
from raycaster.sim import ensure_icarus
from raycaster.sim.simulator import BUILD, SimulationError

HERE = Path(__file__).parent


def draw_timing(build: Path) -> None:
    """Simulate anew, and keep what is drawn of it with the sources.

    Raises:
        UserError: as `timing.simulate`, or the simulated design is at fault.
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


def write_site(output: Path) -> Path:
    """Write all pages.

    Args:
        output: replaced as a whole, once everything is there.

    Returns:
        The first page.

    Raises:
        UserError: Sphinx has a complaint, which it has printed.
    """
    with replaced(output) as written, tempfile.TemporaryDirectory(prefix="raycaster-") as scratch:
        pages = Path(scratch) / "pages"
        shutil.copytree(HERE, pages, ignore=shutil.ignore_patterns("__pycache__", "timing"))
        diagrams = pages / "diagrams"
        diagrams.mkdir()
        for diagram in timing.DIAGRAMS:
            timing.render(timing.kept(diagram.name), diagrams / f"{diagram.name}.svg")
        for drawing in blocks.DRAWINGS:
            blocks.draw(drawing, diagrams)
        write_page(Configuration().rectangles, pages / "extra" / "register_map")
        if build_main(["-q", "-W", "--keep-going", "-d", f"{scratch}/doctrees", str(pages), str(written)]):
            raise UserError("the pages have faults, which stand above")
    return output / "index.html"


def main(argv: Sequence[str] | None = None) -> None:
    """The command."""
    parser = CommandParser("docs", __doc__, "")
    parser.add_argument("--output", type=Path, default=BUILD / "docs", help="(default: %(default)s)")
    parser.add_argument(
        "--keep-timing", action="store_true", help="take the timing diagrams as they are, without a simulation"
    )
    arguments = parser.parse_args(argv)
    if not arguments.keep_timing:
        ensure_icarus.main()
        BUILD.mkdir(exist_ok=True)
        draw_timing(BUILD)
    print(f"documentation: {write_site(arguments.output)}")
