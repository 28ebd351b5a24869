# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Answers: frozen objects with names, with arrays where there are many.

Lengths are in metres. Where an answer has ``lower`` and ``upper``, the true value is between them, rounding included;
``stop`` says why the search ended: "converged" (the bounds are as close as was asked), "sign_known" (that was the
question), "budget_spent", "memory_full" or "rounding_reached".
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from palpate._palpate import Shape

Floats: TypeAlias = NDArray[np.float64]

#: The reasons to stop, in the order of the numbers in :attr:`Separations.stops`.
STOPS = ("converged", "sign_known", "budget_spent", "memory_full", "rounding_reached")


class _Answer:
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
    return bool(one == two)


@dataclass(frozen=True, eq=False, kw_only=True)
class Promise(_Answer):
    """What a field promises of its values.

    >>> import palpate as pp
    >>> (pp.ball(0.5) | pp.cuboid([1, 1, 1])).promise.inside
    'bound'
    """

    #: "exact" (the distance), "bound" (at most the distance) or "lipschitz" (divide by ``lipschitz``) where positive.
    outside: str
    #: The same where the field is negative.
    inside: str
    #: The largest difference of two values over the distance of their points.
    lipschitz: float
    #: The corners of a box that holds the body, shape (2, D) [m]; None if it has none.
    bounds: Floats | None
    #: Whether the field is a convex function.
    convex: bool
    #: Whether points with negative values may exist.
    has_interior: bool
    #: How far a sampled field may be from its source, and the values up to which that holds [m]; None of formulas.
    deviation: tuple[float, float] | None
    #: The whole in words.
    in_words: str

    def __str__(self) -> str:
        return self.in_words


@dataclass(frozen=True, eq=False, kw_only=True)
class AtPoint(_Answer):
    """What a field says at a point, by :meth:`Shape.at`."""

    #: The point [m], shape (D,).
    point: Floats
    #: The value of the field [m]: negative inside.
    distance: float
    #: The gradient of the field, shape (D,).
    gradient: Floats
    #: The gradient's unit vector, shape (D,); None where it vanishes.
    normal: Floats | None
    #: The nearest point of the surface, or of a field that is no distance one close by [m]; None if none was found.
    surface: Floats | None
    #: The radius of a ball about the point that is sure to hold no surface [m].
    safe_radius: float
    #: What the value is here: "exact", "bound" or "lipschitz".
    quality: str
    #: The largest rounding of the value [m].
    rounding: float


@dataclass(frozen=True, eq=False, kw_only=True)
class Separation(_Answer):
    """How far apart two bodies are, by :func:`separation`: negative if they overlap."""

    #: The separation is at least this [m].
    lower: float
    #: The separation is at most this [m].
    upper: float
    #: Why the search ended.
    stop: str
    #: How often the fields were evaluated.
    evaluations: int
    #: A point between the bodies, or in both [m], shape (D,).
    point: Floats
    #: The unit vector from the first to the second there, shape (D,); None where the gradients vanish.
    normal: Floats | None


@dataclass(frozen=True, eq=False, kw_only=True)
class Overlap(_Answer):
    """Whether two bodies overlap, by :func:`overlap`."""

    #: Whether they do, proven; None if the search ended before that was known.
    overlaps: bool | None
    #: The separation is at least this [m].
    lower: float
    #: The separation is at most this [m].
    upper: float
    #: Why the search ended.
    stop: str
    #: How often the fields were evaluated.
    evaluations: int
    #: A point between the bodies, or in both [m], shape (D,).
    point: Floats
    #: The unit vector from the first to the second there, shape (D,); None where the gradients vanish.
    normal: Floats | None

    def __bool__(self) -> bool:
        if self.overlaps is None:
            raise ValueError("undecided: ask with a larger budget, or look at .overlaps, which is None")
        return self.overlaps


@dataclass(frozen=True, eq=False, kw_only=True)
class Contact(_Answer):
    """A pair of points at which two bodies touch or are nearest."""

    #: The point of the first body [m], shape (D,).
    point_a: Floats
    #: The point of the second body [m], shape (D,).
    point_b: Floats
    #: The unit vector from the first to the second, shape (D,).
    normal: Floats
    #: How far apart they are along the normal [m]: negative if they overlap.
    gap: float
    #: What the normal is taken from: "gradients", "thicker body", "history" or "assumed".
    normal_from: str
    #: Whether both points are on surfaces; else they are estimated.
    on_surfaces: bool
    #: A name that stays while bodies move.
    id: int


