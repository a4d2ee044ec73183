# SPDX-License-Identifier: MIT
"""The tables of measured figures, made of `results/*.json`, in Markdown; below each, when and how it was measured."""

from __future__ import annotations

import json
import re
from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import linear_regression
from typing import Any

from raycaster.configuration import configure
from raycaster.docs.facts import table
from raycaster.errors import UserError
from raycaster.report.designs import of_kept
from raycaster.report.hardware import describe
from raycaster.verif.benches.bus_bench import CYCLES
from raycaster.verif.upsets.bench import KINDS

RESULTS = Path(__file__).parents[1] / "results"

Outcome = Mapping[str, Any]


def outcome(name: str) -> Outcome:
    """What `raycaster.outcomes.keep` wrote.

    Raises:
        UserError: it cannot be read.
    """
    path = RESULTS / f"{name}.json"
    try:
        return json.loads(path.read_text())
    except OSError as error:
        raise UserError(f"{path}: cannot be read: {error.strerror}; a command with --keep {path} writes it") from None


def _asked(kept: Outcome, command: str = "") -> str:
    """The command line, without this beginning of it and without where it writes, which come last."""
    return re.split(r" --(?:output|keep)\b", kept["command"])[0].removeprefix(command).strip()


def measured(*names: str) -> str:
    """When, with what and by which command."""
    lines = []
    for name in names:
        kept = outcome(name)
        left_out = f"; not measured: {kept['scope']['left_out']}" if kept["scope"].get("left_out") else ""
        lines.append(f"`{_asked(kept)}`, {kept['date']}, commit {kept['commit']}{left_out}")
    return f"Measured: {'; '.join(lines)}."


def _with_source(body: str, *names: str) -> str:
    return f"{body}\n\n{measured(*names)}"


def _options(design: Mapping[str, Any]) -> str:
    return f"`{' '.join(f'{name.upper()}={value}' for name, value in design.items())}`"


def engines() -> str:
    """The README's table, and the line that says what it is of."""
    kept = outcome("engines")
    figures = kept["figures"]
    rows = [
        [
            _options(row["options"]), f"{row['columns']} x {row['rows']}",
            f"{row['wrong_vs_exact']:,} of {row['pixels']:,}", row["luts"], row["registers"], row["multipliers"],
            f"{row['clock_mhz']:g} MHz",
        ]
        for row in figures["designs"]
    ]  # fmt: skip
    headings = ["engine", "rays a frame", "wrong pixels", "LUT4", "registers", "multipliers", "clock it needs"]
    unlike = sum(row["wrong_vs_golden"] for row in figures["designs"])
    note = (
        f"Wrong pixels: those that differ from exact arithmetic, in {figures['scenes']} scenes. From the model of the "
        f"same engine, {unlike} pixels differ. Cells: of an ECP5, as Yosys counts them, before placing. Each design "
        f"holds {kept['scope']['rectangles']} rectangles; the seed engine has culling, the others do not."
    )
    return _with_source(f"{table(headings, rows)}\n\n{note}", "engines")


def work() -> str:
    """Units and cycles of the designs of the README's table, from their configurations."""
    rows = []
    for row in outcome("engines")["figures"]["designs"]:
        config = configure(**row["options"])
        rays = config.screen_geometry.columns * config.screen_geometry.rows
        rows.append([_options(row["options"]), f"{rays:,}", config.units, config.group_cycles,
                     f"{config.units / config.group_cycles:.3f}"])  # fmt: skip
    return table(
        ["engine", "pixels computed a frame", "units", "cycles for a pixel of each unit", "pixels a clock"], rows
    )


def scenes() -> str:
    """The seed engine's default design, scene by scene, without culling and with it."""
    without = {row["scene"]: row for row in outcome("sim-seed-without-culling")["figures"]["scenes"]}
    rows = []
    for row in outcome("sim-seed")["figures"]["scenes"]:
        slow = without[row["scene"]]["frame_cycles"]
        rows.append(
            [
                row["scene"], row["reflections"], row["pixels"], row["wrong_vs_golden"],
                f"{row['wrong_vs_exact']:,} ({row['wrong_vs_exact'] / row['pixels']:.2%})", row["worst_row_cycles"],
                row["worst_group_cycles"], slow, row["frame_cycles"], f"{row['frame_cycles'] / slow:.0%}",
            ]
        )  # fmt: skip
    headings = [
        "scene", "reflections", "pixels", "unlike the model", "unlike exact arithmetic", "slowest row", "slowest group",
        "frame, `CULLING=0`", "frame", "share",
    ]  # fmt: skip
    return _with_source(table(headings, rows), "sim-seed", "sim-seed-without-culling")


