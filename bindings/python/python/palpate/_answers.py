# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Answers: frozen objects with names, with arrays where there are many.

Lengths are in metres. Where an answer has ``lower`` and ``upper``, the true value is between them, rounding included;
``stop`` says why the search ended: "converged" (the bounds are as close as was asked), "sign_known" (that was the
question), "budget_spent", "memory_full" or "rounding_reached".
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from palpate._palpate import Shape

Floats: TypeAlias = NDArray[np.float64]


class Answer:
    """Equality of fields that may be arrays."""

    def __eq__(self, other: object) -> bool:
        if type(self) is not type(other):
            return NotImplemented
        return all(
            _equal(getattr(self, field.name), getattr(other, field.name))
            for field in fields(self)  # type: ignore[arg-type]
        )

    __hash__ = None  # type: ignore[assignment]


def _equal(one: object, two: object) -> bool:
    if isinstance(one, np.ndarray) and isinstance(two, np.ndarray):
        return bool(np.array_equal(one, two, equal_nan=one.dtype.kind == "f"))
    if isinstance(one, np.ndarray) or isinstance(two, np.ndarray):
        return False
    # NaN stands for what is not known.
    return bool(one == two or (one != one and two != two))


@dataclass(frozen=True, eq=False, kw_only=True)
class Promise(Answer):
    """What a field promises of its values.

    Fields:
        outside: "exact" (the distance), "bound" (at most the distance) or "lipschitz" (divide by ``lipschitz``)
            where positive.
        inside: The same where the field is negative.
        lipschitz: The largest difference of two values over the distance of their points.
        bounds: The corners of a box that holds the body, shape (2, D) [m]; None if it has none.
        convex: Whether the field is a convex function.
        has_interior: Whether points with negative values may exist.
        deviation: How far a sampled field may be from its source, and the values up to which that holds [m];
            None of formulas.
        in_words: The whole in words.

    >>> import palpate as pp
    >>> (pp.ball(0.5) | pp.cuboid([1, 1, 1])).promise.inside
    'bound'
    """

    outside: str
    inside: str
    lipschitz: float
    bounds: Floats | None
    convex: bool
    has_interior: bool
    deviation: tuple[float, float] | None
    in_words: str

    def __str__(self) -> str:
        return self.in_words


@dataclass(frozen=True, eq=False, kw_only=True)
class AtPoint(Answer):
    """What a field says at a point, by :meth:`Shape.at`.

    Fields:
        point: The point [m], shape (D,).
        distance: The value of the field [m]: negative inside.
        gradient: The gradient of the field, shape (D,).
        normal: The gradient's unit vector, shape (D,); None where it vanishes.
        surface: The nearest point of the surface, or of a field that is no distance one close by [m]; None if
            none was found.
        safe_radius: The radius of a ball about the point that is sure to hold no surface [m].
        quality: What the value is here: "exact", "bound" or "lipschitz".
        rounding: The largest rounding of the value [m].

    >>> import palpate as pp
    >>> found = pp.ball(0.5).at([0.0, 2.0, 0.0])
    >>> found.distance, found.quality, round(found.safe_radius, 3)
    (1.5, 'exact', 1.5)
    """

    point: Floats
    distance: float
    gradient: Floats
    normal: Floats | None
    surface: Floats | None
    safe_radius: float
    quality: str
    rounding: float


@dataclass(frozen=True, eq=False, kw_only=True)
class Separation(Answer):
    """How far apart two bodies are, by :func:`separation`: negative if they overlap.

    Where a field is a bound, this is the separation of the fields, which is at most that of the bodies.

    Fields:
        lower: The separation is at least this [m].
        upper: The separation is at most this [m].
        stop: Why the search ended.
        evaluations: How often the fields were evaluated.
        point: A point between the bodies, or in both [m], shape (D,).
        normal: The unit vector from the first to the second there, shape (D,); None where the gradients vanish.

    >>> import palpate as pp
    >>> found = pp.separation(pp.ball(0.5), pp.ball(0.5).translated([2, 0, 0]), tolerance=1e-3)
    >>> found.lower <= 1.0 <= found.upper, found.stop
    (True, 'converged')
    """

    lower: float
    upper: float
    stop: str
    evaluations: int
    point: Floats
    normal: Floats | None


