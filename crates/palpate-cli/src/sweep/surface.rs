// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The surface of a shape as triangles, or as segments in the plane, for local searches.

use contour::ContourBuilder;
use fast_surface_nets::ndshape::{RuntimeShape, Shape as _};
use fast_surface_nets::{SurfaceNetsBuffer, surface_nets};
use palpate::field::{Point, Shape, Vector};
use palpate::mesh::{Mesh, Outline, TriangleMesh};

/// Cells between the shape's box and the edge of the grid.
const AROUND: f64 = 2.0;

/// The places of a grid around a shape's box.
struct Grid<const D: usize> {
    origin: Point<D>,
    /// The edge of a cell [m].
    cell: f64,
    counts: [u32; D],
}

impl<const D: usize> Grid<D> {
    /// With this many cells along the longest side of the box; `None` of a shape without bounds.
    fn around(shape: &Shape<D>, cells: u32) -> Option<Self> {
        let bounds = shape.promise().bounds?.aabb;
        let sides = bounds.max - bounds.min;
        let longest = sides.0.into_iter().fold(0.0, f64::max);
        let cell = longest / f64::from(cells);
        let counts = sides.0.map(|side| (side / cell + 2.0 * AROUND).ceil() as u32 + 1);
        let origin = bounds.min - Vector::constant(AROUND * cell);
        (cell > 0.0).then_some(Self { origin, cell, counts })
    }

    fn place(&self, index: [f64; D]) -> Point<D> {
        self.origin + Vector(index) * self.cell
    }

    /// The nearest point of the surface, of one that the grid puts near it.
    fn on_surface(&self, shape: &Shape<D>, index: [f64; D]) -> Point<D> {
        let near = self.place(index);
        let there = shape.surface_point(near);
        // Where fields are bounds, the way to the surface may end elsewhere.
        there.filter(|there| (*there - near).norm() <= self.cell).unwrap_or(near)
    }
}

/// The outline of a planar shape, by marching squares.
pub(super) fn outline(shape: &Shape<2>, cells: u32) -> Option<Outline> {
    let grid = Grid::around(shape, cells)?;
    let [columns, rows] = grid.counts.map(|count| count as usize);
    let places = (0..rows).flat_map(|y| (0..columns).map(move |x| [x as f64, y as f64]));
    // Negated: lines are around what is at least the level.
    let values: Vec<f64> = places.map(|index| -shape.distance(grid.place(index))).collect();
    let lines =
        ContourBuilder::new(columns, rows, true).lines(&values, &[0.0]).unwrap_or_default();
    let (mut vertices, mut elements) = (Vec::new(), Vec::new());
    for ring in lines.into_iter().flat_map(|line| line.into_inner().0.0) {
        // The last point is the first.
        let points = &ring.0[1..];
        let first = vertices.len() as u32;
        let count = points.len() as u32;
        // Lines are drawn between the middles of the grid's cells.
        let at = points.iter().map(|p| grid.on_surface(shape, [p.x - 0.5, p.y - 0.5]));
        vertices.extend(at);
        elements.extend((0..count).map(|k| [first + k, first + (k + 1) % count]));
    }
    // Without elements there is no surface.
    Mesh::new(vertices, elements).ok()
}

/// The surface of a solid, by surface nets.
pub(super) fn triangles(shape: &Shape<3>, cells: u32) -> Option<TriangleMesh> {
    let grid = Grid::around(shape, cells)?;
    let places = RuntimeShape::<u32, 3>::new(grid.counts);
    let values: Vec<f32> = (0..places.size())
        .map(|k| shape.distance(grid.place(places.delinearize(k).map(f64::from))))
        .map(|value| (value / grid.cell) as f32)
        .collect();
    let mut surface = SurfaceNetsBuffer::default();
    surface_nets(&values, &places, [0; 3], grid.counts.map(|count| count - 1), &mut surface);
    let at = |p: &[f32; 3]| grid.on_surface(shape, p.map(f64::from));
    let vertices = surface.positions.iter().map(at).collect();
    let faces =
        surface.indices.chunks_exact(3).map(|face| [face[0], face[1], face[2]]).collect();
    Mesh::new(vertices, faces).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ball_and_a_ring_have_their_surfaces() {
        let ball = Shape::<3>::ball(0.3).unwrap().translated(Vector([1.0, -2.0, 0.5])).unwrap();
        let surface = triangles(&ball, 32).unwrap();
        let report = surface.report();
        assert!(report.is_watertight(), "{report}");
        let volume = report.enclosed.unwrap();
        let truth = 4.0 / 3.0 * std::f64::consts::PI * 0.027;
        assert!((volume - truth).abs() < 0.01 * truth, "{volume}, {truth}");
        let disc = Shape::<2>::ball(0.3).unwrap();
        let ring = disc.shell(0.1).unwrap();
        let outline = outline(&ring, 64).unwrap();
        assert!(outline.vertices().iter().all(|p| ring.distance(*p).abs() < 1e-9));
        let length: f64 = (0..outline.elements().len())
            .map(|k| outline.corners(k))
            .map(|[a, b]| (a - b).norm())
            .sum();
        // Both circles, of 0.25 m and 0.35 m.
        let truth = std::f64::consts::TAU * 0.6;
        assert!((length - truth).abs() < 0.01 * truth, "{length}, {truth}");
    }
}
