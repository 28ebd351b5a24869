// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The nearest point of a segment or a triangle.

use palpate_field::{Point, Vector};
use palpate_query::Element;

/// The point of the element that is nearest to `p` [m].
///
/// Of a triangle, the foot of the perpendicular on its plane, whose weights v and w of the edges
/// e₁, e₂ from the first vertex solve `eᵢ·(v·e₁ + w·e₂) = eᵢ·(p − a)`; where a weight is
/// negative, or the triangle has no area, the nearest point of its edges.
pub(crate) fn nearest<const N: usize, const D: usize>(
    element: &Element<N, D>,
    p: Point<D>,
) -> Point<D> {
    let vertices = element.vertices();
    if N == 3
        && let Some(foot) = foot(vertices[0], [vertices[1], vertices[N - 1]], p)
    {
        return foot;
    }
    let mut nearest = vertices[0];
    for i in 0..N {
        let on_edge = on_segment(vertices[i], vertices[(i + 1) % N], p);
        if (on_edge - p).norm() < (nearest - p).norm() {
            nearest = on_edge;
        }
    }
    nearest
}

/// The foot of the perpendicular from `p`, if it lies in the triangle.
fn foot<const D: usize>(a: Point<D>, ends: [Point<D>; 2], p: Point<D>) -> Option<Point<D>> {
    let [first, second] = ends.map(|end| end - a);
    let (side, away) = (first.dot(second), p - a);
    let [squared, other] = [first.dot(first), second.dot(second)];
    let [along, across] = [first.dot(away), second.dot(away)];
    let area = squared * other - side * side;
    let v = (other * along - side * across) / area;
    let w = (squared * across - side * along) / area;
    // Written so that NaN, of a triangle without area, is refused.
    (v >= 0.0 && w >= 0.0 && v + w <= 1.0).then(|| a + first * v + second * w)
}

fn on_segment<const D: usize>(a: Point<D>, b: Point<D>, p: Point<D>) -> Point<D> {
    let along: Vector<f64, D> = b - a;
    let squared = along.dot(along);
    let share = if squared > 0.0 { along.dot(p - a) / squared } else { 0.0 };
    a + along * share.clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_come_to_the_face_an_edge_or_a_corner() -> Result<(), Box<dyn std::error::Error>> {
        // In the plane z = 2, with a right angle at its first corner.
        let corners =
            [Vector([1.0, 1.0, 2.0]), Vector([5.0, 1.0, 2.0]), Vector([1.0, 3.0, 2.0])];
        let triangle = Element::new(corners)?;
        for (p, expected) in [
            ([2.0, 1.5, -7.0], [2.0, 1.5, 2.0]), // above the face
            ([3.0, -1.0, 2.0], [3.0, 1.0, 2.0]), // beside an edge
            ([0.0, -9.0, 4.0], [1.0, 1.0, 2.0]), // past a corner
            ([4.0, 4.0, 2.0], [3.0, 2.0, 2.0]),  // beside the longest edge
        ] {
            assert!((nearest(&triangle, Vector(p)) - Vector(expected)).norm() < 1e-15, "{p:?}");
        }
        let line = Element::new([corners[0], corners[1], corners[1]])?;
        assert_eq!(nearest(&line, Vector([2.0, 9.0, 9.0])), Vector([2.0, 1.0, 2.0]));
        let segment = Element::new([Vector([0.0, 0.0]), Vector([4.0, 0.0])])?;
        assert_eq!(nearest(&segment, Vector([3.0, 2.0])), Vector([3.0, 0.0]));
        assert_eq!(nearest(&segment, Vector([-3.0, 2.0])), Vector([0.0, 0.0]));
        Ok(())
    }
}
