# SPDX-FileCopyrightText: The palpate authors
# SPDX-License-Identifier: MIT OR Apache-2.0
"""The primitives, made by generate.py from the catalogue: what is changed here is lost."""

from __future__ import annotations

import math
from typing import Sequence

from numpy.typing import ArrayLike

from palpate._palpate import Shape, primitive

__all__ = [
    "arc",
    "ball",
    "bobbly_cross",
    "box",
    "capped_cone",
    "capped_cone_between",
    "capped_torus",
    "capsule",
    "chamfered_rectangle",
    "circle",
    "circle_wave",
    "cone",
    "cone_approximation",
    "cool_s",
    "cross",
    "cube",
    "cube_approximation",
    "cuboid",
    "cuboid_frame",
    "cut_ball",
    "cut_disk",
    "cut_hollow_sphere",
    "cylinder",
    "cylinder_approximation",
    "cylinder_between",
    "death_star",
    "egg",
    "ellipse",
    "ellipsoid",
    "half_space",
    "heart",
    "hexagonal_prism",
    "horseshoe",
    "hyperbola",
    "infinite_cone",
    "infinite_cylinder",
    "isosceles_trapezoid",
    "isosceles_triangle",
    "link",
    "moon",
    "octahedron",
    "oriented_rectangle",
    "oriented_vesica",
    "parabola",
    "parabola_segment",
    "parallelogram",
    "pie",
    "polygon",
    "power_ball",
    "power_cuboid",
    "power_torus",
    "pyramid",
    "pyramid_approximation",
    "quad_sheet",
    "quadratic_bezier",
    "quadratic_circle",
    "rectangle",
    "regular_polygon",
    "regular_star",
    "rhombus",
    "rhombus_prism",
    "ring",
    "ring_sector",
    "round_cone",
    "round_cone_between",
    "rounded_cross",
    "rounded_cuboid",
    "rounded_cylinder",
    "rounded_rectangle",
    "rounded_x",
    "screw_thread",
    "segment",
    "solid_angle",
    "sphere",
    "square",
    "stairs",
    "tetrahedron",
    "torus",
    "triangle",
    "triangle_sheet",
    "triangular_prism",
    "tunnel",
    "uneven_capsule",
    "vesica",
    "vesica_segment",
]


def _angle(name: str, radians: float | None, degrees: float | None) -> float:
    """The angle [rad], of which one of two units is given."""
    if (radians is None) == (degrees is None):
        raise TypeError(f"exactly one of {name}= [rad] and {name}_degrees= must be given")
    return math.radians(degrees) if degrees is not None else float(radians)  # type: ignore[arg-type]


def _columns(points: ArrayLike) -> int:
    """How many coordinates a vector or points have."""
    import numpy

    shape = numpy.shape(points)
    if not shape or shape[-1] not in (2, 3):
        raise ValueError(f"2 coordinates are needed in the plane, 3 in space, got the shape {shape}")
    return int(shape[-1])


def arc(
    *,
    ring_radius: float,
    angle: float | None = None,
    angle_degrees: float | None = None,
    radius: float,
) -> Shape:
    """All points within a radius of an arc of a circle, open downwards.

    At the centre of its circle; open downwards. In the plane.

    Args:
        ring_radius: the radius of the circle [m].
        angle: how much of the circle, about the +y axis [rad].
        angle_degrees: the same [degrees]; one of the two is given.
        radius: the radius of the tube, zero for a curve without inside [m].

    Raises `ShapeError` if a number is out of range, `TypeError` unless one of an angle in radians and in degrees is given.

    >>> import palpate as pp
    >>> pp.arc(ring_radius=0.7, angle=4.0, radius=0.12)
    arc(ring_radius=0.7, angle=4.0, radius=0.12)
    """
    return primitive("arc", 2, [ring_radius, _angle("angle", angle, angle_degrees), radius])


def ball(
    radius: float,
    *,
    dimension: int = 3,
) -> Shape:
    """All points within a radius of the origin.

    Centred. In the plane or in space.

    Args:
        radius: the radius [m].
        dimension: 2 in the plane, 3 in space.

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.ball(radius=0.7)
    ball(radius=0.7)
    """
    return primitive("ball", dimension, [radius])


def bobbly_cross(
    width: float,
    dip: float,
    rounding: float,
) -> Shape:
    """A cross with four tips on the axes between hollow arcs of parabolas, rounded.

    Centred; a tip up, a tip down. In the plane.

    Args:
        width: the full width and height [m].
        dip: how far the sides are drawn in from the line between two tips [m].
        rounding: the radius of the tips, zero for sharp ones [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.bobbly_cross(width=1.9, dip=0.2, rounding=0.15)
    bobbly_cross(width=1.9, dip=0.2, rounding=0.15)
    """
    return primitive("bobbly_cross", 2, [width, dip, rounding])


def box(
    size: ArrayLike,
) -> Shape:
    """A box along the axes: a rectangle in 2D.

    Centred; edges along the axes. In space.

    Args:
        size: the edge lengths [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.box(size=[1.2, 0.8, 0.6])
    cuboid(size=[1.2, 0.8, 0.6])
    """
    return primitive("box", 3, [size])


def capped_cone(
    bottom_radius: float,
    top_radius: float,
    height: float,
) -> Shape:
    """A cone about the y axis with its tip cut off.

    Centred, at half its height; axis along y, `bottom_radius` below. In space.

    Args:
        bottom_radius: the radius at the bottom [m].
        top_radius: the radius at the top [m].
        height: the full height [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.capped_cone(bottom_radius=0.6, top_radius=0.25, height=0.9)
    capped_cone(bottom_radius=0.6, top_radius=0.25, height=0.9)
    """
    return primitive("capped_cone", 3, [bottom_radius, top_radius, height])


