# SPDX-License-Identifier: MIT
"""The arithmetic at every value or at a volume, in compiled benches."""
