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

/// The nearest point of an element, off by a few roundings of its size however thin it is.
///
/// If the foot of the perpendicular lies in the triangle, it is the nearest point; else the nearest point of
/// the three edges is. The foot is taken first along the longest edge, then square to it (Gram and Schmidt): at a
/// height h over an edge of length L, rounding turns the direction of the height by at most εL/h and so moves the foot
/// of a point at the distance d by at most εLd/h within the triangle, which makes its distance at most εL longer.
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
    let squared = |from: usize, to: usize| {
        let edge = corners[to] - corners[from];
        edge.dot(edge)
    };
    let lengths = [squared(0, 1), squared(1, 2), squared(2, 0)];
    let first = match () {
        () if lengths[0] >= lengths[1] && lengths[0] >= lengths[2] => 0,
        () if lengths[1] >= lengths[2] => 1,
        () => 2,
    };
    let [a, b, c] = [0, 1, 2].map(|k| corners[(first + k) % 3]);
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let longest = lengths[first];
    let (along, third) = (ap.dot(ab) / longest, ac.dot(ab) / longest);
    let (height, off) = (ac - ab * third, ap - ab * along);
    let squared_height = height.dot(height);
    let w = off.dot(height) / squared_height;
    let v = along - third * w;
    if squared_height > FLAT * longest && v >= 0.0 && w >= 0.0 && v + w <= 1.0 {
        return Foot::at(p, a + ab * v + ac * w, Part::Face);
    }
    let nearer = |a: Foot<D>, b: Foot<D>| if b.squared < a.squared { b } else { a };
    let edge = |from: usize, to: usize| {
        let parts = [Part::Corner(from), Part::Corner(to), Part::Edge(from)];
        on_segment(corners[from], corners[to], p, parts)
    };
    nearer(nearer(edge(0, 1), edge(1, 2)), edge(2, 0))
}

/// A triangle with a smaller square of its height, in units of that of its longest edge, is flat up to rounding: its edges
/// are as near as it is.
const FLAT: f64 = (16.0 * f64::EPSILON) * (16.0 * f64::EPSILON);

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
        () if t > 0.0 && t < squared => Foot::at(p, a + ab * (t / squared), parts[2]),
        () if t > 0.0 => Foot::at(p, b, parts[1]),
        // Products that overflow are no number.
        () => Foot::at(p, a, parts[0]),
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

    /// The foot by barycentric coordinates from the Gram matrix was off by ε times the length over the square of the
    /// thinness: by 5e-9 m at a height of 0.25 mm.
    #[test]
    fn the_foot_on_a_thin_triangle_is_off_by_roundings_of_its_length() {
        // Along, across and off the triangle: square to each other, each 7 m long.
        let axes = [[2.0, 3.0, 6.0], [6.0, 2.0, -3.0], [3.0, -6.0, 2.0]].map(Vector);
        let at = |u: f64, v: f64, w: f64| axes[0] * u + axes[1] * v + axes[2] * w;
        let error = 64.0 * f64::EPSILON * 7.0;
        for halvings in 0..60 {
            let height = 0.5_f64.powi(halvings);
            for (third, turn) in [(0.3, 0), (0.5, 1), (-0.2, 2), (0.999, 0)] {
                let mut corners =
                    [at(0.0, 0.0, 0.0), at(1.0, 0.0, 0.0), at(third, height, 0.0)];
                corners.rotate_left(turn);
                for (share, up) in [(0.1, 0.2), (0.5, 0.4), (0.7, 0.25)] {
                    // Within the triangle, up to its height.
                    let along = third * up + share * (1.0 - up);
                    for off in [0.0, 1e-9, 1e-4, 0.1, 3.0] {
                        let p = at(along, height * up, off);
                        let found = foot(&corners, p).squared.sqrt();
                        assert!((found - 7.0 * off).abs() < error, "{height} {off}: {found}");
                    }
                }
            }
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