@dataclass(frozen=True, eq=False, kw_only=True)
class Overlap(Answer):
    """Whether two bodies overlap, by :func:`overlap`.

    Fields:
        overlaps: Whether they do, proven; None if the search ended before that was known.
        lower: The separation is at least this [m].
        upper: The separation is at most this [m].
        stop: Why the search ended.
        evaluations: How often the fields were evaluated.
        point: A point between the bodies, or in both [m], shape (D,).
        normal: The unit vector from the first to the second there, shape (D,); None where the gradients vanish.

    >>> import palpate as pp
    >>> found = pp.overlap(pp.ball(0.5), pp.ball(0.5).translated([2, 0, 0]))
    >>> found.overlaps, bool(found), found.lower > 0
    (False, False, True)
    """

    overlaps: bool | None
    lower: float
    upper: float
    stop: str
    evaluations: int
    point: Floats
    normal: Floats | None

    def __bool__(self) -> bool:
        if self.overlaps is None:
            raise ValueError("undecided: ask with a larger budget, or look at .overlaps, which is None")
        return self.overlaps


@dataclass(frozen=True, eq=False, kw_only=True)
class Contact(Answer):
    """A pair of points at which two bodies touch or are nearest.

    Fields:
        point_a: The point of the first body [m], shape (D,).
        point_b: The point of the second body [m], shape (D,).
        normal: The unit vector from the first to the second, shape (D,).
        gap: How far apart they are along the normal [m]: negative if they overlap.
        normal_from: What the normal is taken from: "gradients", "thicker_body", "history" or "assumed".
        on_surfaces: Whether both points are on surfaces; else they are estimated.
        id: A name that stays while bodies move.

    >>> import palpate as pp
    >>> touch = pp.closest_points(pp.ball(0.5), pp.ball(0.5).translated([2, 0, 0])).contact
    >>> touch.point_a.round(3), round(touch.gap, 3), touch.normal_from
    (array([0.5, 0. , 0. ]), 1.0, 'gradients')
    """

    point_a: Floats
    point_b: Floats
    normal: Floats
    gap: float
    normal_from: str
    on_surfaces: bool
    id: int


@dataclass(frozen=True, eq=False, kw_only=True)
class ClosestPoints(Answer):
    """Where two bodies are nearest to each other, by :func:`closest_points`.

    Fields:
        lower: The separation is at least this [m].
        upper: The separation is at most this [m].
        stop: Why the search ended.
        evaluations: How often the fields were evaluated.
        contact: The points; None where no way to the surfaces was found.

    >>> import palpate as pp
    >>> found = pp.closest_points(pp.ball(0.5), pp.ball(0.5).translated([2, 0, 0]))
    >>> found.stop, found.contact.point_b.round(3)
    ('converged', array([1.5, 0. , 0. ]))
    """

    lower: float
    upper: float
    stop: str
    evaluations: int
    contact: Contact | None


@dataclass(frozen=True, eq=False, kw_only=True)
class Manifold(Answer):
    """Contacts that span where two bodies touch, the deepest first, by :func:`manifold`.

    Fields:
        lower: The separation is at least this [m].
        upper: The distance of the bodies is at most this [m]: 0 if they overlap, infinite if none is known or it is
            more than the margin.
        stop: Why the search for more contacts ended.
        evaluations: How often the fields were evaluated, for the separation and the contacts.
        points_a: The points of the first body [m], shape (n, D).
        points_b: The points of the second body [m], shape (n, D).
        normals: The unit vectors from the first to the second, shape (n, D).
        gaps: How far apart the points are along the normals [m], shape (n,): negative where the bodies overlap.
        ids: Names that stay while bodies move, shape (n,).
        groups: Which of the separate places where the bodies touch each contact is of, shape (n,).
        separation: The separation with its bounds.
        dropped: How many contacts were left out because there were more than ``most``.
        is_whole: Whether every place where the bodies touch that is larger than the spacing has its contacts.

    >>> import palpate as pp
    >>> touch = pp.manifold(pp.cuboid([1, 1, 1]), pp.ball(0.5).translated([0, 0.99, 0]))
    >>> len(touch), touch.normals.round(3), touch.is_whole
    (1, array([[0., 1., 0.]]), True)
    """

    lower: float
    upper: float
    stop: str
    evaluations: int
    points_a: Floats
    points_b: Floats
    normals: Floats
    gaps: Floats
    ids: NDArray[np.uint64]
    groups: NDArray[np.uint64]
    separation: Separation
    dropped: int
    is_whole: bool

    def __len__(self) -> int:
        return len(self.gaps)


@dataclass(frozen=True, eq=False, kw_only=True)
class RayHit(Answer):
    """The first place of a ray at which the field is at most the tolerance, by :func:`cast_ray`.

    A ray that passes the surface at less than the tolerance is one that meets it.

    Fields:
        lower: Up to this way [m] the field is positive, proven.
        upper: At this way [m] the field is at most the tolerance; the length of a ray that is free, infinite if the search
            ended before either was known.
        stop: Why the search ended.
        evaluations: How often the field was evaluated.
        point: The place at ``upper`` [m], shape (D,); None if the ray is free.
        normal: The outward unit normal there, shape (D,); None where the gradient vanishes.

    >>> import palpate as pp
    >>> hit = pp.cast_ray(pp.ball(0.5), [0, 2, 0], [0, -1, 0])
    >>> hit.stop, round(hit.upper, 3), hit.normal.round(3)
    ('converged', 1.5, array([0., 1., 0.]))
    """

    lower: float
    upper: float
    stop: str
    evaluations: int
    point: Floats | None
    normal: Floats | None


