# SPDX-License-Identifier: MIT
"""Mutation testing: faults are planted in every module, and its leaf tests must find them."""
