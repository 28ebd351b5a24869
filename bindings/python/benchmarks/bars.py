# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Numbers of a benchmark, held against bars."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, field
from pathlib import Path


@dataclass
class Table:
    """Numbers with their keys, printed as they come, and the bars of some."""

    rows: dict[str, float] = field(default_factory=dict)
    bars: list[tuple[str, float, bool]] = field(default_factory=list)

    def report(self, key: str, value: float) -> None:
        self.rows[key] = value
        print(f"{key:48} {value:.6g}", flush=True)

    def at_least(self, key: str, bar: float) -> None:
        self.bars.append((key, bar, True))

    def at_most(self, key: str, bar: float) -> None:
        self.bars.append((key, bar, False))

    def end(self, file: Path | None) -> int:
        """Prints the bars, writes the numbers to a file if one is given; 1 if a bar is missed, else 0."""
        print()
        missed = 0
        for key, bar, is_least in self.bars:
            # What was not measured, since a peer is not there, reaches nothing.
            value = self.rows.get(key, math.nan)
            is_reached = value >= bar if is_least else value <= bar
            missed += not is_reached
            word = "at least" if is_least else "at most"
            print(f"{key:48} {value:<12.4g} {word} {bar:.4g}  {'reached' if is_reached else 'missed'}")
        print(f"{len(self.bars) - missed} of {len(self.bars)} bars reached")
        if file:
            file.write_text(json.dumps(self.rows, indent=1))
        return 1 if missed else 0
