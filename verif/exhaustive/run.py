# SPDX-License-Identifier: MIT
"""`raycaster verify exhaustive`: the arithmetic at a volume that only compiled benches reach.

Each bench converts one block, compiles it with Verilator together with a C++ program that drives it back to back (a
result each `divider_steps` cycles, operands held for the one cycle in which they may be looked at), and checks every
result against 64-bit integer arithmetic.

divider: F = 0, 1 to 3 bits a cycle, both roundings. Its dividends are products of a slope's magnitude and a distance,
9 bits each, and its divisors are slopes' magnitudes. The screens' slopes are 0..190; here both factors and the divisor
take all of 0..511, which is everything that a 9-bit multiplier can hand to the divider, whatever the screen: the 67,592
different products, each over each of 512 divisors, 0 included.

intersection: a + b * (c - d) / e at full width, F = 0, 1, 4 and 8; random operands, three in eight of them corners, and
one vector in four with the quotient next to 0, 1 or the first that overflows.

reduced: the same unit with every combination of operands, at a width where they can be counted. The world's 9 bits and
the slopes' are constants of the design, which are patched while the block is converted, and only for this bench. Four
bits are the least: a division must take two cycles, and three bits a cycle are one of the cases.
"""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from unittest import mock

from rich.box import SIMPLE
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table

import raycaster.configuration
import raycaster.rtl.common.widths
import raycaster.rtl.seed.divider
import raycaster.rtl.seed.intersection_helper
from raycaster.configuration import COORDINATE_BITS, Configuration, configure
from raycaster.convert.elaboration import elaboration
from raycaster.convert.hierarchy import convert_hierarchy
from raycaster.errors import UserError
from raycaster.options import CommandParser
from raycaster.rtl.common.interfaces import Steps
from raycaster.rtl.common.widths import SLOPE_BITS, bit, position_bits, product_bits, signed, unsigned
from raycaster.rtl.seed.divider import divider
from raycaster.rtl.seed.intersection_helper import intersection_helper
from raycaster.sim.simulator import find_tool
from raycaster.verif.seeds import seed

SOURCES = Path(__file__).parent
INTERSECTIONS = 400_000_000
"""Random vectors of the intersection bench, over all of its configurations."""

REDUCED_BITS = 5
COMPILER = ("g++", "-std=gnu++20", "-pthread")
# What Verilator's own makefile would define.
DEFINITIONS = tuple(
    f"-DVM_{name}=0" for name in ("COVERAGE", "SC", "TIMING", "TRACE", "TRACE_FST", "TRACE_VCD", "TRACE_SAIF")
)
RUNTIME = ("verilated.cpp", "verilated_threads.cpp")


class BenchError(Exception):
    """A bench that could not be built or did not end by itself; the text says what its tool said."""


class Mismatch(Exception):
    """A result that the hardware got wrong: operands and both results."""


@dataclass(frozen=True)
class Bench:
    """One block in one configuration, and its C++ program."""

    kind: str
    config: Configuration
    coordinate_bits: int
    slope_bits: int
    vectors: int
    """How many it runs; 0 for all that there are."""

    @property
    def label(self) -> str:
        """A name that no other bench of a run has."""
        width = "" if self.kind != "reduced" else f"-w{self.coordinate_bits}"
        rounding = self.config.rounding[0]
        return f"{self.kind}{width}-f{self.config.fraction_bits}{rounding}-d{self.config.divider_bits}"

    @property
    def position_bits(self) -> int:
        """Of positions and quotients."""
        return self.coordinate_bits + self.config.fraction_bits

    @property
    def total(self) -> int:
        """Vectors that it will run."""
        if self.vectors:
            return self.vectors
        if self.kind == "divider":
            products = {a * b for a in range(1 << self.slope_bits) for b in range(1 << self.position_bits)}
            return len(products) << self.slope_bits
        return 1 << (3 * self.position_bits + 2 * (self.slope_bits + 1))


@dataclass(frozen=True)
class Outcome:
    """What a bench that found nothing did."""

    vectors: int
    valid: int
    """Of them, those whose quotient did not overflow and, for intersections, whose plane lay ahead."""

    seconds: float


