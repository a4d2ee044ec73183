# SPDX-License-Identifier: MIT
"""Tables of measured figures for the pages, and whether the figures still hold.

Each command has its own tables (`PUBLISHED`), rows of the table of checks (`CHECKS`), and a function that digests what
decides its figures (`provenance`). A figure is stale if that differs from the digests in its kept file.
"""

from __future__ import annotations

import json
import shlex
from collections.abc import Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from fnmatch import fnmatch
from functools import cache, partial
from importlib.metadata import distributions
from multiprocessing import get_context

from filelock import FileLock

from raycaster.buses import BUSES, OWN
from raycaster.cli.__main__ import loaded
from raycaster.cli.commands import COMMANDS
from raycaster.configuration import Configuration
from raycaster.convert.provenance import ROOT, Provenance, verilog_digest
from raycaster.digests import code_digest
from raycaster.docs import engine_figures, scaling
from raycaster.errors import UserError
from raycaster.fpga import area, bitstream, fit, tiny_tapeout
from raycaster.jobs import run_jobs
from raycaster.outcomes import RESULTS, Check, Digests, Outcome, Published, kept_outcome, table
from raycaster.output import Console
from raycaster.play import game
from raycaster.report import __main__ as report
from raycaster.report import beside
from raycaster.sim import scenes
from raycaster.verif import everything
from raycaster.verif.coverage import measure as coverage
from raycaster.verif.exhaustive import run as exhaustive
from raycaster.verif.formal import prove
from raycaster.verif.mutation import mutate
from raycaster.verif.soak import soak
from raycaster.verif.upsets import upsets
from raycaster.web import site

DECIDING = (
    "rtl", "raycaster", "convert", "golden", "fit", "fpga", "sim", "play", "web", "sw", "report", "scenes",
    *(f"verif/{name}" for name in ("coverage", "exhaustive", "formal", "mutation", "soak", "upsets")),
    "verif/random_scenes.py", "docs/engine_figures.py", "docs/scaling.py",
)  # fmt: skip
"""Sources on which any digest may depend: while none of them changes, no digest is made again."""

JOBS = 2


def _buses(kept: Outcome) -> str:
    """Buses in front of the registers; cycles as their bench measures them."""
    areas = {row["bus"]: row for row in kept.figures["bridges"]}
    rows = []
    for name, bus in BUSES.items():
        cells = [0 if name == OWN else areas[name][kind] for kind in ("tables", "registers")]
        rows.append([f"`BUS={name}`", bus.title, f"`{bus.port}_*`", bus.unit, bus.write, bus.read, *cells])
    return table(["", "bus", "ports", "address unit", "cycles per write", "cycles per read", "LUT4", "registers"], rows)


CHECKS: Sequence[Check] = (
    *scenes.CHECKS, *soak.CHECKS, *game.CHECKS, *exhaustive.CHECKS, *report.CHECKS, *prove.CHECKS, *mutate.CHECKS,
    *upsets.CHECKS, *coverage.CHECKS, *everything.CHECKS,
)  # fmt: skip
"""Rows of the table of long checks."""


def _checks(*kept: Outcome) -> str:
    by_name = {one.name: one for one in kept}
    rows = []
    for check in CHECKS:
        of_it = [by_name[name] for name in check.kept]
        commands, dates = (
            "<br>".join(texts) for texts in zip(*((f"`{one.asked()}`", one.when) for one in of_it), strict=True)
        )
        rows.append([check.title, check.engine, check.body(*of_it), commands, dates])
    return table(["check", "engine", "found", "command", "measured"], rows)


PUBLISHED: Sequence[Published] = (
    *engine_figures.PUBLISHED, *scenes.PUBLISHED, *area.PUBLISHED, *fit.PUBLISHED, *bitstream.PUBLISHED,
    *tiny_tapeout.PUBLISHED, *site.PUBLISHED, *scaling.PUBLISHED, *report.PUBLISHED, *beside.PUBLISHED,
    *mutate.PUBLISHED,
    Published("buses", ["bridges"], _buses),
    Published("checks", list(dict.fromkeys(name for check in CHECKS for name in check.kept)), _checks, dated=True),
)  # fmt: skip


