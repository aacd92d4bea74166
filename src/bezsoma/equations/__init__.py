# SPDX-License-Identifier: BSD-3-Clause
"""From a body to its equations: elements, the assembled matrix, supports, loads, rigid motions."""
