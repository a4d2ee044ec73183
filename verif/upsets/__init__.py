# SPDX-License-Identifier: MIT
"""Disturb a running design, and see how soon its picture is right again."""