FAMILIES = {
    "ecp5": ("ECP5", "LUT4", ""),
    "cycloneive": ("Cyclone IV E", "logic elements", " of 9 bits"),
    "cyclonev": ("Cyclone V", "ALMs at least", " of 9 bits"),
}


def families() -> str:
    """The seed engine's default design in three families of chips."""
    found = outcome("area")["figures"]["families"]
    rows = []
    for name, (title, element, kind) in FAMILIES.items():
        whole = found[name]["units"]["32"]
        rows.append(
            [
                title, f"{whole['elements']:,} {element}", found[name]["shared"]["elements"],
                found[name]["unit"]["elements"], whole["registers"], f"{whole['multipliers']}{kind}",
            ]
        )  # fmt: skip
    return _with_source(table(["family", "logic", "shared", "one unit", "registers", "multipliers"], rows), "area")


def features() -> str:
    """What a camera that turns, mirrors and patterns take of each engine."""
    designs = outcome("features")["figures"]["designs"]
    plain = {row["engine"]: row["tables"] for row in designs if not row["options"]}
    rows = []
    for row in designs:
        units = configure(engine=row["engine"], **row["options"]).units
        part = ", one ray unit" if row["module"] == "ray_unit" else f", {units} units" if units > 1 else ""
        switches = " ".join(f"{name.upper()}=1" for name in row["options"])
        more = row["tables"] / plain[row["engine"]] - 1
        rows.append(
            [
                f"`ENGINE={row['engine']}`{part}", f"`{switches}`" if switches else "", row["tables"],
                f"{more:+.0%}" if switches else "", row["registers"], row["multipliers"],
            ]
        )  # fmt: skip
    headings = ["engine", "with", "LUT4", "more", "registers", "multipliers"]
    return _with_source(table(headings, rows), "features")


BUSES = {
    "avalon": ("Avalon-MM", "`avs_s0_*`", "words"),
    "axi4lite": ("AXI4-Lite", "`s_axi_*`", "bytes"),
    "wishbone": ("Wishbone B4, classic", "`wb_*`", "words"),
    "apb": ("APB4", "`s_apb_*`", "bytes"),
}


def buses() -> str:
    """What the registers may be behind; cycles as the bench of the buses measures them."""
    areas = {row["bus"]: row for row in outcome("bridges")["figures"]["bridges"]}
    rows = []
    for bus, (title, ports, unit) in BUSES.items():
        cycles = CYCLES.get(bus, {"write": 1, "read": 3})
        cells = [areas[bus][name] if bus in areas else 0 for name in ("tables", "registers")]
        rows.append([f"`BUS={bus}`", title, ports, unit, cycles["write"], cycles["read"], *cells])
    headings = ["", "bus", "ports", "addresses count", "cycles a write", "cycles a read", "LUT4", "registers"]
    return _with_source(table(headings, rows), "bridges")


def page_speed() -> str:
    """A frame of the page's walk, beside the same design compiled for the machine that measured it."""
    rows = [
        [
            f"`{row['scene']}`", f"{row['browser_ms']:.0f} ms", f"{row['native_ms']:.0f} ms",
            f"{row['browser_ms'] / row['native_ms']:.2f}", f"{row['shown']:.1f}",
        ]
        for row in outcome("web")["figures"]["scenes"]
    ]  # fmt: skip
    headings = ["scene", "a frame in Chromium", "natively", "ratio", "frames a second on the page"]
    return _with_source(table(headings, rows), "web")


LINEAR = 0.05
"""A count is called linear where no design is off its straight line by more than this share."""


