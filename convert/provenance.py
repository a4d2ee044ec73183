# SPDX-License-Identifier: MIT
"""Digests of everything that decides a measured figure: Verilog, code, data and tools."""

from __future__ import annotations

import ast
import hashlib
import re
import tokenize
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from importlib.metadata import version
from io import StringIO
from pathlib import Path
from tempfile import TemporaryDirectory

from raycaster.configuration import Configuration
from raycaster.convert.elaboration import elaboration
from raycaster.convert.hierarchy import convert_hierarchy
from raycaster.outcomes import Digests
from raycaster.rtl.system.ports import module_ports
from raycaster.rtl.system.ray_caster_module import ray_caster_module

ROOT = Path(__file__).parents[1]
DIGITS = 16
"""Hexadecimal digits of a digest that are kept."""

DATA = (".v", ".cpp", ".h", ".c", ".js", ".toml", ".rdl", ".vlt", ".S", ".ld")
"""Suffixes of files that can decide a figure besides Python's."""


@dataclass(frozen=True)
class Provenance:
    """Everything that decides a command's figures.

    Attributes:
        designs: the designs that it measures.
        sources: files and folders that decide the figures too, by path in the project.
        tools: packages whose versions do.
        projects: digests of other Verilog that it measures, by name.
    """

    designs: Sequence[Configuration] = ()
    sources: Sequence[str] = ()
    tools: Sequence[str] = ()
    projects: Mapping[str, str] = field(default_factory=dict)

    def digests(self, known: Mapping[str, str] | None = None) -> Digests:
        """Digest all of it.

        Args:
            known: digests of designs, by the configuration's name; the others are made.
        """
        known = known or {}
        designs = {design.name: known.get(design.name) or verilog_digest(design) for design in self.designs}
        return {
            "designs": {**designs, **self.projects},
            "sources": {name: code_digest(ROOT / name) for name in self.sources},
            "tools": {name: version(name) for name in self.tools},
        }


def verilog_digest(configuration: Configuration) -> str:
    """Digest the Verilog of `ray_caster_module`, without its comments."""
    with TemporaryDirectory() as directory, elaboration():
        top = ray_caster_module(**module_ports(configuration), config=configuration)
        return files_digest(module.path for module in convert_hierarchy(top, Path(directory), ""))


def files_digest(paths: Iterable[Path]) -> str:
    """Digest Verilog files without their comments, whatever order they come in."""
    digest = hashlib.sha256()
    for path in sorted(paths):
        digest.update(f"{path.name}\0{uncommented(path.read_text())}\0".encode())
    return digest.hexdigest()[:DIGITS]


def code_digest(place: Path) -> str:
    """Digest a file, or all files in a folder that can decide a figure.

    Comments and docstrings of Python files do not count, and neither do empty lines.
    """
    paths = [place] if place.is_file() else [one for one in place.rglob("*") if one.suffix in (*DATA, ".py")]
    digest = hashlib.sha256()
    for path in sorted(paths):
        digest.update(f"{path.relative_to(ROOT)}\0".encode())
        digest.update(_code(path.read_text()).encode() if path.suffix == ".py" else path.read_bytes())
    return digest.hexdigest()[:DIGITS]


def uncommented(verilog: str) -> str:
    """Verilog without comments and empty lines."""
    return _filled(re.sub(r"//.*", "", line) for line in verilog.splitlines())


def _code(text: str) -> str:
    """Python without comments and docstrings: the text itself, as a syntax tree looks different in each Python."""
    lines = text.splitlines()
    for token in tokenize.generate_tokens(StringIO(text).readline):
        if token.type == tokenize.COMMENT:
            row, column = token.start
            lines[row - 1] = lines[row - 1][:column]
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str):
            for row in range(node.lineno, node.end_lineno + 1):
                lines[row - 1] = ""
    return _filled(lines)


def _filled(lines: Iterable[str]) -> str:
    """The lines that are not empty."""
    return "\n".join(line for line in map(str.rstrip, lines) if line)
