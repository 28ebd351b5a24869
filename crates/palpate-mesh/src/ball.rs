// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The smallest ball around a segment or a triangle.

use palpate_field::{BoundingBall, Point, Vector};

/// Room for the roundings of a centre and a distance, relative to the coordinates.
const ROUNDINGS: f64 = 16.0 * f64::EPSILON;

/// The barycentric weights of the centre of the smallest ball around a segment or a triangle,
/// a point of the element.
///
/// The centre is the middle of the longest edge if the triangle is not acute; else it is the
/// circumcentre, with weights `a²(b² + c² − a²)`, where `a` is the edge opposite to a vertex.
///
/// ```
/// use palpate_field::Vector;
/// use palpate_mesh::centre_weights;
///
/// let right = [Vector([0.0, 0.0]), Vector([3.0, 0.0]), Vector([0.0, 4.0])];
/// assert_eq!(centre_weights(&right), [0.0, 0.5, 0.5]);
/// ```
#[inline]
#[must_use]
pub fn centre_weights<const N: usize, const D: usize>(vertices: &[Point<D>; N]) -> [f64; N] {
    const { assert!(N == 2 || N == 3, "segments and triangles") };
    if N == 2 {
        return [0.5; N];
    }
    let (edges, parts) = circumcentre(vertices);
    let longest = (1..3).fold(0, |k, i| if edges[i] > edges[k] { i } else { k });
    let whole: f64 = parts.iter().sum();
    let is_acute = parts[longest] > 0.0 && whole.is_normal();
    // Chosen without branches, which would be guessed wrongly half the time.
    let scale = if is_acute { 1.0 / whole } else { 0.0 };
    std::array::from_fn(|k| {
        let of_edge = if k == longest { 0.0 } else { 0.5 };
        if is_acute { parts[k] * scale } else { of_edge }
    })
}

/// The smallest ball around a segment or a triangle, its radius rounded up.
#[must_use]
pub fn smallest_ball<const N: usize, const D: usize>(
    vertices: &[Point<D>; N],
) -> BoundingBall<D> {
    let mut centre = Vector::ZERO;
    for (vertex, weight) in vertices.iter().zip(centre_weights(vertices)) {
        centre += *vertex * weight;
    }
    BoundingBall { centre, radius: radius_about(centre, vertices) }
}

/// The ball about the circumcentre of a triangle that its vertices lie on, its radius rounded up;
/// the smallest ball of a segment. `None` if the vertices of a triangle lie on a line, up to
/// rounding: the circle through them then has no bounds.
///
/// ```
/// use palpate_field::Vector;
/// use palpate_mesh::{circumscribed_ball, smallest_ball};
///
/// // 1 m long and 1 cm high: R = abc/4A.
/// let sliver = [Vector([0.0, 0.0]), Vector([1.0, 0.0]), Vector([0.5, 0.01])];
/// let around = circumscribed_ball(&sliver).ok_or("the corners lie on a line")?;
/// assert!((around.radius - 12.505).abs() < 1e-9);
/// assert!((around.centre - Vector([0.5, -12.495])).norm() < 1e-9);
/// assert!(smallest_ball(&sliver).radius < 0.5 + 1e-14);
/// # Ok::<(), &str>(())
/// ```
#[must_use]
pub fn circumscribed_ball<const N: usize, const D: usize>(
    vertices: &[Point<D>; N],
) -> Option<BoundingBall<D>> {
    /// Cancellation in the weights makes a centre of thinner triangles meaningless.
    const FLATTEST: f64 = 64.0 * f64::EPSILON;
    if N == 2 {
        return Some(smallest_ball(vertices));
    }
    let (edges, parts) = circumcentre(vertices);
    let (whole, sum): (f64, f64) = (parts.iter().sum(), edges.iter().sum());
    // Sixteen times the squared area, beside the fourth power of the size.
    let is_flat = whole.is_nan() || whole <= FLATTEST * sum * sum;
    let mut centre = Vector::ZERO;
    for (vertex, part) in vertices.iter().zip(parts) {
        centre += *vertex * (part / whole);
    }
    (!is_flat).then(|| BoundingBall { centre, radius: radius_about(centre, vertices) })
}

/// The squared lengths of the edges opposite to the vertices of a triangle, and the weights
/// `a²(b² + c² − a²)` of its circumcentre, whose sum is sixteen times the squared area.
#[inline]
fn circumcentre<const N: usize, const D: usize>(
    vertices: &[Point<D>; N],
) -> ([f64; 3], [f64; 3]) {
    let squared = |i: usize, k: usize| {
        let edge = vertices[i] - vertices[k];
        edge.dot(edge)
    };
    let edges = [squared(1, 2), squared(2, 0), squared(0, 1)];
    let sum: f64 = edges.iter().sum();
    (edges, edges.map(|edge| edge * (sum - 2.0 * edge)))
}

/// The radius of a ball about `centre` that holds all `points`, rounded up.
pub(crate) fn radius_about<'a, const D: usize>(
    centre: Point<D>,
    points: impl IntoIterator<Item = &'a Point<D>>,
) -> f64 {
    let (mut squared, mut largest) = (0.0_f64, 0.0_f64);
    for point in points {
        let away = *point - centre;
        squared = squared.max(away.dot(away));
        largest = point.0.iter().fold(largest, |m, x| m.max(x.abs()));
    }
    // Squares of less than the root of the smallest number have lost their digits.
    squared.sqrt() * (1.0 + ROUNDINGS) + largest * ROUNDINGS + f64::MIN_POSITIVE.sqrt()
}