@dataclass(frozen=True, eq=False, kw_only=True)
class ClosestPoints(_Answer):
    """Where two bodies are nearest to each other, by :func:`closest_points`."""

    #: The separation is at least this [m].
    lower: float
    #: The separation is at most this [m].
    upper: float
    #: Why the search ended.
    stop: str
    #: How often the fields were evaluated.
    evaluations: int
    #: The points; None where no way to the surfaces was found.
    contact: Contact | None


@dataclass(frozen=True, eq=False, kw_only=True)
class Manifold(_Answer):
    """Contacts that span where two bodies touch, the deepest first, by :func:`manifold`."""

    #: The separation is at least this [m].
    lower: float
    #: The distance of the bodies is at most this [m].
    upper: float
    #: Why the search for more contacts ended.
    stop: str
    #: How often the fields were evaluated for the separation.
    evaluations: int
    #: The points of the first body [m], shape (n, D).
    points_a: Floats
    #: The points of the second body [m], shape (n, D).
    points_b: Floats
    #: The unit vectors from the first to the second, shape (n, D).
    normals: Floats
    #: How far apart the points are along the normals [m], shape (n,): negative where the bodies overlap.
    gaps: Floats
    #: Names that stay while bodies move, shape (n,).
    ids: NDArray[np.uint64]
    #: Which of the separate places where the bodies touch each contact is of, shape (n,).
    groups: NDArray[np.uint64]
    #: The separation with its bounds.
    separation: Separation
    #: How many contacts were left out because there were more than ``most``.
    dropped: int
    #: Whether every place where the bodies touch that is larger than the spacing has its contacts.
    is_whole: bool

    def __len__(self) -> int:
        return len(self.gaps)


@dataclass(frozen=True, eq=False, kw_only=True)
class RayHit(_Answer):
    """The first surface along a ray, by :func:`cast_ray`."""

    #: The way to the surface is at least this [m].
    lower: float
    #: The way to the surface is at most this [m]; infinite if the ray ends before.
    upper: float
    #: Why the search ended.
    stop: str
    #: How often the field was evaluated.
    evaluations: int
    #: Where the ray meets the surface [m], shape (D,); None if it does not.
    point: Floats | None
    #: The outward unit normal there, shape (D,); None where the gradient vanishes.
    normal: Floats | None


@dataclass(frozen=True, eq=False, kw_only=True)
class Separations(_Answer):
    """How far apart two bodies are at each of n poses, by :func:`separations`."""

    #: The separations are at least these [m], shape (n,).
    lower: Floats
    #: The separations are at most these [m], shape (n,).
    upper: Floats
    #: Points between the bodies, or in both [m], in the frame of the first, shape (n, D).
    points: Floats
    #: The unit vectors from the first to the second, shape (n, D); NaN where the gradients vanish.
    normals: Floats
    #: Why each search ended, as places in :data:`STOPS`, shape (n,).
    stops: NDArray[np.uint8]
    #: How often the fields were evaluated, shape (n,).
    evaluations: NDArray[np.uint32]

    def __len__(self) -> int:
        return len(self.lower)


@dataclass(frozen=True, eq=False, kw_only=True)
class Mass(_Answer):
    """Mass, centroid and moments of a body, with bounds on their errors, by :meth:`Shape.mass`."""

    #: The mass [kg].
    mass: float
    #: How far it may be off [kg].
    mass_error: float
    #: The volume [m³], in the plane the area [m²].
    volume: float
    #: How far it may be off.
    volume_error: float
    #: The density that was given [kg/m³], in the plane [kg/m²].
    density: float
    #: The centroid [m], shape (D,).
    centroid: Floats
    #: How far it may be off [m].
    centroid_error: float
    #: The integrals of density · x · y about the centroid [kg·m²], shape (D, D).
    second_moments: Floats
    #: How far each may be off.
    second_moments_error: float
    #: How many cells were cut.
    cells: int


