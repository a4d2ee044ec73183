# SPDX-License-Identifier: MIT
"""Compare every value of one pixel with the golden model, and find the first difference: `make trace`."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from rich.text import Text

from raycaster.complaints import as_typed
from raycaster.configuration import CHANNEL_BITS
from raycaster.debug.probes.engines import description_of
from raycaster.debug.probes.ray import (
    Number,
    Place,
    Probe,
    Ray,
    Reading,
    Value,
    channels_of,
    first_difference,
    packed,
    read,
)
from raycaster.debug.recorder import add_recording_options, build_and_record, pixel_place
from raycaster.debug.waves import Waves
from raycaster.design.options import CommandParser, given_options
from raycaster.errors import UserError
from raycaster.fit.fixing import design_of
from raycaster.golden.picture import colour_text
from raycaster.output import Console, Table, printable

PIXEL_EVENTS = ("mixed", "done", "listed", "shown")
WRONG = "bold red"
ERROR_DIGITS = 3


def show(ray: Ray, readings: Sequence[Reading], console: Console) -> None:
    """Print the life of a pixel: for each ray a table of its rectangles, and a table of everything else."""
    first, colour = first_difference(readings), _colour(ray.pixel, ray.config.colour_bits)
    console.print(f"{ray.design.path}, column {ray.column}, row {ray.row}: expected colour {colour}")
    for bounce in range(ray.reflections + 1):
        name = "the ray from the camera" if bounce == 0 else f"reflection {bounce}"
        lost = "" if ray.alive(bounce) else ": none, as the previous ray hit nothing"
        console.print(Text.assemble("\n", (name, "bold"), lost))
        # Values without a column in the table of rectangles are printed in the first table if they are wrong.
        lines, cells = [], []
        for reading in readings:
            if reading.place.bounce == bounce and reading.probe.event not in PIXEL_EVENTS:
                is_line = reading.place.rectangle is None or not reading.probe.shown
                (lines if is_line else cells).append(reading)
        console.print(_others(ray, lines, first))
        if ray.alive(bounce):
            console.print(_rectangles(ray, bounce, cells, first))
    console.print("\nthe pixel", style="bold")
    console.print(_others(ray, [reading for reading in readings if reading.probe.event in PIXEL_EVENTS], first))
    console.print(
        "*: what the ray sees. left out: not tested, as the ray cannot see it. exact: without rounding.", style="dim"
    )
    if first is None:
        console.print(
            "The hardware agrees with the golden model in every value of this pixel. Not compared: other pixels, and "
            "HS, VS and blanking outside it, which `raycaster sim` checks.",
            soft_wrap=True,
        )
        return
    console.print(difference_line(ray, first), style=WRONG, soft_wrap=True)


def difference_line(ray: Ray, reading: Reading) -> str:
    """Describe a difference between the hardware and the golden model in one line."""
    part, probe = reading.wrong or 0, reading.probe
    quantity = ", ".join((probe.quantity, *probe.parts[part : part + 1]))
    golden, found = (
        _text(ray, probe, values, like=reading.golden) if probe.is_channels else _one(ray, probe, part, values[part])
        for values in (reading.golden, reading.found)
    )
    of = "the ray" if reading.place.bounce == 0 else f"reflection {reading.place.bounce}"
    if reading.probe.event in PIXEL_EVENTS:
        of = "the pixel"
    if reading.place.rectangle is not None:
        of += f", rectangle {_label(ray, reading.place.rectangle)}"
    return (
        f"First difference: at {reading.time_ns:.0f} ns, {of}: {quantity} is {found}, "
        f"expected {golden}; module {reading.module}, signal {reading.signal}"
    )


def _others(ray: Ray, readings: Sequence[Reading], first: Reading | None) -> Table:
    """Make the table of readings that take a line each."""
    exactly = any(reading.probe.true for reading in readings)
    values = "golden", "hardware", *(("exact", "error") if exactly else ())
    table = Table("", *values, "ns", "module", texts=("module",))
    for reading in readings:
        probe = reading.probe
        if not probe.shown and reading.wrong is None:
            continue
        true = tuple(probe.true(ray, reading.place)) if probe.true else ()
        of = "" if reading.place.rectangle is None else f", {_label(ray, reading.place.rectangle)}"
        table.add_row(
            _named(probe) + of,
            _text(ray, probe, reading.golden),
            _found(ray, reading, first),
            *((_true_text(true), _error_text(ray, probe, reading.golden, true)) if exactly else ()),
            f"{reading.time_ns:.0f}",
            reading.module,
        )
    return table


def _rectangles(ray: Ray, bounce: int, readings: Sequence[Reading], first: Reading | None) -> Table:
    """Make the table of rectangles: golden values, below them the hardware's values, then the exact ones."""
    by_place = {(reading.place.rectangle, reading.probe.quantity): reading for reading in readings}
    probes = {reading.probe.quantity: reading.probe for reading in readings}
    table = Table("rectangle", "", *map(_named, probes.values()), texts=("",))
    for rectangle in range(len(ray.rectangles)):
        cells = [by_place.get((rectangle, quantity)) for quantity in probes]
        name = _label(ray, rectangle) + " *" * (ray.winner(bounce) == rectangle)
        if not any(cells):
            table.add_row(name, "left out", style="dim", end_section=True)
            continue
        place = Place(bounce, rectangle)
        true = [tuple(probe.true(ray, place)) if probe.true else () for probe in probes.values()]
        table.add_row(name, "golden", *(_text(ray, cell.probe, cell.golden) if cell else "" for cell in cells))
        table.add_row("", "hardware", *(_found(ray, cell, first) if cell else "" for cell in cells))
        if any(true):
            table.add_row("", "exact", *map(_true_text, true), style="dim")
            pairs = zip(cells, true, strict=True)
            errors = [_error_text(ray, cell.probe, cell.golden, value) if cell else "" for cell, value in pairs]
            table.add_row("", "error", *errors, style="dim", end_section=True)
    return table


