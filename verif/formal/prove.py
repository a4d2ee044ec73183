# SPDX-License-Identifier: MIT
"""`raycaster verify prove`: prove what can be proved of the generated Verilog."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from raycaster.errors import UserError
from raycaster.options import CommandParser
from raycaster.tools import TIMEOUT
from raycaster.verif.formal.properties import PROPERTIES
from raycaster.verif.formal.prover import Property, Result, prove


def main(argv: Sequence[str] | None = None) -> int:
    """The command."""
    names = list(dict.fromkeys(proof.name for proof in PROPERTIES))
    parser = CommandParser("verify prove", __doc__, "--small")
    parser.add_argument("--property", action="append", metavar="NAME", help=f"one of {', '.join(names)}; repeatable")
    parser.add_argument("--small", action="store_true", help="the quick subset")
    parser.add_argument("--list", action="store_true", help="list the properties and prove nothing")
    parser.add_argument("--depth", type=_positive, help="steps of base and induction (default: each property's own)")
    parser.add_argument("--timeout", type=_positive, default=TIMEOUT, help="seconds a run (default: %(default)s)")
    parser.add_argument("--jobs", type=_positive, default=2, help="proofs at a time (default: %(default)s)")
    parser.add_argument("--output", type=Path, default=Path("build/formal"), help="(default: %(default)s)")
    arguments = parser.parse_args(argv)
    for name in arguments.property or []:
        if name not in names:
            raise UserError(f"--property: {name} is none of {', '.join(names)}")
    proofs = [
        proof
        for proof in PROPERTIES
        if (not arguments.property or proof.name in arguments.property) and (proof.small or not arguments.small)
    ]
    # A table of this many columns is read from a log as well as on a screen.
    console = Console(width=None if sys.stdout.isatty() else 150)
    if arguments.list:
        console.print(_list(proofs))
        return 0
    results = _prove_all(proofs, arguments, console)
    console.print(_table(results))
    failures = [result for result in results if not result.proved]
    for result in failures:
        console.print(
            f"{result.proof.name}, {result.proof.label}: {escape(result.outcome)}", style="red", soft_wrap=True
        )
        if result.detail:
            console.print(escape(result.detail), soft_wrap=True)
        if result.trace:
            console.print(f"trace: {result.trace}", soft_wrap=True)
    return 1 if failures else 0


def _positive(text: str) -> int:
    value = int(text)
    if value < 1:
        raise ValueError
    return value


def _prove_all(proofs: list[Property], arguments: argparse.Namespace, console: Console) -> list[Result]:
    columns = TextColumn("proving"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn()
    with Progress(*columns, console=console, transient=True) as progress:
        task = progress.add_task("", total=len(proofs))

        def run(proof: Property) -> Result:
            directory = arguments.output / f"{proof.name}-{proof.label}".replace(" ", "-")
            try:
                result = prove(proof, directory, depth=arguments.depth, timeout=arguments.timeout)
            except UserError as error:
                result = Result(proof, "not attempted", proof.induction, 0, detail=str(error))
            progress.advance(task)
            return result

        with ThreadPoolExecutor(arguments.jobs) as pool:
            return list(pool.map(run, proofs))


def _list(proofs: list[Property]) -> Table:
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
        outcome = f"[{'green' if result.proved else 'red'}]{result.outcome}[/]"
        table.add_row(proof.name, proof.label, modules, result.method, outcome, f"{result.seconds:.1f}")
    return table