@dataclass(frozen=True, eq=False, kw_only=True)
class RayHits(Answer):
    """The first places of n rays at which the field is at most the tolerance, by :func:`cast_rays`; see :class:`RayHit`.

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
class Mass(Answer):
    """Mass, centroid and moments of a body, with bounds on their errors, by :meth:`Shape.mass`.

    Fields:
        mass: The mass [kg].
        mass_error: How far it may be off [kg].
        volume: The volume [m³], in the plane the area [m²].
        volume_error: How far it may be off [m³], in the plane [m²].
        density: The density that was given [kg/m³], in the plane [kg/m²].
        centroid: The centroid [m], shape (D,).
        centroid_error: How far it may be off [m].
        second_moments: The integrals of density · x · y about the centroid [kg·m²], shape (D, D).
        second_moments_error: How far each may be off [kg·m²].
        inertia: In space the inertia tensor about the centroid [kg·m²], shape (3, 3); in the plane the moment of inertia
            about it.
        cells: How many cells were cut.

    >>> import palpate as pp
    >>> mass = pp.cuboid([1, 1, 1]).mass(density=1000)
    >>> round(mass.mass), mass.inertia.diagonal().round(), mass.mass_error < 1
    (1000, array([167., 167., 167.]), True)
    """

    mass: float
    mass_error: float
    volume: float
    volume_error: float
    density: float
    centroid: Floats
    centroid_error: float
    second_moments: Floats
    second_moments_error: float
    inertia: Floats | float
    cells: int


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
class FirstTouch(Answer):
    """When two bodies that move touch first, by :func:`sweep`: times from 0 to 1.

    Fields:
        lower: Before this time the bodies are proven apart.
        upper: At this time they touch; infinite if no such time was found, 1 if they are apart all the time.
        stop: Why the search ended: "converged" at a touch, "sign_known" if there is none.
        evaluations: How often the fields were evaluated.
        touches: Whether they touch, proven; None if the search ended before that was known.
        contact: Where they touch at ``upper``; None if they do not.
        start: How they move on if they touch at the start: "approaching", "receding", "sliding" or "resting".

    >>> import palpate as pp
    >>> touch = pp.sweep(pp.ball(0.5), pp.ball(0.5), start=[3, 0, 0], end=[0, 0, 0])
    >>> touch.touches, round(touch.upper, 3), touch.start
    (True, 0.667, None)
    """

    lower: float
    upper: float
    stop: str
    evaluations: int
    touches: bool | None
    contact: Contact | None
    start: str | None


@dataclass(frozen=True, eq=False, kw_only=True)
class BodyImpact(FirstTouch):
    """When two bodies of a world touch first, by :meth:`World.first_impacts`.

    Fields are those of :class:`FirstTouch`, and:
        a: The name of the first body.
        b: The name of the second.

    >>> import palpate as pp
    >>> world = pp.World({"a": pp.ball(0.5), "b": pp.ball(0.5).translated([3, 0, 0])})
    >>> [hit] = world.first_impacts({"b": [-3, 0, 0]})
    >>> hit.a, hit.b, round(hit.upper, 3)
    ('a', 'b', 0.667)
    """

    a: str
    b: str


@dataclass(frozen=True, eq=False, kw_only=True)
class Neighbours(Answer):
    """Two bodies of a world that are near each other, by :meth:`World.step`.

    Fields:
        a: The name of the first body.
        b: The name of the second.
        lower: The separation is at least this [m].
        upper: The separation is at most this [m].
        verdict: "touching" if their distance is proven to be at most the margin, "apart" if it is more, else
            "undecided".
        manifold: Their contacts; None if neither is bounded.

    >>> import palpate as pp
    >>> [near] = pp.World({"a": pp.ball(0.5), "b": pp.ball(0.4)}).step()
    >>> near.a, near.b, near.verdict, near.upper < 0
    ('a', 'b', 'touching', True)
    """

    a: str
    b: str
    lower: float
    upper: float
    verdict: str
    manifold: Manifold | None

    @property
    def stop(self) -> str | None:
        """Why the search for contacts ended.

        >>> import palpate as pp
        >>> [near.stop for near in pp.World({"a": pp.ball(0.5), "b": pp.ball(0.4)}).step()]
        ['converged']
        """
        return None if self.manifold is None else self.manifold.stop
