# SPDX-License-Identifier: MIT
"""Write the top levels as Verilog, one file per module, with the files that other flows need."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial
from pathlib import Path

from raycaster.configuration import Configuration, need_avalon
from raycaster.convert.take_home import PREFIX, write_take_home
from raycaster.convert.vocabulary import VOCABULARY
from raycaster.errors import UserError
from raycaster.hdl.elaboration import elaborated, elaboration
from raycaster.hdl.hierarchy import Module, convert_hierarchy
from raycaster.hdl.internals import Block, EnumItemType, states_of
from raycaster.memory_map import PROGRAM_FILE
from raycaster.output import replaced
from raycaster.rtl.dvi.dvi_encoder import dvi_encoder
from raycaster.rtl.system.ports import dvi_ports, module_ports, scene_system_ports, serial_system_ports, system_ports
from raycaster.rtl.system.ray_caster_module import ray_caster_module
from raycaster.rtl.system.ray_caster_system import ray_caster_system
from raycaster.rtl.system.scene_system import scene_system
from raycaster.rtl.system.serial_system import serial_system
from raycaster.scene import Scene


def write_verilog(config: Configuration, directory: Path, prefix: str = "") -> list[Path]:
    """Write the ray tracer, `ray_caster_module`, and the files that other flows need.

    This and the other functions here replace the directory as a whole, once everything is generated. The same arguments
    always produce identical files.

    Args:
        config: the design to generate.
        directory: output directory.
        prefix: prefix, such as `PREFIX`, for the names of all modules without it, which makes them unique in a larger
            design; none in the project's own simulations.

    Returns:
        The modules' files, each after those that it instantiates; the top is the last.

    Raises:
        UserError: no Verilog name can begin with the prefix.
    """
    if prefix and not re.fullmatch(r"[A-Za-z_]\w*", prefix, re.ASCII):
        raise UserError(f"prefix: expected the beginning of a Verilog name, such as {PREFIX}, got {prefix}")
    return _write(
        config,
        directory,
        lambda: elaborated(ray_caster_module, **module_ports(config), config=config),
        partial(write_take_home, config, prefix),
        prefix,
    )


def write_scene_system(config: Configuration, scene: Scene, directory: Path) -> list[Path]:
    """Write `scene_system`, which has no processor, with a scene that fits the hardware.

    Raises:
        UserError: the configuration has another bus than Avalon-MM.
    """
    need_avalon(config, "a system without a processor")
    return _write(
        config, directory, lambda: elaborated(scene_system, **scene_system_ports(config), config=config, scene=scene)
    )


def write_serial_system(config: Configuration, directory: Path) -> list[Path]:
    """Write `serial_system`, for a configuration with the bus uart."""
    return _write(config, directory, lambda: elaborated(serial_system, **serial_system_ports(config), config=config))


def write_system(config: Configuration, directory: Path, program: str = PROGRAM_FILE) -> list[Path]:
    """Write `ray_caster_system`; PicoRV32 is among the files, unchanged.

    Args:
        config: the design to generate.
        directory: output directory.
        program: file with the words of the program, in hexadecimal; a simulator opens it where it runs, a synthesis
            tool where it reads the Verilog.

    Raises:
        UserError: PicoRV32 is not installed, or the configuration has another bus than Avalon-MM.
    """
    need_avalon(config, "a system with a processor")
    return _write(
        config,
        directory,
        lambda: elaborated(ray_caster_system, **system_ports(config), config=config, program=program),
    )


def write_dvi_encoder(config: Configuration, directory: Path) -> list[Path]:
    """Write `dvi_encoder`, which turns a VGA output with 8 bits per channel into a DVI link.

    The configuration only goes into the headers of the files.
    """
    return _write(config, directory, lambda: elaborated(dvi_encoder, **dvi_ports()))


def state_names(top: Block) -> dict[tuple[str, str], dict[int, str]]:
    """Find the enumerated signals of an elaborated design.

    Returns:
        By module and signal, the name of each value as encoded in Verilog.
    """
    found = {}
    for name, signal in top.sigdict.items():
        if isinstance(signal.val, EnumItemType):
            states = states_of(signal.val)
            found[top.func.__name__, name] = {int(code, 2): state for state, code in states.items()}
    for sub in top.subs:
        if isinstance(sub, Block):
            found |= state_names(sub)
    return found


def design_states(config: Configuration) -> dict[tuple[str, str], dict[int, str]]:
    """Return the enumerated signals of `ray_caster_module`; see `state_names`."""
    with elaboration():
        return state_names(elaborated(ray_caster_module, **module_ports(config), config=config))


def _write(
    config: Configuration,
    directory: Path,
    elaborate: Callable[[], Block],
    complete: Callable[[list[Module], Path], None] | None = None,
    prefix: str = "",
) -> list[Path]:
    with replaced(directory) as written:
        with elaboration():
            modules = convert_hierarchy(elaborate(), written, _header(config), prefix, VOCABULARY)
        if complete:
            complete(modules, written)
    return [directory / module.path.name for module in modules]


def _header(config: Configuration) -> str:
    return f"// RayCaster: {{module}}\n// Configuration: {config.name}\n// SPDX-License-Identifier: MIT"
