// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Meshes against a field.
//!
//! Which elements of a mesh touch a field.
//!
//! Breadth first through the tree of balls, eight nodes with eight children each in a
//! block. From the value at a centre, with the ball's radius r and the field's steepness L,
//!
//! ```text
//! f(centre) > L·r     no element below touches;
//! f(centre) < −L·r    every element below touches, without further evaluations.
//! ```
//!
//! The remaining elements are bounded 64 at a time. A point lifted off the centre along the
//! gradient proves most of them free (see [`element_search`](crate::element_search)), and the
//! lowest corner of the linear model proves most hits. Elements still open are halved twice
//! and bounded again; the few that stay open are searched one by one.

use palpate_field::{BLOCK, Block, Column, Gradients, LARGEST_LENGTH, Point, Pose, Shape};
use palpate_mesh::{FAN, Mesh};

use crate::certified::{Goal, Limits};
use crate::contact::Contact;
use crate::contacts::{self, ElementContacts, level};
use crate::element_search::{Element, ElementWorkspace, Terms, parts_of_one, search};
use crate::error::QueryError;
use crate::sampler::{Placed, Steepness, unit};

/// A contact of an element of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MeshContact<const D: usize> {
    /// The contact, from the field to the mesh, in world coordinates.
    pub contact: Contact<D>,
    /// The index of the element in the mesh.
    pub element: u32,
}

/// All contacts of a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MeshContacts<const D: usize> {
    /// The contacts, by ascending elements, and of each element from the deepest.
    pub contacts: Vec<MeshContact<D>>,
    /// The elements that touch, ascending; each has at least one contact.
    pub hits: Vec<u32>,
    /// The elements that could not be decided, ascending. All others are proven free.
    pub undecided: Vec<Undecided>,
    /// How often the field was evaluated; a gradient counts twice.
    pub evaluations: u32,
}

/// All contacts of a field with the elements of a mesh, up to a gap [m].
///
/// Of each element that [`mesh_hits`](crate::mesh_hits) names, all that
/// [`contacts`](crate::contacts) finds, with the same promises; `limits` are those of each
/// element. Body `a` of a contact is the field, body `b` the mesh.
///
/// # Errors
///
/// If `gap` or the tolerance is negative, NaN or too large, or a pose is not finite or
/// beyond 1e15 m.
///
/// ```
/// use palpate_field::{Pose, Shape, Vector, kernel::Ball};
/// use palpate_mesh::TriangleMesh;
/// use palpate_query::{Limits, MeshWorkspace, Placed, mesh_contacts};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let corners = [[-4.0, 0.0, -3.0], [5.0, 0.0, -3.0], [0.0, 0.0, 4.0]].map(Vector).to_vec();
/// let floor = TriangleMesh::new(corners, vec![[0, 2, 1]])?;
/// let ball = Shape::from_kernel(Ball::new(1.0)?);
/// let above = Placed::new(&ball, Pose::translation(Vector([0.5, 0.75, 0.0])));
/// let limits = Limits::new(1e-6);
/// let mut workspace = MeshWorkspace::new();
/// let touching = mesh_contacts(above, &floor, 0.0, &limits, &mut workspace)?;
/// let [touch] = touching.contacts.as_slice() else { panic!("one contact") };
/// assert_eq!(touch.element, 0);
/// assert!((touch.contact.gap + 0.25).abs() < 1e-6);
/// assert!((touch.contact.normal - Vector([0.0, -1.0, 0.0])).norm() < 1e-2);
/// # Ok(())
/// # }
/// ```
pub fn mesh_contacts<'a, 'w, const N: usize, const D: usize>(
    field: impl Into<Placed<'a, D>>,
    mesh: impl Into<PlacedMesh<'a, N, D>>,
    gap: f64,
    limits: &Limits,
    workspace: &'w mut MeshWorkspace<N, D>,
) -> Result<&'w MeshContacts<D>, QueryError> {
    contacts_of(field.into(), mesh.into(), gap, limits, workspace)
}

