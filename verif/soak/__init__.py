# SPDX-License-Identifier: MIT
"""Random scenes at full size."""
