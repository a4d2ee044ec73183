# SPDX-License-Identifier: MIT
"""cocotb benches that verify a whole design."""