#[inline(never)]
pub(crate) fn contacts_of<'w, const N: usize, const D: usize>(
    field: Placed<'_, D>,
    placed: PlacedMesh<'_, N, D>,
    gap: f64,
    limits: &Limits,
    workspace: &'w mut MeshWorkspace<N, D>,
) -> Result<&'w MeshContacts<D>, QueryError> {
    find(&field, &placed, gap, limits, workspace)?;
    let mut evaluations = workspace.hits.evaluations;
    let view = placed.seen_from(&field)?;
    let terms = Terms {
        goal: Goal::least(limits.tolerance),
        budget: limits.budget,
        level: level(field.shape, gap)?,
        reach: view.reach,
    };
    let MeshWorkspace { hits, contacts: all, search, .. } = workspace;
    all.contacts.clear();
    for &element in &hits.hits {
        let first = all.contacts.len() as u64;
        contacts::find(field.shape, &view.element(element), &terms, search);
        let ElementContacts { contacts, least } = &mut search.found;
        evaluations += least.evaluations;
        if contacts.is_empty() {
            // The element touches, and the budget ended before its deepest point was found.
            contacts.push(contacts::at(field.shape, least.best));
        }
        all.contacts.extend(contacts.iter().zip(first..).map(|(contact, id)| MeshContact {
            contact: contact.placed(&field.world_from_body).with_id(id),
            element,
        }));
    }
    all.hits.clone_from(&hits.hits);
    all.undecided.clone_from(&hits.undecided);
    all.evaluations = evaluations;
    Ok(all)
}

/// How high points are lifted off elements, in radii.
const HEIGHT: f64 = 4.0;

/// How often open elements are halved in blocks before each is searched alone.
const HALVINGS: u32 = 2;

/// Memory of searches over meshes, kept from one to the next: after the first search over a
/// mesh of some size, none allocates.
#[derive(Debug)]
pub struct MeshWorkspace<const N: usize, const D: usize> {
    block: Block<f64, D, BLOCK>,
    values: Column<f64, BLOCK>,
    slopes: Gradients<f64, D, BLOCK>,
    frontier: Vec<u32>,
    next: Vec<u32>,
    open: Vec<Part<N, D>>,
    still_open: Vec<Part<N, D>>,
    marks: Marks,
    hits: MeshHits,
    contacts: MeshContacts<D>,
    pub(crate) search: ElementWorkspace<N, D>,
}

/// An element or a part of one, in the field's coordinates.
#[derive(Clone, Copy, Debug)]
struct Part<const N: usize, const D: usize> {
    name: u32,
    element: Element<N, D>,
    /// Of the smallest ball around it.
    centre: Point<D>,
    radius: f64,
}

impl<const N: usize, const D: usize> MeshWorkspace<N, D> {
    /// Room for searches over elements of `N` points in `D` dimensions.
    #[must_use]
    #[inline(never)]
    pub fn new() -> Self {
        Self {
            block: Block::zero(),
            values: Column::zero(),
            slopes: Gradients::zero(),
            frontier: Vec::new(),
            next: Vec::new(),
            open: Vec::new(),
            still_open: Vec::new(),
            marks: Marks::default(),
            hits: MeshHits::default(),
            contacts: MeshContacts::default(),
            search: ElementWorkspace::new(),
        }
    }
}

impl<const N: usize, const D: usize> Default for MeshWorkspace<N, D> {
    fn default() -> Self {
        Self::new()
    }
}

/// An element of which the search could not tell whether it touches.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Undecided {
    /// The index of the element in the mesh.
    pub element: u32,
    /// Proven lower bound of the field on the element [m].
    pub lower: f64,
    /// Upper bound of the field's least value on the element [m].
    pub upper: f64,
}

/// Which elements of a mesh touch.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MeshHits {
    /// The elements that touch, ascending.
    pub hits: Vec<u32>,
    /// The elements that could not be decided, ascending. All others are proven free.
    pub undecided: Vec<Undecided>,
    /// How often the field was evaluated; a gradient counts twice.
    pub evaluations: u32,
}

