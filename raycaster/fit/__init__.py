# SPDX-License-Identifier: MIT
"""Find the smallest hardware that shows a scene."""
