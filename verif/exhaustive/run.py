# SPDX-License-Identifier: MIT
"""`raycaster verify exhaustive`: check the arithmetic with every operand, or with millions, in compiled benches.

Each bench converts one block, compiles it with Verilator together with a C++ program that drives it back to back (one
result every `divider_steps` cycles, operands valid for one cycle only), and compares every result with 64-bit integer
arithmetic.

divider: F = 0, 1 to 3 bits per cycle, both roundings. The dividends are products of a slope's magnitude and a distance,
9 bits each; the divisors are magnitudes of slopes. Slopes of the screens are 0..190; here both factors and the divisor
take all values 0..511, which covers everything that a 9-bit multiplier can pass to the divider, for any screen: 67,592
different products, each with each of 512 divisors, 0 included.

intersection: a + b * (c - d) / e at full width, F = 0, 1, 4 and 8; random operands, three in eight of them corners, and
one vector in four with the quotient next to 0, 1 or the first value that overflows.

reduced: the same unit with every combination of operands, at a width that allows this. The 9 bits of the world and
those of the slopes are constants of the design, which are patched while the block is converted, for this bench only.
Four bits are the minimum: a division must take two cycles, and one of the cases computes three bits per cycle.
"""

from __future__ import annotations

import argparse
import re
import shlex
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import astuple, dataclass
from functools import partial
from operator import attrgetter
from pathlib import Path
from typing import Any
from unittest import mock

from rich.box import SIMPLE
from rich.table import Table
from rich.text import Text

import raycaster.configuration
import raycaster.rtl.common.widths
import raycaster.rtl.seed.divider
import raycaster.rtl.seed.intersection_helper
from raycaster.configuration import COORDINATE_BITS, Configuration, configure
from raycaster.convert.provenance import Provenance
from raycaster.errors import UserError
from raycaster.hdl.elaboration import elaboration
from raycaster.hdl.hierarchy import convert_hierarchy
from raycaster.hdl.signals import bit, signed, unsigned
from raycaster.jobs import add_job_options, executors, run_jobs
from raycaster.options import CommandParser
from raycaster.outcomes import Check, add_keep_option, keep
from raycaster.outcomes import Outcome as Kept
from raycaster.output import Console, printable
from raycaster.rtl.common.interfaces import Steps
from raycaster.rtl.common.widths import SLOPE_BITS, position_bits, product_bits
from raycaster.rtl.seed.divider import divider
from raycaster.rtl.seed.intersection_helper import intersection_helper
from raycaster.sim.simulator import build_program
from raycaster.verif.seeds import seed

SOURCES = Path(__file__).parent
INTERSECTIONS = 400_000_000
"""Number of random vectors of the intersection bench, over all its configurations."""

REDUCED_BITS = 5


class BenchError(Exception):
    """A bench ended without a result."""


class Mismatch(Exception):
    """A result of the hardware is wrong; the message has the operands and both results."""


@dataclass(frozen=True)
class Bench:
    """A block in one configuration, and its C++ program."""

    kind: str
    config: Configuration
    coordinate_bits: int
    slope_bits: int
    vectors: int
    """Number of vectors to run; 0 for all."""

    @property
    def label(self) -> str:
        """Name of the bench, unique in a run."""
        width = "" if self.kind != "reduced" else f"-w{self.coordinate_bits}"
        rounding = self.config.rounding[0]
        return f"{self.kind}{width}-f{self.config.fraction_bits}{rounding}-d{self.config.divider_bits}"

    @property
    def position_bits(self) -> int:
        """Width of positions and quotients."""
        return self.coordinate_bits + self.config.fraction_bits

    @property
    def total(self) -> int:
        """Number of vectors that it runs."""
        if self.vectors:
            return self.vectors
        if self.kind == "divider":
            products = {a * b for a in range(1 << self.slope_bits) for b in range(1 << self.position_bits)}
            return len(products) << self.slope_bits
        return 1 << (3 * self.position_bits + 2 * (self.slope_bits + 1))


@dataclass(frozen=True)
class Outcome:
    """Results of a bench."""

    vectors: int
    valid: int
    """Number of vectors whose quotient did not overflow and, for intersections, whose plane is ahead."""

    wrong: int
    seconds: float


def benches(intersections: int, divisions: int, reduced_bits: int) -> list[Bench]:
    """List all benches.

    Args:
        intersections: number of random vectors, divided among the configurations of that kind.
        divisions: number of divisions per configuration, spread over all possible ones; 0 for all.
        reduced_bits: width of positions and of slopes in the reduced bench.
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
    """Set the design's constants to the widths of the bench, in each module that has imported their names."""
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


def build_bench(bench: Bench, spoil: Callable[[str], str] = str) -> list[str]:
    """Convert and compile a bench.

    Args:
        bench: the bench.
        spoil: applied to each Verilog text, to show that the bench notices.

    Returns:
        The command that runs it.

    Raises:
        SimulationError: it could not be built.
    """
    with tempfile.TemporaryDirectory(prefix="exhaustive-") as scratch:
        with _widths(bench):
            function, arguments = _arguments(bench)
            steps = bench.config.divider_steps
            with elaboration():
                top = function(**arguments)
            modules = convert_hierarchy(top, Path(scratch), "// {module}")
        for module in modules:
            module.path.write_text(spoil(module.path.read_text()))
        widths = {
            "POSITION_BITS": bench.position_bits,
            "SLOPE_BITS": bench.slope_bits,
            "FRACTION_BITS": bench.config.fraction_bits,
            "STEPS": steps,
            "NEAREST": int(bench.config.rounding == "nearest"),
        }
        program = "divider" if bench.kind == "divider" else "intersection"
        return build_program(
            bench.label, modules[-1].name, [module.path for module in modules],
            [SOURCES / f"{program}.cpp", SOURCES / "common.h"], flags=("-O3", "-Wno-WIDTH", "--prefix", "Vdut"),
            compiler=("-O3", f"-I{SOURCES}", *(f"-D{name}={value}" for name, value in widths.items())),
        )  # fmt: skip


