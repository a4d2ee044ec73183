# SPDX-License-Identifier: MIT
"""Tables of the measured figures in `results/`, in Markdown; `raycaster results --render` puts them on the pages."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Mapping
from functools import cache

from raycaster.cli.__main__ import loaded
from raycaster.cli.commands import COMMANDS
from raycaster.errors import UserError
from raycaster.report.designs import best_of, of_kept
from raycaster.runs.outcomes import RESULTS, Outcome, kept_outcome, kept_outcomes, table


def _engines(kept: Outcome) -> str:
    """The README's comparison, with a note below it."""
    figures, rows = kept.figures, []
    for row in figures["designs"]:
        options = " ".join(f"{name.upper()}={value}" for name, value in row["options"].items())
        wrong, clock = f"{row['wrong_vs_exact']:,} of {row['pixels']:,}", f"{row['clock_mhz']:g} MHz"
        counts = [row[kind] for kind in ("luts", "registers", "multipliers")]
        rows.append([f"`{options}`", f"{row['columns']} x {row['rows']}", wrong, *counts, clock])
    headings = ["engine", "rays per frame", "wrong pixels", "LUT4", "registers", "multipliers", "required clock"]
    unlike = sum(row["wrong_vs_golden"] for row in figures["designs"])
    return (
        f"{table(headings, rows)}\n\nWrong pixels differ from exact arithmetic, counted over {figures['scenes']} "
        f"scenes; {unlike or 'no'} pixels differ from the engine's own model. Cell counts are Yosys's for an ECP5, "
        f"before placement. Each design holds {figures['rectangles']} rectangles; the seed engine has culling, the "
        "others do not."
    )


def _scenes(kept: Outcome) -> str:
    """All scenes, each with the engine that `make sim` chooses."""
    rows = []
    for row in kept.figures["scenes"]:
        engine, wrong = row["configuration"].partition("-")[0], row["wrong_vs_exact"]
        counts = [row[name] for name in ("worst_row_cycles", "worst_group_cycles", "frame_cycles")]
        differ = [row["wrong_vs_golden"], f"{wrong:,} ({wrong / row['pixels']:.2%})"]
        rows.append([row["scene"], engine, row["reflections"], *differ, *counts, f"{row['sim_seconds']:.1f} s"])
    headings = [
        "scene", "engine", "reflections", "differ from the model", "differ from exact arithmetic", "slowest row",
        "slowest group", "frame", "simulated in",
    ]  # fmt: skip
    return table(headings, rows)


def _families(kept: Outcome) -> str:
    """Cells of the seed engine's default design in three families of chips."""
    titles = {
        "ecp5": "ECP5, LUT4",
        "cycloneive": "Cyclone IV E, logic elements",
        "cyclonev": "Cyclone V, ALMs at least",
    }
    rows = []
    for name, title in titles.items():
        found = kept.figures["families"][name]
        rows.append([title, *(found[kind] for kind in ("elements", "registers", "multipliers"))])
    return table(["family", "logic", "registers", "multipliers"], rows)


def _features(kept: Outcome) -> str:
    """Cells of each engine without and with its optional features, such as a turning camera."""
    rows = []
    for row in kept.figures["designs"]:
        switches = " ".join(f"{name.upper()}={value}" for name, value in row["options"].items())
        part = ", one ray unit" if row["module"] == "ray_unit" else ""
        counts = [row[kind] for kind in ("tables", "registers", "multipliers")]
        rows.append([f"`ENGINE={row['engine']}`{part}", f"`{switches}`" if switches else "", *counts])
    return table(["engine", "with", "LUT4", "registers", "multipliers"], rows)


def _bitstreams(*kept: Outcome) -> str:
    """Bitstreams that were placed and routed, by board."""
    rows = []
    for figures in (one.figures for one in kept):
        counts = [figures["cells"][figures["kinds"][kind]] for kind in ("logic", "multipliers")]
        clocks = [figures["clocks"].get(name) for name in ("clk", "shift_clk")]
        cells = [f"{used:,} of {there:,}" for used, there in counts]
        reached = [f"{one[0]:.2f} of {one[1]:g} MHz" if one else "" for one in clocks]
        rows.append(
            [figures["title"].partition(",")[0], figures["chip"], f"`{figures['configuration']}`", *cells, *reached]
        )
    return table(["board", "chip", "design", "logic cells", "multipliers", "system clock", "shift clock"], rows)


def _one_scene(kept: Outcome) -> str:
    """Cells of designs with a scene built in, also relative to the general design."""
    scopes, rows = ("rects", "all"), []
    engines = dict.fromkeys(one["engine"] for designs in kept.figures.values() for one in designs)
    for scene, designs in kept.figures.items():
        luts, cells = {(one["engine"], one["scope"]): one["luts"] for one in designs}, []
        for engine in engines:
            general = luts[engine, "general"]
            cells += [general, *(f"{luts[engine, scope]:,} ({luts[engine, scope] / general:.0%})" for scope in scopes)]
        rows.append([scene, *cells])
    headings = (word for engine in engines for word in (engine, *(f"{engine} `FIX={scope}`" for scope in scopes)))
    return table(["scene", *headings], rows)