def capped_cone_between(
    from_: ArrayLike,
    to: ArrayLike,
    from_radius: float,
    to_radius: float,
) -> Shape:
    """A cone between two points, with a radius at each.

    Given by its points. In space.

    Args:
        from_: the middle of one end [m].
        to: the middle of the other end [m].
        from_radius: the radius at one end [m].
        to_radius: the radius at the other end [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.capped_cone_between(from_=[-0.5, -0.4, 0.2], to=[0.6, 0.5, -0.1], from_radius=0.45, to_radius=0.15)
    capped_cone_between(from_=[-0.5, -0.4, 0.2], to=[0.6, 0.5, -0.1], from_radius=0.45, to_radius=0.15)
    """
    return primitive("capped_cone_between", 3, [from_, to, from_radius, to_radius])


def capped_torus(
    *,
    ring_radius: float,
    radius: float,
    angle: float | None = None,
    angle_degrees: float | None = None,
) -> Shape:
    """All points within a radius of an arc of a circle about the y axis, open towards -z.

    At the centre of its circle; axis along y, open towards -z. In space.

    Args:
        ring_radius: the radius of the circle [m].
        radius: the radius of the tube, zero for a curve without inside [m].
        angle: how much of the circle, about the +z axis [rad].
        angle_degrees: the same [degrees]; one of the two is given.

    Raises `ShapeError` if a number is out of range, `TypeError` unless one of an angle in radians and in degrees is given.

    >>> import palpate as pp
    >>> pp.capped_torus(ring_radius=0.7, radius=0.15, angle=4.0)
    capped_torus(ring_radius=0.7, radius=0.15, angle=4.0)
    """
    return primitive("capped_torus", 3, [ring_radius, radius, _angle("angle", angle, angle_degrees)])


def capsule(
    radius: float,
    height: float,
    *,
    dimension: int = 3,
) -> Shape:
    """A rod with round ends along the y axis.

    Centred; its length along y. In the plane or in space.

    Args:
        radius: the radius of the rod [m].
        height: the length from tip to tip [m].
        dimension: 2 in the plane, 3 in space.

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.capsule(radius=0.3, height=1.4)
    capsule(radius=0.3, height=1.4)
    """
    return primitive("capsule", dimension, [radius, height])


def chamfered_rectangle(
    size: ArrayLike,
    chamfer: float,
) -> Shape:
    """A rectangle along the axes with its corners cut off at 45°.

    Centred; edges along the axes. In the plane.

    Args:
        size: the edge lengths before cutting [m].
        chamfer: what a cut takes from each edge [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.chamfered_rectangle(size=[1.6, 1.1], chamfer=0.35)
    chamfered_rectangle(size=[1.6, 1.1], chamfer=0.35)
    """
    return primitive("chamfered_rectangle", 2, [size, chamfer])


def circle(
    radius: float,
) -> Shape:
    """All points within a radius of the origin.

    Centred. In the plane.

    Args:
        radius: the radius [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.circle(radius=0.7)
    ball(radius=0.7, dimension=2)
    """
    return primitive("circle", 2, [radius])


def circle_wave(
    *,
    ring_radius: float,
    angle: float | None = None,
    angle_degrees: float | None = None,
    radius: float,
) -> Shape:
    """All points within a radius of an endless line of arcs, up and down in turn.

    Endless along x; a crest at x = 0, arcs that meet at y = 0. In the plane.

    Args:
        ring_radius: the radius of the arcs [m].
        angle: how much of a circle each arc is, at most 300° [rad].
        angle_degrees: the same [degrees]; one of the two is given.
        radius: the radius of the tube, zero for a curve without inside [m].

    Raises `ShapeError` if a number is out of range, `TypeError` unless one of an angle in radians and in degrees is given.

    >>> import palpate as pp
    >>> pp.circle_wave(ring_radius=0.31, angle=4.0, radius=0.08)
    circle_wave(ring_radius=0.31, angle=4.0, radius=0.08)
    """
    return primitive("circle_wave", 2, [ring_radius, _angle("angle", angle, angle_degrees), radius])


def cone(
    radius: float,
    height: float,
) -> Shape:
    """A cone about the y axis, its tip up.

    Centred, at half its height; axis along y, a tip up, a flat side down. In space.

    Args:
        radius: the radius of the base [m].
        height: the full height [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.cone(radius=0.6, height=1.0)
    cone(radius=0.6, height=1.0)
    """
    return primitive("cone", 3, [radius, height])


def cone_approximation(
    radius: float,
    height: float,
) -> Shape:
    """The article's approximate cone, corrected to be a bound.

    Centred, at half its height; axis along y, a tip up, a flat side down. In space.

    Args:
        radius: the radius of the base [m].
        height: the full height [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.cone_approximation(radius=0.6, height=1.0)
    cone_approximation(radius=0.6, height=1.0)
    """
    return primitive("cone_approximation", 3, [radius, height])


def cool_s(
    height: float,
) -> Shape:
    """The S that every pupil draws, two fifths as wide as high.

    Centred; a tip up, a tip down. In the plane.

    Args:
        height: the full height [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.cool_s(height=1.8)
    cool_s(height=1.8)
    """
    return primitive("cool_s", 2, [height])


def cross(
    length: float,
    width: float,
) -> Shape:
    """A bar along x and one along y, crossed at the origin.

    Centred; bars along the axes. In the plane.

    Args:
        length: the full length of a bar [m].
        width: the full width of a bar [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.cross(length=1.7, width=0.5)
    cross(length=1.7, width=0.5)
    """
    return primitive("cross", 2, [length, width])


def cube(
    size: float,
) -> Shape:
    """A box along the axes: a rectangle in 2D.

    Centred; edges along the axes. In space.

    Args:
        size: the length of every edge [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.cube(size=1.0)
    cuboid(size=[1.0, 1.0, 1.0])
    """
    return primitive("cube", 3, [size])


def cube_approximation(
    side: float,
) -> Shape:
    """The article's approximate cube: a bound with sharp isolines.

    Centred; edges along the axes. In space.

    Args:
        side: the edge length [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.cube_approximation(side=0.9)
    cube_approximation(side=0.9)
    """
    return primitive("cube_approximation", 3, [side])


def cuboid(
    size: ArrayLike,
) -> Shape:
    """A box along the axes: a rectangle in 2D.

    Centred; edges along the axes. In the plane or in space.

    Args:
        size: the edge lengths [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.cuboid(size=[1.2, 0.8, 0.6])
    cuboid(size=[1.2, 0.8, 0.6])
    """
    return primitive("cuboid", _columns(size), [size])


