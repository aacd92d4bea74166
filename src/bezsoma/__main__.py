# SPDX-License-Identifier: BSD-3-Clause
"""`python -m bezsoma` is `bezsoma`."""

import sys

from bezsoma.cli import main

sys.exit(main())
