# SPDX-License-Identifier: MIT
"""Tables of measured figures for the pages, and the check that the figures still hold.

The module of each command defines its tables (`PUBLISHED`), its rows in the table of checks (`CHECKS`), and a function
that returns what decides its figures (`provenance`). A figure is stale if the digests in its stored file differ.
"""

from __future__ import annotations

import json
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import replace
from fnmatch import fnmatch
from functools import cache
from importlib.metadata import distributions
from pathlib import Path
from typing import Any

from filelock import FileLock

from raycaster.buses import BUSES, OWN
from raycaster.cli.__main__ import loaded
from raycaster.cli.commands import COMMANDS
from raycaster.complaints import as_typed
from raycaster.configuration import Configuration
from raycaster.convert.provenance import ROOT, Provenance, verilog_digest
from raycaster.digests import code_digest, tool_versions
from raycaster.docs import beside, engine_figures, scaling
from raycaster.errors import UserError
from raycaster.fpga import area, bitstream, fit
from raycaster.jobs import processes, run_jobs
from raycaster.outcomes import RESULTS, Check, Digests, Outcome, Published, kept_outcome, table
from raycaster.output import Console
from raycaster.play import game
from raycaster.report import __main__ as report
from raycaster.sim import scenes
from raycaster.verif import everything
from raycaster.verif.coverage import measure as coverage
from raycaster.verif.formal import prove
from raycaster.verif.mutation import mutate
from raycaster.verif.soak import soak
from raycaster.verif.upsets import upsets
from raycaster.web import site

DECIDING = (
    "hdl", "rtl", "raycaster", "convert", "golden", "fit", "fpga", "sim", "play", "web", "sw", "report", "scenes",
    *(f"verif/{name}" for name in ("coverage", "formal", "mutation", "soak", "upsets")),
    "verif/random_scenes.py", "docs/engine_figures.py", "docs/scaling.py",
)  # fmt: skip
"""Sources on which any digest may depend: digests are only computed again if one of them changes."""

HARDWARE = ("hdl", "rtl", "convert", "raycaster")
"""Sources on which the Verilog of a design may depend: `convert` imports nothing else."""

CONVERTERS = ("myhdl", "numpy", "systemrdl-compiler")
"""Packages on which the Verilog of a design may depend."""

DIGESTS = RESULTS / "verilog.digests"
"""Digests of the measured designs' Verilog, in JSON; they hold while the sources and packages above stay the same."""

STORE = ROOT / "build" / "provenance.json"
"""Digests of everything that affects the stored figures, when they were last computed."""

JOBS = 2


def _buses(kept: Outcome) -> str:
    """Return the table of buses, with the cycles that their bench measures."""
    areas = {row["bus"]: row for row in kept.figures["bridges"]}
    rows = []
    for name, bus in BUSES.items():
        cells = [0 if name == OWN else areas[name][kind] for kind in ("tables", "registers")]
        rows.append([f"`BUS={name}`", bus.title, f"`{bus.port}_*`", bus.unit, bus.write, bus.read, *cells])
    return table(["", "bus", "ports", "address unit", "cycles per write", "cycles per read", "LUT4", "registers"], rows)


CHECKS: Sequence[Check] = (
    *scenes.CHECKS, *soak.CHECKS, *game.CHECKS, *prove.CHECKS, *mutate.CHECKS,
    *upsets.CHECKS, *coverage.CHECKS, *everything.CHECKS,
)  # fmt: skip
"""Rows of the table of long-running checks."""


def _checks(*kept: Outcome) -> str:
    by_name = {one.name: one for one in kept}
    rows = []
    for check in CHECKS:
        of_it = [by_name[name] for name in check.kept]
        commands, dates = "<br>".join(f"`{one.asked()}`" for one in of_it), "<br>".join(one.when for one in of_it)
        rows.append([check.title, check.engine, check.body(*of_it), commands, dates])
    return table(["check", "engine", "result", "command", "measured"], rows)


PUBLISHED: Sequence[Published] = (
    *engine_figures.PUBLISHED, *scenes.PUBLISHED, *area.PUBLISHED, *fit.PUBLISHED, *bitstream.PUBLISHED,
    *site.PUBLISHED, *scaling.PUBLISHED, *report.PUBLISHED, *beside.PUBLISHED,
    *mutate.PUBLISHED,
    Published("buses", ["bridges"], _buses),
    Published("checks", list(dict.fromkeys(name for check in CHECKS for name in check.kept)), _checks, dated=True),
)  # fmt: skip


def tables() -> dict[str, str]:
    """Return all tables of stored figures, in Markdown, by the names in the pages' markers.

    Raises:
        UserError: a stored file that a table needs is missing.
    """
    return {one.name: _shown(one) for one in PUBLISHED}


def _shown(published: Published) -> str:
    kept = []
    for pattern in published.kept:
        found = [one for name, one in outcomes().items() if fnmatch(name, pattern)]
        if not found:
            raise UserError(
                f"{published.name}: {RESULTS / pattern}.json is missing; a command with {as_typed('keep')} writes it"
            )
        kept += found
    body = published.body(*kept)
    return body if published.dated else f"{body}\n\n{_measured(kept)}"


