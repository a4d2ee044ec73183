# SPDX-License-Identifier: MIT
"""Shared by the engines: sequencing, primary rays, products, colour."""