/// The elements of a mesh that are proven to come within `gap` [m] of a field.
///
/// An element touches if the field is somewhere on it at most `gap`, times the steepness of
/// the field if that exceeds one. So no element within `gap` of the surface is missed, and
/// where the field is exact every element named is within `gap`.
///
/// The mesh is not copied: the search moves centres of its tree as it needs them. `limits`
/// hold for each element that the tree and a few points do not decide; an element that they
/// do not suffice for is undecided. Before that, the search evaluates the field at most 71
/// times per element (8 in the tree, 3 for each of 21 parts), and not at all on elements in a ball that is wholly free or inside.
///
/// # Errors
///
/// If `gap` or the tolerance is negative, NaN or too large, or a pose is not finite or
/// beyond 1e15 m.
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
/// let near = mesh_hits(&disc, placed, 0.0, &Limits::new(1e-4), &mut workspace)?;
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
) -> Result<&'w MeshHits, QueryError> {
    find(&field.into(), &mesh.into(), gap, limits, workspace)?;
    Ok(&workspace.hits)
}

/// Finds the hits of a mesh, and writes them into the workspace.
#[inline(never)]
pub(crate) fn find<const N: usize, const D: usize>(
    field: &Placed<'_, D>,
    placed: &PlacedMesh<'_, N, D>,
    gap: f64,
    limits: &Limits,
    workspace: &mut MeshWorkspace<N, D>,
) -> Result<(), QueryError> {
    limits.check()?;
    let level = level(field.shape, gap)?;
    let view = placed.seen_from(field)?;
    // No element is larger than the mesh.
    let highest = HEIGHT * placed.mesh.bounds().half_extents().norm();
    let sweep = Sweep {
        shape: field.shape,
        steepness: Steepness::new(field.shape, view.reach + highest, level),
        view,
        level,
        evaluations: 0,
    };
    workspace.hits.evaluations = sweep.run(limits, workspace);
    let MeshWorkspace { marks, hits, .. } = workspace;
    marks.move_to(&mut hits.hits);
    hits.undecided.sort_unstable_by_key(|undecided| undecided.element);
    Ok(())
}

/// A bit for each element that touches. Hits may be thousands, and sorting them would take
/// longer than finding them.
#[derive(Debug, Default)]
struct Marks(Vec<u64>);

impl Marks {
    /// None set, of `count`.
    fn reset(&mut self, count: usize) {
        self.0.clear();
        self.0.resize(count.div_ceil(64), 0);
    }

    #[inline]
    fn set(&mut self, i: u32) {
        self.0[i as usize / 64] |= 1 << (i % 64);
    }

    #[inline]
    fn is_set(&self, i: u32) -> bool {
        self.0[i as usize / 64] >> (i % 64) & 1 == 1
    }

    /// Writes those that are set into `list`, ascending.
    fn move_to(&mut self, list: &mut Vec<u32>) {
        list.clear();
        for (i, word) in self.0.iter().enumerate() {
            let mut rest = *word;
            while rest != 0 {
                list.push(64 * i as u32 + rest.trailing_zeros());
                rest &= rest - 1;
            }
        }
    }
}

/// A search through a mesh, from the top of its tree.
struct Sweep<'a, const N: usize, const D: usize> {
    shape: &'a Shape<D>,
    view: View<'a, N, D>,
    steepness: Steepness<D>,
    level: f64,
    evaluations: u32,
}

