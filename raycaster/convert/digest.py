# SPDX-License-Identifier: MIT
"""Digests of Verilog without its comments, by which a measured figure knows the hardware that it was measured on."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from raycaster.configuration import Configuration
from raycaster.hdl.elaboration import elaborated, elaboration
from raycaster.hdl.hierarchy import convert_hierarchy
from raycaster.rtl.system.ports import module_ports
from raycaster.rtl.system.ray_caster_module import ray_caster_module
from raycaster.runs.digests import DIGITS, digest, uncommented


def verilog_digest(*designs: Configuration) -> str:
    """Digest the Verilog of `ray_caster_module` in each of these designs, in any order."""
    found = sorted({digest_of(design) for design in designs})
    return found[0] if len(found) == 1 else digest(found)


@cache
def digest_of(design: Configuration) -> str:
    """Digest the Verilog of one design."""
    with TemporaryDirectory() as directory, elaboration():
        top = elaborated(ray_caster_module, **module_ports(design), config=design)
        return files_digest(module.path for module in convert_hierarchy(top, Path(directory), ""))


def files_digest(paths: Iterable[Path]) -> str:
    """Digest Verilog files without their comments, in any order."""
    found = hashlib.sha256()
    for path in sorted(paths):
        found.update(f"{path.name}\0{uncommented(path.read_text())}\0".encode())
    return found.hexdigest()[:DIGITS]
