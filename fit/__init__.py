# SPDX-License-Identifier: MIT
"""From a scene to the least hardware that shows it."""