def _measured(kept: Sequence[Outcome]) -> str:
    """Return a line with the commands and dates of the measurements, and the changes since."""
    lines = []
    for one in kept:
        left_out = f"; not measured: {one.scope['left_out']}" if one.scope.get("left_out") else ""
        lines.append(f"`{one.asked()}`, {one.date}{left_out}")
    changed = list(dict.fromkeys(name for one in kept for name in one.changed))
    return f"Measured: {'; '.join(lines)}.{f' **Stale**: {listed(changed)} changed since.' if changed else ''}"


def listed(names: Sequence[str], most: int = 3) -> str:
    """List the first names and the number of further ones."""
    more = len(names) - most
    return ", ".join([*(f"`{name}`" for name in names[:most]), *([f"{more} more"] if more > 0 else [])])


@cache
def outcomes() -> Mapping[str, Outcome]:
    """Read all stored figures, by file name, and find the changes since each was measured."""
    kept = [kept_outcome(path) for path in sorted(RESULTS.glob("*.json"))]
    current = _current(list(dict.fromkeys(one.command for one in kept)))
    return {one.name: replace(one, changed=_changed(one.provenance, current[one.command])) for one in kept}


def _current(commands: Sequence[str]) -> Mapping[str, Digests | str]:
    """Return the current digests for the figures of these commands, or the reason why a command is refused.

    Digests are stored in build/ and computed again if a source or a tool has changed; those of designs, which take most
    of the time, only if the hardware or its conversion has. A new clone takes these from `DIGESTS`.
    """
    console = Console(stderr=True)
    state = _state(DECIDING, [one.name for one in distributions()])
    hardware = _state(HARDWARE, CONVERTERS)
    # New processes, because MyHDL searches all loaded modules repeatedly, and a test has loaded many.
    pool = processes(JOBS, spawned=True)
    STORE.parent.mkdir(exist_ok=True)
    with FileLock(STORE.with_suffix(".lock")):
        stored = _read(STORE)
        found = stored["found"] if stored.get("state") == state else {}
        kept = [one for one in (stored, _read(DIGESTS)) if one.get("hardware") == hardware]
        known = kept[0]["designs"] if kept else {}
        wanted = [command for command in commands if command not in found]
        if wanted:
            described = run_jobs("commands", _described, wanted, pool, console)
            designs = {one.name: one for each in described if isinstance(each, Provenance) for one in each.designs}
            new = [one for name, one in designs.items() if name not in known]
            known |= zip((one.name for one in new), run_jobs("designs", _digested, new, pool, console), strict=True)
            made = (each.digests(known) if isinstance(each, Provenance) else each for each in described)
            found |= zip(wanted, made, strict=True)
            partly = STORE.with_suffix(".partial")
            partly.write_text(json.dumps({"state": state, "found": found, "hardware": hardware, "designs": known}))
            partly.replace(STORE)
    return found


def _state(places: Sequence[str], packages: Sequence[str]) -> list[str]:
    versions = sorted(tool_versions(*packages).items())
    return [*(code_digest(ROOT / place, ROOT) for place in places), *(" ".join(each) for each in versions)]


def _read(path: Path) -> dict[str, Any]:
    return json.loads(path.read_text()) if path.exists() else {}


def keep_digests() -> None:
    """Write `DIGESTS`, for the stored figures' designs as they are now."""
    commands = [one.command for one in outcomes().values()]  # this also updates STORE
    stored = _read(STORE)
    now = [stored["found"][command] for command in commands]
    wanted = {name for each in now if not isinstance(each, str) for name in each["designs"]}
    designs = {name: digest for name, digest in sorted(stored["designs"].items()) if name in wanted}
    DIGESTS.write_text(f"{json.dumps({'hardware': stored['hardware'], 'designs': designs}, indent=1)}\n")


def _described(command: str) -> Provenance | str:
    """Return the current provenance of a command's figures, or the reason why the command is refused."""
    words = shlex.split(command)[1:]
    taken = 2 if " ".join(words[:2]) in COMMANDS else 1
    try:
        module = loaded(COMMANDS[" ".join(words[:taken])])
        return module.provenance(module.command_parser().parse_args(words[taken:]))
    except UserError as error:
        return str(error)


def _digested(design: Configuration) -> str:
    """Return the digest of a design's Verilog, or the reason why it has none."""
    try:
        return verilog_digest(design)
    except UserError as error:
        return f"refused: {error}"


def _changed(then: Digests, now: Digests | str) -> Sequence[str]:
    """Name everything whose digest has changed, appeared or disappeared."""
    if isinstance(now, str):
        return [f"the command, which is refused: {now}"]
    found = []
    for kind, digests in now.items():
        before = then.get(kind, {})
        found += sorted(name for name in digests.keys() | before.keys() if digests.get(name) != before.get(name))
    return found
