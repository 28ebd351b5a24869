// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Which elements of a mesh touch a field.
//!
//! Breadth first through the tree of balls, eight nodes with eight children each in a
//! block. From the value at a centre, with the ball's radius r and the field's steepness L,
//!
//! ```text
//! f(centre) > L·r     nothing below touches;
//! f(centre) < −L·r    everything below does, and nothing more is asked of it.
//! ```
//!
//! What is left of the elements is looked at 64 at a time: a point lifted off the centre
//! along the gradient frees most (see [`search`](crate::search)), the lowest corner of the
//! linear model hits most. Few remain to be searched one by one.

use palpate_field::field::{DifferentiateBlock, EvaluateBlock, Field};
use palpate_field::{BLOCK, Block, Column, Gradients, LARGEST_LENGTH, Point, Pose, SHORT};
use palpate_mesh::{FAN, Mesh};

use super::placed::PlacedMesh;
use crate::certified::Limits;
use crate::element::Element;
use crate::error::QueryError;
use crate::goal::Goal;
use crate::placed::Placed;
use crate::sampler::{Steepness, unit};
use crate::search::{Terms, Workspace, search};

/// How high points are lifted off elements, in radii.
const HEIGHT: f64 = 4.0;

/// Memory of searches over meshes, to be kept between them: after the first on a mesh of
/// some size, none allocates.
#[derive(Debug)]
pub struct MeshWorkspace<const N: usize, const D: usize> {
    block: Block<f64, D, BLOCK>,
    values: Column<f64, BLOCK>,
    slopes: Gradients<f64, D, BLOCK>,
    frontier: Vec<u32>,
    next: Vec<u32>,
    open: Vec<u32>,
    hits: Vec<u32>,
    undecided: Vec<Undecided>,
    /// A bit for each element, none set between searches.
    marks: Vec<u64>,
    search: Workspace<N, D>,
}

impl<const N: usize, const D: usize> MeshWorkspace<N, D> {
    /// Room for searches over elements of `N` points in `D` dimensions.
    #[must_use]
    pub fn new() -> Self {
        Self {
            block: Block::zero(),
            values: Column::zero(),
            slopes: Gradients::zero(),
            frontier: Vec::new(),
            next: Vec::new(),
            open: Vec::new(),
            hits: Vec::new(),
            undecided: Vec::new(),
            marks: Vec::new(),
            search: Workspace::new(),
        }
    }
}

impl<const N: usize, const D: usize> Default for MeshWorkspace<N, D> {
    fn default() -> Self {
        Self::new()
    }
}

/// An element of which it is not known whether it touches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Undecided {
    /// The element.
    pub element: u32,
    /// The field is no less on it [m].
    pub lower: f64,
    /// The field is no more somewhere on it [m].
    pub upper: f64,
}

/// What is known of every element of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshHits<'a> {
    /// The elements that touch, ascending.
    pub hits: &'a [u32],
    /// Those of which it is not known, ascending. All others are proven free.
    pub undecided: &'a [Undecided],
    /// How often the field was asked; a gradient counts twice.
    pub evaluations: u32,
}

