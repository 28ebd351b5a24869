# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Answers that Rust has too, made by generate_answers.py: what is changed here is lost.

Lengths are in metres. Where an answer has ``lower`` and ``upper``, the true value is between them, rounding included.
Points and vectors have the shape (D,), matrices (D, D).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from palpate import _examples
from palpate._answer import Floats

NormalSource: TypeAlias = Literal["gradients", "thicker_body", "history", "assumed"]
Quality: TypeAlias = Literal["exact", "bound", "lipschitz"]
Start: TypeAlias = Literal["approaching", "receding", "sliding", "resting"]
Stop: TypeAlias = Literal["converged", "sign_known", "budget_spent", "memory_full", "rounding_reached", "unresolved"]


@dataclass(frozen=True, eq=False, kw_only=True)
class AtPoint(_examples.AtPoint):
    """The value of a field at a point, with what it promises there.

    Fields:
        point: The point [m].
        distance: The value of the field [m]. ``quality`` says whether it is the distance.
        gradient: The gradient of the field.
        normal: The gradient's unit vector; None where it is shorter than 1e-6.
        surface: Where the promise is exact the nearest point of the surface, else a zero of the field nearby. None if
            none was found [m].
        is_inside: ``True`` if the value is negative.
        safe_radius: The radius of a ball that is sure to hold no surface, rounding included [m].
        quality: What the distance promises on this side of the surface.
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
    is_inside: bool
    safe_radius: float
    quality: Quality
    rounding: float


@dataclass(frozen=True, eq=False, kw_only=True)
class Promise(_examples.Promise):
    """All that a field promises about its values.

    Fields:
        outside: The quality where ``f > 0``.
        inside: The quality where ``f < 0``.
        lipschitz: The least known ``L`` with ``|f(p) − f(q)| ≤ L‖p − q‖``.
        region: The ball in which ``lipschitz`` holds; everywhere if None.
        bounds: Bounds of the set ``f ≤ 0``; None if it has none.
        above_bounds: ``True`` if ``f`` is at least the distance to both bounds, everywhere outside them. Exact fields
            are; others are raised to the distance to their box where an operator needs it.
        convex: ``True`` if ``f`` is a convex function.
        symmetric: For each axis, ``True`` if mirroring the axis changes nothing.
        has_interior: ``True`` if points with ``f < 0`` may exist.
        reach: The largest difference of two fields over which an operator in this tree still blends them [m]; zero if
            all are sharp.
        rounding: The absolute error of ``distance`` in double precision.
        deviation: How far the field may be from the one that it stands in for; None if it stands for itself, as
            formulas do.
        in_words: The whole in words.

    >>> import palpate as pp
    >>> (pp.ball(0.5) | pp.cuboid([1, 1, 1])).promise.inside
    'bound'
    """

    outside: Quality
    inside: Quality
    lipschitz: float
    region: BoundingBall | None
    bounds: Bounds | None
    above_bounds: bool
    convex: bool
    symmetric: NDArray[np.bool_]
    has_interior: bool
    reach: float
    rounding: Rounding
    deviation: Deviation | None


@dataclass(frozen=True, eq=False, kw_only=True)
class Mass(_examples.Mass):
    """Mass, centroid and second moments of a body of one density.

    In the plane a body is one metre thick: mass is in kg for each metre.

    Fields:
        volume: The volume [m³], or area [m²].
        volume_error: The largest error of the volume.
        density: The density [kg/m³].
        centroid: The centre of mass [m].
        centroid_error: The largest error of each of its coordinates [m]; infinite if the volume may be zero.
        second_moments: ``∫ ρ (p − c)(p − c)ᵀ`` about the centroid ``c`` [kg·m²].
        second_moments_error: The largest error of each second moment [kg·m²].
        cells: The cells that were looked at; none of a polyhedron, whose faces tell.
        mass: The mass [kg].
        mass_error: The largest error of the mass [kg].
        inertia: In space the inertia tensor about the centroid [kg·m²], shape (3, 3); in the plane the moment of
            inertia about it.

    >>> import palpate as pp
    >>> mass = pp.cuboid([1, 1, 1]).mass(density=1000)
    >>> round(mass.mass), mass.inertia.diagonal().round(), mass.mass_error < 1
    (1000, array([167., 167., 167.]), True)
    """

    volume: float
    volume_error: float
    density: float
    centroid: Floats
    centroid_error: float
    second_moments: Floats
    second_moments_error: float
    cells: int


@dataclass(frozen=True, eq=False, kw_only=True)
class Separation(_examples.Separation):
    """How far apart two bodies are, by :func:`separation`: negative if they overlap.

    Where a field is a bound, this is the separation of the fields, which is at most that of the bodies.

    Fields:
        best: The best point or contact that was found.
        lower: Proven lower bound [m].
        upper: Upper bound, attained at ``best`` [m].
        stop: Why the search stopped.
        evaluations: How often fields were evaluated; a gradient counts twice.

    >>> import palpate as pp
    >>> found = pp.separation(pp.ball(0.5), pp.ball(0.5).translated([2, 0, 0]), tolerance=1e-3)
    >>> found.lower <= 1.0 <= found.upper, found.stop
    (True, 'converged')
    """

    best: Nearest
    lower: float
    upper: float
    stop: Stop
    evaluations: int


@dataclass(frozen=True, eq=False, kw_only=True)
class PenetrationBounds(_examples.PenetrationBounds):
    """How far the second of two bodies must move to leave the first, by :func:`penetration`: zero if they are apart.

    No translation shorter than `lower` separates the bodies. One of the length `upper` along the direction of `best`
    does; it is infinite if none was found.

    Fields:
        best: The best point or contact that was found.
        lower: Proven lower bound [m].
        upper: Upper bound, attained at ``best`` [m].
        stop: Why the search stopped.
        evaluations: How often fields were evaluated; a gradient counts twice.

    >>> import palpate as pp
    >>> found = pp.penetration(pp.cuboid([1, 1, 1]), pp.ball(0.1).translated([0.2, 0, 0]), tolerance=1e-4)
    >>> found.lower <= 0.4 <= found.upper, found.best.direction.round(2)
    (True, array([1., 0., 0.]))
    """

    best: Penetration
    lower: float
    upper: float
    stop: Stop
    evaluations: int


@dataclass(frozen=True, eq=False, kw_only=True)
class Overlap(_examples.Overlap):
    """Whether two bodies overlap, by :func:`overlap`: the bounds are those of their separation.

    Fields:
        best: The best point or contact that was found.
        lower: Proven lower bound [m].
        upper: Upper bound, attained at ``best`` [m].
        stop: Why the search stopped.
        evaluations: How often fields were evaluated; a gradient counts twice.
        overlaps: Whether they do, proven; None if the search ended before that was known.

    >>> import palpate as pp
    >>> found = pp.overlap(pp.ball(0.5), pp.ball(0.5).translated([2, 0, 0]))
    >>> found.overlaps, bool(found), found.lower > 0
    (False, False, True)
    """

    best: Nearest
    lower: float
    upper: float
    stop: Stop
    evaluations: int


@dataclass(frozen=True, eq=False, kw_only=True)
class ClosestPoints(_examples.ClosestPoints):
    """Where two bodies are nearest to each other, by :func:`closest_points`: the bounds are those of their separation.

    Fields:
        best: The best point or contact that was found.
        lower: Proven lower bound [m].
        upper: Upper bound, attained at ``best`` [m].
        stop: Why the search stopped.
        evaluations: How often fields were evaluated; a gradient counts twice.

    >>> import palpate as pp
    >>> found = pp.closest_points(pp.ball(0.5), pp.ball(0.5).translated([2, 0, 0]))
    >>> found.stop, found.best.point_b.round(3)
    ('converged', array([1.5, 0. , 0. ]))
    """

    best: Contact | None
    lower: float
    upper: float
    stop: Stop
    evaluations: int


@dataclass(frozen=True, eq=False, kw_only=True)
class RayCast(_examples.RayCast):
    """The first place of a ray at which the field is at most the tolerance, by :func:`cast_ray`.

    Up to the way ``lower`` [m] the field is positive, proven. At the way ``upper`` it is at most the tolerance; of a
    ray that is free, ``best`` is None and ``upper`` the length.

    Fields:
        best: The best point or contact that was found.
        lower: Proven lower bound [m].
        upper: Upper bound, attained at ``best`` [m].
        stop: Why the search stopped.
        evaluations: How often fields were evaluated; a gradient counts twice.

    >>> import palpate as pp
    >>> hit = pp.cast_ray(pp.ball(0.5), [0, 2, 0], [0, -1, 0])
    >>> hit.stop, round(hit.upper, 3), hit.best.normal.round(3)
    ('converged', 1.5, array([0., 1., 0.]))
    """

    best: RayHit | None
    lower: float
    upper: float
    stop: Stop
    evaluations: int


@dataclass(frozen=True, eq=False, kw_only=True)
class Manifold(_examples.Manifold):
    """The contacts of two bodies.

    Fields:
        contacts: The contacts, by group; in each group the deepest comes first, by the fields' values.
        groups: The number of contacts in each group. A group is one patch with like normals.
        separation: The separation. Its point is the deepest contact, except when (a) the separation exceeds the
            margin, (b) the contact was moved to an edge, or (c) ``normal_from`` is not the gradients. Its evaluations
            are those of both searches; steps to points of surfaces do not count.
        distance_at_most: The distance of the bodies is at most this [m]: zero if they overlap, the separation where
            both fields are exact outside, else that of two points found in the bodies. Infinite where none of these is
            known, as a separation made of bounds does not tell how far the bodies are apart at most, and of bodies
            that are proven farther apart than the margin.
        dropped: How many contacts were left out beyond the most that were asked for.
        is_whole: ``False`` if the search ended before it had seen the whole region, or bounds leave thin parts of it
            open.
        region_stop: Why the search of the region ended: ``converged`` if it is whole.

    >>> import palpate as pp
    >>> touch = pp.manifold(pp.cuboid([1, 1, 1]), pp.ball(0.5).translated([0, 0.99, 0]))
    >>> len(touch), touch.contacts.normal[:1].round(3), touch.is_whole
    (5, array([[0., 1., 0.]]), True)
    """

    contacts: Contacts
    groups: NDArray[np.uint64]
    separation: Separation
    distance_at_most: float
    dropped: int
    is_whole: bool
    region_stop: Stop


@dataclass(frozen=True, eq=False, kw_only=True)
class FirstTouch(_examples.FirstTouch):
    """When two bodies touch first, of a motion over the time from 0 to 1.

    Fields:
        lower: Before this time the bodies are proven apart, rounding included: their separation is more than half of
            the gap. Of an element or a mesh, the field is more than half of the gap at every point.
        upper: At this time the separation is at most the gap. Infinite if no touch was found; the end of the time if
            the bodies are proven apart all the time.
        contact: The deepest contact at ``upper``; None if there is none.
        start: How the bodies move on, if they touch at the start and a field gives the normal there.
        stop: Why the search stopped: ``converged`` at a touch, ``sign_known`` if there is none.
        evaluations: How often fields were evaluated; a gradient counts twice.
        touches: Whether they touch, proven; None if the search ended before that was known.

    >>> import palpate as pp
    >>> touch = pp.sweep(pp.ball(0.5), pp.ball(0.5), start=[3, 0, 0], end=[0, 0, 0])
    >>> touch.touches, round(touch.upper, 3), touch.start
    (True, 0.667, None)
    """

    lower: float
    upper: float
    contact: Contact | None
    start: Start | None
    stop: Stop
    evaluations: int


@dataclass(frozen=True, eq=False, kw_only=True)
class BoundingBall(_examples.BoundingBall):
    """A ball that bounds a shape.

    Fields:
        centre: The centre [m].
        radius: The radius [m].

    >>> import palpate as pp
    >>> pp.ball(0.5).translated([2, 0, 0]).promise.bounds.ball.centre
    array([2., 0., 0.])
    """

    centre: Floats
    radius: float


@dataclass(frozen=True, eq=False, kw_only=True)
class Bounds(_examples.Bounds):
    """A box and a ball, each of which holds the set ``f ≤ 0``.

    Fields:
        aabb: The box.
        ball: The ball; often tighter than the one around the box.

    >>> import palpate as pp
    >>> bounds = pp.cuboid([6, 4, 12]).promise.bounds
    >>> bounds.aabb.max, round(bounds.ball.radius, 9)
    (array([3., 2., 6.]), 7.0)
    """

    aabb: Aabb
    ball: BoundingBall


@dataclass(frozen=True, eq=False, kw_only=True)
class Aabb(_examples.Aabb):
    """A box along the axes, ``min ≤ p ≤ max`` in each coordinate [m].

    Fields:
        min: The corner with the smallest coordinates.
        max: The corner with the largest coordinates.

    >>> import palpate as pp
    >>> pp.ball(0.5).promise.bounds.aabb.min
    array([-0.5, -0.5, -0.5])
    """

    min: Floats
    max: Floats


@dataclass(frozen=True, eq=False, kw_only=True)
class Rounding(_examples.Rounding):
    """The absolute error of ``distance``, as a function of how far the point is from the origin.

    Composed per node from the count of its rounded operations, and checked against double-double arithmetic on random
    trees.

    Fields:
        constant: The error at the origin [m].
        per_metre: The further error for each metre from the origin.

    >>> import palpate as pp
    >>> 0 < pp.ball(0.5).promise.rounding.constant < 1e-14
    True
    """

    constant: float
    per_metre: float


@dataclass(frozen=True, eq=False, kw_only=True)
class Deviation(_examples.Deviation):
    """How far a field may be from the one that it stands in for, as a grid for the shape that was baked.

    With both clamped to ``within`` on both sides, their values differ by at most ``value`` everywhere. So the surface
    of each lies where the size of the other's values is at most ``value``: of an exact source, nowhere farther than
    ``value`` from its surface. Where the source is a bound, places may be farther off. (Where the source is a bound
    that falls below the distance to its box, that distance is meant.) Where ``within`` is not larger than ``value``,
    nothing is known.

    Fields:
        value: The largest difference of the values [m].
        within: The values to which both are clamped [m].

    >>> import palpate as pp
    >>> deviation = pp.ball(0.5).baked(cell=0.05).promise.deviation
    >>> 0 < deviation.value < deviation.within
    True
    """

    value: float
    within: float


@dataclass(frozen=True, eq=False, kw_only=True)
class Nearest(_examples.Nearest):
    """Where two bodies are nearest, or overlap most, in world coordinates.

    Fields:
        point: The point between the bodies, or in both [m].
        normal: The unit vector from the first body to the second; None where the gradients of both are equal or
            vanish.

    >>> import palpate as pp
    >>> pp.separation(pp.ball(0.5), pp.ball(0.5).translated([2, 0, 0])).best.normal.round(3)
    array([1., 0., 0.])
    """

    point: Floats
    normal: Floats | None


@dataclass(frozen=True, eq=False, kw_only=True)
class Penetration(_examples.Penetration):
    """How a body leaves another.

    Fields:
        direction: The direction in which the second body leaves the first one by a translation as long as the upper
            bound: a unit vector in world coordinates. None if no translation is needed, or none was found.

    >>> import palpate as pp
    >>> print(pp.penetration(pp.ball(0.5), pp.ball(0.5).translated([2, 0, 0])).best.direction)
    None
    """

    direction: Floats | None


@dataclass(frozen=True, eq=False, kw_only=True)
class Contact(_examples.Contact):
    """One place where two bodies touch, or nearly do, in world coordinates.

    Every question that finds contacts answers with this type. Which body is ``a`` and which is ``b`` follows from the
    order of the arguments.

    Fields:
        point_a: The point on the surface of body ``a`` [m]; see ``on_surfaces``.
        point_b: The point on the surface of body ``b`` [m].
        normal: The unit vector from the first body to the second. Where the fields give no direction, as at the centre
            of a ball, it is the line between the centres of the bodies; where that is none, and for elements, the y
            axis. See ``normal_from``.
        normal_from: What the normal was taken from.
        on_surfaces: ``False`` where a point is not found on its surface, but estimated along the normal from the
            values of both fields: where a field is a bound, the surfaces may be farther apart than the gap.
        gap: The distance from ``point_a`` to ``point_b`` along the normal, ``(point_b − point_a)·normal`` [m];
            negative where the bodies overlap.
        id: Tells this contact from the others of the same answer. Where a ``Track`` or a ``World`` follows the bodies,
            a contact that lasts keeps its id from step to step. So it does at a tool of ``palpate-haptics``, where the
            id is ``body << 32 | point``, of a body and a point of the tool's shell. Elsewhere the id is the contact's
            index in the answer.
        age: For how many steps before this one a ``Track`` or a ``World`` has had this contact: zero for a new one,
            and for those that nothing follows.

    >>> import palpate as pp
    >>> touch = pp.closest_points(pp.ball(0.5), pp.ball(0.5).translated([2, 0, 0])).best
    >>> touch.point_a.round(3), round(touch.gap, 3), touch.normal_from
    (array([0.5, 0. , 0. ]), 1.0, 'gradients')
    """

    point_a: Floats
    point_b: Floats
    normal: Floats
    normal_from: NormalSource
    on_surfaces: bool
    gap: float
    id: int
    age: int


@dataclass(frozen=True, eq=False, kw_only=True)
class RayHit(_examples.RayHit):
    """Where a ray meets a surface.

    Fields:
        point: The point [m].
        normal: The gradient's unit vector there; None where it is shorter than 1e-6.

    >>> import palpate as pp
    >>> pp.cast_ray(pp.ball(0.5), [0, 2, 0], [0, -1, 0]).best.point.round(3)
    array([0. , 0.5, 0. ])
    """

    point: Floats
    normal: Floats | None


@dataclass(frozen=True, eq=False, kw_only=True)
class Contacts(_examples.Contacts):
    """Contacts as arrays, with a row for each :class:`Contact`.

    Fields:
        point_a: The point on the surface of body ``a`` [m]; see ``on_surfaces``.
        point_b: The point on the surface of body ``b`` [m].
        normal: The unit vector from the first body to the second. Where the fields give no direction, as at the centre
            of a ball, it is the line between the centres of the bodies; where that is none, and for elements, the y
            axis. See ``normal_from``.
        normal_from: What the normal was taken from.
        on_surfaces: ``False`` where a point is not found on its surface, but estimated along the normal from the
            values of both fields: where a field is a bound, the surfaces may be farther apart than the gap.
        gap: The distance from ``point_a`` to ``point_b`` along the normal, ``(point_b − point_a)·normal`` [m];
            negative where the bodies overlap.
        id: Tells this contact from the others of the same answer. Where a ``Track`` or a ``World`` follows the bodies,
            a contact that lasts keeps its id from step to step. So it does at a tool of ``palpate-haptics``, where the
            id is ``body << 32 | point``, of a body and a point of the tool's shell. Elsewhere the id is the contact's
            index in the answer.
        age: For how many steps before this one a ``Track`` or a ``World`` has had this contact: zero for a new one,
            and for those that nothing follows.

    >>> import palpate as pp
    >>> touch = pp.manifold(pp.cuboid([1, 1, 1]), pp.ball(0.5).translated([0, 0.99, 0])).contacts
    >>> touch.normal[:1].round(3), touch.gap[:1].round(3)
    (array([[0., 1., 0.]]), array([-0.01]))
    """

    point_a: Floats
    point_b: Floats
    normal: Floats
    normal_from: NDArray[np.str_]
    on_surfaces: NDArray[np.bool_]
    gap: Floats
    id: NDArray[np.uint64]
    age: NDArray[np.uint64]