def cuboid_frame(
    size: ArrayLike,
    thickness: float,
) -> Shape:
    """The twelve edges of a box as square bars.

    Centred; edges along the axes. In space.

    Args:
        size: the edge lengths [m].
        thickness: the thickness of the bars, less than half the shortest edge [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.cuboid_frame(size=[1.4, 1.1, 0.8], thickness=0.2)
    cuboid_frame(size=[1.4, 1.1, 0.8], thickness=0.2)
    """
    return primitive("cuboid_frame", 3, [size, thickness])


def cut_ball(
    radius: float,
    cut_height: float,
) -> Shape:
    """A ball about the origin, cut off below a height.

    At the centre of its ball; a flat side down. In space.

    Args:
        radius: the radius of the ball [m].
        cut_height: where it is cut, between minus and plus the radius [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.cut_ball(radius=0.8, cut_height=-0.3)
    cut_ball(radius=0.8, cut_height=-0.3)
    """
    return primitive("cut_ball", 3, [radius, cut_height])


def cut_disk(
    radius: float,
    cut_height: float,
) -> Shape:
    """What is above a line of a disc.

    At the centre of its disc; a flat side down. In the plane.

    Args:
        radius: the radius of the disc [m].
        cut_height: how far above the centre the cut is [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.cut_disk(radius=0.9, cut_height=-0.3)
    cut_disk(radius=0.9, cut_height=-0.3)
    """
    return primitive("cut_disk", 2, [radius, cut_height])


def cut_hollow_sphere(
    radius: float,
    cut_height: float,
    thickness: float,
) -> Shape:
    """A bowl: a hollow sphere about the origin, cut off above a height, its rim round.

    At the centre of its sphere; hollow upwards. In space.

    Args:
        radius: from the origin to the middle of the wall [m].
        cut_height: where it is cut, between minus and plus the radius [m].
        thickness: the thickness of the wall, zero for a sheet without inside [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.cut_hollow_sphere(radius=0.8, cut_height=0.2, thickness=0.15)
    cut_hollow_sphere(radius=0.8, cut_height=0.2, thickness=0.15)
    """
    return primitive("cut_hollow_sphere", 3, [radius, cut_height, thickness])


def cylinder(
    radius: float,
    height: float,
) -> Shape:
    """A cylinder about the y axis.

    Centred; axis along y. In space.

    Args:
        radius: the radius [m].
        height: the full height [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.cylinder(radius=0.4, height=1.0)
    cylinder(radius=0.4, height=1.0)
    """
    return primitive("cylinder", 3, [radius, height])


def cylinder_approximation(
    radius: float,
    height: float,
) -> Shape:
    """The article's approximate cylinder: a bound with sharp isolines.

    Centred; axis along y. In space.

    Args:
        radius: the radius [m].
        height: the full height [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.cylinder_approximation(radius=0.4, height=1.0)
    cylinder_approximation(radius=0.4, height=1.0)
    """
    return primitive("cylinder_approximation", 3, [radius, height])


def cylinder_between(
    from_: ArrayLike,
    to: ArrayLike,
    radius: float,
) -> Shape:
    """A cylinder with flat ends between two points.

    Given by its points. In space.

    Args:
        from_: the middle of one end [m].
        to: the middle of the other end [m].
        radius: the radius [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.cylinder_between(from_=[-0.5, -0.4, 0.2], to=[0.6, 0.3, -0.1], radius=0.35)
    cylinder_between(from_=[-0.5, -0.4, 0.2], to=[0.6, 0.3, -0.1], radius=0.35)
    """
    return primitive("cylinder_between", 3, [from_, to, radius])


def death_star(
    radius: float,
    cut_radius: float,
    distance: float,
) -> Shape:
    """A ball about the origin with a ball-shaped bite from above.

    At the centre of its ball; hollow upwards. In space.

    Args:
        radius: the radius of the ball [m].
        cut_radius: the radius of the bite [m].
        distance: from centre to centre, so that the spheres cross [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.death_star(radius=0.9, cut_radius=0.6, distance=1.1)
    death_star(radius=0.9, cut_radius=0.6, distance=1.1)
    """
    return primitive("death_star", 3, [radius, cut_radius, distance])


def egg(
    bottom_radius: float,
    top_radius: float,
) -> Shape:
    """An egg of four arcs, its thin end up.

    At the centre of its bottom circle; the thin end up. In the plane.

    Args:
        bottom_radius: the radius of the bottom, half the width [m].
        top_radius: the radius of the top, at most that of the bottom [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.egg(bottom_radius=0.7, top_radius=0.25)
    egg(bottom_radius=0.7, top_radius=0.25)
    """
    return primitive("egg", 2, [bottom_radius, top_radius])


def ellipse(
    radii: ArrayLike,
) -> Shape:
    """An ellipse along the axes.

    Centred; radii along the axes. In the plane.

    Args:
        radii: the radii along the axes [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.ellipse(radii=[0.9, 0.4])
    ellipse(radii=[0.9, 0.4])
    """
    return primitive("ellipse", 2, [radii])


def ellipsoid(
    radii: ArrayLike,
) -> Shape:
    """An ellipsoid along the axes.

    Centred; radii along the axes. In space.

    Args:
        radii: the radii along the axes [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.ellipsoid(radii=[0.9, 0.6, 0.3])
    ellipsoid(radii=[0.9, 0.6, 0.3])
    """
    return primitive("ellipsoid", 3, [radii])


def half_space(
    normal: ArrayLike,
    offset: float,
) -> Shape:
    """All points behind a plane.

    Endless; `offset` from the origin along `normal`, which points out. In the plane or in space.

    Args:
        normal: the direction out of the half-space, of any length.
        offset: where the plane is along the normal [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.half_space(normal=[0.3, 1.0, -0.2], offset=0.1)
    half_space(normal=[0.3, 1.0, -0.2], offset=0.1)
    """
    return primitive("half_space", _columns(normal), [normal, offset])


