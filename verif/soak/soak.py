# SPDX-License-Identifier: MIT
"""Draw random or stiff scenes with the converted hardware, at full size, and check every pixel: `make soak`."""

from __future__ import annotations

import argparse
from collections import defaultdict
from collections.abc import Sequence

from rich.table import Table

from raycaster.configuration import MOST_REFLECTIONS, Configuration, configure
from raycaster.convert.provenance import Provenance
from raycaster.errors import UserError
from raycaster.golden.catalogue import catalogue
from raycaster.jobs import add_fresh_option, add_job_options, executors
from raycaster.options import (
    CommandParser,
    add_build_option,
    add_configuration_options,
    command_line,
    given_options,
)
from raycaster.outcomes import Check, Outcome, add_keep_option, keep, scope_of
from raycaster.output import Console
from raycaster.sim.simulator import add_simulator_option
from raycaster.verif.campaign import Campaign, run_campaign
from raycaster.verif.random_scenes import style_of

BENCH = "raycaster.verif.soak.bench"


def show(
    results: list[dict], seconds: float, configuration: Configuration, console: Console, *, stiff: bool = False
) -> None:
    """Print the results, by style and reflections."""
    rows: dict[tuple[str, int], list[dict]] = defaultdict(list)
    for result in results:
        rows["stiff" if stiff else style_of(result["seed"]), result["reflections"]].append(result)
    table = Table(title=f"{configuration.name}, {len(results)} scenes in {seconds:.0f} s")
    table.add_column("style")
    for heading in ("reflections", "scenes", "pixels", "wrong", "against exact"):
        table.add_column(heading, justify="right")
    for (style, reflections), group in [*sorted(rows.items()), (("all", ""), results)]:
        pixels = sum(result["pixels"] for result in group)
        rounding = sum(result["wrong_vs_exact"] for result in group)
        wrong = sum(result["wrong_vs_golden"] for result in group)
        # The golden model of an engine that does not round is exact, so there is no rounding to count.
        share = f"{100 * rounding / pixels:.2f} %" if pixels and configuration.facts.divides else ""
        table.add_row(style, str(reflections), str(len(group)), f"{pixels:,}", f"{wrong:,}", share)
    console.print(table)


def command_parser() -> CommandParser:
    """Build the parser of the command line."""
    parser = CommandParser("verify soak", __doc__, "--seeds 10")
    parser.add_argument("--seeds", type=int, default=100, metavar="N", help="number of scenes (default: %(default)s)")
    parser.add_argument("--first", type=int, default=0, metavar="SEED", help="first seed (default: %(default)s)")
    parser.add_argument("--stiff", action="store_true", help="run all cases of the stiff catalogue instead")
    add_job_options(parser)
    add_fresh_option(parser)
    add_simulator_option(parser)
    add_build_option(parser)
    add_configuration_options(parser)
    add_keep_option(parser)
    return parser


def _configuration(arguments: argparse.Namespace) -> Configuration:
    return configure(**{"reflections": MOST_REFLECTIONS} | given_options(arguments))


def provenance(arguments: argparse.Namespace) -> Provenance:
    """Digest everything that decides the figures of the command."""
    return Provenance([_configuration(arguments)], ["golden", "verif/random_scenes.py"])


def _wrong_pixels(*kept: Outcome) -> str:
    scenes, pixels, wrong = (sum(one.figures[key] for one in kept) for key in ("scenes", "pixels", "wrong_vs_golden"))
    return f"{scenes:,} scenes, {pixels:,} pixels, {wrong} wrong"


CHECKS = (
    Check("random scenes, surfaces of all kinds, full size", "seed, culling", ["soak-seed"], _wrong_pixels),
    Check(
        "random and stiff scenes, turned cameras and surfaces of all kinds, full size",
        "exact, no culling", ["soak-exact", "soak-exact-stiff"], _wrong_pixels,
    ),
    Check(
        "random scenes with lights, turned cameras and surfaces of all kinds, 64x48", "exact", ["soak-exact-light"],
        _wrong_pixels,
    ),
    Check(
        "random and stiff scenes, turned cameras and surfaces of all kinds, 640x480",
        "beam", ["soak-beam", "soak-beam-stiff"], _wrong_pixels,
    ),
    Check("random scenes at 1920x1080, two pixels per clock", "beam", ["soak-beam-1920x1080"], _wrong_pixels),
)  # fmt: skip


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command and return its exit code."""
    arguments = command_parser().parse_args(argv)
    if arguments.seeds < 1 or arguments.first < 0:
        raise UserError("seeds: must be 1 or more, first: 0 or more")
    configuration = _configuration(arguments)
    console = Console()
    output = arguments.build / "soak"
    seeds = range(arguments.first, arguments.first + arguments.seeds)
    if arguments.stiff:
        seeds = range(len(catalogue(configuration.looks)))
    whole = Campaign(
        BENCH, configuration, seeds, output, arguments.build, simulator=arguments.simulator, stiff=arguments.stiff,
        fresh=arguments.fresh,
    )  # fmt: skip
    with executors(arguments.scheduler, arguments.jobs) as make_executor:
        outcome = run_campaign(whole, console, make_executor)
    results = outcome.results
    show(results, outcome.seconds, configuration, console, stiff=arguments.stiff)
    for result in results:
        if result["wrong_vs_golden"]:
            which = {"stiff": True} if arguments.stiff else {"seeds": 1, "first": result["seed"]}
            repeat = command_line("verify soak", options=which | given_options(arguments))
            console.print(
                f"seed {result['seed']}: {result['wrong_vs_golden']} wrong pixels; the scene, whole and shrunk, "
                f"is in {output}/*/from*/{result['seed']}*.toml; repeat with: {repeat}",
                style="red",
                soft_wrap=True,
            )
    counts = {name: sum(one[name] for one in results) for name in ("pixels", "wrong_vs_golden", "wrong_vs_exact")}
    figures = {"scenes": len(results), "not_shown": outcome.missing, **counts}
    keep(arguments, figures, scope_of(configuration) | {"stiff": arguments.stiff}, provenance)
    return outcome.verdict("scenes", console)