@dataclass(frozen=True, eq=False, kw_only=True)
class MeshReport(_Answer):
    """What a mesh is, by :meth:`Mesh.report`."""

    #: How many triangles or segments.
    elements: int
    #: How many vertices.
    vertices: int
    #: Vertices that no element names.
    unreferenced: int
    #: Vertices equal to another.
    coincident: int
    #: Elements without extent.
    degenerate: int
    #: Elements with the vertices of another.
    duplicates: int
    #: Edges of one triangle, or vertices of one segment.
    boundary: int
    #: Edges of more than two triangles.
    non_manifold: int
    #: Edges whose two triangles disagree on the inside.
    inconsistent: int
    #: The corners of the box around it [m], shape (2, D).
    bounds: Floats
    #: The area of the triangles [m²], or the length of the segments [m].
    surface: float
    #: What it encloses [m³], in the plane [m²]; None if it is not closed.
    enclosed: float | None
    #: Whether it is closed and agrees on the inside.
    is_watertight: bool
    #: The whole in words.
    in_words: str

    def __str__(self) -> str:
        return self.in_words


@dataclass(frozen=True, eq=False, kw_only=True)
class MeshContacts(_Answer):
    """Where the faces of a mesh touch a shape, by :func:`mesh_contacts`."""

    #: The points of the shape [m], shape (n, D).
    points_a: Floats
    #: The points of the mesh [m], shape (n, D).
    points_b: Floats
    #: The unit vectors from the shape to the mesh, shape (n, D).
    normals: Floats
    #: How far apart the points are [m], shape (n,): negative where they overlap.
    gaps: Floats
    #: The face of each contact, shape (n,).
    faces: NDArray[np.uint32]
    #: The faces that touch, proven.
    hits: NDArray[np.uint32]
    #: The faces of which the budget proved neither.
    undecided: NDArray[np.uint32]
    #: The field on each undecided face is at least this [m].
    lower: Floats
    #: The least value of the field on each undecided face is at most this [m].
    upper: Floats
    #: How often the field was evaluated.
    evaluations: int

    def __len__(self) -> int:
        return len(self.gaps)


@dataclass(frozen=True, eq=False, kw_only=True)
class Body(_Answer):
    """A body of a scene, by ``scene[name]``."""

    #: Its name.
    name: str
    #: Its shape where it is in the scene.
    shape: Shape
    #: Its shape in its own frame.
    shape_in_body: Shape
    #: Where it is: a matrix of shape (D + 1, D + 1).
    pose: Floats


@dataclass(frozen=True, eq=False, kw_only=True)
class Touch(_Answer):
    """A contact point at an instant, in :attr:`Snapshot.touches`."""

    #: Where the hand is [m], shape (D,).
    device: Floats
    #: How fast it moves [m/s], shape (D,).
    velocity: Floats
    #: Where the proxy is, which enters no body [m], shape (D,).
    proxy: Floats
    #: The force that the material wants [N], shape (D,).
    wanted: Floats
    #: The force that was written, after the safety chain [N], shape (D,).
    force: Floats
    #: The outward unit normal of the surface that is touched, shape (D,); zero if none is.
    normal: Floats
    #: The name of the body that is touched; None if none is.
    body: str | None
    #: Whether the proxy slips.
    is_slipping: bool


@dataclass(frozen=True, eq=False, kw_only=True)
class Snapshot(_Answer):
    """The newest state of a servo, by :meth:`Servo.latest`."""

    #: The time of the servo [s].
    time: float
    #: How many ticks there were.
    ticks: int
    #: The largest force since the last snapshot [N].
    force: float
    #: The largest depth since the last snapshot [m].
    depth: float
    #: The contact points.
    touches: tuple[Touch, ...]
    #: Whether the emergency stop holds.
    is_stopped: bool
    #: Events that nobody took in time.
    events_lost: int


@dataclass(frozen=True, eq=False, kw_only=True)
class Event(_Answer):
    """What a contact point began or ended, by :meth:`Servo.events`."""

    #: The tick, from 0.
    tick: int
    #: The contact point.
    point: int
    #: The name of the body.
    body: str | None
    #: "touch", "leave", "slip", "stick" or "pop".
    kind: str
    #: Of a touch, the speed along the normal, relative to the body [m/s].
    speed: float | None
    #: Of a pop, the force that broke the layer [N].
    force: float | None