def _scaling(option: str) -> str:
    """The designs that differ in one option, all engines."""
    lines = []
    for row in outcome("scaling")["figures"]["designs"]:
        if row["option"] != option:
            continue
        if "refused" in row:
            lines.append([f"`{row['engine']}`", row["value"], "refused", *6 * [""]])
            continue
        counts = [f"{row[name]:,}" for name in ("tables", "registers", "multipliers", "units", "frame_cycles")]
        time = f"{row['frame_ms']:.0f} ms" if "frame_ms" in row else ""
        lines.append([f"`{row['engine']}`", row["value"], *counts, f"{row['clock_mhz']:g} MHz", time])
    headings = [
        "engine", option, "LUT4", "registers", "multipliers", "units", "cycles a frame, at most", "clock it needs",
        "a frame in Verilator",
    ]  # fmt: skip
    return table(headings, lines)


def scaling_rectangles() -> str:
    """Designs of few and many rectangles."""
    return _with_source(_scaling("rectangles"), "scaling")


def scaling_reflections() -> str:
    """Designs of no and of many reflections."""
    return _scaling("reflections")


def scaling_units() -> str:
    """Designs of few and many ray units."""
    return _scaling("units")


def scaling_resolution() -> str:
    """Designs of few and many pixels."""
    return _scaling("resolution")


def line_through(values: Sequence[float], counts: Sequence[float]) -> tuple[float, float, float]:
    """The straight line of least squares: its value at 0, its slope, and by what share it is off at most."""
    slope, start = linear_regression(values, counts)
    off = max(abs(start + slope * value - count) / count for value, count in zip(values, counts, strict=True))
    return start, slope, off


def scaling_growth() -> str:
    """Which counts grow by a straight line, and by which."""
    found: dict[tuple[str, str], list[Mapping[str, Any]]] = defaultdict(list)
    for row in outcome("scaling")["figures"]["designs"]:
        if "refused" not in row and isinstance(row["value"], int):
            found[row["engine"], row["option"]].append(row)
    lines = []
    for (engine, option), series in found.items():
        for count, title in (("tables", "LUT4"), ("registers", "registers"), ("multipliers", "multipliers")):
            start, slope, off = line_through([row["value"] for row in series], [row[count] for row in series])
            formula = f"{start:,.1f} + {slope:,.1f} x {option}" if off <= LINEAR else "no straight line"
            lines.append([f"`{engine}`", option, title, formula, f"{off:.1%}"])
    return table(["engine", "over", "count", "it is", "off by at most"], lines)


ROUTED = ("seed", "exact", "beam-320x240", "beam-640x480", "beam-1280x720", "beam-1920x1080")
CELLS = ("TRELLIS_COMB", "TRELLIS_FF", "MULT18X18D", "DP16KD")


def _clock(figures: Mapping[str, Any], name: str) -> str:
    reached, required = figures["clocks"][name]
    return f"{reached:.2f} of {required:g} MHz{', **missed**' if name in figures['missed'] else ''}"


def routed() -> str:
    """Designs placed and routed for the ULX3S."""
    rows = []
    for name in ROUTED:
        kept = outcome(f"bitstream-{name}")
        figures = kept["figures"]
        counts = [f"{used:,} of {there:,}" for used, there in (figures["cells"][cell] for cell in CELLS)]
        command = _asked(kept, "raycaster bitstream")
        rows.append(
            [f"`{command}`" if command else "default", *counts, _clock(figures, "clk"), _clock(figures, "shift_clk"),
             f"{kept['date']}, {kept['commit']}"]
        )  # fmt: skip
    return table(["`raycaster bitstream`", *CELLS, "system clock", "shift clock", "measured at"], rows)


def boards() -> str:
    """What was placed and routed for boards, but for what `routed` has, with any seed."""
    rows = []
    for path in sorted(RESULTS.glob("bitstream-*.json")):
        kept = outcome(path.stem)
        figures = kept["figures"]
        if "kinds" not in figures or path.stem.partition("-seed-")[0].removeprefix("bitstream-") in ROUTED:
            continue
        kinds = figures["kinds"]
        counts = []
        for kind in (kinds["logic"], kinds["multipliers"]):
            used, there = figures["cells"][kind]
            counts.append(f"{used:,} of {there:,} {kind}")
        command = _asked(kept, "raycaster bitstream")
        link = _clock(figures, "shift_clk") if "shift_clk" in figures["clocks"] else ""
        rows.append([figures["title"], figures["chip"], f"`{command}`", *counts, _clock(figures, "clk"), link,
                     f"{kept['date']}, {kept['commit']}"])  # fmt: skip
    headings = ["board", "chip", "`raycaster bitstream`", "logic", "multipliers", "system clock", "shift clock",
                "measured at"]  # fmt: skip
    return table(headings, rows)


