# SPDX-License-Identifier: MIT
"""The engines, which are exchangeable: blocks with the ports of ray_caster."""

from raycaster.rtl.exact_caster import exact_caster
from raycaster.rtl.ray_caster import ray_caster

ENGINES = {"seed": ray_caster, "exact": exact_caster}
"""By the configuration's name for them."""