def heart(
    height: float,
) -> Shape:
    """A heart, its tip down: a square on its corner with half a disc on each upper edge.

    Centred, at half its height; a tip down. In the plane.

    Args:
        height: the full height [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.heart(height=1.7)
    heart(height=1.7)
    """
    return primitive("heart", 2, [height])


def hexagonal_prism(
    radius: float,
    height: float,
) -> Shape:
    """A prism along y on a regular hexagon.

    Centred; axis along y, two corners on z. In space.

    Args:
        radius: from the axis to a corner of the hexagon [m].
        height: the full height [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.hexagonal_prism(radius=0.6, height=0.5)
    hexagonal_prism(radius=0.6, height=0.5)
    """
    return primitive("hexagonal_prism", 3, [radius, height])


def horseshoe(
    *,
    ring_radius: float,
    angle: float | None = None,
    angle_degrees: float | None = None,
    length: float,
    width: float,
) -> Shape:
    """A band along an arc and its tangents at both ends, open downwards.

    At the centre of its arc; open downwards. In the plane.

    Args:
        ring_radius: the radius of the arc, to the middle of the band [m].
        angle: how much of the circle, about the +y axis [rad].
        angle_degrees: the same [degrees]; one of the two is given.
        length: the length of each straight leg [m].
        width: the full width of the band [m].

    Raises `ShapeError` if a number is out of range, `TypeError` unless one of an angle in radians and in degrees is given.

    >>> import palpate as pp
    >>> pp.horseshoe(ring_radius=0.7, angle=3.7, length=0.55, width=0.3)
    horseshoe(ring_radius=0.7, angle=3.7, length=0.55, width=0.3)
    """
    return primitive("horseshoe", 2, [ring_radius, _angle("angle", angle, angle_degrees), length, width])


def hyperbola(
    radii: ArrayLike,
) -> Shape:
    """What is beyond the upper branch of a hyperbola.

    Endless; at the middle of both vertices, the branch above. In the plane.

    Args:
        radii: the semi-axes along x and y [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.hyperbola(radii=[0.45, 0.31])
    hyperbola(radii=[0.45, 0.31])
    """
    return primitive("hyperbola", 2, [radii])


def infinite_cone(
    *,
    angle: float | None = None,
    angle_degrees: float | None = None,
) -> Shape:
    """A cone without a base, its tip at the origin, opening downwards.

    Endless; at its tip, opening downwards. In space.

    Args:
        angle: the opening from side to side, less than half a turn [rad].
        angle_degrees: the same [degrees]; one of the two is given.

    Raises `ShapeError` if a number is out of range, `TypeError` unless one of an angle in radians and in degrees is given.

    >>> import palpate as pp
    >>> pp.infinite_cone(angle=0.9)
    infinite_cone(angle=0.9)
    """
    return primitive("infinite_cone", 3, [_angle("angle", angle, angle_degrees)])


def infinite_cylinder(
    radius: float,
) -> Shape:
    """A cylinder without ends about the y axis.

    Endless along y; about the y axis. In space.

    Args:
        radius: the radius [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.infinite_cylinder(radius=0.3)
    infinite_cylinder(radius=0.3)
    """
    return primitive("infinite_cylinder", 3, [radius])


def isosceles_trapezoid(
    bottom_width: float,
    top_width: float,
    height: float,
) -> Shape:
    """A trapezoid about the y axis.

    Centred, at half its height; a flat side down. In the plane.

    Args:
        bottom_width: the full width at the bottom [m].
        top_width: the full width at the top [m].
        height: the full height [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.isosceles_trapezoid(bottom_width=1.6, top_width=0.7, height=0.9)
    isosceles_trapezoid(bottom_width=1.6, top_width=0.7, height=0.9)
    """
    return primitive("isosceles_trapezoid", 2, [bottom_width, top_width, height])


def isosceles_triangle(
    base: float,
    height: float,
) -> Shape:
    """A triangle about the y axis, its tip up.

    Centred, at half its height; a tip up, a flat side down. In the plane.

    Args:
        base: the length of the base [m].
        height: the full height [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.isosceles_triangle(base=1.1, height=1.3)
    isosceles_triangle(base=1.1, height=1.3)
    """
    return primitive("isosceles_triangle", 2, [base, height])


def link(
    ring_radius: float,
    radius: float,
    length: float,
) -> Shape:
    """A chain's link: a torus about the y axis with straight sides along z.

    Centred; axis along y, straight sides along z. In space.

    Args:
        ring_radius: the radius of the circle of each bow [m].
        radius: the radius of the tube [m].
        length: the length of the straight sides [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.link(ring_radius=0.4, radius=0.15, length=0.8)
    link(ring_radius=0.4, radius=0.15, length=0.8)
    """
    return primitive("link", 3, [ring_radius, radius, length])


def moon(
    radius: float,
    cut_radius: float,
    distance: float,
) -> Shape:
    """A disc without a second one above it: a crescent with its horns up.

    At the centre of its disc; hollow upwards. In the plane.

    Args:
        radius: the radius of the disc [m].
        cut_radius: the radius of the disc that is taken off [m].
        distance: how far above the disc's centre the other's is [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.moon(radius=0.9, cut_radius=0.7, distance=0.45)
    moon(radius=0.9, cut_radius=0.7, distance=0.45)
    """
    return primitive("moon", 2, [radius, cut_radius, distance])


def octahedron(
    radius: float,
) -> Shape:
    """A regular octahedron with corners on the axes.

    Centred; corners on the axes. In space.

    Args:
        radius: from the centre to a corner [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.octahedron(radius=0.8)
    octahedron(radius=0.8)
    """
    return primitive("octahedron", 3, [radius])


def oriented_rectangle(
    from_: ArrayLike,
    to: ArrayLike,
    width: float,
) -> Shape:
    """The rectangle around the line between two points.

    Given by its points. In the plane.

    Args:
        from_: the middle of one end [m].
        to: the middle of the other end [m].
        width: the full width across [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.oriented_rectangle(from_=[-0.7, -0.5], to=[0.6, 0.4], width=0.5)
    oriented_rectangle(from_=[-0.7, -0.5], to=[0.6, 0.4], width=0.5)
    """
    return primitive("oriented_rectangle", 2, [from_, to, width])


