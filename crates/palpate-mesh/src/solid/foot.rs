// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The point of a segment or a triangle that is nearest to a point.

use palpate_field::{Point, Vector};

/// Where on an element a point of it lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    /// At a corner.
    Corner(usize),
    /// On the edge of a triangle from this corner to the next.
    Edge(usize),
    /// Within the element.
    Face,
}

/// The point of an element nearest to another point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Foot<const D: usize> {
    pub(crate) point: Point<D>,
    pub(crate) part: Part,
    /// The square of the distance [m²].
    pub(crate) squared: f64,
}

impl<const D: usize> Foot<D> {
    #[inline(always)]
    fn at(p: Point<D>, point: Point<D>, part: Part) -> Self {
        let away = p - point;
        Self { point, part, squared: away.dot(away) }
    }
}

/// The nearest point of an element.
///
/// If the foot of the perpendicular lies in the triangle, it is the nearest point; else the nearest point of
/// the three edges is. Slivers use the edges alone, since their plane is inexact.
#[inline(always)]
pub(crate) fn foot<const N: usize, const D: usize>(
    corners: &[Point<D>; N],
    p: Point<D>,
) -> Foot<D> {
    const { assert!(N == 2 || N == 3, "segments and triangles") };
    if N == 2 {
        return on_segment(
            corners[0],
            corners[1],
            p,
            [Part::Corner(0), Part::Corner(1), Part::Face],
        );
    }
    let (a, b, c) = (corners[0], corners[1], corners[2]);
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (bb, bc, cc) = (ab.dot(ab), ab.dot(ac), ac.dot(ac));
    let (pb, pc) = (ap.dot(ab), ap.dot(ac));
    // Barycentric coordinates, times twice the squared area.
    let area = bb * cc - bc * bc;
    let (v, w) = (cc * pb - bc * pc, bb * pc - bc * pb);
    if area > FLAT * bb * cc && v >= 0.0 && w >= 0.0 && v + w <= area {
        let point = a + ab * (v / area) + ac * (w / area);
        return Foot::at(p, point, Part::Face);
    }
    let nearer = |a: Foot<D>, b: Foot<D>| if b.squared < a.squared { b } else { a };
    let edge = |from: usize, to: usize| {
        let parts = [Part::Corner(from), Part::Corner(to), Part::Edge(from)];
        on_segment(corners[from], corners[to], p, parts)
    };
    nearer(nearer(edge(0, 1), edge(1, 2)), edge(2, 0))
}

/// Below this share of what it would be at a right angle, the squared area of a triangle is rounding.
const FLAT: f64 = 1e-12;

/// The nearest point of a segment; the parts are its ends and what is between.
#[inline(always)]
fn on_segment<const D: usize>(
    a: Point<D>,
    b: Point<D>,
    p: Point<D>,
    parts: [Part; 3],
) -> Foot<D> {
    let ab = b - a;
    let squared = ab.dot(ab);
    let t = (p - a).dot(ab);
    match () {
        () if t <= 0.0 => Foot::at(p, a, parts[0]),
        () if t >= squared => Foot::at(p, b, parts[1]),
        () => Foot::at(p, a + ab * (t / squared), parts[2]),
    }
}

/// A vector perpendicular to an element, as long as its length or twice its area: out of a solid whose triangles
/// are counter-clockwise seen from outside, and whose segments have it on their left. Zero if the element
/// is not one less in dimension than space.
#[inline]
pub(crate) fn across<const N: usize, const D: usize>(
    corners: &[Point<D>; N],
) -> Vector<f64, D> {
    if N != D {
        return Vector::ZERO;
    }
    Vector::across(&std::array::from_fn(|i| corners[i]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_of_a_triangle_is_found() {
        let corners = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 3.0, 0.0]].map(Vector);
        let cases = [
            ([1.0, 1.0, 2.0], [1.0, 1.0, 0.0], Part::Face),
            ([-1.0, -1.0, 1.0], [0.0, 0.0, 0.0], Part::Corner(0)),
            ([6.0, -1.0, 0.0], [4.0, 0.0, 0.0], Part::Corner(1)),
            ([-0.5, 4.0, 0.0], [0.0, 3.0, 0.0], Part::Corner(2)),
            ([2.0, -2.0, 1.0], [2.0, 0.0, 0.0], Part::Edge(0)),
            ([2.0 + 0.6, 1.5 + 0.8, 1.0], [2.0, 1.5, 0.0], Part::Edge(1)),
            ([-2.0, 1.0, 0.0], [0.0, 1.0, 0.0], Part::Edge(2)),
        ];
        for (p, nearest, part) in cases {
            let found = foot(&corners, Vector(p));
            assert!((found.point - Vector(nearest)).norm() < 1e-15, "{found:?}");
            assert_eq!(found.part, part, "{p:?}");
        }
    }

    #[test]
    fn the_foot_on_a_sliver_is_that_of_its_edges() {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 1e-12, 0.0]].map(Vector);
        let found = foot(&corners, Vector([0.25, 0.0, 2.0]));
        assert!((found.squared - 4.0).abs() < 1e-14, "{found:?}");
        assert!((found.point - Vector([0.25, 0.0, 0.0])).norm() < 1e-11);
    }
}
