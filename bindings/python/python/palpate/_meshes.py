# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Answers about meshes: frozen objects with names. Lengths are in metres."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palpate._answer import Answer, Floats
from palpate._answers import Contacts


@dataclass(frozen=True, eq=False, kw_only=True)
class MeshReport(Answer):
    """What a mesh is, by :meth:`Mesh.report`.

    Fields:
        elements: How many triangles or segments.
        vertices: How many vertices.
        unreferenced: Vertices that no element names.
        coincident: Vertices equal to another.
        degenerate: Elements without extent.
        duplicates: Elements with the vertices of another.
        boundary: Edges of one triangle, or vertices of one segment.
        non_manifold: Edges of more than two triangles.
        inconsistent: Edges whose two triangles disagree on the inside.
        bounds: The corners of the box around it [m], shape (2, D).
        surface: The area of the triangles [m²], or the length of the segments [m].
        enclosed: What it encloses [m³], in the plane [m²]; None if it is not closed.
        is_watertight: Whether it is closed and agrees on the inside.
        in_words: The whole in words.

    >>> import palpate as pp
    >>> report = pp.cuboid([1, 1, 1]).mesh(cell=0.3).report()
    >>> report.is_watertight, report.boundary, round(report.surface, 6)
    (True, 0, 6.0)
    """

    elements: int
    vertices: int
    unreferenced: int
    coincident: int
    degenerate: int
    duplicates: int
    boundary: int
    non_manifold: int
    inconsistent: int
    bounds: Floats
    surface: float
    enclosed: float | None
    is_watertight: bool
    in_words: str

    def __str__(self) -> str:
        return self.in_words


@dataclass(frozen=True, eq=False, kw_only=True)
class MeshHits(Answer):
    """Which faces of a mesh touch a shape, by :func:`mesh_hits`.

    Fields:
        hits: The faces that touch, proven.
        undecided: The faces of which the budget proved neither.
        lower: The field on each undecided face is at least this [m].
        upper: The least value of the field on each undecided face is at most this [m].
        evaluations: How often the field was evaluated.

    >>> import palpate as pp
    >>> found = pp.mesh_hits(pp.ball(0.5), pp.cuboid([1, 1, 1]).mesh(cell=0.3), pose=[0, 0.95, 0])
    >>> len(found) == len(found.hits), len(found.undecided)
    (True, 0)
    """

    hits: NDArray[np.uint32]
    undecided: NDArray[np.uint32]
    lower: Floats
    upper: Floats
    evaluations: int

    def __len__(self) -> int:
        return len(self.hits)


@dataclass(frozen=True, eq=False, kw_only=True)
class MeshContacts(MeshHits):
    """Where the faces of a mesh touch a shape, by :func:`mesh_contacts`.

    Fields are those of :class:`MeshHits`, and:
        contacts: The contacts, from the shape to the mesh.
        elements: The face of each contact, shape (n,).

    >>> import palpate as pp
    >>> found = pp.mesh_contacts(pp.ball(0.5), pp.cuboid([1, 1, 1]).mesh(cell=0.3), pose=[0, 0.95, 0])
    >>> len(found) == len(found.elements), bool(found.contacts.gap.min() < 0)
    (True, True)
    """

    contacts: Contacts
    elements: NDArray[np.uint32]

    def __len__(self) -> int:
        return len(self.contacts)