def tables() -> dict[str, str]:
    """All tables of kept figures, in Markdown, by the names that pages use.

    Raises:
        UserError: a kept file that a table is made of is missing.
    """
    return {one.name: _shown(one) for one in PUBLISHED}


def _shown(published: Published) -> str:
    kept = []
    for pattern in published.kept:
        found = [one for name, one in outcomes().items() if fnmatch(name, pattern)]
        if not found:
            raise UserError(f"{published.name}: {RESULTS / pattern}.json is missing; a command with --keep writes it")
        kept += found
    body = published.body(*kept)
    return body if published.dated else f"{body}\n\n{_measured(kept)}"


def _measured(kept: Sequence[Outcome]) -> str:
    """Say when, by which commands, and what has changed since."""
    lines = []
    for one in kept:
        left_out = f"; not measured: {one.scope['left_out']}" if one.scope.get("left_out") else ""
        lines.append(f"`{one.asked()}`, {one.date}{left_out}")
    changed = list(dict.fromkeys(name for one in kept for name in one.changed))
    return f"Measured: {'; '.join(lines)}.{f' **Stale**: {listed(changed)} changed since.' if changed else ''}"


def listed(names: Sequence[str], most: int = 3) -> str:
    """The first names, and how many more there are."""
    more = len(names) - most
    return ", ".join([*(f"`{name}`" for name in names[:most]), *([f"{more} more"] if more > 0 else [])])


@cache
def outcomes() -> Mapping[str, Outcome]:
    """Read all kept figures, by file name, and find what has changed since each was measured."""
    kept = [kept_outcome(path) for path in sorted(RESULTS.glob("*.json"))]
    current = _current(list(dict.fromkeys(one.command for one in kept)))
    return {one.name: replace(one, changed=_changed(one.provenance, current[one.command])) for one in kept}


def _current(commands: Sequence[str]) -> Mapping[str, Digests | str]:
    """Digest what decides the figures of these commands today, or say why a command is refused.

    Digests are kept in build/ and made again where a source or a tool has changed.
    """
    store, state, console = ROOT / "build" / "provenance.json", _state(), Console(stderr=True)
    # Fresh processes, as MyHDL looks through all loaded modules again and again, and a test has many.
    pool = partial(ProcessPoolExecutor, JOBS, mp_context=get_context("spawn"))
    store.parent.mkdir(exist_ok=True)
    with FileLock(store.with_suffix(".lock")):
        stored = json.loads(store.read_text()) if store.exists() else {}
        found = stored["found"] if stored.get("state") == state else {}
        wanted = [command for command in commands if command not in found]
        if wanted:
            described = run_jobs("commands", _described, wanted, pool, console)
            designs = {one.name: one for each in described if isinstance(each, Provenance) for one in each.designs}
            digests = run_jobs("designs", _digested, list(designs.values()), pool, console)
            known = dict(zip(designs, digests, strict=True))
            made = (each.digests(known) if isinstance(each, Provenance) else each for each in described)
            found |= zip(wanted, made, strict=True)
            partly = store.with_suffix(".partial")
            partly.write_text(json.dumps({"state": state, "found": found}))
            partly.replace(store)
    return found


def _state() -> list[str]:
    packages = sorted({f"{one.name} {one.version}" for one in distributions()})  # one on two paths comes twice
    return [*(code_digest(ROOT / place, ROOT) for place in DECIDING), *packages]


def _described(command: str) -> Provenance | str:
    """The provenance of a command's figures today, or the reason why the command is refused."""
    words = shlex.split(command)[1:]
    taken = 2 if " ".join(words[:2]) in COMMANDS else 1
    try:
        module = loaded(COMMANDS[" ".join(words[:taken])])
        return module.provenance(module.command_parser().parse_args(words[taken:]))
    except UserError as error:
        return str(error)


def _digested(design: Configuration) -> str:
    """The digest of a design's Verilog, or why there is none."""
    try:
        return verilog_digest(design)
    except UserError as error:
        return f"refused: {error}"


def _changed(then: Digests, now: Digests | str) -> Sequence[str]:
    """Name what has another digest now, and what is digested only then or only now."""
    if isinstance(now, str):
        return [f"the command, which is refused: {now}"]
    found = []
    for kind, digests in now.items():
        before = then.get(kind, {})
        found += sorted(name for name in digests.keys() | before.keys() if digests.get(name) != before.get(name))
    return found
