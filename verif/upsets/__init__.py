# SPDX-License-Identifier: MIT
"""Disturbances of a running design, and how soon its picture is right again."""