def icebreaker() -> str:
    """How many rectangles its chip takes, as far as was tried."""
    rows = []
    for path in sorted(RESULTS.glob("bitstream-icebreaker-*.json")):
        kept = outcome(path.stem)
        figures = kept["figures"]
        cells, kinds = figures["cells"], figures["kinds"]
        used, there = cells[kinds["logic"]]
        command = _asked(kept, "raycaster bitstream")
        rows.append(
            [f"`{command}`", figures["rectangles"], figures["reflections"], figures["rows"], figures["units"],
             f"{used:,} of {there:,}", _clock(figures, "clk"), f"{kept['date']}, {kept['commit']}"]
        )  # fmt: skip
    headings = ["`raycaster bitstream`", "rectangles", "reflections", "rows", "units", "logic cells", "clock",
                "measured at"]  # fmt: skip
    return table(headings, rows)


def tinytapeout() -> str:
    """What a scene takes as a Tiny Tapeout project, the chosen design first."""
    figures = outcome("tinytapeout")["figures"]
    rows = [
        [
            f"`ENGINE={row['engine']}`", f"{row['columns']} x {row['rows']}", row["gates"], row["registers"],
            row["buffer_bits"], row["products"], f"{row['tiles']:.1f}",
        ]
        for row in figures["designs"]
    ]  # fmt: skip
    note = (
        f"`{figures['scene']}`, built in. Tiles: one for {figures['gates_a_tile']:,} gates, and one for "
        f"{figures['registers_a_tile']} registers."
    )
    headings = ["engine", "rays a frame", "gates", "registers", "of them line buffer", "multiplications", "tiles"]
    return _with_source(f"{table(headings, rows)}\n\n{note}", "tinytapeout")


def routed_again() -> str:
    """What other seeds of the placement reach of the routed design at 1280x720."""
    found = []
    for path in sorted(RESULTS.glob("bitstream-beam-1280x720-seed-*.json")):
        figures = outcome(path.stem)["figures"]
        clocks = f"system clock {_clock(figures, 'clk')}, shift clock {_clock(figures, 'shift_clk')}"
        found.append(f"`SEED={figures['seed']}`: {clocks}")
    return "; ".join(found)


def modules_routed() -> str:
    """Modules without a board, placed and routed between registers at their pins."""
    rows = []
    for path in sorted(RESULTS.glob("area-beam-*.json")):
        kept = outcome(path.stem)
        figures = kept["figures"]
        counts = [f"{used:,} of {there:,}" for used, there in (figures["cells"][cell] for cell in CELLS)]
        clock = f"{figures['routed_mhz']:.2f} of {figures['clock_mhz']:g} MHz"
        missed = ", **missed**" if figures["routed_mhz"] < figures["clock_mhz"] else ""
        rows.append([f"`{_asked(kept)}`", *counts, clock + missed, f"{kept['date']}, {kept['commit']}"])
    return table(["command", *CELLS, "clock", "measured at"], rows)


def game_board() -> str:
    """The game on the ULX3S."""
    figures = outcome("bitstream-game")["figures"]
    (comb, there), (multipliers, blocks) = figures["cells"]["TRELLIS_COMB"], figures["cells"]["MULT18X18D"]
    cells = f"{comb:,} of {there:,} TRELLIS_COMB and {multipliers} of {blocks} multipliers"
    return f"{cells}, at {_clock(figures, 'clk')}"


def one_scene() -> str:
    """Cells of designs with a scene built in."""
    rows = []
    for scene, designs in outcome("fit")["figures"].items():
        luts = {(one["engine"], one["scope"]): one["luts"] for one in designs}
        cells = []
        for engine in ("seed", "exact", "beam"):
            general = luts[engine, "general"]
            cells += [general]
            cells += [f"{luts[engine, scope]:,} ({luts[engine, scope] / general:.0%})" for scope in ("rects", "all")]
        rows.append([scene, *cells])
    headings = [
        word
        for engine in ("seed", "exact", "beam")
        for word in (engine, f"{engine} `FIX=rects`", f"{engine} `FIX=all`")
    ]
    return _with_source(table(["scene", *headings], rows), "fit")


