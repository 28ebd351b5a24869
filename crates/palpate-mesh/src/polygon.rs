// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Polygons with few corners into triangles; `solid::repair::ears` cuts long loops, at a cost for each that short ones
//! need not pay.

use palpate_field::{Point, Vector};

/// The largest number of corners of a polygon. Cutting takes up to the cube of the number in time.
pub const MOST_CORNERS: usize = 1024;

/// Cuts a polygon into triangles, two fewer than it has corners and with its orientation, and
/// appends them.
///
/// Ear clipping (Meisters 1975): it cuts off a corner whose triangle has the polygon's
/// orientation and holds no other corner. Corners on a straight edge stay, since a neighbour
/// may end there. If a polygon that crosses itself has no ear left, any corner is cut off.
pub(crate) fn triangulate(
    corners: &[u32],
    vertices: &[Point<3>],
    triangles: &mut Vec<[u32; 3]>,
) {
    let at = |i: u32| vertices[i as usize];
    let normal = newell(corners.iter().map(|&i| at(i)));
    let turn = |a: Point<3>, b: Point<3>, c: Point<3>| (b - a).cross(c - a).dot(normal);
    let mut rest = corners.to_vec();
    while rest.len() > 3 {
        let count = rest.len();
        let neighbours =
            |i: usize| [rest[(i + count - 1) % count], rest[i], rest[(i + 1) % count]];
        let is_ear = |&i: &usize| {
            let ear = neighbours(i);
            let [a, b, c] = ear.map(at);
            let holds = |p: Point<3>| {
                turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0
            };
            turn(a, b, c) > 0.0
                && !rest.iter().any(|k| {
                    let p = at(*k);
                    !ear.contains(k) && p != a && p != b && p != c && holds(p)
                })
        };
        let ear = (0..count).find(is_ear).unwrap_or(0);
        triangles.push(neighbours(ear));
        rest.remove(ear);
    }
    if let [a, b, c] = rest[..] {
        triangles.push([a, b, c]);
    }
}

/// The normal of a polygon with a length of twice its area (Newell).
pub(crate) fn newell(corners: impl Iterator<Item = Point<3>> + Clone) -> Vector<f64, 3> {
    let next = corners.clone().skip(1);
    let Some(first) = corners.clone().next() else { return Vector::ZERO };
    let mut normal = Vector::ZERO;
    for (a, b) in corners.zip(next) {
        normal += (a - first).cross(b - first);
    }
    normal
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cut(outline: &[[f64; 2]]) -> (Vec<[u32; 3]>, Vec<f64>) {
        // In the plane z = 2 x − y, so that nothing depends on an axis.
        let vertices: Vec<_> =
            outline.iter().map(|&[x, y]| Vector([x, y, 2.0 * x - y])).collect();
        let corners: Vec<u32> = (0..outline.len() as u32).collect();
        let mut triangles = Vec::new();
        triangulate(&corners, &vertices, &mut triangles);
        let area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| outline[i as usize]);
            0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
        };
        let areas = triangles.iter().map(area).collect();
        (triangles, areas)
    }

    #[test]
    fn a_polygon_with_a_notch_is_cut_without_overlap() {
        let notched = [[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [2.0, 1.0], [0.0, 3.0]];
        let (triangles, areas) = cut(&notched);
        assert_eq!(triangles.len(), 3);
        assert!(areas.iter().all(|area| *area > 0.0), "{areas:?}");
        assert_eq!(areas.iter().sum::<f64>(), 8.0);
    }

    #[test]
    fn a_corner_on_a_straight_edge_is_kept() {
        let square = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
        let (triangles, areas) = cut(&square);
        assert!(areas.iter().all(|area| *area > 0.0), "{triangles:?} {areas:?}");
        assert_eq!(areas.iter().sum::<f64>(), 4.0);
    }

    #[test]
    fn a_spiral_is_cut_into_its_area() {
        // Ten corners out along a spiral arm, and back along a narrower one.
        let arm = |i: u32, r: f64| {
            let angle = 0.6 * f64::from(i);
            [(r + 0.2 * angle) * angle.cos(), (r + 0.2 * angle) * angle.sin()]
        };
        let mut outline: Vec<_> = (0..16).map(|i| arm(i, 1.0)).collect();
        outline.extend((0..16).rev().map(|i| arm(i, 0.5)));
        let shoelace: f64 = (0..outline.len())
            .map(|i| {
                let ([ax, ay], [bx, by]) = (outline[i], outline[(i + 1) % outline.len()]);
                0.5 * (ax * by - ay * bx)
            })
            .sum();
        let (triangles, areas) = cut(&outline);
        assert_eq!(triangles.len(), 30);
        assert!(areas.iter().all(|area| *area > 0.0));
        assert!((areas.iter().sum::<f64>() - shoelace).abs() < 1e-12);
    }

    #[test]
    fn a_polygon_that_crosses_itself_still_gives_triangles() {
        assert_eq!(
            cut(&[[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0], [1.0, 1.0]]).0.len(),
            3
        );
        assert_eq!(cut(&[[1.0, 1.0]; 6]).0.len(), 4);
    }
}
