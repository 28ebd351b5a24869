// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Meshes of shapes, by manifold dual contouring (Ju et al. 2002; Schaefer, Ju and Warren 2007).
//!
//! A lattice of cells is laid over the shape. Where the ends of an edge differ in sign, the surface crosses it; the
//! crossings of a cell fall into patches, and each patch gets a vertex where the planes at its crossings meet best.
//! So edges and corners stay sharp, and sheets that share a cell stay apart. Around each crossing the vertices of
//! four cells make two triangles.

mod cells;
mod deviation;
mod fit;
mod refine;
mod sharp;
mod simplify;
mod surface;
mod vertex;

use std::collections::HashMap;
use std::ops::ControlFlow;

use palpate_field::{Point, Shape};

use crate::mesh::{MeshError, TriangleMesh, single};
use crate::solid::crossing_faces;
use cells::{Cells, Crossing, EDGES, NONE, Patches, Signed};
pub use fit::{FitProgress, FittedMesh};

/// Cells around the bounds of the shape, on each side.
const AROUND: f64 = 1.5;

/// The shares of the work that looking for cells and finding crossings are.
const LOOKING: f64 = 0.4;
const CROSSING: f64 = 0.5;

/// Cells from one look at whether to stop to the next.
const A_LOOK: usize = 1024;

/// A triangle of at most this height, as a share of its largest coordinate, is not made where that can be avoided.
const FLAT: f64 = 1e-7;

/// How often vertices of faces that cross are moved.
const MOST_MENDS: usize = 8;

/// How far vertices in single precision are moved first, as shares of the way to the middles of their patches.
const NUDGES: [f64; 2] = [1e-4, 1e-2];

/// The most triangles of a mesh of a shape, unless its options say another number.
pub const MOST_TRIANGLES: usize = 10_000_000;

/// What a mesh of a shape is asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct ContourOptions {
    /// The side of a cell [m]: parts thinner than two may be lost or get holes.
    pub cell: f64,
    /// A node of the lattice of cells [m]; `None` leaves it beside round numbers, where faces of shapes often lie.
    pub node: Option<Point<3>>,
    /// More cells than these near the surface are refused.
    pub most_cells: usize,
    /// More triangles than these are refused.
    pub most_triangles: usize,
    /// Whether vertices are in single precision, as files of STL and GLB hold them: faces that cross where they are
    /// rounded are mended as others are.
    pub is_single: bool,
}

impl ContourOptions {
    /// Cells of a size [m], at most 2²⁶ of them near the surface, and at most [`MOST_TRIANGLES`].
    #[must_use]
    pub const fn with_cell(cell: f64) -> Self {
        let (most_cells, most_triangles) = (1 << 26, MOST_TRIANGLES);
        Self { cell, node: None, most_cells, most_triangles, is_single: false }
    }
}

/// Why a shape has no mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ContourError {
    /// The size of a cell is no length.
    #[error("the size of a cell must be positive and finite, got {cell} m")]
    Cell {
        /// The size given [m].
        cell: f64,
    },
    /// A tolerance is no length.
    #[error("the tolerance must be positive and finite, got {tolerance} m")]
    Tolerance {
        /// The tolerance given [m].
        tolerance: f64,
    },
    /// The shape has no bounds.
    #[error("the shape has no bounds: intersect it with a box first")]
    Unbounded,
    /// There are more cells than allowed.
    #[error(
        "cells of {cell} m near the surface are more than the {limit} allowed; choose larger ones"
    )]
    TooMany {
        /// The size of a cell [m].
        cell: f64,
        /// How many are allowed.
        limit: usize,
    },
    /// There are more triangles than allowed.
    #[error(
        "the mesh has more than the {limit} triangles allowed; take a larger tolerance or larger cells, or allow more"
    )]
    TooManyTriangles {
        /// How many are allowed.
        limit: usize,
    },
    /// No edge of a cell crosses the surface.
    #[error(
        "no surface was found with cells of {cell:.3e} m: the shape is empty, or thinner than they are; choose smaller ones"
    )]
    NoSurface {
        /// The size of a cell [m].
        cell: f64,
    },
    /// Cells that see the surface would be too many.
    #[error(
        "no surface was found with cells of {cell:.3e} m, and smaller ones would be more than the {limit} allowed: \
         the shape is empty, or too thin for its size"
    )]
    TooThin {
        /// The size of the cells that saw no surface [m].
        cell: f64,
        /// How many are allowed.
        limit: usize,
    },
    /// A part of the shape has no triangle.
    #[error(
        "a part or a cavity at {point:?} [m] has no triangle, and others may have none: cells of {cell:.3e} m are too large"
    )]
    Lost {
        /// A point of that part, or in a cavity [m].
        point: [f64; 3],
        /// The size of a cell [m].
        cell: f64,
    },
    /// No mesh within a tolerance was found.
    #[error(
        "no mesh within {tolerance} m was found: with cells of {cell} m the field is up to {proven} m on a triangle; \
         allow more, or choose the cells"
    )]
    NotReached {
        /// The tolerance [m].
        tolerance: f64,
        /// The size of the cells of the last try [m].
        cell: f64,
        /// The largest field that a triangle of the last try may have [m].
        proven: f64,
    },
    /// A value of the shape is no number.
    #[error("the shape's distance is no number at {point:?} [m]")]
    NotFinite {
        /// Where [m].
        point: [f64; 3],
    },
    /// The caller stopped the work.
    #[error("stopped before the mesh was complete")]
    Stopped,
    /// The triangles make no mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