def error_and_time() -> str:
    """The best designs of the report, which were simulated and counted."""
    rows = [
        [describe(one.config), one.cells, f"{one.pixel_ns:.2f}", f"{one.frame_ms:.2f}", f"{one.error:.4%}"]
        for one in of_kept(outcome("report")["figures"]["designs"]).best
    ]
    headings = ["design", "LUT4", "a pixel, ns", "a frame, ms", "wrong pixels, mean share"]
    return _with_source(table(headings, rows), "report")


def beside() -> str:
    """Others' designs, ours, and software, in one run."""
    rows = []
    for one in outcome("beside")["figures"]["designs"]:
        counts = [f"{one[key]:,}" if key in one else "" for key in ("luts", "registers", "multipliers", "blocks")]
        clock = f"{one['routed_mhz']} of {one['clock_mhz']:g}" if "routed_mhz" in one else ""
        frame = f"{one['frame_s']:.3f} s"
        rows.append([one["design"], one["draws"], f"{one['pixels']:,}", *counts, clock, frame, one["commit"]])
    counted = ["LUT4", "registers", "multipliers", "blocks of RAM"]
    headings = ["design", "draws", "pixels", *counted, "routed, MHz of those it needs", "a frame", "commit"]
    return _with_source(table(headings, rows), "beside")


def _pixels(*names: str) -> str:
    figures = [outcome(name)["figures"] for name in names]
    scenes, pixels, wrong = (sum(one[key] for one in figures) for key in ("scenes", "pixels", "wrong_vs_golden"))
    return f"{scenes:,} scenes, {pixels:,} pixels, {wrong} wrong"


def _shown(name: str) -> str:
    rows = outcome(name)["figures"]["scenes"]
    return f"{sum(row['pixels'] for row in rows):,} pixels, {sum(row['wrong_vs_golden'] for row in rows)} wrong"


def _vectors(kind: str) -> str:
    found = outcome("exhaustive")["figures"][kind]
    return f"{found['vectors']:,} operands, {found['wrong']} wrong"


def _mutants() -> str:
    found = outcome("mutate")["figures"]
    every = sum(found[kind] for kind in ("caught", "equivalent", "contract", "explained", "surviving"))
    return (
        f"{every:,} faults in {found['modules']} modules: {found['caught']:,} caught, "
        f"{found['equivalent'] + found['contract']} change nothing (proved), {found['explained']} explained; "
        f"{found['caught_of_the_rest']:.1%} of those that change something are caught, {found['worst_caught']:.1%} in "
        "the worst module"
    )


def _code(name: str) -> str:
    found = outcome(name)["figures"]
    return ", ".join(f"{kind} {found[kind][0]:,} of {found[kind][1]:,}" for kind in ("lines", "conditions", "toggles"))


def _bins(name: str) -> str:
    found = outcome(name)["figures"]
    (hit, there), rays, shown = found["bins"], found["intersections"], found["scenes"]
    return f"{hit} of {there} bins, {rays:,} intersections, {shown} scenes"


def _proofs() -> str:
    found = outcome("prove-small")["figures"]
    return f"{found['proved']} of {found['proofs']} proved"


def _upsets(*names: str) -> str:
    figures = [outcome(name)["figures"] for name in names]
    cases = sum(one["cases"] for one in figures)
    hung = sum(one[kind].get("hangs", 0) for one in figures for kind in set(KINDS))
    flips = sum((Counter(one["upset"]) for one in figures), Counter())
    most = max(one["most_wrong"] for one in figures)
    return (
        f"{cases:,} cases, {hung} never came back. Of {flips.total():,} flipped bits "
        f"{flips['unseen']:,} did not show, the next StartScreen mended {flips['StartScreen']:,}, a commit "
        f"{flips['commit']:,}; at most {most} frames were wrong"
    )


