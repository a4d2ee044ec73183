# SPDX-License-Identifier: MIT
"""Digests of everything that affects a measured figure: Verilog, code, data and tools."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory

from raycaster.configuration import Configuration
from raycaster.digests import DIGITS, code_digest, tool_versions, uncommented
from raycaster.hdl.elaboration import elaborated, elaboration
from raycaster.hdl.hierarchy import convert_hierarchy
from raycaster.outcomes import Digests
from raycaster.rtl.system.ports import module_ports
from raycaster.rtl.system.ray_caster_module import ray_caster_module

ROOT = Path(__file__).resolve().parents[1]


@dataclass(frozen=True)
class Provenance:
    """Everything that affects a command's figures.

    Attributes:
        designs: designs that it measures.
        sources: files and folders that affect the figures, by path in the project.
        tools: packages whose versions affect the figures.
        projects: digests of other Verilog that it measures, by name.
    """

    designs: Sequence[Configuration] = ()
    sources: Sequence[str] = ()
    tools: Sequence[str] = ()
    projects: Mapping[str, str] = field(default_factory=dict)

    def digests(self, known: Mapping[str, str] | None = None) -> Digests:
        """Compute the digests.

        Args:
            known: digests of designs, by the configuration's name; the others are computed.
        """
        known = known or {}
        designs = {design.name: known.get(design.name) or verilog_digest(design) for design in self.designs}
        return {
            "designs": {**designs, **self.projects},
            "sources": {name: code_digest(ROOT / name, ROOT) for name in self.sources},
            "tools": tool_versions(*self.tools),
        }


def verilog_digest(configuration: Configuration) -> str:
    """Digest the Verilog of `ray_caster_module`, without its comments."""
    with TemporaryDirectory() as directory, elaboration():
        top = elaborated(ray_caster_module, **module_ports(configuration), config=configuration)
        return files_digest(module.path for module in convert_hierarchy(top, Path(directory), ""))


def files_digest(paths: Iterable[Path]) -> str:
    """Digest Verilog files without their comments, in any order."""
    digest = hashlib.sha256()
    for path in sorted(paths):
        digest.update(f"{path.name}\0{uncommented(path.read_text())}\0".encode())
    return digest.hexdigest()[:DIGITS]