def benches(intersections: int, divisions: int, reduced_bits: int) -> list[Bench]:
    """All benches.

    Args:
        intersections: random vectors, shared by the configurations of that kind.
        divisions: of each configuration, spread over all that there are; 0 for all.
        reduced_bits: bits of positions in the reduced bench, and of slopes.
    """
    found = []
    for rounding in ("truncate", "nearest"):
        for bits in (1, 2, 3):
            config = _config(0, rounding, bits)
            found.append(Bench("divider", config, COORDINATE_BITS, SLOPE_BITS, divisions))
    fractions = (0, 1, 4, 8)
    share = -(-intersections // (len(fractions) * 6))
    for fraction_bits in fractions:
        for rounding in ("truncate", "nearest"):
            for bits in (1, 2, 3):
                config = _config(fraction_bits, rounding, bits)
                found.append(Bench("intersection", config, COORDINATE_BITS, SLOPE_BITS, share))
    for fraction_bits in (0, 1):
        for rounding in ("truncate", "nearest"):
            for bits in (1, 2, 3):
                config = _config(fraction_bits, rounding, bits)
                width = reduced_bits - fraction_bits
                found.append(Bench("reduced", config, width, width, 0))
    return found


def _config(fraction_bits: int, rounding: str, divider_bits: int) -> Configuration:
    return configure(fraction_bits=fraction_bits, rounding=rounding, divider_bits=divider_bits, allow_underrun=True)


@contextmanager
def _widths(bench: Bench) -> Iterator[None]:
    """The design's constants as the bench wants them, in each module that has a name of its own for them."""
    patches = [
        (raycaster.configuration, "COORDINATE_BITS", bench.coordinate_bits),
        (raycaster.rtl.common.widths, "COORDINATE_BITS", bench.coordinate_bits),
        (raycaster.rtl.common.widths, "SLOPE_BITS", bench.slope_bits),
        (raycaster.rtl.seed.divider, "SLOPE_BITS", bench.slope_bits),
        (raycaster.rtl.seed.intersection_helper, "SLOPE_BITS", bench.slope_bits),
    ]
    with ExitStack() as stack:
        for module, name, value in patches:
            stack.enter_context(mock.patch.object(module, name, value))
        yield


def _arguments(bench: Bench) -> tuple[Callable, dict[str, Any]]:
    config = bench.config
    slope, position = bench.slope_bits, position_bits(config)
    if bench.kind == "divider":
        return divider, {
            "clk": bit(),
            "load_divider": bit(),
            "store_quotient": bit(),
            "dividend": unsigned(product_bits(config)),
            "divisor": unsigned(slope),
            "quotient": unsigned(position),
            "overflow": bit(),
            "config": config,
        }
    return intersection_helper, {
        "clk": bit(),
        "steps": Steps(),
        **{name: unsigned(position) for name in ("a", "c", "d")},
        **{name: unsigned(slope) for name in ("b", "e")},
        **{name: bit() for name in ("b_negative", "e_negative", "valid", "towards")},
        "value": signed(position + 2),
        **{name: unsigned(position) for name in ("quotient", "distance")},
        "config": config,
    }


class Builder:
    """Compiles benches, and what all of them link with once.

    Args:
        directory: scratch space.
    """

    def __init__(self, directory: Path):
        self._directory = directory
        self._environment = {**os.environ, **find_tool("verilator").environment}
        self._include = Path(self._call(directory, "verilator", "--getenv", "VERILATOR_ROOT").strip()) / "include"
        self._runtime: list[Path] = []

    def build(self, bench: Bench, spoil: Callable[[str], str] = str) -> Path:
        """Convert and compile.

        Args:
            bench: what.
            spoil: applied to each Verilog text, to show that the bench would notice.

        Returns:
            The executable.
        """
        directory = Path(tempfile.mkdtemp(dir=self._directory, prefix=bench.label))
        model = directory / "model"
        with _widths(bench):
            function, arguments = _arguments(bench)
            steps = bench.config.divider_steps
            with elaboration():
                top = function(**arguments)
            modules = convert_hierarchy(top, directory, "// {module}")
        for module in modules:
            module.path.write_text(spoil(module.path.read_text()))
        files = [module.path.name for module in modules]
        self._call(
            directory, "verilator", "--cc", "-O3", "-Wno-fatal", "-Wno-WIDTH", "--prefix", "Vdut", "--Mdir", "model",
            "--top-module", modules[-1].name, *files,
        )  # fmt: skip
        program = "divider" if bench.kind == "divider" else "intersection"
        # As one text it compiles several times as fast as file by file, and the clock's two edges inline.
        parts = [*sorted(path.name for path in model.glob("*.cpp")), SOURCES / f"{program}.cpp"]
        (model / "all.cc").write_text("".join(f'#include "{part}"\n' for part in parts))
        widths = {
            "POSITION_BITS": bench.position_bits,
            "SLOPE_BITS": bench.slope_bits,
            "FRACTION_BITS": bench.config.fraction_bits,
            "STEPS": steps,
            "NEAREST": int(bench.config.rounding == "nearest"),
        }
        self._compile(
            model, *(f"-D{name}={value}" for name, value in widths.items()), "-O3", "all.cc", *self._link(), "-o", "run"
        )
        return model / "run"

    def _link(self) -> list[Path]:
        if not self._runtime:
            for source in RUNTIME:
                target = self._directory / f"{source}.o"
                self._compile(self._directory, "-O1", "-c", self._include / source, "-o", target)
                self._runtime.append(target)
        return self._runtime

    def _compile(self, directory: Path, *arguments: str | Path) -> None:
        includes = (f"-I{self._include}", f"-I{self._include / 'vltstd'}", f"-I{SOURCES}", "-I.")
        self._call(directory, *COMPILER, *DEFINITIONS, *includes, *map(str, arguments))

    def _call(self, directory: Path, *command: str) -> str:
        done = subprocess.run(
            command, cwd=directory, env=self._environment, capture_output=True, text=True, check=False
        )
        if done.returncode:
            raise BenchError(f"{shlex.join(command)}: {done.stdout}{done.stderr}")
        return done.stdout


def run(executable: Path, bench: Bench, number: int, report: Callable[[int], None]) -> Outcome:
    """Run a compiled bench to its end or first mismatch.

    Args:
        executable: what `Builder.build` made.
        bench: of which.
        number: the seed.
        report: told now and then how many vectors are done.

    Raises:
        Mismatch: the hardware was wrong.
        BenchError: the bench itself failed.
    """
    begin = time.monotonic()
    with subprocess.Popen([executable, str(bench.vectors), str(number)], stdout=subprocess.PIPE, text=True) as process:
        try:
            for line in process.stdout:
                if match := re.match(r"progress (\d+)", line):
                    report(int(match[1]))
                elif match := re.match(r"done (\d+) (\d+)", line):
                    return Outcome(int(match[1]), int(match[2]), time.monotonic() - begin)
                elif line.startswith("mismatch"):
                    raise Mismatch(f"{bench.label}: {line.strip()}")
        finally:
            process.terminate()
    raise BenchError(f"{bench.label}: ended without a result, code {process.returncode}")


def show(outcomes: Mapping[Bench, Outcome], number: int, console: Console) -> None:
    """The table of results."""
    table = Table(title=f"No mismatch (seed {number})", title_justify="left", box=SIMPLE, padding=0)
    table.add_column("bench", no_wrap=True)
    for heading in ("vectors", "valid", "wrong", "seconds", "vectors/s"):
        table.add_column(heading, justify="right", no_wrap=True)

    def add(label: str, vectors: int, valid: int, seconds: float) -> None:
        rate = f"{vectors / max(seconds, 1e-9):,.0f}"
        table.add_row(label, f"{vectors:,}", f"{valid:,}", "0", f"{seconds:.1f}", rate)

    for kind in dict.fromkeys(bench.kind for bench in outcomes):
        of_kind = [(bench, outcome) for bench, outcome in outcomes.items() if bench.kind == kind]
        for bench, outcome in of_kind:
            add(bench.label, outcome.vectors, outcome.valid, outcome.seconds)
        results = [outcome for _, outcome in of_kind]
        add(
            f"[bold]{kind}", sum(r.vectors for r in results), sum(r.valid for r in results),
            sum(r.seconds for r in results),
        )  # fmt: skip
        table.add_section()
    console.print(table)


def main(argv: list[str] | None = None) -> int:
    """The command.

    Args:
        argv: its arguments, those of the process by default.

    Returns:
        Its exit code: 1 for a mismatch.

    Raises:
        UserError: no such bench, or a tool is missing.
    """
    parser = CommandParser("verify exhaustive", __doc__, "--only divider")
    parser.add_argument(
        "--only", metavar="PREFIX", default="", help="only benches whose name begins so: divider, intersection-f4, ..."
    )
    parser.add_argument(
        "--count", type=int, default=INTERSECTIONS, help="random intersections in all (default: %(default)s)"
    )
    parser.add_argument(
        "--divisions", type=int, default=0, help="of each divider, spread over all (default: 0, which is all)"
    )
    parser.add_argument(
        "--reduced-bits", type=int, choices=(4, 5), default=REDUCED_BITS,
        help="width of the reduced unit; 5 means up to 134 million vectors a configuration (default: %(default)s)",
    )  # fmt: skip
    parser.add_argument("--seed", type=int, default=seed(), help="(default: %(default)s)")
    arguments = parser.parse_args(argv)
    if arguments.count < 1 or arguments.divisions < 0 or arguments.seed < 0:
        raise UserError("--count must be at least 1, --divisions and --seed at least 0")
    every = benches(arguments.count, arguments.divisions, arguments.reduced_bits)
    chosen = [bench for bench in every if bench.label.startswith(arguments.only)]
    if not chosen:
        raise UserError(f"--only: no bench begins with {arguments.only}; there are {', '.join(b.label for b in every)}")

    repeat = (
        f"raycaster verify exhaustive --only {{label}} --count {arguments.count} "
        f"--divisions {arguments.divisions} --reduced-bits {arguments.reduced_bits} --seed {arguments.seed}"
    )
    console = Console()
    outcomes: dict[Bench, Outcome] = {}
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with (
        tempfile.TemporaryDirectory(prefix="exhaustive-") as scratch,
        Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bars,
    ):
        builder = Builder(Path(scratch))
        whole = bars.add_task("benches", total=len(chosen))
        for bench in chosen:
            bar = bars.add_task(bench.label, total=bench.total)
            try:
                outcomes[bench] = run(
                    builder.build(bench), bench, arguments.seed, lambda done, bar=bar: bars.update(bar, completed=done)
                )
            except Mismatch as mismatch:
                print(f"{mismatch}\nrepeat with: {repeat.format(label=bench.label)}", file=sys.stderr)
                return 1
            bars.remove_task(bar)
            bars.advance(whole)
    show(outcomes, arguments.seed, console)
    print(f"repeat with: {repeat.format(label=shlex.quote(arguments.only))}")
    return 0
