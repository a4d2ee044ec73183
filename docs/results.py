# SPDX-License-Identifier: MIT
"""`raycaster results`: measure the engines or their scaling, and write all measured tables into the pages.

With --list or --stale it only lists the stored figures.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from raycaster.configuration import configure
from raycaster.digests import digest
from raycaster.docs import beside, engine_figures, scaling
from raycaster.docs.facts import facts
from raycaster.docs.pages import HERE, need_clone, render_all
from raycaster.docs.proofs import proofs
from raycaster.docs.tables import keep_digests, listed, outcomes, tables
from raycaster.options import CommandParser
from raycaster.outcomes import RESULTS, Provenance, add_keep_option, keep, kept_outcome
from raycaster.output import Console, Table, printable
from raycaster.scene import packaged_scenes


def _measure_engines(arguments: argparse.Namespace, console: Console) -> int:
    designs = []
    for options in engine_figures.DESIGNS:
        name = configure(**options).name
        with console.waiting(f"measuring {name}"):
            designs.append(engine_figures.measured(options, arguments.output / name))
    figures = {"scenes": len(packaged_scenes(plain=True)), "designs": designs}
    keep(arguments, figures, {"rectangles": configure().rectangles}, provenance, "placing and routing")
    return 0


def _measure_scaling(arguments: argparse.Namespace, console: Console) -> int:
    designs = scaling.measure_scaling(arguments.output / "scaling", arguments.output, console)
    keep(arguments, {"designs": designs}, {}, provenance, "placing and routing")
    scaling.draw_scaling(designs, kept_outcome(arguments.keep).date, HERE / "scaling.svg")
    return 0


def _measure_beside(arguments: argparse.Namespace, console: Console) -> int:
    checkouts = beside.checkouts_of(arguments.beside)
    rows, failures = beside.measure_beside(beside.SCENE, checkouts, arguments.output / "beside", console)
    keep(arguments, {"designs": rows}, {"scene": beside.SCENE}, provenance)
    return int(bool(failures))


def _show_all(console: Console) -> None:
    """List the stored figures, each with a digest of everything that affects it."""
    shown = Table("results/", "measured", "commit", "digest", "", texts=("measured", "commit", "digest", ""))
    for one in outcomes().values():
        deciding = digest(one.provenance) if one.provenance else ""
        shown.add_row(one.name, one.date, one.commit, deciding, "stale" if one.changed else "holds")
    console.print(shown)


def _show_stale(console: Console) -> None:
    """List the stored figures that no longer hold, with the command that measures each again."""
    shown = Table("results/", "changed since", "measured again by", texts=("changed since", "measured again by"))
    stale = [one for one in outcomes().values() if one.changed]
    for one in stale:
        shown.add_row(one.name, listed(one.changed).replace("`", ""), f"{one.command} --keep results/{one.name}.json")
    console.print(shown if stale else "No figure is stale.")
    if stale:
        console.print(f"{len(stale)} of {len(outcomes())} are stale.", highlight=False)


def command_parser() -> CommandParser:
    """Return the command's parser."""
    parser = CommandParser("results", __doc__, "--render")
    asked = parser.add_mutually_exclusive_group()
    asked.add_argument("--render", action="store_true", help="only update the pages, from the files in results/")
    asked.add_argument("--list", action="store_true", help="list the figures in results/, with dates and digests")
    asked.add_argument("--stale", action="store_true", help="list the figures in results/ that no longer hold")
    asked.add_argument("--scaling", action="store_true", help="measure designs of many sizes (a quarter of an hour)")
    asked.add_argument(
        "--beside",
        nargs="*",
        metavar="NAME=CHECKOUT",
        help="measure software, and other projects' designs in their checkouts",
    )
    parser.add_argument(
        "--output", type=Path, default=Path("build/results"), help="directory for output files (%(default)s)"
    )
    add_keep_option(parser)
    return parser


def provenance(arguments: argparse.Namespace) -> Provenance:
    """Return what decides the figures of the requested measurement."""
    if arguments.scaling:
        return scaling.provenance()
    return engine_figures.provenance() if arguments.beside is None else beside.provenance()


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command and return its exit code, 1 if a measurement failed."""
    arguments = command_parser().parse_args(argv)
    need_clone()
    console = Console()
    if arguments.list or arguments.stale:
        (_show_all if arguments.list else _show_stale)(console)
        return 0
    code = 0
    if not arguments.render:
        measures = {"engines": _measure_engines, "scaling": _measure_scaling, "beside": _measure_beside}
        name = "scaling" if arguments.scaling else "engines" if arguments.beside is None else "beside"
        arguments.keep = arguments.keep or RESULTS / f"{name}.json"
        code = measures[name](arguments, console)
        outcomes.cache_clear()
    keep_digests()
    for page in render_all(facts() | tables() | proofs()):
        print(printable(f"written: {page}"))
    return code
