# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Answers that only Python has. Lengths are in metres.

Arrays of many answers are filled in Rust, without an object for each; bodies have names instead of numbers.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palpate._answer import Answer, Floats
from palpate._answers import FirstTouch, Manifold
from palpate._palpate import Shape


@dataclass(frozen=True, eq=False, kw_only=True)
class RayHits(Answer):
    """The first places of n rays at which the field is at most the tolerance, by :func:`cast_rays`; see :class:`RayCast`.

    Fields:
        lower: Up to these ways [m] the field is positive, proven, shape (n,).
        upper: At these ways [m] the field is at most the tolerance, shape (n,); the length of a ray that is free, infinite
            if a search ended before either was known.
        stops: Why each search ended, as places in ``STOPS``, shape (n,).
        evaluations: How often the field was evaluated, shape (n,).
        hits: 1 where the field is at most the tolerance somewhere along the ray, 0 where it is positive all along, proven,
            -1 where neither is known, shape (n,).
        points: The places at ``upper`` [m], shape (n, D); NaN of rays that are free.
        normals: The outward unit normals there, shape (n, D); NaN where the gradient vanishes.

    >>> import palpate as pp
    >>> hits = pp.cast_rays(pp.ball(0.5), [[0, 2, 0], [1, 2, 0]], [0, -1, 0])
    >>> hits.hits, hits.upper.round(3)
    (array([1, 0], dtype=int8), array([   1.5, 1000. ]))
    """

    lower: Floats
    upper: Floats
    stops: NDArray[np.uint8]
    evaluations: NDArray[np.uint32]
    hits: NDArray[np.int8]
    points: Floats
    normals: Floats

    def __len__(self) -> int:
        return len(self.lower)


@dataclass(frozen=True, eq=False, kw_only=True)
class Separations(Answer):
    """How far apart two bodies are at each of n poses, by :func:`separations`.

    Fields:
        lower: The separations are at least these [m], shape (n,).
        upper: The separations are at most these [m], shape (n,).
        points: Points between the bodies, or in both [m], in the frame of the first, shape (n, D).
        normals: The unit vectors from the first to the second, shape (n, D); NaN where the gradients vanish.
        stops: Why each search ended, as places in ``STOPS``, shape (n,).
        evaluations: How often the fields were evaluated, shape (n,).

    >>> import palpate as pp
    >>> found = pp.separations(pp.ball(0.5), pp.ball(0.5), [[2, 0, 0], [3, 0, 0]])
    >>> found.upper.round(3), [pp.STOPS[number] for number in found.stops]
    (array([1., 2.]), ['converged', 'converged'])
    """

    lower: Floats
    upper: Floats
    points: Floats
    normals: Floats
    stops: NDArray[np.uint8]
    evaluations: NDArray[np.uint32]

    def __len__(self) -> int:
        return len(self.lower)


@dataclass(frozen=True, eq=False, kw_only=True)
class Body(Answer):
    """A body of a scene, by ``scene[name]``.

    Fields:
        name: Its name.
        shape: Its shape where it is in the scene.
        shape_in_body: Its shape in its own frame.
        pose: Where it is: a matrix of shape (D + 1, D + 1).

    >>> import palpate as pp
    >>> body = pp.Scene({"ball": pp.ball(0.5)}, poses={"ball": [0, 1, 0]})["ball"]
    >>> body.shape_in_body, body.pose[:3, 3]
    (ball(radius=0.5), array([0., 1., 0.]))
    """

    name: str
    shape: Shape
    shape_in_body: Shape
    pose: Floats


@dataclass(frozen=True, eq=False, kw_only=True)
class BodyImpact(FirstTouch):
    """When two bodies of a world touch first, by :meth:`World.first_impacts`.

    Fields are those of :class:`FirstTouch`, and:
        bodies: The names of the two bodies.

    >>> import palpate as pp
    >>> world = pp.World({"a": pp.ball(0.5), "b": pp.ball(0.5).translated([3, 0, 0])})
    >>> [hit] = world.first_impacts({"b": [-3, 0, 0]})
    >>> hit.bodies, round(hit.upper, 3)
    (('a', 'b'), 0.667)
    """

    bodies: tuple[str, str]


@dataclass(frozen=True, eq=False, kw_only=True)
class Neighbours(Answer):
    """Two bodies of a world that are near each other, by :meth:`World.step`.

    Fields:
        bodies: The names of the two bodies.
        lower: The separation is at least this [m].
        upper: The separation is at most this [m].
        verdict: "touching" if their distance is proven to be at most the margin, "apart" if it is more, else
            "undecided".
        manifold: Their contacts; None if neither is bounded.

    >>> import palpate as pp
    >>> [near] = pp.World({"a": pp.ball(0.5), "b": pp.ball(0.4)}).step()
    >>> near.bodies, near.verdict, near.upper < 0
    (('a', 'b'), 'touching', True)
    """

    bodies: tuple[str, str]
    lower: float
    upper: float
    verdict: str
    manifold: Manifold | None
