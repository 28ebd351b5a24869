# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""The program: ``python -m palpate``, or ``palpate``."""

from __future__ import annotations

import signal
import sys

from palpate import _palpate


def run() -> int:
    """Runs the command line of this process, and returns the exit status."""
    # The program listens to Ctrl-C itself, and ends with what it has.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _palpate.main(["palpate", *sys.argv[1:]])


if __name__ == "__main__":
    raise SystemExit(run())