def _error_and_time(kept: Outcome) -> str:
    """The designs on a frontier of error, time and cells."""
    rows = []
    for one in best_of(of_kept(kept.figures["designs"])):
        screen = one.config.screen_geometry
        pixel_ns = one.required_ms * 1e6 / screen.columns / screen.rows
        rows.append([one.title, one.cells, f"{pixel_ns:.2f}", f"{one.required_ms:.2f}", f"{one.error:.4%}"])
    return table(["design", "LUT4", "ns per pixel", "ms per frame", "mean share of wrong pixels"], rows)


SOAKED = "{scenes:,} scenes, {pixels:,} pixels, {wrong_vs_golden} wrong".format_map


def _covered(figures: Mapping[str, Mapping[str, int]]) -> str:
    """Lines and branches that were reached, by engine."""
    return ", ".join(f"{one['reached']:,} of {one['all']:,} ({name})" for name, one in figures.items())


CHECKS = {
    "--engine seed": ("random scenes, surfaces of all kinds, full size", "seed", SOAKED),
    "exact --turn": ("random scenes, turned cameras and surfaces of all kinds, full size", "exact", SOAKED),
    "exact --light": ("random scenes with lights, turned cameras and surfaces of all kinds, 64x48", "exact", SOAKED),
    "--engine span": ("random scenes with lights, turned cameras and surfaces of all kinds, 320x240", "span", SOAKED),
    "verify soak": ("random scenes", "as the command says", SOAKED),
    "verify prove": ("proofs", "as the table below says", "{proved} of {proofs} proved".format_map),
    "verify mutate": (
        "faults planted in modules", "the modules' leaf tests",
        "{caught:,} caught in {modules} modules, {surviving:,} not".format_map,
    ),
    "verify coverage": ("lines and branches reached in frames and benches", "each", _covered),
    "verify all": (
        "all tests, slow ones included", "each", "{passed:,} tests passed, {skipped} were skipped".format_map,
    ),
}  # fmt: skip
"""Rows of the table of long checks, by the first of these words in the command: check, engine, and figures in words."""


def _checks(*kept: Outcome) -> str:
    """The long checks."""
    rows = []
    for one in kept:
        title, engine, in_words = next(row for words, row in CHECKS.items() if words in one.command)
        rows.append([title, engine, in_words(one.figures), _measured(one)])
    return table(["check", "engine", "result", "measured"], rows)


TABLES: Mapping[str, tuple[str | tuple[str, ...], Callable[..., str]]] = {
    "engines": ("engines", _engines),
    "scenes": ("sim", _scenes),
    "families": ("area", _families),
    "features": ("features", _features),
    "bitstreams": (("bitstreams",), _bitstreams),
    "one_scene": ("fit", _one_scene),
    "error_and_time": ("report", _error_and_time),
    "checks": (("soak", "prove", "mutate", "coverage", "verify-all"), _checks),
}
"""Tables by the names of their markers in the pages: the file of a single outcome, or files of any number, and a
function that makes Markdown.
"""


def tables() -> dict[str, str]:
    """Return all tables in Markdown, by the names of their markers.

    Raises:
        UserError: as `kept_outcome`.
    """
    found = {}
    for name, (files, body) in TABLES.items():
        if isinstance(files, str):
            of_table = [kept_outcome(RESULTS / f"{files}.json")]
        else:
            of_table = [one for file in files for one in kept_outcomes(RESULTS / f"{file}.json")]
        found[name] = body(*of_table)
        if body is not _checks:
            left_out = "; ".join(dict.fromkeys(one.left_out for one in of_table if one.left_out))
            words = "; ".join(map(_measured, of_table)) + (f"; not measured: {left_out}" if left_out else "")
            found[name] += f"\n\nMeasured: {words}."
    return found | {"not_mutated": kept_outcome(RESULTS / "mutate.json").left_out}


def _measured(one: Outcome) -> str:
    return f"`{one.command}`, {one.date}{', **stale**' if is_stale(one) else ''}"


@cache
def current_digest(command: str) -> str:
    """Return the digest of the Verilog that a command would measure now; nothing if it is refused."""
    words = shlex.split(command)[1:]
    taken = 2 if " ".join(words[:2]) in COMMANDS else 1
    try:
        module = loaded(COMMANDS[" ".join(words[:taken])])
        return module.verilog(module.command_parser().parse_args(words[taken:]))
    except (KeyError, UserError):
        return ""


def is_stale(kept: Outcome) -> bool:
    """Return True if the Verilog that was measured is not that of today."""
    return kept.verilog != current_digest(kept.command)
