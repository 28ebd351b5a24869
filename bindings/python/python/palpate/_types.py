# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Types of arguments."""

from __future__ import annotations

from typing import Literal, TypeAlias, TypedDict

#: The form of the fill of a smooth boolean.
Profile: TypeAlias = Literal[
    "quadratic", "cubic", "quartic", "circular", "root", "exponential", "circular_geometrical"
]

#: A plane of space that a picture shows.
Plane: TypeAlias = Literal["xy", "xz", "yz"]


class Row(TypedDict, total=False):
    """A row of copies: the spacing [m], and the numbers of the first and the last, both or neither."""

    spacing: float
    first: int
    last: int