impl TriangleMesh {
    /// The surface of a shape in triangles, closed, and facing outwards.
    ///
    /// ```
    /// use palpate_field::Shape;
    /// use palpate_mesh::{ContourOptions, TriangleMesh};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let block = Shape::cuboid([0.3, 0.2, 0.1])?;
    /// let mesh = TriangleMesh::of_shape(&block, &ContourOptions::with_cell(0.017))?;
    /// let report = mesh.report();
    /// assert!(report.is_watertight());
    /// // The corners are sharp: nothing of the volume is lost.
    /// assert!((report.enclosed.unwrap() - 0.006).abs() < 1e-9);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    ///
    /// If the shape has no bounds, no surface is found, there are too many cells or triangles, or a value is no number.
    pub fn of_shape(shape: &Shape<3>, options: &ContourOptions) -> Result<Self, ContourError> {
        Self::of_shape_with(shape, options, &mut |_| ControlFlow::Continue(()))
    }

    /// The same; `progress` gets the share that is done, and can stop the work.
    ///
    /// # Errors
    ///
    /// As of [`of_shape`](Self::of_shape), and if `progress` breaks.
    pub fn of_shape_with(
        shape: &Shape<3>,
        options: &ContourOptions,
        progress: &mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Result<Self, ContourError> {
        made(shape, options, false, progress).map(|(mesh, _)| mesh)
    }
}

/// The mesh, and a point of a part of the shape that it lacks, if such parts are looked for.
fn made(
    shape: &Shape<3>,
    options: &ContourOptions,
    looks_between: bool,
    progress: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<(TriangleMesh, Option<Point<3>>), ContourError> {
    let cell = options.cell;
    if !(cell > 0.0 && cell.is_finite()) {
        return Err(ContourError::Cell { cell });
    }
    let bounds = shape.promise().bounds.ok_or(ContourError::Unbounded)?.aabb;
    let cells = Cells::over(&bounds.grown(AROUND * cell), options)?;
    let [looking, crossing] = [LOOKING, CROSSING];
    let (signed, lost) =
        cells.signed(shape, looks_between, &mut |share| progress(share * looking))?;
    if signed.is_empty() {
        return Err(ContourError::NoSurface { cell });
    }
    let mut found = |share| progress(looking + share * crossing);
    let contour = Contour::of(shape, &cells, &signed, options.most_triangles, &mut found)?;
    let mesh = contour.mesh(shape, options.is_single, &mut |share| {
        progress(looking + crossing + share * (1.0 - looking - crossing))
    })?;
    Ok((mesh, lost))
}

/// A vertex, with what it stands for.
#[derive(Clone, Debug)]
struct Corner {
    /// Where it is [m].
    place: Point<3>,
    /// The middle of the crossings of its patch [m].
    middle: Point<3>,
}

/// The vertices of patches, and the four around each crossing.
struct Contour {
    corners: Vec<Corner>,
    quads: Vec<[u32; 4]>,
}

impl Contour {
    fn of(
        shape: &Shape<3>,
        cells: &Cells,
        signed: &[Signed],
        most_triangles: usize,
        progress: &mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Result<Self, ContourError> {
        let patches = Patches::of(signed);
        let mut crossings: HashMap<[u32; 4], Crossing> = HashMap::new();
        let mut corners = Vec::new();
        // The vertex of each edge of each cell.
        let mut of_edges = Vec::with_capacity(signed.len());
        let mut found = Vec::new();
        for (number, (cell, patches)) in signed.iter().zip(&patches).enumerate() {
            if number.is_multiple_of(A_LOOK)
                && progress(number as f64 / signed.len() as f64).is_break()
            {
                return Err(ContourError::Stopped);
            }
            let first = corners.len() as u32;
            for patch in 0..patches.count {
                found.clear();
                for edge in (0..EDGES).filter(|edge| patches.of_edge[*edge] == patch) {
                    let key = cell.edge(edge);
                    if let Some(known) = crossings.get(&key) {
                        found.push(*known);
                        continue;
                    }
                    let crossing = Crossing::on(shape, cells.ends(key))?;
                    crossings.insert(key, crossing);
                    found.push(crossing);
                }
                let around = cells.around(cell.cell);
                corners.push(vertex::of(shape, &found, &around));
            }
            of_edges.push(patches.of_edge.map(|patch| match patch {
                NONE => u32::MAX,
                patch => first + u32::from(patch),
            }));
        }
        let quads = cells::quads(signed, &of_edges);
        if 2 * quads.len() > most_triangles {
            return Err(ContourError::TooManyTriangles { limit: most_triangles });
        }
        Ok(Self { corners, quads })
    }

    /// Triangles, with the vertices of those that cross moved to the middles of their patches.
    fn mesh(
        mut self,
        shape: &Shape<3>,
        is_single: bool,
        progress: &mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Result<TriangleMesh, ContourError> {
        for mend in 0.. {
            if progress(mend as f64 / MOST_MENDS as f64).is_break() {
                return Err(ContourError::Stopped);
            }
            let place =
                |corner: &Corner| if is_single { single(corner.place) } else { corner.place };
            let places: Vec<_> = self.corners.iter().map(place).collect();
            let triangles = cells::triangles(shape, &places, &self.quads);
            let mesh = TriangleMesh::new(places, triangles)?;
            if mend == MOST_MENDS {
                return Ok(mesh);
            }
            let crossing = crossing_faces(&mesh);
            if crossing.is_empty() {
                return Ok(mesh);
            }
            // Where rounding alone makes faces touch, as at an edge of two parts, little moves them apart.
            let nudge = NUDGES.get(mend).filter(|_| is_single);
            let share = nudge.copied().unwrap_or(0.5);
            for vertex in crossing.into_iter().flat_map(|face| mesh.elements()[face]) {
                let corner = &mut self.corners[vertex as usize];
                corner.place = corner.place + (corner.middle - corner.place) * share;
            }
        }
        unreachable!("the loop returns")
    }
}