def oriented_vesica(
    from_: ArrayLike,
    to: ArrayLike,
    width: float,
) -> Shape:
    """A lens of two equal arcs between two points.

    Given by its points. In the plane.

    Args:
        from_: one tip [m].
        to: the other tip [m].
        width: the full width across, at most the distance of the tips [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.oriented_vesica(from_=[-0.7, -0.4], to=[0.6, 0.5], width=0.6)
    oriented_vesica(from_=[-0.7, -0.4], to=[0.6, 0.5], width=0.6)
    """
    return primitive("oriented_vesica", 2, [from_, to, width])


def parabola(
    focal_length: float,
) -> Shape:
    """What is above a parabola.

    Endless; at its vertex, opening upwards. In the plane.

    Args:
        focal_length: from the vertex to the focus [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.parabola(focal_length=0.2)
    parabola(focal_length=0.2)
    """
    return primitive("parabola", 2, [focal_length])


def parabola_segment(
    width: float,
    height: float,
) -> Shape:
    """What is under a parabolic arch and above its chord.

    Centred, at half its height; a flat side down. In the plane.

    Args:
        width: the length of the chord [m].
        height: the full height [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.parabola_segment(width=1.3, height=1.7)
    parabola_segment(width=1.3, height=1.7)
    """
    return primitive("parabola_segment", 2, [width, height])


def parallelogram(
    width: float,
    height: float,
    skew: float,
) -> Shape:
    """A parallelogram, two of its edges along x.

    Centred; two edges along x. In the plane.

    Args:
        width: the length of the top and of the bottom [m].
        height: the full height [m].
        skew: how much further right the top is than the bottom [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.parallelogram(width=1.1, height=0.9, skew=0.5)
    parallelogram(width=1.1, height=0.9, skew=0.5)
    """
    return primitive("parallelogram", 2, [width, height, skew])


def pie(
    *,
    radius: float,
    angle: float | None = None,
    angle_degrees: float | None = None,
) -> Shape:
    """A sector of a disc, spread about the +y axis.

    At the centre of its disc; spread about +y. In the plane.

    Args:
        radius: the radius of the disc [m].
        angle: how much of the disc, about the +y axis [rad].
        angle_degrees: the same [degrees]; one of the two is given.

    Raises `ShapeError` if a number is out of range, `TypeError` unless one of an angle in radians and in degrees is given.

    >>> import palpate as pp
    >>> pp.pie(radius=0.9, angle=1.9)
    pie(radius=0.9, angle=1.9)
    """
    return primitive("pie", 2, [radius, _angle("angle", angle, angle_degrees)])


def polygon(
    rings: Sequence[ArrayLike],
) -> Shape:
    """The inside of closed rings by the even-odd rule: rings in rings are holes.

    Given by its points. In the plane.

    Args:
        rings: lists of at least 3 points, each closed by itself [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.polygon(rings=[[[-0.8, -0.5], [0.7, -0.6], [0.9, 0.2], [0.2, 0.1], [-0.3, 0.8]], [[-0.4, -0.3], [0.1, -0.4], [-0.2, 0.2]]])
    polygon(rings=[[[-0.8, -0.5], [0.7, -0.6], [0.9, 0.2], [0.2, 0.1], [-0.3, 0.8]], [[-0.4, -0.3], [0.1, -0.4], [-0.2, 0.2]]])
    """
    return primitive("polygon", 2, [rings])


def power_ball(
    radius: float,
    exponent: int,
    *,
    dimension: int = 3,
) -> Shape:
    """A ball in the norm of fourth, sixth or eighth powers: a rounded cube.

    Centred; radii along the axes. In the plane or in space.

    Args:
        radius: the radius along the axes [m].
        exponent: the power that the norm adds up, 4, 6 or 8.
        dimension: 2 in the plane, 3 in space.

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.power_ball(radius=0.8, exponent=4)
    power_ball(radius=0.8, exponent=4)
    """
    return primitive("power_ball", dimension, [radius, exponent])


def power_cuboid(
    size: ArrayLike,
    rounding: float,
    exponent: int,
) -> Shape:
    """A box along the axes, its edges rounded inwards in a norm of higher powers.

    Centred; edges along the axes. In the plane or in space.

    Args:
        size: the edge lengths [m].
        rounding: the radius of the edges along the axes [m].
        exponent: the power that the norm adds up, 4, 6 or 8.

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.power_cuboid(size=[1.4, 1.1, 0.9], rounding=0.4, exponent=6)
    power_cuboid(size=[1.4, 1.1, 0.9], rounding=0.4, exponent=6)
    """
    return primitive("power_cuboid", _columns(size), [size, rounding, exponent])


def power_torus(
    ring_radius: float,
    radius: float,
    ring_exponent: int,
    tube_exponent: int,
) -> Shape:
    """A torus about the y axis, its ring and its tube circles in norms of higher powers.

    Centred; axis along y. In space.

    Args:
        ring_radius: the radius of the ring along the axes [m].
        radius: the radius of the tube along the axes [m].
        ring_exponent: the power that the ring's norm adds up, 2, 4, 6 or 8.
        tube_exponent: the power that the tube's norm adds up, 2, 4, 6 or 8.

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.power_torus(ring_radius=0.6, radius=0.25, ring_exponent=4, tube_exponent=8)
    power_torus(ring_radius=0.6, radius=0.25, ring_exponent=4, tube_exponent=8)
    """
    return primitive("power_torus", 3, [ring_radius, radius, ring_exponent, tube_exponent])


def pyramid(
    side: float,
    height: float,
) -> Shape:
    """A pyramid on a square, its tip up along y.

    Centred, at half its height; a tip up, a base with edges along x and z. In space.

    Args:
        side: the edge of the base [m].
        height: the full height [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.pyramid(side=1.0, height=0.9)
    pyramid(side=1.0, height=0.9)
    """
    return primitive("pyramid", 3, [side, height])


