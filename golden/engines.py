# SPDX-License-Identifier: MIT
"""Choice of the golden model for a design."""

from __future__ import annotations

from raycaster.configuration import Configuration
from raycaster.golden.exact import ExactModel
from raycaster.golden.model import Model
from raycaster.golden.seed_engine import SeedModel


def model_of(config: Configuration) -> Model:
    """Return the golden model whose pictures a design must draw."""
    if config.facts.divides:
        return SeedModel(config.fraction_bits, config.rounding, features=config.features)
    return ExactModel(features=config.features)
