# SPDX-License-Identifier: MIT
"""What engines share: sequencing, primary rays, products, colour."""
