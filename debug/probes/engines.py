# SPDX-License-Identifier: MIT
"""The description of whatever engine a design has."""

from raycaster.configuration import Configuration
from raycaster.debug.probes.beam import BeamProbes
from raycaster.debug.probes.exact import ExactProbes
from raycaster.debug.probes.ray import Description
from raycaster.debug.probes.seed import SeedProbes
from raycaster.engines import BEAM, EXACT, SEED

DESCRIPTIONS = {SEED.name: SeedProbes, EXACT.name: ExactProbes, BEAM.name: BeamProbes}
"""By engine."""


def description_of(config: Configuration, unit: int) -> Description:
    """What the engine has of the pixels of a unit."""
    return DESCRIPTIONS[config.engine](config, unit)