/// Which elements of a mesh come as close to a field as `gap` [m], for certain.
///
/// An element touches if the field is at most `gap` somewhere on it, times the field's
/// steepness if that is more than one: so no element within `gap` of the surface is
/// missed, and where the field is exact none that is further off is named.
///
/// The mesh stays as it is: its tree is moved on the way. Each element of which the tree
/// and a few points say too little is searched with `limits` of its own, and is undecided
/// if they do not suffice. Before that, the field is asked at most seven times an element.
///
/// # Errors
///
/// If `gap` is negative or no number, or a pose is not finite or beyond 1e15 m.
///
/// ```
/// use palpate_field::{Pose, Shape, Vector, kernel::Ball};
/// use palpate_mesh::Outline;
/// use palpate_query::{Limits, MeshWorkspace, PlacedMesh, mesh_hits};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let disc = Shape::from_kernel(Ball::new(1.0)?);
/// let corners = [[0.0, 0.0], [4.0, 0.0], [4.0, 3.0]].map(Vector).to_vec();
/// let triangle = Outline::new(corners, vec![[0, 1], [1, 2], [2, 0]])?;
/// let mut workspace = MeshWorkspace::new();
/// // Its lowest side passes the disc at 0.5, and its long side at 1.3.
/// let placed = PlacedMesh::new(&triangle, Pose::translation(Vector([-2.0, 0.5])));
/// let near = mesh_hits(&disc, placed, 0.0, &Limits::default(), &mut workspace)?;
/// assert_eq!(near.hits, [0]);
/// assert!(near.undecided.is_empty());
/// # Ok(())
/// # }
/// ```
pub fn mesh_hits<'a, 'w, const N: usize, const D: usize>(
    field: impl Into<Placed<'a, D>>,
    mesh: impl Into<PlacedMesh<'a, N, D>>,
    gap: f64,
    limits: &Limits,
    workspace: &'w mut MeshWorkspace<N, D>,
) -> Result<MeshHits<'w>, QueryError>
where
    dyn Field<D>: EvaluateBlock<f64, D, BLOCK>
        + DifferentiateBlock<f64, D, BLOCK>
        + EvaluateBlock<f64, D, SHORT>
        + DifferentiateBlock<f64, D, SHORT>,
{
    let (field, placed) = (field.into(), mesh.into());
    if !(0.0..=LARGEST_LENGTH).contains(&gap) {
        return Err(QueryError::Length { value: gap });
    }
    let (field_from_mesh, reach) = placed.seen_from(&field)?;
    let level = gap * field.shape.promise().lipschitz.max(1.0);
    // No element is larger than the mesh.
    let highest = HEIGHT * placed.mesh.bounds().half_extents().norm();
    let sweep = Sweep {
        field: &field,
        mesh: placed.mesh,
        field_from_mesh,
        steepness: Steepness::new(field.shape, reach + highest, level),
        level,
        reach,
        evaluations: 0,
    };
    let evaluations = sweep.run(limits, workspace);
    sort(&mut workspace.hits, placed.mesh.elements().len(), &mut workspace.marks);
    workspace.undecided.sort_unstable_by_key(|undecided| undecided.element);
    Ok(MeshHits { hits: &workspace.hits, undecided: &workspace.undecided, evaluations })
}

/// Sorts different numbers below `end` by setting and reading a bit for each: there may be
/// thousands, and comparing them would take longer than finding them did.
fn sort(numbers: &mut Vec<u32>, end: usize, marks: &mut Vec<u64>) {
    marks.resize(marks.len().max(end.div_ceil(64)), 0);
    for number in numbers.drain(..) {
        marks[number as usize / 64] |= 1 << (number % 64);
    }
    for (i, word) in marks.iter_mut().take(end.div_ceil(64)).enumerate() {
        let mut rest = std::mem::take(word);
        while rest != 0 {
            numbers.push(64 * i as u32 + rest.trailing_zeros());
            rest &= rest - 1;
        }
    }
}

/// A way through a mesh.
struct Sweep<'a, const N: usize, const D: usize> {
    field: &'a Placed<'a, D>,
    mesh: &'a Mesh<N, D>,
    field_from_mesh: Pose<D>,
    steepness: Steepness<D>,
    level: f64,
    reach: f64,
    evaluations: u32,
}

