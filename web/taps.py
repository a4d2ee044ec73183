# SPDX-License-Identifier: MIT
"""What a page sees of a ray unit at work: the signals of `raycaster.debug.probes`, brought out of a machine.

They are those that the table of `make trace` is made of, and those that its events come from. A unit is chosen while
the machine runs; `machine.cpp` records what is brought out, in `TAP_BITS` bits a signal, in each clock of a group.
"""

from __future__ import annotations

from raycaster.configuration import Configuration
from raycaster.debug.probes.engines import description_of
from raycaster.debug.probes.ray import DUT, Probe
from raycaster.play.machine import TOP

TAP_BITS = 32
UNIT_BITS = 8
FIRST = ("place_row", "place_column_offset", "steps_screen_to_ray", "done")
"""The first taps: those that `machine.cpp` looks at."""

UNPRINTED = ("valid", "nearest point", "ended before")
"""Quantities that are no part of the table, but say what in it means something, or where the ray goes on."""

_TEXT = """\
// SPDX-License-Identifier: MIT
// Signals of one ray unit, and of the control, {bits} bits each; 0 while there is no such unit.

module taps (
    input  wire [{unit_bits}-1:0] unit,
    output reg  [{bits}*{count}-1:0] values
);

always @* begin
    values = 0;
    case (unit)
{cases}
    default: values = 0;
    endcase
end

endmodule
"""


def tapped_probes(config: Configuration, unit: int) -> list[Probe]:
    """What is brought out of a unit: all that is known before its pixel is shown.

    Args:
        config: a design with ray units.
        unit: which one of them.
    """
    return [
        probe
        for probe in description_of(config, unit).probes
        if (probe.shown or probe.quantity in UNPRINTED) and probe.event != "shown" and not probe.decode
    ]


def tapped_signals(config: Configuration, unit: int) -> list[str]:
    """The whole names of what is brought out of a unit, those that `FIRST` names first.

    Of each unit they are as many, and a signal's counterpart in another one has the same place.
    """
    description = description_of(config, unit)
    controls = [name for name in description.controls() if not name.startswith(description.video)]
    first = [next(name for name in controls if name.endswith(f".{end}")) for end in FIRST]
    values = [name for probe in tapped_probes(config, unit) for name in probe.signals]
    return list(dict.fromkeys([*first, *controls, *values]))


def tap_facts(config: Configuration) -> dict:
    """What the page must know to read the records: the arguments are those of `tapped_probes`.

    Returns:
        units: how many there are; count: of taps; controls: by the last part of its name, the tap of each signal that
        events come from; probes: what has which value when, as a `Probe` does, with taps in place of signals.
    """
    signals = tapped_signals(config, 0)
    place = {name: number for number, name in enumerate(signals)}
    controls = [name for name in description_of(config, 0).controls() if name in place]
    return {
        "units": config.units,
        "count": len(signals),
        "controls": {name.rpartition(".")[2]: place[name] for name in controls},
        "probes": [
            {
                "quantity": probe.quantity,
                "event": probe.event,
                "late": probe.late,
                "taps": [place[name] for name in probe.signals],
                "signed": bool(probe.signed),
                "colour": probe.colour is True,
                "scale": probe.scale,
                "printed": probe.shown,
            }
            for probe in tapped_probes(config, 0)
        ],
    }


def taps_verilog(config: Configuration) -> str:
    """The module that `machine.v` has where TAPS is defined; the arguments are those of `tapped_probes`."""
    cases = []
    for unit in range(config.units):
        signals = tapped_signals(config, unit)
        signed = {name for probe in tapped_probes(config, unit) if probe.signed for name in probe.signals}
        cases.append(f"    {UNIT_BITS}'d{unit}: begin")
        for number, name in enumerate(signals):
            value = name.replace(f"{DUT}.", f"{TOP}.ray_caster_module_i.", 1)
            # Each is as wide as its tap by its own kind of extension, as it is assigned alone.
            extended = f"$signed({value})" if name in signed else value
            cases.append(f"        values[{number * TAP_BITS} +: {TAP_BITS}] = {extended};")
        cases.append("    end")
    return _TEXT.format(bits=TAP_BITS, unit_bits=UNIT_BITS, count=len(signals), cases="\n".join(cases))
