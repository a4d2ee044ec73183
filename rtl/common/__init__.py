# SPDX-License-Identifier: MIT
"""What all rooms share: ports, records, widths, constants."""
