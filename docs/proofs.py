# SPDX-License-Identifier: MIT
"""Tables of properties and lemmas, from the lists that `raycaster verify prove` uses."""

from __future__ import annotations

from collections.abc import Sequence

from raycaster.configuration import Configuration
from raycaster.design.decide import configure
from raycaster.runs.outcomes import table
from raycaster.verif.formal.alone import FIXED_SCENE, TableAlone
from raycaster.verif.formal.lemmas import LEMMAS
from raycaster.verif.formal.properties import PROPERTIES
from raycaster.verif.formal.prover import Property


def _scale(of_it: Sequence[Property]) -> str:
    """Return the sizes of a property's designs, in words.

    The number of rectangles is a width if the property covers their index or their memory. The number of reflections is
    a range if the property uses it.
    """
    alone = [proof.parameters for proof in of_it if not isinstance(proof.design, Configuration)]
    narrow = [parameters["COORDINATE_BITS"] for parameters in alone if "COORDINATE_BITS" in parameters]
    columns = [parameters["COLUMNS"] for parameters in alone if "COLUMNS" in parameters]
    tables = [len(FIXED_SCENE.rect) for proof in of_it if isinstance(proof.design, TableAlone)]
    configured = [(proof, proof.design) for proof in of_it if isinstance(proof.design, Configuration)]
    counts = [
        design.rectangles
        for proof, design in configured
        if "INDEX_BITS" in proof.parameters or {"rect_mem", "rect_sequencer"} & {*proof.modules}
    ]
    mirrors = [design.reflections for proof, design in configured if {"REFLECTIONS", "MIRRORS"} & {*proof.parameters}]
    mirrors += [parameters["MIRRORS"] for parameters in alone if "MIRRORS" in parameters]
    full = not narrow and not columns and not tables and (not counts or max(counts) >= configure().rectangles)
    sizes = [] if narrow or not full else ["full width"]
    counted = {"bits": narrow, "columns": columns, "rectangles": tables + counts, "reflections": mirrors}
    for unit, numbers in counted.items():
        sizes += [f"{_values(numbers)} {unit}"] if numbers else []
    sizes += ["bounded waits"] if any("MOST_WAIT" in proof.parameters for proof in of_it) else []
    return ", ".join(sizes)


def _values(numbers: list[int]) -> str:
    """Format numbers as a list, or as a range if they are consecutive."""
    found = sorted(set(numbers))
    if len(found) > 2 and found == list(range(found[0], found[-1] + 1)):
        return f"{found[0]} to {found[-1]}"
    return " and ".join(filter(None, [", ".join(map(str, found[:-1])), str(found[-1])]))


def properties() -> str:
    """Table of all properties, with the sizes of the designs for which each is proved."""
    rows = []
    for name in dict.fromkeys(proof.name for proof in PROPERTIES):
        of_it = [proof for proof in PROPERTIES if proof.name == name]
        claim = of_it[0].claim.removesuffix(", at full width")
        depths = sorted({proof.induction for proof in of_it})
        products = "any function" if any(proof.any_product for proof in of_it) else "bits"
        quick = sum(proof.small for proof in of_it)
        rows.append([name, claim, _scale(of_it), products, len(of_it), quick, ", ".join(map(str, depths))])
    return table(["property", "claim", "proved for", "products", "designs", "quick", "induction depth"], rows)


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
    return {"properties": properties(), "lemmas": lemmas()}
