# SPDX-License-Identifier: MIT
"""Long runs: parallel jobs, external programs, digests of sources, and the outcomes that are kept."""
