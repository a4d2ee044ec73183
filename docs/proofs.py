# SPDX-License-Identifier: MIT
"""Tables of proofs and other checks per block, from the lists that the commands themselves use."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from raycaster import rtl
from raycaster.configuration import Configuration, configure
from raycaster.docs.facts import table
from raycaster.verif.formal.alone import FIXED_SCENE, TableAlone
from raycaster.verif.formal.lemmas import LEMMAS
from raycaster.verif.formal.properties import PROPERTIES
from raycaster.verif.formal.prover import Property
from raycaster.verif.mutation.mutate import expectations

RTL = Path(rtl.__file__).parent
TESTS = RTL.parent / "verif" / "tests"

FOLDERS = ("exact", "engine", "beam", "seed", "cull", "scene", "bus", "video", "common", "dvi", "system")
"""Folders that come first in the table of blocks; other folders follow."""

UNGATED = "clock_gate"
"""Module that no proof covers: proofs are about the Verilog for FPGAs, in which it is a wire."""


def scale(of_it: Sequence[Property]) -> tuple[bool, str]:
    """Return whether one of a property's designs has the full widths of a default design, and the sizes of all of them.

    The number of rectangles is a width if the property covers their index or their memory. The number of reflections is
    a range if the property uses it.
    """
    alone = [proof.parameters for proof in of_it if not isinstance(proof.design, Configuration)]
    narrow = [parameters["COORDINATE_BITS"] for parameters in alone if "COORDINATE_BITS" in parameters]
    tables = [len(FIXED_SCENE.rect) for proof in of_it if isinstance(proof.design, TableAlone)]
    configured = [(proof, proof.design) for proof in of_it if isinstance(proof.design, Configuration)]
    counts = [
        design.rectangles
        for proof, design in configured
        if "INDEX_BITS" in proof.parameters or {"rect_mem", "rect_sequencer"} & {*proof.modules}
    ]
    mirrors = [design.reflections for proof, design in configured if {"REFLECTIONS", "MIRRORS"} & {*proof.parameters}]
    mirrors += [parameters["MIRRORS"] for parameters in alone if "MIRRORS" in parameters]
    full = not narrow and not tables and (not counts or max(counts) >= configure().rectangles)
    sizes = [] if narrow or not full else ["full width"]
    for numbers, unit in ((narrow, "bits"), (tables + counts, "rectangles"), (mirrors, "reflections")):
        sizes += [f"{_values(numbers)} {unit}"] if numbers else []
    sizes += ["bounded waits"] if any("MOST_WAIT" in proof.parameters for proof in of_it) else []
    return full, ", ".join(sizes)


def _values(numbers: list[int]) -> str:
    """Format numbers as a list, or as a range if they are consecutive."""
    found = sorted(set(numbers))
    if len(found) > 2 and found == list(range(found[0], found[-1] + 1)):
        return f"{found[0]} to {found[-1]}"
    return " and ".join(filter(None, [", ".join(map(str, found[:-1])), str(found[-1])]))


def _proofs(module: str) -> tuple[str, str]:
    """Return a module's properties at full width, and its properties for smaller designs."""
    of_it = [proof for proof in PROPERTIES if module in proof.modules and module not in (*proof.cut, UNGATED)]
    full, small = [], []
    for name in dict.fromkeys(proof.name for proof in of_it):
        of_name = [proof for proof in of_it if proof.name == name]
        at_full_width, sizes = scale(of_name)
        if at_full_width:
            full.append(f"`{name}`{' and lemmas' if any(proof.any_product for proof in of_name) else ''}")
        else:
            small.append(f"`{name}` ({sizes})")
    return ", ".join(full), ", ".join(small)


def _tested() -> set[str]:
    """Return the names of all tests, without the prefix `test_`."""
    found = (re.findall(r"^def test_(\w+)\(", path.read_text(), re.MULTILINE) for path in TESTS.rglob("test_*.py"))
    return set().union(*found)


def proved_blocks() -> str:
    """Table of the project's modules, with the checks of each one."""
    mutated, tested = expectations(), _tested()
    rows = []
    others = {path.parent.name for path in RTL.glob("*/*.py")} - {*FOLDERS}
    for folder in (*FOLDERS, *sorted(others)):
        for path in sorted((RTL / folder).glob("*.py")):
            module = path.stem
            if not re.search(rf"^@block\ndef {module}\(", path.read_text(), re.MULTILINE):
                continue
            full, small = _proofs(module)
            faults = f"`{module}`" if module in mutated else ""
            replayed = {mutated[module].test.removeprefix("test_")} if module in mutated else set()
            names = replayed | ({module} & tested)
            tests = ", ".join(f"`{name}`" for name in sorted(names)) or "in frames"
            rows.append([folder, f"`{module}`", full, small, faults, tests])
    return table(["rtl/", "block", "proved at full width", "proved, smaller", "faults planted", "tests"], rows)


def properties() -> str:
    """Table of all properties, with the sizes of the designs for which each is proved."""
    rows = []
    for name in dict.fromkeys(proof.name for proof in PROPERTIES):
        of_it = [proof for proof in PROPERTIES if proof.name == name]
        claim = of_it[0].claim.removesuffix(", at full width")
        depths = sorted({proof.induction for proof in of_it})
        products = "any function" if any(proof.any_product for proof in of_it) else "bits"
        quick = sum(proof.small for proof in of_it)
        rows.append([name, claim, scale(of_it)[1], products, len(of_it), quick, ", ".join(map(str, depths))])
    return table(["property", "claim", "proved for", "products", "designs", "quick", "induction depth"], rows)


def counts() -> str:
    """Return the number of proofs, and of quick proofs, as part of a sentence."""
    quick = sum(proof.small for proof in PROPERTIES)
    return (
        f"{len(PROPERTIES)} property proofs and {len(LEMMAS)} lemmas; "
        f"{quick} of the property proofs and all lemmas are quick"
    )


def lemmas() -> str:
    """Table of all lemmas, in the form in which they are proved."""
    rows = []
    for lemma in LEMMAS:
        kind = "integers" if lemma.integers else "reals"
        given = ", ".join(f"`{text}`" for text in lemma.given)
        rows.append([f"`{lemma.label}`", lemma.claim, kind, given, f"`{lemma.then}`"])
    return table(["lemma", "claim", "numbers", "given", "then"], rows)


def proofs() -> dict[str, str]:
    """Return all tables of this module, by the names in the pages' markers."""
    return {"proved_blocks": proved_blocks(), "properties": properties(), "lemmas": lemmas(), "proof_counts": counts()}