def pyramid_approximation(
    side: float,
    height: float,
) -> Shape:
    """The article's approximate pyramid, corrected to be a bound.

    Centred, at half its height; a tip up, a base with edges along x and z. In space.

    Args:
        side: the edge of the base [m].
        height: the full height [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.pyramid_approximation(side=1.0, height=0.9)
    pyramid_approximation(side=1.0, height=0.9)
    """
    return primitive("pyramid_approximation", 3, [side, height])


def quad_sheet(
    points: ArrayLike,
    radius: float,
) -> Shape:
    """All points within a radius of a flat convex quadrilateral in space.

    Given by its points. In space.

    Args:
        points: the four corners, in their order around it, in one plane [m].
        radius: the radius, zero for a sheet without inside [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.quad_sheet(points=[[-0.7, -0.5, -0.25], [0.8, -0.4, -0.2], [0.6, 0.6, 0.3], [-0.5, 0.4, 0.2]], radius=0.15)
    quad_sheet(points=[[-0.7, -0.5, -0.25], [0.8, -0.4, -0.2], [0.6, 0.6, 0.3], [-0.5, 0.4, 0.2]], radius=0.15)
    """
    return primitive("quad_sheet", 3, [points, radius])


def quadratic_bezier(
    from_: ArrayLike,
    control: ArrayLike,
    to: ArrayLike,
    radius: float,
) -> Shape:
    """All points within a radius of a quadratic Bézier curve.

    Given by its points. In the plane.

    Args:
        from_: one end [m].
        control: where the tangents of both ends meet [m].
        to: the other end [m].
        radius: the radius, zero for a curve without inside [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.quadratic_bezier(from_=[-0.8, -0.6], control=[0.5, 1.1], to=[0.9, -0.4], radius=0.12)
    quadratic_bezier(from_=[-0.8, -0.6], control=[0.5, 1.1], to=[0.9, -0.4], radius=0.12)
    """
    return primitive("quadratic_bezier", 2, [from_, control, to, radius])


def quadratic_circle(
    radius: float,
) -> Shape:
    """A round shape whose outline is four arcs of parabolas.

    Centred; radii along the axes. In the plane.

    Args:
        radius: from the centre to where it meets the axes [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.quadratic_circle(radius=0.8)
    quadratic_circle(radius=0.8)
    """
    return primitive("quadratic_circle", 2, [radius])


def rectangle(
    size: ArrayLike,
) -> Shape:
    """A box along the axes: a rectangle in 2D.

    Centred; edges along the axes. In the plane.

    Args:
        size: the edge lengths [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.rectangle(size=[1.2, 0.8])
    cuboid(size=[1.2, 0.8])
    """
    return primitive("rectangle", 2, [size])


def regular_polygon(
    sides: int,
    radius: float,
) -> Shape:
    """A regular polygon, one corner up.

    At the centre of its circle; a tip up. In the plane.

    Args:
        sides: how many sides, 3 to 256.
        radius: from the centre to a corner [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.regular_polygon(sides=5, radius=0.8)
    regular_polygon(sides=5, radius=0.8)
    """
    return primitive("regular_polygon", 2, [sides, radius])


def regular_star(
    branches: int,
    outer_radius: float,
    inner_radius: float,
) -> Shape:
    """A regular star, one tip up.

    At the centre of its circle; a tip up. In the plane.

    Args:
        branches: how many branches, 3 to 256.
        outer_radius: from the centre to a tip [m].
        inner_radius: from the centre to an inner corner [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.regular_star(branches=7, outer_radius=0.9, inner_radius=0.5)
    regular_star(branches=7, outer_radius=0.9, inner_radius=0.5)
    """
    return primitive("regular_star", 2, [branches, outer_radius, inner_radius])


def rhombus(
    size: ArrayLike,
) -> Shape:
    """A rhombus, its diagonals along the axes.

    Centred; diagonals along the axes. In the plane.

    Args:
        size: the full diagonals along x and y [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.rhombus(size=[1.8, 1.1])
    rhombus(size=[1.8, 1.1])
    """
    return primitive("rhombus", 2, [size])


def rhombus_prism(
    size: ArrayLike,
    rounding: float,
) -> Shape:
    """A prism along y on a rhombus, its edges rounded inwards.

    Centred; axis along y, diagonals along x and z. In space.

    Args:
        size: the diagonal along x, the height along y and the diagonal along z, before rounding [m].
        rounding: the radius of the edges [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.rhombus_prism(size=[1.6, 0.6, 1.0], rounding=0.08)
    rhombus_prism(size=[1.6, 0.6, 1.0], rounding=0.08)
    """
    return primitive("rhombus_prism", 3, [size, rounding])


def ring(
    inner_radius: float,
    outer_radius: float,
) -> Shape:
    """All points between two circles.

    Centred. In the plane.

    Args:
        inner_radius: the radius of the hole [m].
        outer_radius: the radius of the outer circle [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.ring(inner_radius=0.4, outer_radius=0.8)
    ring(inner_radius=0.4, outer_radius=0.8)
    """
    return primitive("ring", 2, [inner_radius, outer_radius])


def ring_sector(
    *,
    inner_radius: float,
    outer_radius: float,
    angle: float | None = None,
    angle_degrees: float | None = None,
) -> Shape:
    """A sector of a ring with flat ends, spread about the +y axis.

    At the centre of its ring; open downwards. In the plane.

    Args:
        inner_radius: the radius of the hole [m].
        outer_radius: the radius of the outer circle [m].
        angle: how much of the ring, about the +y axis [rad].
        angle_degrees: the same [degrees]; one of the two is given.

    Raises `ShapeError` if a number is out of range, `TypeError` unless one of an angle in radians and in degrees is given.

    >>> import palpate as pp
    >>> pp.ring_sector(inner_radius=0.5, outer_radius=0.9, angle=4.2)
    ring_sector(inner_radius=0.5, outer_radius=0.9, angle=4.2)
    """
    return primitive("ring_sector", 2, [inner_radius, outer_radius, _angle("angle", angle, angle_degrees)])