impl<const N: usize, const D: usize> Sweep<'_, N, D> {
    fn run(mut self, limits: &Limits, workspace: &mut MeshWorkspace<N, D>) -> u32 {
        workspace.marks.reset(self.view.mesh.elements().len());
        workspace.open.clear();
        workspace.hits.undecided.clear();
        workspace.frontier.clear();
        // The top level holds the children of one root, which is not evaluated.
        workspace.frontier.push(0);
        for level in (0..self.view.mesh.tree().levels().len()).rev() {
            self.descend(level, workspace);
        }
        self.look_closer(workspace);
        for _ in 0..HALVINGS {
            halve(workspace);
            self.look_closer(workspace);
        }
        self.search_rest(limits, workspace);
        // Two lists that swap may each need the capacity of the other next time.
        equalise(&mut workspace.frontier, &mut workspace.next);
        equalise(&mut workspace.open, &mut workspace.still_open);
        self.evaluations
    }

    /// Evaluates the field at the centres of all children of the frontier.
    fn descend(&mut self, level: usize, workspace: &mut MeshWorkspace<N, D>) {
        let tree = self.view.mesh.tree();
        let MeshWorkspace { block, values, frontier, next, open, marks, .. } = workspace;
        let balls = &tree.levels()[level];
        next.clear();
        for group in frontier.chunks(BLOCK / FAN) {
            let count = group.len() * FAN;
            for (lane, &node) in group.iter().enumerate() {
                for (i, centre) in balls.children(node as usize).into_iter().enumerate() {
                    block
                        .set(lane * FAN + i, self.view.field_from_mesh.transform_point(centre));
                }
            }
            self.shape.block_distances(block, count, values);
            self.evaluations += count as u32;
            for (lane, &node) in group.iter().enumerate() {
                let first = node as usize * FAN;
                for (i, &radius) in balls.radii()[first..][..FAN].iter().enumerate() {
                    let (child, lane) = (first + i, lane * FAN + i);
                    let value = values.get(lane) - self.level;
                    let change = self.steepness.change(|| block.get(lane), radius);
                    // Padding of a group has a negative radius. NaN is neither free nor a hit.
                    if radius < 0.0 || value > change {
                        continue;
                    }
                    match level {
                        0 if value <= -self.steepness.slack => marks.set(tree.order()[child]),
                        0 => {
                            let (name, centre) = (tree.order()[child], block.get(lane));
                            open.push(Part {
                                name,
                                element: self.view.element(name),
                                centre,
                                radius,
                            });
                        }
                        _ if value < -change => {
                            for &element in tree.elements_below(level, child) {
                                marks.set(element);
                            }
                        }
                        _ => next.push(child as u32),
                    }
                }
            }
        }
        std::mem::swap(frontier, next);
    }

    /// Bounds the open parts, a block at a time, and keeps those that stay open.
    fn look_closer(&mut self, workspace: &mut MeshWorkspace<N, D>) {
        let MeshWorkspace { block, values, slopes, open, still_open, marks, .. } = workspace;
        still_open.clear();
        for parts in open.chunks(BLOCK) {
            for (lane, part) in parts.iter().enumerate() {
                block.set(lane, part.centre);
            }
            self.shape.block_gradients(block, parts.len(), slopes);
            let mut is_on_it = [false; BLOCK];
            for (lane, part) in parts.iter().enumerate() {
                let (value, gradient) =
                    (slopes.distance.get(lane) - self.level, slopes.gradient.get(lane));
                let rise = |p: Point<D>| (p - part.centre).dot(gradient);
                let [first, rest @ ..] = part.element.vertices().as_slice() else { continue };
                let lowest =
                    rest.iter().fold(*first, |a, b| if rise(*b) < rise(a) { *b } else { a });
                is_on_it[lane] = value + rise(lowest) <= 0.0;
                let lifted = part.centre + unit(gradient) * (HEIGHT * part.radius);
                block.set(lane, if is_on_it[lane] { lowest } else { lifted });
                if value <= -self.steepness.slack {
                    marks.set(part.name);
                }
            }
            self.shape.block_distances(block, parts.len(), values);
            self.evaluations += 3 * parts.len() as u32;
            for (lane, part) in parts.iter().enumerate() {
                let (p, value) = (block.get(lane), values.get(lane) - self.level);
                if is_on_it[lane] && value <= -self.steepness.slack {
                    marks.set(part.name);
                }
                let lower = self.steepness.bound(p, value, part.element.farthest(p));
                let is_free = lower > 0.0;
                if !is_free && !marks.is_set(part.name) {
                    still_open.push(*part);
                }
            }
        }
        std::mem::swap(open, still_open);
    }

    /// Searches the elements that are still open, one by one.
    fn search_rest(&mut self, limits: &Limits, workspace: &mut MeshWorkspace<N, D>) {
        let terms = Terms {
            goal: Goal::sign(limits.tolerance),
            budget: limits.budget,
            level: self.level,
            reach: self.view.reach,
        };
        let MeshWorkspace { open, marks, hits, search: memory, .. } = workspace;
        open.dedup_by_key(|part| part.name);
        for &Part { name, .. } in &*open {
            if marks.is_set(name) {
                continue;
            }
            let element = self.view.element(name);
            let answer = search(self.shape, &element, &terms, memory);
            self.evaluations += answer.evaluations;
            match answer.is_hit() {
                Some(true) => marks.set(name),
                Some(false) => {}
                None => hits.undecided.push(Undecided {
                    element: name,
                    lower: answer.lower + self.level,
                    upper: answer.upper + self.level,
                }),
            }
        }
    }
}