def checks() -> str:
    """What the long commands found, each with its scope."""
    of_seed, before, of_exact, of_beam = "seed, culling", "seed, before culling", "exact, no culling", "beam"
    exact_culled = "exact, culling"
    game = outcome("game")["figures"]
    report = outcome("report")["figures"]
    lines: Sequence[tuple[str, str, str, tuple[str, ...]]] = (
        ("every scene, full size", of_seed, _shown("sim-seed"), ("sim-seed",)),
        ("random scenes, surfaces of all kinds, full size", of_seed, _pixels("soak-seed"), ("soak-seed",)),
        ("random and stiff scenes, turned cameras and surfaces of all kinds, full size", of_exact,
         _pixels("soak-exact", "soak-exact-stiff"), ("soak-exact", "soak-exact-stiff")),
        ("the same, 640x480", of_beam, _pixels("soak-beam", "soak-beam-stiff"), ("soak-beam", "soak-beam-stiff")),
        ("random scenes at 1920x1080, two pixels a clock", of_beam, _pixels("soak-beam-1920x1080"),
         ("soak-beam-1920x1080",)),
        ("scenes at 1920x1080, two pixels a clock", of_beam, _shown("sim-beam-1920x1080"), ("sim-beam-1920x1080",)),
        ("every scene built in, full size", of_exact, _shown("sim-exact-fixed"), ("sim-exact-fixed",)),
        ("every scene through the ECP5 netlist, tiny, 16 units", before, _shown("sim-netlist"), ("sim-netlist",)),
        ("the recorded game, full RTL", of_beam, f"{game['frames']} frames, {game['pixels']:,} pixels, {game['wrong']} "
         "wrong", ("game",)),
        ("divider: every dividend that can occur over every divisor", "seed", _vectors("divider"), ("exhaustive",)),
        ("intersection: random and corner operands, full width", "seed", _vectors("intersection"), ("exhaustive",)),
        ("intersection: every operand, reduced width", "seed", _vectors("reduced"), ("exhaustive",)),
        ("hit points of the stiff cases, every ray", "seed, no culling", f"{report['stiff_cases']} cases, "
         f"{report['unlike_golden']} unlike the model, {report['over_bound']} over their bound", ("report",)),
        ("proofs, the quick subset", "as the table below says", _proofs(), ("prove-small",)),
        ("faults planted in modules", "the modules' leaf tests", _mutants(), ("mutate",)),
        ("bits flipped, resets, misuse of the bus while it draws, tiny, 3 rectangles", "each, seed with culling",
         _upsets("upsets-seed", "upsets-exact", "upsets-beam"), ("upsets-seed", "upsets-exact", "upsets-beam")),
        ("code coverage", of_seed, _code("coverage"), ("coverage",)),
        ("functional coverage", of_seed, _bins("coverage"), ("coverage",)),
        ("code coverage", exact_culled, _code("coverage-exact"), ("coverage-exact",)),
        ("functional coverage", exact_culled, _bins("coverage-exact"), ("coverage-exact",)),
        ("code coverage", "beam", _code("coverage-beam"), ("coverage-beam",)),
        ("functional coverage", "beam", _bins("coverage-beam"), ("coverage-beam",)),
    )  # fmt: skip
    rows = []
    for what, scope, figure, names in lines:
        kept = [outcome(name) for name in names]
        commands = "<br>".join(f"`{_asked(one)}`" for one in kept)
        rows.append([what, scope, figure, commands, f"{kept[0]['date']}, {kept[0]['commit']}"])
    return table(["what", "engine", "found", "command", "measured at"], rows)


def not_mutated() -> str:
    """The modules that no fault is planted in."""
    return ", ".join(f"`{name}`" for name in outcome("mutate")["scope"]["left_out"].split(", "))


def tables() -> dict[str, str]:
    """All of them, by the names that pages use."""
    made = (
        engines, work, scenes, families, features, buses, page_speed, routed, boards, icebreaker, tinytapeout,
        routed_again, modules_routed, game_board, one_scene, error_and_time, beside, checks, not_mutated,
        scaling_rectangles, scaling_reflections, scaling_units, scaling_resolution, scaling_growth,
    )  # fmt: skip
    return {each.__name__: each() for each in made}
