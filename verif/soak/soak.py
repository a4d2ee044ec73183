# SPDX-License-Identifier: MIT
"""Draw random or stiff scenes with the converted hardware, at full size, and check every pixel: `make soak`.

Random scenes are new each day; SEED= repeats those of another one.
"""

from __future__ import annotations

import argparse
from collections import defaultdict
from collections.abc import Sequence

from raycaster.configuration import MOST_REFLECTIONS, Configuration, configure
from raycaster.convert.digest import verilog_digest
from raycaster.golden.catalogue import catalogue
from raycaster.options import CommandParser, given_options
from raycaster.outcomes import keep
from raycaster.output import Console, Table
from raycaster.sim.simulator import add_simulator_option
from raycaster.verif.campaign import Campaign, add_campaign_options, repeated, run_asked
from raycaster.verif.random_scenes import style_of
from raycaster.verif.seeds import add_seed_option, drawn

BENCH = "raycaster.verif.soak.bench"

SCENES_PER_SEED = 10_000
"""Distance between the first scenes of two days, so that each day has new ones."""


def show(
    results: list[dict], seconds: float, configuration: Configuration, console: Console, *, stiff: bool = False
) -> None:
    """Print the results, by style and reflections."""
    rows: dict[tuple[str, int], list[dict]] = defaultdict(list)
    for result in results:
        rows["stiff" if stiff else style_of(result["seed"]), result["reflections"]].append(result)
    title = f"{configuration.name}, {len(results)} scenes in {seconds:.0f} s"
    table = Table("style", "reflections", "scenes", "pixels", "wrong", "against exact", title=title)
    for (style, reflections), group in [*sorted(rows.items()), (("all", ""), results)]:
        pixels, wrong, rounding = (
            sum(result[name] for result in group) for name in ("pixels", "wrong_vs_golden", "wrong_vs_exact")
        )
        # The golden model of an engine that does not round is exact, so there is no rounding to count.
        share = f"{100 * rounding / pixels:.2f} %" if pixels and configuration.facts.divides else ""
        table.add_row(style, reflections, len(group), pixels, wrong, share)
    console.print(table)


def command_parser() -> CommandParser:
    """Build the parser of the command line."""
    parser = CommandParser("verify soak", __doc__, "--seeds 10")
    parser.add_argument("--stiff", action="store_true", help="run all cases of the stiff catalogue instead")
    add_simulator_option(parser)
    add_seed_option(parser)
    add_campaign_options(parser, "seeds", 100, f"{SCENES_PER_SEED:,} times the seed")
    return parser


def _configuration(arguments: argparse.Namespace) -> Configuration:
    return configure(**{"reflections": MOST_REFLECTIONS} | given_options(arguments))


def verilog(arguments: argparse.Namespace) -> str:
    """Digest the Verilog that draws the scenes."""
    return verilog_digest(_configuration(arguments))


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command and return its exit code."""
    arguments = command_parser().parse_args(argv)
    configuration, console = _configuration(arguments), Console()
    output, seeds = arguments.build / "soak", range(len(catalogue(configuration.looks)))
    if not arguments.stiff:
        options, first = {"seeds": arguments.seeds} | given_options(arguments), arguments.first
        if first is None:
            first = SCENES_PER_SEED * drawn("verify soak", arguments.seed, None, console, **options)
        seeds = range(first, first + arguments.seeds)
    whole = Campaign(
        BENCH, configuration, seeds, output, arguments.build, simulator=arguments.simulator, stiff=arguments.stiff
    )
    outcome = run_asked(whole, arguments, console)
    results = outcome.results
    show(results, outcome.seconds, configuration, console, stiff=arguments.stiff)
    counts = {name: sum(one[name] for one in results) for name in ("pixels", "wrong_vs_golden", "wrong_vs_exact")}
    figures = {"scenes": len(results), "first": seeds.start, "not_shown": outcome.missing, **counts}
    keep(arguments, figures, verilog)
    wrong = []
    for result in results:
        if result["wrong_vs_golden"]:
            which = {"stiff": True} if arguments.stiff else {"seeds": 1, "first": result["seed"]}
            wrong.append(
                f"seed {result['seed']}: {result['wrong_vs_golden']} wrong pixels; the scene, whole and shrunk, "
                f"is in {output}/*/from*/{result['seed']}*.toml; {repeated('verify soak', arguments, **which)}"
            )
    return outcome.verdict("scenes", console, wrong)