@dataclass(frozen=True, eq=False, kw_only=True)
class Trace(_Answer):
    """Ticks that were recorded: n rows, one for each tick and contact point."""

    #: The time of the tick [s], shape (n,).
    time: Floats
    #: The contact point, shape (n,).
    point: NDArray[np.uint32]
    #: Where the hand is [m], shape (n, D).
    device: Floats
    #: Where the proxy is [m], shape (n, D).
    proxy: Floats
    #: The force that the material wants [N], shape (n, D).
    wanted: Floats
    #: The force that was written [N], shape (n, D).
    force: Floats
    #: The outward unit normal, shape (n, D).
    normal: Floats
    #: Whether a body is touched, shape (n,).
    contact: NDArray[np.bool_]
    #: The number of the body, shape (n,); without meaning where none is touched.
    body: NDArray[np.uint32]
    #: Whether the proxy slips, shape (n,).
    is_slipping: NDArray[np.bool_]
    #: How often the field was evaluated, shape (n,).
    evaluations: NDArray[np.uint32]
    #: How long the tick took [ns], shape (n,).
    cost_ns: NDArray[np.uint64]
    #: How late it was [ns], shape (n,).
    lateness_ns: NDArray[np.uint64]
    #: Rows that were not kept.
    lost: int

    def __len__(self) -> int:
        return len(self.time)

    def columns(self) -> dict[str, NDArray[Any]]:
        """The rows as columns of numbers, for ``pandas.DataFrame``, ``pyarrow.table`` or ``polars.DataFrame``.

        >>> import palpate as pp, pandas
        >>> felt = pp.feel(pp.Scene(pp.ball(0.05)), hand=[0, 0.049, 0], seconds=0.01)
        >>> pandas.DataFrame(felt.trace.columns()).shape
        (10, 23)
        """
        columns: dict[str, NDArray[Any]] = {}
        for field in fields(self):
            value = getattr(self, field.name)
            if not isinstance(value, np.ndarray):
                continue
            if value.ndim == 1:
                columns[field.name] = value
            else:
                for axis, name in zip(range(value.shape[1]), "xyz", strict=False):
                    columns[f"{field.name}_{name}"] = np.ascontiguousarray(value[:, axis])
        return columns


@dataclass(frozen=True, eq=False, kw_only=True)
class Felt(_Answer):
    """What :func:`feel` felt."""

    #: What the run was like: ticks, forces, safety, as a dict.
    report: dict[str, Any]
    #: All ticks.
    trace: Trace


@dataclass(frozen=True, eq=False, kw_only=True)
class FirstTouch(_Answer):
    """When two bodies that move touch first, by :func:`sweep`: times from 0 to 1."""

    #: Before this time the bodies are proven apart.
    lower: float
    #: At this time they touch; infinite if no such time was found, 1 if they are apart all the time.
    upper: float
    #: Why the search ended: "converged" at a touch, "sign_known" if there is none.
    stop: str
    #: How often the fields were evaluated.
    evaluations: int
    #: Whether they touch, proven; None if the search ended before that was known.
    touches: bool | None
    #: Where they touch at ``upper``; None if they do not.
    contact: Contact | None
    #: How they move on if they touch at the start: "approaching", "receding", "sliding" or "resting".
    start: str | None


@dataclass(frozen=True, eq=False, kw_only=True)
class Neighbours(_Answer):
    """Two bodies of a world that are near each other, by :meth:`World.step`."""

    #: The name of the first body.
    a: str
    #: The name of the second.
    b: str
    #: The separation is at least this [m].
    lower: float
    #: The separation is at most this [m].
    upper: float
    #: "touching" if their distance is proven to be at most the margin, "apart" if it is more, else "undecided".
    verdict: str
    #: Their contacts; None if neither is bounded.
    manifold: Manifold | None

    @property
    def stop(self) -> str | None:
        """Why the search for contacts ended.

        >>> import palpate as pp
        >>> [near.stop for near in pp.World(pp.Scene({"a": pp.ball(0.5), "b": pp.ball(0.4)})).step()]
        ['converged']
        """
        return self.manifold.stop if self.manifold else None
