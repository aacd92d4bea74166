# SPDX-License-Identifier: BSD-3-Clause
"""The process that `bezsoma.solvers.factors` starts: factors a matrix and solves with it.

It reads pickles from its standard input, first the matrix and options, then right-hand sides, and
answers each with one; an error is an answer too. It ends when there is no more to read. Not for
import: it knows nothing of the package, so that it starts soon.
"""

from __future__ import annotations

import pickle
import sys
from typing import Any

from scipy.sparse.linalg import splu


def main() -> None:
    """Factor, then solve until whoever asks has gone."""
    factors: Any = None
    answers = sys.stdout.buffer
    sys.stdout = sys.stderr  # what a library might print is no answer
    while True:
        try:
            given = pickle.load(sys.stdin.buffer)
        except EOFError:
            return
        try:
            if factors is None:
                matrix, options = given
                factors, answer = splu(matrix, **options), None
            else:
                answer = factors.solve(given)
        except Exception as failure:
            answer = failure
        pickle.dump(answer, answers, pickle.HIGHEST_PROTOCOL)
        answers.flush()


if __name__ == "__main__":
    main()
