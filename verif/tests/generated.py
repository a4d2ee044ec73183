# SPDX-License-Identifier: MIT
"""Random settings for property-based tests: Hypothesis generates examples, and shrinks failing ones."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import hypothesis
from hypothesis import strategies as st

from raycaster.buses import BUSES, USUAL_BAUD
from raycaster.configuration import Facts
from raycaster.rtl.engines import ENGINES
from raycaster.verif.seeds import seed


def examples(count: int) -> Callable:
    """Return a decorator for a test with `count` examples, generated from the seed of all random tests."""
    settings = hypothesis.settings(max_examples=count, deadline=None, database=None, print_blob=True)
    return lambda test: hypothesis.seed(seed())(settings(test))


def engine_options(facts: Facts) -> dict[str, st.SearchStrategy]:
    """Return options of an engine in addition to those of every engine."""
    found: dict[str, st.SearchStrategy] = {"screen": st.sampled_from(sorted({name for name, _ in facts.screens}))}
    found["rectangles"] = st.integers(1, facts.rectangles)
    found |= {look: st.booleans() for look in ("turn", "light") if look in facts.features}
    if facts.whole_frames:
        return found | {"scale": st.sampled_from([1, 2, 4])}
    found |= {"units": st.sampled_from([1, 2, 4, 8, 16, 32, 64]), "culling": st.booleans()}
    if not facts.divides:
        return found | {"reflections": st.integers(0, 4)}
    return found | {
        "fraction_bits": st.integers(0, 8),
        "rounding": st.sampled_from(["truncate", "nearest"]),
        "divider_bits": st.sampled_from(["auto", 1, 2, 3]),
    }


ANY_OPTIONS = {
    "reflections": st.integers(0, 2),
    "rows": st.sampled_from([240, 200, 180, 48]),
    "colour_bits": st.integers(1, 8),
    "materials": st.booleans(),
    "patterns": st.booleans(),
    "bus": st.sampled_from(list(BUSES)),
    "baud": st.sampled_from([USUAL_BAUD, 115_200]),
}
ODD = {
    "engine": "none", "units": 0, "rectangles": 129, "reflections": -1, "rows": 100, "scale": 6, "fraction_bits": 9,
    "rounding": "up", "divider_bits": 4, "colour_bits": "x", "screen": "cinema", "culling": 2, "colour": 8,
    "bus": "pci", "baud": 100,
}  # fmt: skip
"""Values that no engine accepts, and an option that does not exist."""


@st.composite
def options(draw: st.DrawFn, odd: bool = False) -> dict[str, Any]:
    """Generate options of a configuration, mostly compatible ones; if `odd`, sometimes with an invalid one."""
    engine = draw(st.sampled_from(list(ENGINES)))
    chosen = draw(st.fixed_dictionaries({}, optional=ANY_OPTIONS | engine_options(ENGINES[engine].facts)))
    chosen |= {"engine": engine, "allow_underrun": draw(st.booleans())}
    if odd and draw(st.integers(0, 3)) == 0:
        name = draw(st.sampled_from(list(ODD)))
        chosen[name] = ODD[name]
    return chosen
