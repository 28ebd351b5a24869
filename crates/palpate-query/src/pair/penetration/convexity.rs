// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Whether a shape is proven to be convex.
//!
//! A field's promise says so of most primitives. Of polygons and of solids of meshes the faces tell.
//! Let every vertex lie behind the plane of every face. Then every point of the surface lies on the
//! border of the convex hull, and the solid fills the hull, because the inside of the hull holds no
//! surface that could end it.

use std::f64::consts::{PI, TAU};

use palpate_field::kernel::Argument;
use palpate_field::{Node, Point, Quality, Shape, Vector};
use palpate_mesh::Solid;

/// Comparisons of a vertex with a face at most: more would take longer than many a search.
const MOST: usize = 1 << 20;

/// How far before a plane a vertex may be, in roundings of the size.
const ROUNDINGS: f64 = 16.0;

/// `true` if a shape is proven to be convex, up to rounding. Of others nothing is known.
pub(super) fn is_convex<const D: usize>(shape: &Shape<D>) -> bool {
    if shape.promise().convex {
        return true;
    }
    match shape.node() {
        Node::Primitive(primitive) => match primitive.argument("rings") {
            Some(Argument::Rings(rings)) => is_convex_polygon(rings),
            _ => false,
        },
        // What lies within a distance of a convex shape is convex.
        Node::Offset { distance, of } => *distance >= 0.0 && is_convex(of),
        Node::Placed { of, .. } | Node::Scaled { of, .. } => is_convex(of),
        Node::Extruded { of, .. } => is_convex(of),
        Node::Opaque(opaque) => {
            opaque.custom::<Solid<2, D>>().is_some_and(is_convex_solid)
                || opaque.custom::<Solid<3, D>>().is_some_and(is_convex_solid)
        }
        _ => false,
    }
}

fn is_convex_solid<const N: usize, const D: usize>(solid: &Solid<N, D>) -> bool {
    let promise = solid.promise();
    if N != D || promise.inside != Quality::Exact {
        return false;
    }
    let (vertices, elements) = (solid.vertices(), solid.elements());
    let corners =
        |element: &[u32; N]| std::array::from_fn(|k| vertices[element[k.min(N - 1)] as usize]);
    vertices.len().saturating_mul(elements.len()) <= MOST
        && elements.iter().all(|element| is_behind(vertices, &corners(element)))
}

fn is_convex_polygon(rings: &[Vec<Vec<f64>>]) -> bool {
    let [ring] = rings else { return false };
    let points: Vec<Point<2>> = ring.iter().map(|p| Vector([p[0], p[1]])).collect();
    let count = points.len();
    if count.saturating_mul(count) > MOST {
        return false;
    }
    let edges = || {
        let all = points.iter().zip(points.iter().cycle().skip(1));
        all.filter(|(from, to)| from != to).map(|(from, to)| [*from, *to])
    };
    // The angle by which the edges turn in all: a whole turn, unless the ring goes round twice.
    let turns = edges().zip(edges().cycle().skip(1)).map(|([a, b], [c, d])| {
        let (before, after) = (b - a, d - c);
        let across = before[0] * after[1] - before[1] * after[0];
        across.atan2(before.dot(after))
    });
    let turned: f64 = turns.sum();
    if (turned.abs() - TAU).abs() > 0.5 * PI {
        return false;
    }
    edges().all(|[from, to]| {
        let edge = if turned > 0.0 { [from, to] } else { [to, from] };
        is_behind(&points, &edge)
    })
}

/// Whether all vertices are behind the plane of a face, and its corners on it, up to rounding.
fn is_behind<const D: usize>(vertices: &[Point<D>], face: &[Point<D>; D]) -> bool {
    let Some(normal) = Vector::across(face).normalized() else { return false };
    let largest = vertices.iter().map(|v| v.norm()).fold(0.0_f64, f64::max);
    let slack = ROUNDINGS * f64::EPSILON * largest;
    let before = |v: &Point<D>| normal.dot(*v - face[0]);
    vertices.iter().all(|v| before(v) <= slack) && face.iter().all(|v| before(v) >= -slack)
}

#[cfg(test)]
mod tests {
    use palpate_mesh::{Outline, TriangleMesh};

    use super::*;

    fn polygon(points: &[[f64; 2]]) -> Shape<2> {
        Shape::polygon(vec![points.iter().copied().map(Vector).collect::<Vec<_>>()]).unwrap()
    }

    #[test]
    fn a_polygon_is_convex_if_it_turns_one_way_and_once() {
        let square = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]];
        assert!(is_convex(&polygon(&square)));
        let backwards: Vec<_> = square.iter().rev().copied().collect();
        assert!(is_convex(&polygon(&backwards)));
        // With a point on an edge, and one twice.
        let more =
            [[1.0, 1.0], [0.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [-1.0, -1.0], [1.0, -1.0]];
        assert!(is_convex(&polygon(&more)));
        assert!(!is_convex(&polygon(&[[1.0, 1.0], [0.0, 0.9], [-1.0, 1.0], [0.0, -1.0]])));
        // Twice round: by the even-odd rule nothing is inside.
        let twice: Vec<_> = square.iter().chain(&square).copied().collect();
        assert!(!is_convex(&polygon(&twice)));
        // A pentagram turns one way, but twice.
        let corner = |i: usize| {
            let angle = 0.8 * PI * i as f64;
            [angle.cos(), angle.sin()]
        };
        let star: Vec<_> = (0..5).map(corner).collect();
        assert!(!is_convex(&polygon(&star)));
        let moved = polygon(&square).offset(0.1).unwrap().translated([3.0, 4.0]).unwrap();
        assert!(is_convex(&moved));
    }

    #[test]
    fn a_mesh_is_convex_if_no_vertex_is_before_a_face() {
        let vertices = |apex: f64| {
            let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
            let mut points = points.map(Vector).to_vec();
            points.push(Vector([apex; 3]));
            points
        };
        let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 4], [2, 3, 4], [3, 1, 4]];
        let shape = |apex: f64| {
            let mesh = TriangleMesh::new(vertices(apex), faces.clone()).unwrap();
            Shape::custom(Solid::from_mesh(&mesh).unwrap().0)
        };
        assert!(is_convex(&shape(0.5)));
        assert!(!is_convex(&shape(0.2)));
        let corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]].map(Vector).to_vec();
        let sides = vec![[0, 1], [1, 2], [2, 3], [3, 0]];
        let outline = Outline::new(corners, sides).unwrap();
        assert!(is_convex(&Shape::custom(Solid::from_mesh(&outline).unwrap().0)));
    }
}
