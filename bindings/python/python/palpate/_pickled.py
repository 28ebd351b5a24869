# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""What pickles call to make their objects again."""

from __future__ import annotations

from palpate._palpate import Scene, Shape


def shape(text: str, dimension: int) -> Shape:
    """The shape of a text."""
    return Shape.from_json(text, dimension=dimension)


def scene(text: str, folder: str | None) -> Scene:
    """The scene of a text."""
    return Scene.from_json(text, folder=folder)