def round_cone(
    bottom_radius: float,
    top_radius: float,
    height: float,
) -> Shape:
    """Two balls above each other and all that is between them.

    Midway between its centres; the bottom ball down. In space.

    Args:
        bottom_radius: the radius of the lower ball [m].
        top_radius: the radius of the upper ball [m].
        height: from centre to centre, more than the radii differ [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.round_cone(bottom_radius=0.45, top_radius=0.2, height=0.8)
    round_cone(bottom_radius=0.45, top_radius=0.2, height=0.8)
    """
    return primitive("round_cone", 3, [bottom_radius, top_radius, height])


def round_cone_between(
    from_: ArrayLike,
    to: ArrayLike,
    from_radius: float,
    to_radius: float,
) -> Shape:
    """Balls about two points and all that is between them.

    Given by its points. In space.

    Args:
        from_: the centre of one ball [m].
        to: the centre of the other ball [m].
        from_radius: the radius of one ball [m].
        to_radius: the radius of the other ball [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.round_cone_between(from_=[-0.4, -0.3, 0.2], to=[0.5, 0.4, -0.1], from_radius=0.4, to_radius=0.2)
    round_cone_between(from_=[-0.4, -0.3, 0.2], to=[0.5, 0.4, -0.1], from_radius=0.4, to_radius=0.2)
    """
    return primitive("round_cone_between", 3, [from_, to, from_radius, to_radius])


def rounded_cross(
    size: ArrayLike,
    arc_radius: float,
) -> Shape:
    """A cross with four tips on the axes between arcs that are hollow.

    Centred; a tip up, a tip down. In the plane.

    Args:
        size: from tip to tip along x and y [m].
        arc_radius: the radius of the arcs [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.rounded_cross(size=[1.9, 1.5], arc_radius=1.1)
    rounded_cross(size=[1.9, 1.5], arc_radius=1.1)
    """
    return primitive("rounded_cross", 2, [size, arc_radius])


def rounded_cuboid(
    size: ArrayLike,
    rounding: float,
) -> Shape:
    """A box along the axes, its edges rounded inwards.

    Centred; edges along the axes. In the plane or in space.

    Args:
        size: the edge lengths [m].
        rounding: the radius of the edges [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.rounded_cuboid(size=[1.2, 0.8, 0.6], rounding=0.15)
    rounded_cuboid(size=[1.2, 0.8, 0.6], rounding=0.15)
    """
    return primitive("rounded_cuboid", _columns(size), [size, rounding])


def rounded_cylinder(
    radius: float,
    height: float,
    rounding: float,
) -> Shape:
    """A cylinder about the y axis, its rims rounded inwards.

    Centred; axis along y. In space.

    Args:
        radius: the radius [m].
        height: the full height [m].
        rounding: the radius of the rims [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.rounded_cylinder(radius=0.4, height=1.0, rounding=0.1)
    rounded_cylinder(radius=0.4, height=1.0, rounding=0.1)
    """
    return primitive("rounded_cylinder", 3, [radius, height, rounding])


def rounded_rectangle(
    size: ArrayLike,
    top_left_radius: float,
    top_right_radius: float,
    bottom_right_radius: float,
    bottom_left_radius: float,
) -> Shape:
    """A rectangle along the axes, each corner rounded inwards with its own radius.

    Centred; edges along the axes. In the plane.

    Args:
        size: the edge lengths before rounding [m].
        top_left_radius: the radius at the top left [m].
        top_right_radius: the radius at the top right [m].
        bottom_right_radius: the radius at the bottom right [m].
        bottom_left_radius: the radius at the bottom left [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.rounded_rectangle(size=[1.6, 1.0], top_left_radius=0.6, top_right_radius=0.2, bottom_right_radius=0.0, bottom_left_radius=0.35)
    rounded_rectangle(size=[1.6, 1.0], top_left_radius=0.6, top_right_radius=0.2, bottom_right_radius=0.0, bottom_left_radius=0.35)
    """
    return primitive("rounded_rectangle", 2, [size, top_left_radius, top_right_radius, bottom_right_radius, bottom_left_radius])


def rounded_x(
    size: float,
    radius: float,
) -> Shape:
    """Two crossed diagonal strokes with round ends.

    Centred; strokes along the diagonals. In the plane.

    Args:
        size: the full width and height [m].
        radius: half the width of a stroke [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.rounded_x(size=1.7, radius=0.22)
    rounded_x(size=1.7, radius=0.22)
    """
    return primitive("rounded_x", 2, [size, radius])


def screw_thread(
    radius: float,
    height: float,
    pitch: float,
    starts: int,
    profile: ArrayLike,
) -> Shape:
    """A ridge that winds around a cylinder about the y axis; left-handed if its pitch is negative.

    Centred; a helix about the y axis, a crest at +x. In space.

    Args:
        radius: from the axis to the crests [m].
        height: the full height [m].
        pitch: from crest to crest, negative for a left-handed thread [m].
        starts: the number of ridges beside each other, at most 1000.
        profile: the width of a crest, the width of a root, and the depth [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.screw_thread(radius=0.7, height=1.7, pitch=0.5, starts=2, profile=[0.1, 0.17, 0.15])
    screw_thread(radius=0.7, height=1.7, pitch=0.5, starts=2, profile=[0.1, 0.17, 0.15])
    """
    return primitive("screw_thread", 3, [radius, height, pitch, starts, profile])


def segment(
    from_: ArrayLike,
    to: ArrayLike,
    radius: float,
) -> Shape:
    """All points within a radius of the segment between two points.

    Given by its points. In the plane or in space.

    Args:
        from_: one end [m].
        to: the other end [m].
        radius: the radius, zero for a curve without inside [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.segment(from_=[-0.4, -0.3, 0.2], to=[0.5, 0.3, -0.1], radius=0.2)
    segment(from_=[-0.4, -0.3, 0.2], to=[0.5, 0.3, -0.1], radius=0.2)
    """
    return primitive("segment", _columns(from_), [from_, to, radius])


def solid_angle(
    *,
    radius: float,
    angle: float | None = None,
    angle_degrees: float | None = None,
) -> Shape:
    """The part of a ball in a cone about the +y axis, its tip at the origin.

    At its tip; spread about +y. In space.

    Args:
        radius: the radius of the ball [m].
        angle: the opening from side to side, less than a full turn [rad].
        angle_degrees: the same [degrees]; one of the two is given.

    Raises `ShapeError` if a number is out of range, `TypeError` unless one of an angle in radians and in degrees is given.

    >>> import palpate as pp
    >>> pp.solid_angle(radius=0.9, angle=1.2)
    solid_angle(radius=0.9, angle=1.2)
    """
    return primitive("solid_angle", 3, [radius, _angle("angle", angle, angle_degrees)])