impl<const N: usize, const D: usize> Sweep<'_, N, D>
where
    dyn Field<D>: EvaluateBlock<f64, D, BLOCK>
        + DifferentiateBlock<f64, D, BLOCK>
        + EvaluateBlock<f64, D, SHORT>
        + DifferentiateBlock<f64, D, SHORT>,
{
    fn run(mut self, limits: &Limits, workspace: &mut MeshWorkspace<N, D>) -> u32 {
        workspace.hits.clear();
        workspace.open.clear();
        workspace.undecided.clear();
        workspace.frontier.clear();
        // The top level is the children of one node that is not asked.
        workspace.frontier.push(0);
        for level in (0..self.mesh.tree().levels().len()).rev() {
            self.descend(level, workspace);
        }
        // What the blocks leave open takes the place of the frontier.
        workspace.frontier.clear();
        for start in (0..workspace.open.len()).step_by(BLOCK) {
            self.look_closer(start, workspace);
        }
        self.search_rest(limits, workspace);
        self.evaluations
    }

    /// Asks at the centres of all children of the frontier.
    fn descend(&mut self, level: usize, workspace: &mut MeshWorkspace<N, D>) {
        let tree = self.mesh.tree();
        let MeshWorkspace { block, values, frontier, next, open, hits, .. } = workspace;
        let balls = &tree.levels()[level];
        next.clear();
        for group in frontier.chunks(BLOCK / FAN) {
            let count = group.len() * FAN;
            for (lane, &node) in group.iter().enumerate() {
                for (i, centre) in balls.children(node as usize).into_iter().enumerate() {
                    block.set(lane * FAN + i, self.field_from_mesh.transform_point(centre));
                }
            }
            self.field.shape.block_distances(block, count, values);
            self.evaluations += count as u32;
            for (lane, &node) in group.iter().enumerate() {
                let first = node as usize * FAN;
                for (i, &radius) in balls.radii()[first..][..FAN].iter().enumerate() {
                    let (child, lane) = (first + i, lane * FAN + i);
                    let value = values.get(lane) - self.level;
                    let change = self.steepness.change(|| block.get(lane), radius);
                    // What completes a group has no radius. NaN is neither free nor a hit.
                    if radius < 0.0 || value > change {
                        continue;
                    }
                    match level {
                        0 if value <= -self.steepness.slack => hits.push(tree.order()[child]),
                        0 => open.push(child as u32),
                        _ if value < -change => {
                            hits.extend_from_slice(tree.elements_below(level, child));
                        }
                        _ => next.push(child as u32),
                    }
                }
            }
        }
        std::mem::swap(frontier, next);
    }

    /// Asks once more about a block of the elements that are open, and puts those that it
    /// leaves open on the frontier.
    fn look_closer(&mut self, start: usize, workspace: &mut MeshWorkspace<N, D>) {
        let tree = self.mesh.tree();
        let MeshWorkspace { block, values, slopes, frontier, open, hits, .. } = workspace;
        let open = &open[start..open.len().min(start + BLOCK)];
        let balls = &tree.levels()[0];
        for (lane, &leaf) in open.iter().enumerate() {
            let centre = balls.centre(leaf as usize);
            block.set(lane, self.field_from_mesh.transform_point(centre));
        }
        self.field.shape.block_gradients(block, open.len(), slopes);
        let mut is_on_it = [false; BLOCK];
        for (lane, &leaf) in open.iter().enumerate() {
            let element = self.element(tree.order()[leaf as usize]);
            let (centre, value) = (block.get(lane), slopes.distance.get(lane) - self.level);
            let gradient = slopes.gradient.get(lane);
            let rise = |corner: &Point<D>| (*corner - centre).dot(gradient);
            let lowest =
                element.vertices().iter().fold(element.vertices()[0], |low, corner| {
                    if rise(corner) < rise(&low) { *corner } else { low }
                });
            is_on_it[lane] = value + rise(&lowest) <= 0.0;
            let height = HEIGHT * balls.radii()[leaf as usize];
            let lifted = centre + unit(gradient) * height;
            block.set(lane, if is_on_it[lane] { lowest } else { lifted });
        }
        self.field.shape.block_distances(block, open.len(), values);
        self.evaluations += 3 * open.len() as u32;
        for (lane, &leaf) in open.iter().enumerate() {
            let name = tree.order()[leaf as usize];
            let (p, value) = (block.get(lane), values.get(lane) - self.level);
            if is_on_it[lane] && value <= -self.steepness.slack {
                hits.push(name);
                continue;
            }
            let lower = self.steepness.bound(p, value, self.element(name).farthest(p));
            let is_free = lower > 0.0;
            if !is_free {
                frontier.push(name);
            }
        }
    }

    /// Searches the elements that are still open, one by one.
    fn search_rest(&mut self, limits: &Limits, workspace: &mut MeshWorkspace<N, D>) {
        let terms = Terms {
            goal: Goal::Sign { tolerance: limits.tolerance },
            budget: limits.budget,
            level: self.level,
            reach: self.reach,
        };
        let MeshWorkspace { frontier, hits, undecided, search: memory, .. } = workspace;
        for &name in &*frontier {
            let answer = search(self.field.shape, &self.element(name), &terms, memory);
            self.evaluations += answer.evaluations;
            match answer.is_hit() {
                Some(true) => hits.push(name),
                Some(false) => {}
                None => undecided.push(Undecided {
                    element: name,
                    lower: answer.lower + self.level,
                    upper: answer.upper + self.level,
                }),
            }
        }
    }

    /// An element where the field sees it.
    #[inline]
    fn element(&self, name: u32) -> Element<N, D> {
        let mut vertices = self.mesh.corners(name as usize);
        for vertex in &mut vertices {
            *vertex = self.field_from_mesh.transform_point(*vertex);
        }
        Element { vertices }
    }
}