def _named(probe: Probe) -> str:
    """Name a quantity, with the names of its values."""
    return f"{probe.quantity} ({', '.join(probe.parts)})" if probe.parts else probe.quantity


def _label(ray: Ray, rectangle: int) -> str:
    """A rectangle's number and name."""
    name = printable(ray.name(rectangle))
    return f"{rectangle} {name}" if name else str(rectangle)


def _found(ray: Ray, reading: Reading, first: Reading | None) -> Text:
    """Format the hardware's values; wrong ones stand out."""
    text = _text(ray, reading.probe, reading.found, like=reading.golden)
    if reading.wrong is None:
        return Text(text)
    return Text(f"{text} <- first" if reading is first else text, style=WRONG)


def _text(ray: Ray, probe: Probe, values: Sequence[Value], like: Sequence[Value] | None = None) -> str:
    """Format values; a dash stands for don't care."""
    likes = values if like is None else like
    if probe.is_channels and None not in likes:
        whole, bits = [value for value in values if isinstance(value, int)], _bits(ray, probe)
        return _colour(packed(whole, bits), bits) if len(whole) == len(values) else "unknown"
    pairs = enumerate(zip(values, likes, strict=True))
    return ", ".join("-" if hint is None else _one(ray, probe, number, value) for number, (value, hint) in pairs)


def _colour(value: int, bits: int) -> str:
    """Format a colour with this many bits per channel as #rrggbb."""
    return colour_text(channel << (CHANNEL_BITS - bits) for channel in channels_of(value, bits))


def _bits(ray: Ray, probe: Probe) -> int:
    """Bits per channel of a probe's colours."""
    return ray.config.colour_bits if probe.narrow else CHANNEL_BITS


def _one(ray: Ray, probe: Probe, number: int, value: Value) -> str:
    if value is None:
        return "unknown"
    if isinstance(value, str):
        return value
    if probe.is_colour(number):
        return _colour(int(value), _bits(ray, probe))
    if probe.scale and ray.config.fraction_bits:
        return f"{int(value) / (1 << ray.config.fraction_bits):g}"
    return str(int(value))


def _true_text(values: Sequence[Number]) -> str:
    return ", ".join(
        "-" if value is None else f"{float(value):.{ERROR_DIGITS}f}".rstrip("0").rstrip(".") for value in values
    )


def _error_text(ray: Ray, probe: Probe, golden: Sequence[Value], true: Sequence[Number]) -> str:
    """Format the errors of the golden model's values: their distances from the exact ones."""
    unit = 1 << ray.config.fraction_bits if probe.scale else 1
    errors = [
        "-" if value is None or exact is None else f"{float(Fraction(int(value), unit) - exact):+.{ERROR_DIGITS}f}"
        for value, exact in zip(golden, true, strict=False)
    ]
    return ", ".join("0" if error.strip("+-0.") == "" and error != "-" else error for error in errors)


def command_parser() -> CommandParser:
    """Make the command's parser."""
    parser = CommandParser("trace", __doc__, "boxes --pixel 160,120")
    add_recording_options(parser, "column and row of the ray, from 0")
    return parser


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command and return its exit code."""
    arguments = command_parser().parse_args(argv)
    if arguments.pixel is None:
        raise UserError(f"pixel: expected a ray's column and row, as in {as_typed('pixel', '160,120')}, got none")
    column, row = pixel_place(arguments.pixel)
    console = Console()
    design = design_of(arguments.scene, given_options(arguments), arguments.fix, console)
    ray = Ray(design, row, column)
    description = description_of(design.configuration, ray.unit)
    target = arguments.build / "trace" / design.name
    waves = build_and_record(arguments, design, (row, row), target, console)
    if waves is None:
        return 1
    readings = read(Waves(waves), description, ray)
    show(ray, readings, console)
    console.print(f"The waveform of the pixel's row is {waves}", soft_wrap=True)
    return int(first_difference(readings) is not None)