def sphere(
    radius: float,
) -> Shape:
    """All points within a radius of the origin.

    Centred. In space.

    Args:
        radius: the radius [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.sphere(radius=0.7)
    ball(radius=0.7)
    """
    return primitive("sphere", 3, [radius])


def square(
    size: float,
) -> Shape:
    """A box along the axes: a rectangle in 2D.

    Centred; edges along the axes. In the plane.

    Args:
        size: the length of every edge [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.square(size=1.0)
    cuboid(size=[1.0, 1.0])
    """
    return primitive("square", 2, [size])


def stairs(
    step_width: float,
    step_height: float,
    steps: int,
) -> Shape:
    """A solid staircase that rises to the right.

    Centred; rising to the right. In the plane.

    Args:
        step_width: the depth of a step [m].
        step_height: the height of a step [m].
        steps: how many steps, 1 to 256.

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.stairs(step_width=0.42, step_height=0.3, steps=4)
    stairs(step_width=0.42, step_height=0.3, steps=4)
    """
    return primitive("stairs", 2, [step_width, step_height, steps])


def tetrahedron(
    points: ArrayLike,
) -> Shape:
    """The solid tetrahedron of four points.

    Given by its points. In space.

    Args:
        points: the four corners [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.tetrahedron(points=[[-0.6, -0.4, -0.3], [0.7, -0.3, -0.4], [0.1, -0.2, 0.6], [0.0, 0.7, 0.1]])
    tetrahedron(points=[[-0.6, -0.4, -0.3], [0.7, -0.3, -0.4], [0.1, -0.2, 0.6], [0.0, 0.7, 0.1]])
    """
    return primitive("tetrahedron", 3, [points])


def torus(
    ring_radius: float,
    radius: float,
) -> Shape:
    """All points within a radius of a circle about the y axis.

    Centred; axis along y. In space.

    Args:
        ring_radius: the radius of the circle [m].
        radius: the radius of the tube [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.torus(ring_radius=0.6, radius=0.2)
    torus(ring_radius=0.6, radius=0.2)
    """
    return primitive("torus", 3, [ring_radius, radius])


def triangle(
    points: ArrayLike,
) -> Shape:
    """The solid triangle of three points.

    Given by its points. In the plane.

    Args:
        points: the three corners [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.triangle(points=[[-0.6, -0.4], [0.7, -0.3], [0.1, 0.6]])
    triangle(points=[[-0.6, -0.4], [0.7, -0.3], [0.1, 0.6]])
    """
    return primitive("triangle", 2, [points])


def triangle_sheet(
    points: ArrayLike,
    radius: float,
) -> Shape:
    """All points within a radius of a triangle in space.

    Given by its points. In space.

    Args:
        points: the three corners [m].
        radius: the radius, zero for a sheet without inside [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.triangle_sheet(points=[[-0.8, -0.5, 0.3], [0.7, -0.4, -0.2], [0.1, 0.8, 0.1]], radius=0.15)
    triangle_sheet(points=[[-0.8, -0.5, 0.3], [0.7, -0.4, -0.2], [0.1, 0.8, 0.1]], radius=0.15)
    """
    return primitive("triangle_sheet", 3, [points, radius])


def triangular_prism(
    side: float,
    height: float,
) -> Shape:
    """A prism along y on a regular triangle.

    At the centre of its triangle, at half its height; axis along y, a corner towards +z. In space.

    Args:
        side: the edge of the triangle [m].
        height: the full height [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.triangular_prism(side=1.0, height=0.6)
    triangular_prism(side=1.0, height=0.6)
    """
    return primitive("triangular_prism", 3, [side, height])


def tunnel(
    width: float,
    height: float,
) -> Shape:
    """A rectangle below and half a disc on top.

    Centred, at half its height; a flat side down. In the plane.

    Args:
        width: the full width [m].
        height: the full height, the half disc included [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.tunnel(width=1.1, height=1.5)
    tunnel(width=1.1, height=1.5)
    """
    return primitive("tunnel", 2, [width, height])


def uneven_capsule(
    bottom_radius: float,
    top_radius: float,
    height: float,
) -> Shape:
    """Two discs on the y axis and all between their common tangents.

    Midway between its centres; the bottom disc down. In the plane.

    Args:
        bottom_radius: the radius of the lower disc [m].
        top_radius: the radius of the upper disc [m].
        height: between the centres of the discs [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.uneven_capsule(bottom_radius=0.5, top_radius=0.25, height=0.8)
    uneven_capsule(bottom_radius=0.5, top_radius=0.25, height=0.8)
    """
    return primitive("uneven_capsule", 2, [bottom_radius, top_radius, height])


def vesica(
    width: float,
    height: float,
) -> Shape:
    """A lens of two equal arcs that meet on the y axis.

    Centred; a tip up, a tip down. In the plane.

    Args:
        width: the full width [m].
        height: from tip to tip, at least the width [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.vesica(width=0.9, height=1.7)
    vesica(width=0.9, height=1.7)
    """
    return primitive("vesica", 2, [width, height])


def vesica_segment(
    from_: ArrayLike,
    to: ArrayLike,
    width: float,
) -> Shape:
    """A spindle between two points: an arc turned about the line between them.

    Given by its points. In space.

    Args:
        from_: one tip [m].
        to: the other tip [m].
        width: the full width in the middle, at most the distance of the tips [m].

    Raises `ShapeError` if a number is out of range.

    >>> import palpate as pp
    >>> pp.vesica_segment(from_=[-0.7, -0.5, 0.2], to=[0.8, 0.6, -0.1], width=0.7)
    vesica_segment(from_=[-0.7, -0.5, 0.2], to=[0.8, 0.6, -0.1], width=0.7)
    """
    return primitive("vesica_segment", 3, [from_, to, width])
