# SPDX-License-Identifier: BSD-3-Clause
"""What this machine can do at best: a STREAM triad and a dense product, on the threads given.

The triad a = b + s c runs in pieces that stay in the second-level cache between its two passes, so
that memory sees b and c read, a read (a store that misses reads first) and written: 32 bytes each
for float64. Beware: a machine with a huge last-level cache, or one that is shared with others,
shows more for arrays that fit that cache; so the triad is also measured on arrays of the size that
the product under test touches, and the larger of both is the bound.
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise
from time import perf_counter, process_time
from typing import Any

import numpy as np

PIECE = 16_384
"""Numbers of an array handled at once: three pieces of 128 KiB."""
LARGE = 1 << 27
"""Bytes of each of the three arrays that no cache holds, at least."""


def triad(size: int, threads: int, repeats: int = 5) -> float:
    """Bytes a second, all arrays together of `size` bytes; the best of the repeats."""
    count = max(size // 24, threads * PIECE)
    b, c = np.full(count, 1.5), np.full(count, 2.5)
    a = np.zeros(count)
    shares = np.linspace(0, count, threads + 1).astype(int)
    parts = list(pairwise(shares))

    def share(part: tuple[int, int]) -> None:
        for begin in range(part[0], part[1], PIECE):
            piece = slice(begin, min(begin + PIECE, part[1]))
            np.multiply(c[piece], 3.0, out=a[piece])
            np.add(a[piece], b[piece], out=a[piece])

    passes = max(1, LARGE // size)
    with ThreadPoolExecutor(threads) as pool:

        def all_parts() -> None:
            for _ in range(passes):
                list(pool.map(share, parts))

        return 32 * count * passes / least(all_parts, repeats, threads)


def flops(width: int, threads: int, repeats: int) -> float:
    """Flops a second of a dense product of numpy's BLAS, whose threads the environment sets."""
    n = 1536
    kind: Any = np.float64 if width == 8 else np.float32
    a = np.random.default_rng(0).random((n, n)).astype(kind)
    b, c = a.T.copy(), np.empty_like(a)
    return 2 * n**3 / least(lambda: np.matmul(a, b, out=c), repeats, threads)


def least(call: Any, repeats: int, threads: int = 1) -> float:
    """The least seconds of some calls, after one that does not count.

    On one thread processor time, which does not see that others use the machine, but for what they
    take of caches and of memory; on several threads time on the wall.
    """
    clock = process_time if threads == 1 else perf_counter
    call()
    seconds = []
    for _ in range(repeats):
        start = clock()
        call()
        seconds.append(clock() - start)
    return min(seconds)
