# SPDX-License-Identifier: MIT
"""Taps: signals of a working ray unit, as named by `raycaster.debug.probes`, brought out of a machine for a page.

They are the signals from which `make trace` makes its table and takes its events. The unit is selected while the
machine runs; `machine.cpp` records the taps in every clock of a group, with `TAP_BITS` bits per signal.
"""

from __future__ import annotations

from raycaster.configuration import Configuration
from raycaster.debug.probes import DUT
from raycaster.debug.probes.engines import description_of
from raycaster.debug.probes.ray import Probe
from raycaster.play.machine import TOP

TAP_BITS = 32
UNIT_BITS = 8
FIRST = ("place_row", "place_column_offset", "steps_screen_to_ray", "done")
"""The first taps, which `machine.cpp` itself reads."""

UNPRINTED = ("valid", "nearest point", "ended before")
"""Quantities outside the table, which say which of its entries are meaningful, or where the ray goes on."""

DECODED = ("light",)
"""Quantities that the page itself derives from their signals."""

_TEXT = """\
// SPDX-License-Identifier: MIT
// Signals of one ray unit and of the control, {bits} bits each; all 0 if unit selects none.

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
    """List the probes brought out of a unit: all that are known before its pixel is shown."""
    return [
        probe
        for probe in description_of(config, unit).probes
        if (probe.shown or probe.quantity in UNPRINTED)
        and probe.event != "shown"
        and (not probe.decode or probe.quantity in DECODED)
    ]


def _controls(config: Configuration, unit: int) -> list[str]:
    """List the control's signals that events come from, including those of shadow passes."""
    description = description_of(config, unit)
    controls = [name for name in description.controls() if not name.startswith(description.video)]
    return controls + [
        name.replace("from_light", "steps_write_shadow") for name in controls if name.endswith("from_light")
    ]


def tapped_signals(config: Configuration, unit: int) -> list[str]:
    """List the full names of the signals brought out of a unit, beginning with those named in `FIRST`.

    All units have the same number of them, with corresponding signals at the same place.
    """
    controls = _controls(config, unit)
    first = [next(name for name in controls if name.endswith(f".{end}")) for end in FIRST]
    values = [name for probe in tapped_probes(config, unit) for name in probe.signals]
    return list(dict.fromkeys([*first, *controls, *values]))


def tap_facts(config: Configuration) -> dict:
    """Return the facts that the page needs to read the records of a design.

    Returns:
        units: number of units; count: number of taps; controls: the tap of each signal that events come from, by the
        last part of the signal's name; probes: which taps hold a quantity and when, as in a `Probe`, with taps instead
        of signals.
    """
    signals = tapped_signals(config, 0)
    place = {name: number for number, name in enumerate(signals)}
    return {
        "units": config.units,
        "count": len(signals),
        "controls": {name.rpartition(".")[2]: place[name] for name in _controls(config, 0)},
        "probes": [
            {
                **{name: getattr(probe, name) for name in ("quantity", "event", "late")},
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
    """Generate the module that `machine.v` instantiates if TAPS is defined."""
    cases, count = [], len(tapped_signals(config, 0))
    for unit in range(config.units):
        signed = {name for probe in tapped_probes(config, unit) if probe.signed for name in probe.signals}
        cases.append(f"    {UNIT_BITS}'d{unit}: begin")
        for number, name in enumerate(tapped_signals(config, unit)):
            value = name.replace(f"{DUT}.", f"{TOP}.ray_caster_module_i.", 1)
            # Each assignment stands alone, so that each value is extended according to its own sign.
            extended = f"$signed({value})" if name in signed else value
            cases.append(f"        values[{number * TAP_BITS} +: {TAP_BITS}] = {extended};")
        cases.append("    end")
    return _TEXT.format(bits=TAP_BITS, unit_bits=UNIT_BITS, count=count, cases="\n".join(cases))
