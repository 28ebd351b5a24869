# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""What is written by hand of answers that Rust has too: examples, methods, and what Python adds.

``generate_answers.py`` puts the docstrings below the fields.
"""

from __future__ import annotations

from collections.abc import Sized
from dataclasses import dataclass

from palpate._answer import Answer, Floats


class AtPoint(Answer):
    """
    >>> import palpate as pp
    >>> found = pp.ball(0.5).at([0.0, 2.0, 0.0])
    >>> found.distance, found.quality, round(found.safe_radius, 3)
    (1.5, 'exact', 1.5)
    """


@dataclass(frozen=True, eq=False, kw_only=True)
class Promise(Answer):
    """
    Fields:
        in_words: The whole in words.

    >>> import palpate as pp
    >>> (pp.ball(0.5) | pp.cuboid([1, 1, 1])).promise.inside
    'bound'
    """

    in_words: str

    def __str__(self) -> str:
        return self.in_words


class Bounds(Answer):
    """
    >>> import palpate as pp
    >>> bounds = pp.cuboid([6, 4, 12]).promise.bounds
    >>> bounds.aabb.max, round(bounds.ball.radius, 9)
    (array([3., 2., 6.]), 7.0)
    """


class Aabb(Answer):
    """
    >>> import palpate as pp
    >>> pp.ball(0.5).promise.bounds.aabb.min
    array([-0.5, -0.5, -0.5])
    """


class BoundingBall(Answer):
    """
    >>> import palpate as pp
    >>> pp.ball(0.5).translated([2, 0, 0]).promise.bounds.ball.centre
    array([2., 0., 0.])
    """


class Rounding(Answer):
    """
    >>> import palpate as pp
    >>> 0 < pp.ball(0.5).promise.rounding.constant < 1e-14
    True
    """


class Deviation(Answer):
    """
    >>> import palpate as pp
    >>> deviation = pp.ball(0.5).baked(cell=0.05).promise.deviation
    >>> 0 < deviation.value < deviation.within
    True
    """


@dataclass(frozen=True, eq=False, kw_only=True)
class Mass(Answer):
    """
    Fields:
        mass: The mass [kg].
        mass_error: The largest error of the mass [kg].
        inertia: In space the inertia tensor about the centroid [kg·m²], shape (3, 3); in the plane the moment of
            inertia about it.

    >>> import palpate as pp
    >>> mass = pp.cuboid([1, 1, 1]).mass(density=1000)
    >>> round(mass.mass), mass.inertia.diagonal().round(), mass.mass_error < 1
    (1000, array([167., 167., 167.]), True)
    """

    mass: float
    mass_error: float
    inertia: Floats | float


class Separation(Answer):
    """How far apart two bodies are, by :func:`separation`: negative if they overlap.

    Where a field is a bound, this is the separation of the fields, which is at most that of the bodies.

    >>> import palpate as pp
    >>> found = pp.separation(pp.ball(0.5), pp.ball(0.5).translated([2, 0, 0]), tolerance=1e-3)
    >>> found.lower <= 1.0 <= found.upper, found.stop
    (True, 'converged')
    """


class PenetrationBounds(Answer):
    """How far the second of two bodies must move to leave the first, by :func:`penetration`: zero if they are apart.

    No translation shorter than `lower` separates the bodies. One of the length `upper` along the direction of `best`
    does; it is infinite if none was found.

    >>> import palpate as pp
    >>> found = pp.penetration(pp.cuboid([1, 1, 1]), pp.ball(0.1).translated([0.2, 0, 0]), tolerance=1e-4)
    >>> found.lower <= 0.4 <= found.upper, found.best.direction.round(2)
    (True, array([1., 0., 0.]))
    """


@dataclass(frozen=True, eq=False, kw_only=True)
class Overlap(Answer):
    """Whether two bodies overlap, by :func:`overlap`: the bounds are those of their separation.

    Fields:
        overlaps: Whether they do, proven; None if the search ended before that was known.

    >>> import palpate as pp
    >>> found = pp.overlap(pp.ball(0.5), pp.ball(0.5).translated([2, 0, 0]))
    >>> found.overlaps, bool(found), found.lower > 0
    (False, False, True)
    """

    overlaps: bool | None

    def __bool__(self) -> bool:
        if self.overlaps is None:
            raise ValueError("undecided: ask with a larger budget, or look at .overlaps, which is None")
        return self.overlaps


class Nearest(Answer):
    """
    >>> import palpate as pp
    >>> pp.separation(pp.ball(0.5), pp.ball(0.5).translated([2, 0, 0])).best.normal.round(3)
    array([1., 0., 0.])
    """


class Penetration(Answer):
    """
    >>> import palpate as pp
    >>> print(pp.penetration(pp.ball(0.5), pp.ball(0.5).translated([2, 0, 0])).best.direction)
    None
    """


class ClosestPoints(Answer):
    """Where two bodies are nearest to each other, by :func:`closest_points`: the bounds are those of their separation.

    >>> import palpate as pp
    >>> found = pp.closest_points(pp.ball(0.5), pp.ball(0.5).translated([2, 0, 0]))
    >>> found.stop, found.best.point_b.round(3)
    ('converged', array([1.5, 0. , 0. ]))
    """


class Contact(Answer):
    """
    >>> import palpate as pp
    >>> touch = pp.closest_points(pp.ball(0.5), pp.ball(0.5).translated([2, 0, 0])).best
    >>> touch.point_a.round(3), round(touch.gap, 3), touch.normal_from
    (array([0.5, 0. , 0. ]), 1.0, 'gradients')
    """


class Contacts(Answer):
    """Contacts as arrays, with a row for each :class:`Contact`.

    >>> import palpate as pp
    >>> touch = pp.manifold(pp.cuboid([1, 1, 1]), pp.ball(0.5).translated([0, 0.99, 0])).contacts
    >>> touch.normal[:1].round(3), touch.gap[:1].round(3)
    (array([[0., 1., 0.]]), array([-0.01]))
    """

    gap: Floats

    def __len__(self) -> int:
        return len(self.gap)


class Manifold(Answer):
    """
    >>> import palpate as pp
    >>> touch = pp.manifold(pp.cuboid([1, 1, 1]), pp.ball(0.5).translated([0, 0.99, 0]))
    >>> len(touch), touch.contacts.normal[:1].round(3), touch.is_whole
    (5, array([[0., 1., 0.]]), True)
    """

    contacts: Sized

    def __len__(self) -> int:
        return len(self.contacts)


class RayCast(Answer):
    """The first place of a ray at which the field is at most the tolerance, by :func:`cast_ray`.

    Up to the way ``lower`` [m] the field is positive, proven. At the way ``upper`` it is at most the tolerance; of a ray
    that is free, ``best`` is None and ``upper`` the length.

    >>> import palpate as pp
    >>> hit = pp.cast_ray(pp.ball(0.5), [0, 2, 0], [0, -1, 0])
    >>> hit.stop, round(hit.upper, 3), hit.best.normal.round(3)
    ('converged', 1.5, array([0., 1., 0.]))
    """


class RayHit(Answer):
    """
    >>> import palpate as pp
    >>> pp.cast_ray(pp.ball(0.5), [0, 2, 0], [0, -1, 0]).best.point.round(3)
    array([0. , 0.5, 0. ])
    """


@dataclass(frozen=True, eq=False, kw_only=True)
class FirstTouch(Answer):
    """
    Fields:
        touches: Whether they touch, proven; None if the search ended before that was known.

    >>> import palpate as pp
    >>> touch = pp.sweep(pp.ball(0.5), pp.ball(0.5), start=[3, 0, 0], end=[0, 0, 0])
    >>> touch.touches, round(touch.upper, 3), touch.start
    (True, 0.667, None)
    """

    touches: bool | None