def run(command: Sequence[str], bench: Bench, number: int) -> Outcome:
    """Run a compiled bench to its end.

    Args:
        command: as returned by `build_bench`.
        bench: the bench.
        number: the seed.

    Raises:
        Mismatch: the hardware was wrong.
        BenchError: the bench itself failed.
    """
    begin = time.monotonic()
    done = subprocess.run([*command, str(bench.vectors), str(number)], stdout=subprocess.PIPE, text=True, check=False)
    first = re.search(r"^mismatch.*", done.stdout, re.M)
    counts = re.search(r"^done (\d+) (\d+) (\d+)", done.stdout, re.M)
    if first:
        raise Mismatch(f"{bench.label}: {first[0]}; {counts[3] if counts else 'more'} are wrong")
    if counts and done.returncode == 0:
        vectors, valid, wrong = map(int, counts.groups())
        return Outcome(vectors, valid, wrong, time.monotonic() - begin)
    raise BenchError(f"{bench.label}: ended without a result, code {done.returncode}")


def _check(bench: Bench, number: int) -> Outcome:
    return run(build_bench(bench), bench, number)


def show(outcomes: Mapping[Bench, Outcome], number: int, console: Console) -> None:
    """Print the table of results."""
    table = Table(title=f"No mismatch (seed {number})", title_justify="left", box=SIMPLE, padding=0)
    table.add_column("bench", no_wrap=True)
    for heading in ("vectors", "valid", "wrong", "seconds", "vectors/s"):
        table.add_column(heading, justify="right", no_wrap=True)

    def add(label: str, outcomes: Sequence[Outcome], style: str = "") -> None:
        vectors, valid, wrong, seconds = map(sum, zip(*map(astuple, outcomes), strict=True))
        rate = f"{vectors / max(seconds, 1e-9):,.0f}"
        table.add_row(Text(label, style), f"{vectors:,}", f"{valid:,}", f"{wrong:,}", f"{seconds:.1f}", rate)

    for kind in dict.fromkeys(bench.kind for bench in outcomes):
        of_kind = [(bench, outcome) for bench, outcome in outcomes.items() if bench.kind == kind]
        for bench, outcome in of_kind:
            add(bench.label, [outcome])
        add(kind, [outcome for _, outcome in of_kind], "bold")
        table.add_section()
    console.print(table)


def command_parser() -> CommandParser:
    """Build the parser of the command line."""
    parser = CommandParser("verify exhaustive", __doc__, "--only divider")
    parser.add_argument(
        "--only", metavar="PREFIX", default="", help="run only benches with this prefix: divider, intersection-f4, ..."
    )
    parser.add_argument(
        "--count", type=int, default=INTERSECTIONS, help="total number of random intersections (default: %(default)s)"
    )
    parser.add_argument(
        "--divisions", type=int, default=0, help="divisions per divider, spread over all (default: 0, which is all)"
    )
    parser.add_argument(
        "--reduced-bits", type=int, choices=(4, 5), default=REDUCED_BITS,
        help="width of the reduced unit; 5 means up to 134 million vectors per configuration (default: %(default)s)",
    )  # fmt: skip
    add_job_options(parser)
    parser.add_argument("--seed", type=int, default=seed(), help="seed of the operands (default: %(default)s)")
    add_keep_option(parser)
    return parser


def provenance(arguments: argparse.Namespace) -> Provenance:
    """Digest everything that decides the figures; three designs represent all of the arithmetic."""
    designs = [configure(), configure(divider_bits=2, rounding="nearest"), configure(divider_bits=3, fraction_bits=8)]
    return Provenance(designs, ["verif/exhaustive"])


def _check_of(title: str, kind: str) -> Check:
    def body(kept: Kept) -> str:
        found = kept.figures[kind]
        return f"{found['vectors']:,} operands, {found['wrong']} wrong"

    return Check(title, "seed", ["exhaustive"], body)


CHECKS = (
    _check_of("divider: every dividend that can occur over every divisor", "divider"),
    _check_of("intersection: random and corner operands, full width", "intersection"),
    _check_of("intersection: every operand, reduced width", "reduced"),
)


def main(argv: list[str] | None = None) -> int:
    """Run the command.

    Args:
        argv: its arguments, those of the process by default.

    Returns:
        Its exit code: 1 for a mismatch.

    Raises:
        UserError: there is no such bench, or a tool is missing.
    """
    arguments = command_parser().parse_args(argv)
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
    check = partial(_check, number=arguments.seed)
    with executors(arguments.scheduler, arguments.jobs) as make_executor:
        try:
            found = run_jobs("benches", check, chosen, make_executor, console, label=attrgetter("label"))
        except Mismatch as mismatch:
            label = str(mismatch).partition(":")[0]
            print(printable(f"{mismatch}\nrepeat with: {repeat.format(label=label)}", lines=True), file=sys.stderr)
            return 1
    outcomes = dict(zip(chosen, found, strict=True))
    show(outcomes, arguments.seed, console)
    kinds = {bench.kind: {"vectors": 0, "valid": 0, "wrong": 0} for bench in outcomes}
    for bench, outcome in outcomes.items():
        for name in kinds[bench.kind]:
            kinds[bench.kind][name] += getattr(outcome, name)
    keep(arguments, kinds, {"engine": "seed", "seed": arguments.seed}, provenance)
    print(printable(f"repeat with: {repeat.format(label=shlex.quote(arguments.only))}"))
    return 0
