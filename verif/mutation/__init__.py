# SPDX-License-Identifier: MIT
"""Faults planted in every module, which its leaf tests must find."""
