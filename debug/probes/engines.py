# SPDX-License-Identifier: MIT
"""The description of whatever engine a design has."""

from raycaster.configuration import Configuration
from raycaster.debug.probes.beam import BeamProbes
from raycaster.debug.probes.exact import ExactProbes
from raycaster.debug.probes.ray import Description
from raycaster.debug.probes.seed import SeedProbes

DESCRIPTIONS = {"seed": SeedProbes, "exact": ExactProbes, "beam": BeamProbes}
"""By the configuration's name for the engine."""


def description_of(config: Configuration, unit: int) -> Description:
    """What the engine has of the pixels of a unit."""
    return DESCRIPTIONS[config.engine](config, unit)
