# SPDX-License-Identifier: MIT
"""What is proved of each block, and what else checks it, from the lists that the commands themselves work through."""

from __future__ import annotations

import re
from pathlib import Path

from raycaster import rtl
from raycaster.docs.facts import table
from raycaster.verif.formal.lemmas import LEMMAS
from raycaster.verif.formal.properties import PROPERTIES
from raycaster.verif.mutation.mutate import expectations

RTL = Path(rtl.__file__).parent
TESTS = RTL.parent / "verif" / "tests"

FULL = (
    "video-timing", "host-transfers", "ray-order", "line-sections", "render-counters", "divider-exact",
    "finder-quotients", "nearest-depth", "tester-products", "nearest-products", "slope-exact", "eye-exact",
    "cell-products", "group-safe", "row-setup", "line-start", "walked-products", "turned-walks", "contest-products",
    "unit-wiring", "fold-products", "beam-tester-products", "blend-exact", "shares-exact",
)  # fmt: skip
"""The properties that are proved of blocks as wide as in a default design, among others."""

REDUCED = {
    "avalon-agent": "2 rectangles",
    "fixed-rects": "3 rectangles",
    "tester-exact": "1 to 4 bits",
    "axi4lite-transfers": "full width, bounded waits",
    "wishbone-transfers": "full width, bounded waits",
    "apb-transfers": "full width, bounded waits",
    "fold-exact": "2 and 3 bits, 8 cycles from reset only",
}
"""In what the designs of others are smaller; of one that is in neither list no more is claimed than that it is."""

EVERY_OPERAND = {
    "divider": "`divider`",
    "divider_step": "`divider`",
    "intersection_helper": "`reduced`, 4 bits",
}
"""By module, the benches of `raycaster verify exhaustive` in which it gets all its operands."""

FOLDERS = ("exact", "engine", "beam", "seed", "cull", "scene", "bus", "video", "common", "dvi", "system")

UNGATED = "clock_gate"
"""Proofs are of what goes to an FPGA, where this is a wire; so they say nothing of it."""


def _proofs(module: str) -> tuple[str, str]:
    """The properties of designs as large as they come, and of smaller ones."""
    of_it = [proof for proof in PROPERTIES if module in proof.modules and module not in (*proof.cut, UNGATED)]
    full, small = [], []
    for name in dict.fromkeys(proof.name for proof in of_it):
        products = any(proof.any_product for proof in of_it if proof.name == name)
        if name in FULL:
            full.append(f"`{name}`{' and lemmas' if products else ''}")
        else:
            small.append(f"`{name}` ({REDUCED.get(name, 'smaller')})")
    return ", ".join(full), ", ".join(small)


def _tested() -> set[str]:
    """The tests' names, without what they begin with."""
    found = (re.findall(r"^def test_(\w+)\(", path.read_text(), re.MULTILINE) for path in TESTS.glob("test_*.py"))
    return set().union(*found)


def proved_blocks() -> str:
    """Every module of the project's own, with what checks it by itself."""
    mutated, tested = expectations(), _tested()
    rows = []
    for folder in FOLDERS:
        for path in sorted((RTL / folder).glob("*.py")):
            module = path.stem
            if not re.search(rf"^@block\ndef {module}\(", path.read_text(), re.MULTILINE):
                continue
            full, small = _proofs(module)
            faults = f"`{module}`" if module in mutated else ""
            replayed = mutated[module].tests if module in mutated else ()
            names = {re.search(r"::test_(\w+)", test)[1] for test in replayed} | ({module} & tested)
            tests = ", ".join(f"`{name}`" for name in sorted(names)) or "in frames"
            rows.append([folder, f"`{module}`", full, small, EVERY_OPERAND.get(module, ""), faults, tests])
    return table(
        ["rtl/", "block", "proved at full width", "proved, smaller", "every operand", "faults planted", "tests"], rows
    )


def properties() -> str:
    """Every property, with how much of a design it is of."""
    rows = []
    for name in dict.fromkeys(proof.name for proof in PROPERTIES):
        of_it = [proof for proof in PROPERTIES if proof.name == name]
        claim = of_it[0].claim.removesuffix(", at full width")
        depths = sorted({proof.induction for proof in of_it})
        products = "any function" if any(proof.any_product for proof in of_it) else "bits"
        width = "full width" if name in FULL else REDUCED.get(name, "smaller")
        rows.append([name, claim, width, products, len(of_it), ", ".join(map(str, depths))])
    return table(["property", "what it says", "of", "products", "designs", "induction depth"], rows)


def lemmas() -> str:
    """Every lemma, as it is proved."""
    rows = []
    for lemma in LEMMAS:
        kind = "integers" if lemma.integers else "reals"
        given = ", ".join(f"`{text}`" for text in lemma.given)
        rows.append([f"`{lemma.label}`", lemma.claim, kind, given, f"`{lemma.then}`"])
    return table(["lemma", "what it says", "of", "given", "then"], rows)


def proofs() -> dict[str, str]:
    """All of them, by the names that pages use."""
    return {"proved_blocks": proved_blocks(), "properties": properties(), "lemmas": lemmas()}
