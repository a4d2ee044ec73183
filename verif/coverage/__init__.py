# SPDX-License-Identifier: MIT
"""Code and functional coverage of the hardware."""
