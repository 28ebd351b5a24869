// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A tree of balls around elements.
//!
//! An implicit tree of balls over the elements of a mesh.
//!
//! Recursive medians of the centres order the elements; the left part is always eight times a
//! power of two. So each run of `8ᵏ` elements from the first on is compact, and the balls
//! around these runs form a tree without pointers: the children of node i are `8i` to
//! `8i + 7` one level below. A level is a few arrays, padded to whole groups of eight.

use palpate_field::{Aabb, BoundingBall, Point, Vector};

/// Children of a node.
pub const FAN: usize = 8;

/// The balls of one level of a [`BallTree`].
#[derive(Clone, Debug)]
pub struct Level<const D: usize> {
    centres: [Vec<f64>; D],
    radii: Vec<f64>,
}

impl<const D: usize> Level<D> {
    /// The level of `balls`, padded to whole groups.
    fn new(balls: impl ExactSizeIterator<Item = (Point<D>, f64)>) -> Self {
        let padded = balls.len().div_ceil(FAN) * FAN;
        let mut level = Self {
            centres: std::array::from_fn(|_| vec![0.0; padded]),
            radii: vec![f64::NEG_INFINITY; padded],
        };
        for (i, (centre, radius)) in balls.enumerate() {
            for (column, x) in level.centres.iter_mut().zip(centre.0) {
                column[i] = x;
            }
            level.radii[i] = radius;
        }
        level
    }

    /// The centres of the children of a node one level up [m].
    ///
    /// # Panics
    ///
    /// If there is no such node.
    #[inline]
    #[must_use]
    pub fn children(&self, node: usize) -> [Point<D>; FAN] {
        let mut children = [Vector::ZERO; FAN];
        for (axis, column) in self.centres.iter().enumerate() {
            let column = &column[node * FAN..][..FAN];
            for (child, x) in children.iter_mut().zip(column) {
                child[axis] = *x;
            }
        }
        children
    }

    /// The radii [m], rounded up; minus infinity where there is no ball.
    #[inline]
    #[must_use]
    pub fn radii(&self) -> &[f64] {
        &self.radii
    }

    /// The centre of ball `i` [m].
    ///
    /// # Panics
    ///
    /// If there is no such ball.
    #[inline]
    #[must_use]
    pub fn centre(&self, i: usize) -> Point<D> {
        let mut centre = Vector::ZERO;
        for (axis, column) in self.centres.iter().enumerate() {
            centre[axis] = column[i];
        }
        centre
    }
}

/// Balls around the elements of a mesh, around groups of eight of them, and so on.
///
/// ```
/// use palpate_field::Vector;
/// use palpate_mesh::{MeshError, Outline};
///
/// # fn main() -> Result<(), MeshError> {
/// // A row of 20 segments, each half a metre long: 20 balls, 3 around eight each, 1.
/// let vertices = (0..21_u32).map(|i| Vector([0.5 * f64::from(i), 0.0])).collect();
/// let row = Outline::new(vertices, (0..20).map(|i| [i, i + 1]).collect())?;
/// let [elements, groups] = row.tree().levels() else { panic!("two levels") };
/// assert_eq!(elements.centre(0), Vector([0.25, 0.0]));
/// assert!(groups.radii()[0] >= 2.0 && groups.radii()[0] < 2.0 + 1e-12);
/// assert_eq!(row.tree().elements_below(1, 2), [16, 17, 18, 19]);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct BallTree<const D: usize> {
    levels: Vec<Level<D>>,
    order: Vec<u32>,
}

impl<const D: usize> BallTree<D> {
    #[inline(never)]
    pub(crate) fn new<const N: usize>(vertices: &[Point<D>], elements: &[[u32; N]]) -> Self {
        let corners =
            |element: u32| elements[element as usize].map(|index| vertices[index as usize]);
        // Side by side with its number, a middle need not be looked up at each of the many comparisons.
        let mut middles: Vec<(Point<D>, u32)> = (0..elements.len() as u32)
            .map(|element| {
                let corners = corners(element);
                (corners.into_iter().fold(Vector::ZERO, |sum, p| sum + p), element)
            })
            .collect();
        sort(&mut middles);
        let order: Vec<u32> = middles.into_iter().map(|(_, element)| element).collect();

        let faces: Vec<[Point<D>; N]> = order.iter().map(|&element| corners(element)).collect();
        let mut levels = vec![Level::new(faces.iter().map(|corners| {
            let ball = smallest_ball(corners);
            (ball.centre, ball.radius)
        }))];
        let mut size = FAN;
        while order.len().div_ceil(size / FAN) > FAN {
            levels.push(Level::new(faces.chunks(size).map(|group| {
                let points = group.as_flattened();
                let centre = Aabb::around(points.iter().copied())
                    .map_or(Vector::ZERO, |bounds| bounds.centre());
                (centre, radius_about(centre, points))
            })));
            size *= FAN;
        }
        Self { levels, order }
    }

    /// The levels, from the elements' own balls up to one of at most eight.
    #[must_use]
    pub fn levels(&self) -> &[Level<D>] {
        &self.levels
    }

    /// The elements, in the order of their balls.
    #[must_use]
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// The elements in ball `i` of a level; none for a ball of padding.
    #[inline]
    #[must_use]
    pub fn elements_below(&self, level: usize, i: usize) -> &[u32] {
        let size = FAN.saturating_pow(level as u32);
        let start = i.saturating_mul(size).min(self.order.len());
        let end = start.saturating_add(size).min(self.order.len());
        &self.order[start..end]
    }
}

/// Sorts elements by the medians of their middles, along the longest side of the box
/// around those; a tie goes to the lower element.
fn sort<const D: usize>(middles: &mut [(Point<D>, u32)]) {
    if middles.len() <= FAN {
        return;
    }
    let Some(bounds) = Aabb::around(middles.iter().map(|(middle, _)| *middle)) else { return };
    let sides = bounds.half_extents();
    let axis = (1..D).fold(0, |longest, k| if sides[k] > sides[longest] { k } else { longest });
    let mut half = FAN;
    while 2 * half < middles.len() {
        half *= 2;
    }
    middles.select_nth_unstable_by(half, |(a, first), (b, second)| {
        a[axis].total_cmp(&b[axis]).then(first.cmp(second))
    });
    let (left, right) = middles.split_at_mut(half);
    sort(left);
    sort(right);
}

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