/// Empties two lists, and gives both the larger capacity.
fn equalise<T>(a: &mut Vec<T>, b: &mut Vec<T>) {
    let room = a.capacity().max(b.capacity());
    for list in [a, b] {
        list.clear();
        list.reserve_exact(room);
    }
}

/// Halves the parts that are open.
fn halve<const N: usize, const D: usize>(workspace: &mut MeshWorkspace<N, D>) {
    let MeshWorkspace { open, still_open, marks, .. } = workspace;
    still_open.clear();
    for part in open.iter().filter(|part| !marks.is_set(part.name)) {
        let weights = part.element.centre_weights();
        let (name, radius) = (part.name, 0.5 * part.radius);
        still_open.extend(
            part.element.halves()[..parts_of_one::<N>()].iter().map(|&element| Part {
                name,
                element,
                centre: element.at(&weights),
                radius,
            }),
        );
    }
    std::mem::swap(open, still_open);
}

/// A mesh and its pose. A plain `&Mesh` converts to one at the identity.
#[derive(Clone, Copy, Debug)]
pub struct PlacedMesh<'a, const N: usize, const D: usize> {
    /// The mesh.
    pub mesh: &'a Mesh<N, D>,
    /// From the mesh's coordinates to the world's.
    pub world_from_mesh: Pose<D>,
}

impl<'a, const N: usize, const D: usize> PlacedMesh<'a, N, D> {
    /// `mesh` moved by `world_from_mesh`.
    #[must_use]
    pub fn new(mesh: &'a Mesh<N, D>, world_from_mesh: Pose<D>) -> Self {
        Self { mesh, world_from_mesh }
    }

    /// The mesh in the coordinates of a field.
    fn seen_from(&self, field: &Placed<'_, D>) -> Result<View<'a, N, D>, QueryError> {
        let poses = [field.world_from_body, self.world_from_mesh];
        if let Some(index) = poses.iter().position(|pose| !pose.is_finite()) {
            return Err(QueryError::Pose { index });
        }
        let [body, mesh] = poses.map(|pose| pose.translation.norm());
        let reach = body + mesh + self.mesh.bounds().radius_about_origin();
        if reach > LARGEST_LENGTH {
            return Err(QueryError::Coordinate { what: "mesh", value: reach });
        }
        let field_from_mesh = field.world_from_body.inverse() * self.world_from_mesh;
        Ok(View { mesh: self.mesh, field_from_mesh, reach })
    }
}

/// A mesh in the coordinates of a field.
#[derive(Clone, Copy, Debug)]
struct View<'a, const N: usize, const D: usize> {
    mesh: &'a Mesh<N, D>,
    field_from_mesh: Pose<D>,
    /// An upper bound of the coordinates in the conversion [m].
    reach: f64,
}

impl<const N: usize, const D: usize> View<'_, N, D> {
    /// An element in the field's coordinates.
    #[inline]
    fn element(&self, name: u32) -> Element<N, D> {
        let mut vertices = self.mesh.corners(name as usize);
        for vertex in &mut vertices {
            *vertex = self.field_from_mesh.transform_point(*vertex);
        }
        Element { vertices }
    }
}

impl<'a, const N: usize, const D: usize> From<&'a Mesh<N, D>> for PlacedMesh<'a, N, D> {
    fn from(mesh: &'a Mesh<N, D>) -> Self {
        Self::new(mesh, Pose::identity())
    }
}
