// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! One door to all questions about shapes.

use palpate_field::{Aabb, Point, Pose, Shape};
use palpate_mesh::Mesh;
#[cfg(feature = "parallel")]
use rayon::prelude::*;

use crate::ball::{BallWorkspace, contact_ball, touches_ball};
use crate::certified::{Certified, Limits};
use crate::contact::Contact;
use crate::contacts::{ElementContacts, contacts};
use crate::element_search::{Element, minimum, touches};
use crate::error::QueryError;
use crate::manifold::{Manifold, ManifoldSettings, manifold};
use crate::mesh::{
    MeshContacts, MeshHits, MeshWorkspace, PlacedMesh, mesh_contacts, mesh_hits,
};
use crate::pair::{
    Nearest, PairWorkspace, Penetration, Proof, overlap, penetration, proof, separation,
};
use crate::ray::{Ray, RayHit, cast_ray};
use crate::sampler::{Placed, Pool, check_pose};
use crate::sweep::{
    ElementSweep, FirstTouch, Motion, Moving, SweepSettings, SweepWorkspace, cast_ball, sweep,
    sweep_element, sweep_mesh,
};

/// Questions about shapes, with the memory that they need.
///
/// Answers are owned, and may be sent to other threads. Memory is allocated by the first
/// question that needs it, and kept. Bounds are at most [`Tolerance`] apart, which is a
/// share of the size of the smaller body unless an absolute one is asked for. A search that would
/// take more evaluations than the budget stops with [`Stop::BudgetSpent`] and what it has proven;
/// the budget is [`Limits::BUDGET`], or that of [`SweepSettings`], unless another is asked for. To
/// allocate nothing, call the functions of this crate that take a workspace.
///
/// [`Stop::BudgetSpent`]: crate::Stop::BudgetSpent
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::{Ball, Cuboid}};
/// use palpate_query::Query;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let plate = Shape::from_kernel(Cuboid::new(Vector([0.2, 0.02, 0.2]))?);
/// let ball = Shape::from_kernel(Ball::new(0.05)?).translated(Vector([0.0, 0.0605, 0.0]))?;
/// let mut query = Query::new();
/// let nearest = query.closest_points(&plate, &ball)?;
/// let contact = nearest.best.ok_or("both have a surface")?;
/// assert!((contact.gap - 0.0005).abs() < 2e-5);
/// assert!(nearest.lower <= 0.0005 && 0.0005 <= nearest.upper);
/// assert_eq!(query.overlap(&plate, &ball)?.is_hit(), Some(false));
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Query<const D: usize> {
    tolerance: Tolerance,
    /// `None` for that of each kind of search.
    budget: Option<u32>,
    gap: f64,
    scratch: Scratch<D>,
    /// Memory of batches, one a thread.
    pool: Pool<D>,
}

impl<const D: usize> Query<D> {
    /// The default tolerance, [`Limits::BUDGET`], and no gap.
    #[must_use]
    pub fn new() -> Self {
        Self {
            tolerance: Tolerance::default(),
            budget: None,
            gap: 0.0,
            scratch: Scratch::new(),
            pool: Pool::new(),
        }
    }

    /// The same questions with another tolerance.
    #[must_use]
    pub fn with_tolerance(self, tolerance: Tolerance) -> Self {
        Self { tolerance, ..self }
    }

    /// The same questions with another limit of evaluations for each question.
    #[must_use]
    pub fn with_budget(self, budget: u32) -> Self {
        Self { budget: Some(budget), ..self }
    }

    /// The same questions with another gap [m] up to which segments, triangles and elements of
    /// meshes count as touching.
    #[must_use]
    pub fn with_gap(self, gap: f64) -> Self {
        Self { gap, ..self }
    }

    /// The separation of two bodies, and where it is found; see [`separation`].
    ///
    /// # Errors
    ///
    /// If neither body is bounded, or a pose or the tolerance is NaN or out of range.
    pub fn separation<'a>(
        &mut self,
        a: impl Into<Placed<'a, D>>,
        b: impl Into<Placed<'a, D>>,
    ) -> Result<Certified<Nearest<D>>, QueryError> {
        let (a, b) = (a.into(), b.into());
        separation(a, b, &self.limits(sizes(&a, &b)), self.scratch.pair())
    }

    /// The points of both surfaces where the bodies are nearest or, if they overlap, deepest in
    /// each other, with the bounds of the [`separation`]; see [`Nearest::contact`] for what they promise.
    ///
    /// # Errors
    ///
    /// If neither body is bounded, or a pose or the tolerance is NaN or out of range.
    pub fn closest_points<'a>(
        &mut self,
        a: impl Into<Placed<'a, D>>,
        b: impl Into<Placed<'a, D>>,
    ) -> Result<Certified<Option<Contact<D>>>, QueryError> {
        let (a, b) = (a.into(), b.into());
        Ok(self.separation(a, b)?.map(|nearest| nearest.contact(a, b)))
    }

    /// Whether two bodies overlap: read the answer with [`Certified::is_hit`]; see [`overlap`].
    ///
    /// # Errors
    ///
    /// If neither body is bounded, or a pose or the tolerance is NaN or out of range.
    pub fn overlap<'a>(
        &mut self,
        a: impl Into<Placed<'a, D>>,
        b: impl Into<Placed<'a, D>>,
    ) -> Result<Certified<Nearest<D>>, QueryError> {
        let (a, b) = (a.into(), b.into());
        overlap(a, b, &self.limits(sizes(&a, &b)), self.scratch.pair())
    }

    /// Contacts that span the region in which two bodies touch, with
    /// [`ManifoldSettings::of_size`] for the smaller body; see [`manifold`].
    ///
    /// # Errors
    ///
    /// If neither body is bounded or has a size, or a pose or the tolerance is NaN or out of
    /// range.
    pub fn manifold<'a>(
        &mut self,
        a: impl Into<Placed<'a, D>>,
        b: impl Into<Placed<'a, D>>,
    ) -> Result<Manifold<D>, QueryError> {
        self.manifold_with(a, b, |settings| settings)
    }

    /// As [`Query::manifold`], with its settings changed by the caller.
    ///
    /// ```
    /// use palpate_field::{Shape, kernel::Ball};
    /// use palpate_query::{ManifoldSettings, Query};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let ball = Shape::from_kernel(Ball::new(0.5)?);
    /// let beside = ball.clone().translated([1.01, 0.0, 0.0])?;
    /// let near = Query::new().manifold_with(&ball, &beside, |own| ManifoldSettings {
    ///     margin: 0.02,
    ///     ..own
    /// })?;
    /// assert!((near.contacts[0].gap - 0.01).abs() < 1e-3);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    ///
    /// As of [`Query::manifold`], and if a setting is no length.
    pub fn manifold_with<'a>(
        &mut self,
        a: impl Into<Placed<'a, D>>,
        b: impl Into<Placed<'a, D>>,
        change: impl FnOnce(ManifoldSettings) -> ManifoldSettings,
    ) -> Result<Manifold<D>, QueryError> {
        let (a, b) = (a.into(), b.into());
        let settings = change(ManifoldSettings::of_size(smallest(sizes(&a, &b))));
        manifold(a, b, &settings, &self.limits(sizes(&a, &b)), self.scratch.pair())
    }

    /// The least translation of the second body that separates two bodies, between bounds; see
    /// [`penetration`].
    ///
    /// # Errors
    ///
    /// If neither body is bounded, or a pose or the tolerance is NaN or out of range.
    pub fn penetration<'a>(
        &mut self,
        a: impl Into<Placed<'a, D>>,
        b: impl Into<Placed<'a, D>>,
    ) -> Result<Certified<Penetration<D>>, QueryError> {
        let (a, b) = (a.into(), b.into());
        penetration(a, b, &self.limits(sizes(&a, &b)), self.scratch.pair())
    }

    /// The separation of two bodies with the boxes that prove it; see [`proof`].
    ///
    /// # Errors
    ///
    /// If neither body is bounded, or a pose or the tolerance is NaN or out of range.
    pub fn proof<'a>(
        &mut self,
        a: impl Into<Placed<'a, D>>,
        b: impl Into<Placed<'a, D>>,
    ) -> Result<Proof<D>, QueryError> {
        let (a, b) = (a.into(), b.into());
        proof(a, b, &self.limits(sizes(&a, &b)), self.scratch.pair())
    }

    /// The contact of a shape with a ball about `centre` [m] of this `radius` [m]; see
    /// [`contact_ball`].
    ///
    /// # Errors
    ///
    /// If a coordinate is not finite or beyond 1e15 m, or a length is negative or NaN.
    pub fn contact_ball(
        &mut self,
        shape: &Shape<D>,
        centre: impl Into<Point<D>>,
        radius: f64,
    ) -> Result<Certified<Option<Contact<D>>>, QueryError> {
        let limits = self.limits([size(shape), Some(2.0 * radius)]);
        contact_ball(shape, centre, radius, &limits, self.scratch.ball())
    }

    /// Whether a ball touches a shape: read the answer with [`Certified::is_hit`]; see
    /// [`touches_ball`].
    ///
    /// # Errors
    ///
    /// If a coordinate is not finite or beyond 1e15 m, or a length is negative or NaN.
    pub fn touches_ball(
        &mut self,
        shape: &Shape<D>,
        centre: impl Into<Point<D>>,
        radius: f64,
    ) -> Result<Certified<Option<Contact<D>>>, QueryError> {
        let limits = self.limits([size(shape), Some(2.0 * radius)]);
        touches_ball(shape, centre, radius, &limits, self.scratch.ball())
    }

    /// The first surface along a ray; see [`cast_ray`].
    ///
    /// # Errors
    ///
    /// If the tolerance is negative, NaN or too large.
    pub fn cast_ray(
        &mut self,
        shape: &Shape<D>,
        ray: &Ray<D>,
    ) -> Result<Certified<Option<RayHit<D>>>, QueryError> {
        cast_ray(shape, ray, &self.limits([size(shape), Some(ray.length())]))
    }

    /// The first touch of a ball of a `radius` [m] whose centre moves along a ray; see
    /// [`cast_ball`].
    ///
    /// # Errors
    ///
    /// If the radius or the tolerance is negative, NaN or too large.
    pub fn cast_ball(
        &mut self,
        shape: &Shape<D>,
        ray: &Ray<D>,
        radius: f64,
    ) -> Result<Certified<Option<Contact<D>>>, QueryError> {
        let limits = self.limits([size(shape), Some(ray.length().max(2.0 * radius))]);
        cast_ball(shape, ray, radius, &limits, self.scratch.ball())
    }

    /// When two bodies that move touch first, of motions over the time from 0 to 1, with the
    /// tolerance as the gap, and [`SweepSettings::of_size`] for the rest; see [`sweep`].
    ///
    /// # Errors
    ///
    /// If neither body is bounded, or a pose or the tolerance is NaN or out of range.
    pub fn cast_shape<'a>(
        &mut self,
        a: impl Into<Moving<'a, D>>,
        b: impl Into<Moving<'a, D>>,
    ) -> Result<FirstTouch<D>, QueryError> {
        let (a, b) = (a.into(), b.into());
        let sizes = sizes(&a.at(0.0), &b.at(0.0));
        sweep(a, b, &self.sweep_settings(sizes), self.scratch.sweep())
    }

    /// When a segment or a triangle that moves touches a field first, with settings as in
    /// [`cast_shape`](Self::cast_shape); see [`sweep_element`].
    ///
    /// # Errors
    ///
    /// If a pose or the tolerance is NaN or out of range.
    pub fn cast_element<'a, const N: usize>(
        &mut self,
        field: impl Into<Moving<'a, D>>,
        element: &Element<N, D>,
        motion: impl Into<Motion<D>>,
    ) -> Result<FirstTouch<D>, QueryError>
    where
        Self: ElementMemory<N, D>,
    {
        let field = field.into();
        let sizes = [size(field.shape), extent(element)];
        let settings = self.sweep_settings(sizes);
        sweep_element(field, element, motion, &settings, self.moving_elements())
    }

    /// When a mesh that moves touches a field first, with settings as in
    /// [`cast_shape`](Self::cast_shape); see [`sweep_mesh`].
    ///
    /// # Errors
    ///
    /// If a pose or the tolerance is NaN or out of range.
    pub fn cast_mesh<'a, const N: usize>(
        &mut self,
        field: impl Into<Moving<'a, D>>,
        mesh: &Mesh<N, D>,
        motion: impl Into<Motion<D>>,
    ) -> Result<FirstTouch<D>, QueryError>
    where
        Self: ElementMemory<N, D>,
    {
        let field = field.into();
        let sizes = [size(field.shape), Some(diagonal(&mesh.bounds()))];
        let settings = self.sweep_settings(sizes);
        sweep_mesh(field, mesh, motion, &settings, self.moving_elements())
    }

    /// The least value of a field on a segment or a triangle; see [`minimum`].
    ///
    /// # Errors
    ///
    /// If the tolerance is negative, NaN or too large.
    pub fn minimum<const N: usize>(
        &mut self,
        shape: &Shape<D>,
        element: &Element<N, D>,
    ) -> Result<Certified<Point<D>>, QueryError>
    where
        Self: ElementMemory<N, D>,
    {
        let limits = self.limits([size(shape), extent(element)]);
        minimum(shape, element, &limits, &mut self.elements().search)
    }

    /// Whether a field is at most zero on a segment or a triangle, in
    /// [`Certified::is_hit`]; see [`touches`].
    ///
    /// # Errors
    ///
    /// If the tolerance is negative, NaN or too large.
    pub fn touches<const N: usize>(
        &mut self,
        shape: &Shape<D>,
        element: &Element<N, D>,
    ) -> Result<Certified<Point<D>>, QueryError>
    where
        Self: ElementMemory<N, D>,
    {
        let limits = self.limits([size(shape), extent(element)]);
        touches(shape, element, &limits, &mut self.elements().search)
    }

    /// All contacts of a field on a segment or a triangle, up to the gap of
    /// [`Query::with_gap`]; see [`contacts`].
    ///
    /// # Errors
    ///
    /// If the gap or the tolerance is negative, NaN or too large.
    pub fn contacts<const N: usize>(
        &mut self,
        shape: &Shape<D>,
        element: &Element<N, D>,
    ) -> Result<ElementContacts<D>, QueryError>
    where
        Self: ElementMemory<N, D>,
    {
        let (limits, gap) = (self.limits([size(shape), extent(element)]), self.gap);
        let search = &mut self.elements().search;
        contacts(shape, element, gap, &limits, search).cloned()
    }

    /// The elements of a mesh that touch a field, up to the gap of [`Query::with_gap`]; see
    /// [`mesh_hits`].
    ///
    /// # Errors
    ///
    /// If the gap or the tolerance is negative, NaN or too large, or a pose is not finite or
    /// beyond 1e15 m.
    pub fn mesh_hits<'a, const N: usize>(
        &mut self,
        field: impl Into<Placed<'a, D>>,
        mesh: impl Into<PlacedMesh<'a, N, D>>,
    ) -> Result<MeshHits, QueryError>
    where
        Self: ElementMemory<N, D>,
    {
        let (field, mesh) = (field.into(), mesh.into());
        let sizes = [size(field.shape), Some(diagonal(&mesh.mesh.bounds()))];
        let (limits, gap) = (self.limits(sizes), self.gap);
        mesh_hits(field, mesh, gap, &limits, self.elements()).cloned()
    }

    /// All contacts of a field with the elements of a mesh, up to the gap of
    /// [`Query::with_gap`]; see [`mesh_contacts`].
    ///
    /// # Errors
    ///
    /// If the gap or the tolerance is negative, NaN or too large, or a pose is not finite or
    /// beyond 1e15 m.
    pub fn mesh_contacts<'a, const N: usize>(
        &mut self,
        field: impl Into<Placed<'a, D>>,
        mesh: impl Into<PlacedMesh<'a, N, D>>,
    ) -> Result<MeshContacts<D>, QueryError>
    where
        Self: ElementMemory<N, D>,
    {
        let (field, mesh) = (field.into(), mesh.into());
        let sizes = [size(field.shape), Some(diagonal(&mesh.mesh.bounds()))];
        let (limits, gap) = (self.limits(sizes), self.gap);
        mesh_contacts(field, mesh, gap, &limits, self.elements()).cloned()
    }

    /// The separations of two bodies, one for each pose of the second in the frame of the first
    /// (`a_from_b`). They are written to `answers` in the order of `poses`; see [`separation`].
    ///
    /// With the feature `parallel` rayon's threads share the work; the bits do not depend on
    /// how many there are. `goes_on` is asked before each pose, on any thread: after it said
    /// `false`, no further pose is begun; the answers of poses that were not begun are `None`.
    /// Returns `true` if all were answered.
    ///
    /// ```
    /// use palpate_field::{Pose, Shape, Vector, kernel::Ball};
    /// use palpate_query::Query;
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let ball = Shape::from_kernel(Ball::new(0.5)?);
    /// let poses = [1.5, 2.0, 2.5].map(|x| Pose::translation(Vector([x, 0.0, 0.0])));
    /// let mut answers = [None; 3];
    /// assert!(Query::new().separations([&ball, &ball], &poses, &mut answers, || true)?);
    /// let gaps = answers.map(|answer| answer.map_or(f64::NAN, |found| found.upper));
    /// for (gap, truth) in gaps.into_iter().zip([0.5, 1.0, 1.5]) {
    ///     assert!((gap - truth).abs() < 1e-3);
    /// }
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    ///
    /// If there are not as many places as poses, neither body is bounded, or the tolerance or
    /// a pose is NaN or out of range; the error of a pose has its index. On any error no
    /// answer is written.
    pub fn separations(
        &self,
        bodies: [&Shape<D>; 2],
        poses: &[Pose<D>],
        answers: &mut [Option<Certified<Nearest<D>>>],
        goes_on: impl Fn() -> bool + Sync,
    ) -> Result<bool, QueryError> {
        self.batch(bodies, Asked::Separation).run(poses, answers, goes_on)
    }

    /// Whether two bodies overlap with the second at each of `poses`; as
    /// [`Query::separations`], of [`overlap`].
    ///
    /// # Errors
    ///
    /// As of [`Query::separations`].
    pub fn overlaps(
        &self,
        bodies: [&Shape<D>; 2],
        poses: &[Pose<D>],
        answers: &mut [Option<Certified<Nearest<D>>>],
        goes_on: impl Fn() -> bool + Sync,
    ) -> Result<bool, QueryError> {
        self.batch(bodies, Asked::Overlap).run(poses, answers, goes_on)
    }

    /// Casts many rays, as [`Query::separations`] asks about many poses; see [`cast_ray`].
    ///
    /// ```
    /// use palpate_field::Shape;
    /// use palpate_query::{Query, Ray};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let ball = Shape::<2>::circle(0.5)?;
    /// let from_left = |y: f64| Ray::new([-2.0, y], [1.0, 0.0], 5.0);
    /// let rays = [from_left(0.0)?, from_left(0.3)?];
    /// let mut answers = [None; 2];
    /// assert!(Query::new().cast_rays(&ball, &rays, &mut answers, || true)?);
    /// let distances = answers.map(|answer| answer.map_or(f64::NAN, |found| found.upper));
    /// assert!((distances[0] - 1.5).abs() < 1e-4 && (distances[1] - 1.6).abs() < 2e-4);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    ///
    /// If there are not as many places as rays, or the tolerance is negative, NaN or too large. On
    /// any error no answer is written.
    pub fn cast_rays(
        &self,
        shape: &Shape<D>,
        rays: &[Ray<D>],
        answers: &mut [Option<Certified<Option<RayHit<D>>>>],
        goes_on: impl Fn() -> bool + Sync,
    ) -> Result<bool, QueryError> {
        let size = size(shape);
        let limits = |ray: &Ray<D>| self.limits([size, Some(ray.length())]);
        cast_rays(shape, rays, answers, limits, goes_on)
    }

    fn batch<'a>(&'a self, bodies: [&'a Shape<D>; 2], asked: Asked) -> Batch<'a, D> {
        let limits = self.limits(bodies.map(size));
        Batch { bodies, asked, limits, pool: &self.pool }
    }

    /// The limits of a question about bodies of these sizes.
    fn limits(&self, sizes: [Option<f64>; 2]) -> Limits {
        let limits = Limits::new(self.tolerance.for_size(smallest(sizes)));
        self.budget.map_or(limits, |budget| limits.with_budget(budget))
    }

    /// The settings of a sweep of bodies of these sizes.
    fn sweep_settings(&self, sizes: [Option<f64>; 2]) -> SweepSettings {
        let size = smallest(sizes);
        SweepSettings {
            gap: self.tolerance.for_size(size),
            budget: self.budget.unwrap_or(SweepSettings::BUDGET),
            ..SweepSettings::of_size(size)
        }
    }
}

impl<const D: usize> Default for Query<D> {
    fn default() -> Self {
        Self::new()
    }
}

/// The diameter of a shape's box [m]; `None` if it is unbounded.
pub(crate) fn size<const D: usize>(shape: &Shape<D>) -> Option<f64> {
    shape.promise().bounds.map(|bounds| diagonal(&bounds.aabb))
}

fn sizes<const D: usize>(a: &Placed<'_, D>, b: &Placed<'_, D>) -> [Option<f64>; 2] {
    [size(a.shape), size(b.shape)]
}

fn diagonal<const D: usize>(aabb: &Aabb<D>) -> f64 {
    2.0 * aabb.half_extents().norm()
}

fn extent<const N: usize, const D: usize>(element: &Element<N, D>) -> Option<f64> {
    Aabb::around(element.vertices().iter().copied()).map(|aabb| diagonal(&aabb))
}

/// The smaller of the sizes that are positive; zero if none is.
pub(crate) fn smallest(sizes: [Option<f64>; 2]) -> f64 {
    let known = sizes.into_iter().flatten().filter(|size| *size > 0.0);
    known.reduce(f64::min).unwrap_or(0.0)
}

/// Questions that one thread takes at a time: enough that fetching a workspace costs nothing
/// beside them, few enough that threads end together.
const CHUNK: usize = 16;

/// The question about each pose.
#[derive(Clone, Copy, Debug)]
enum Asked {
    Separation,
    Overlap,
}

/// A question about a pair of bodies at many poses.
#[derive(Debug)]
struct Batch<'a, const D: usize> {
    bodies: [&'a Shape<D>; 2],
    asked: Asked,
    limits: Limits,
    pool: &'a Pool<D>,
}

impl<const D: usize> Batch<'_, D> {
    /// Writes the answers for `poses`; `true` if `goes_on` let all be asked.
    fn run(
        &self,
        poses: &[Pose<D>],
        answers: &mut [Option<Certified<Nearest<D>>>],
        goes_on: impl Fn() -> bool + Sync,
    ) -> Result<bool, QueryError> {
        self.check(poses, answers.len())?;
        Ok(share(poses, answers, |poses, answers| {
            self.pool.with(|workspace| {
                fill(poses, answers, &goes_on, |pose| self.ask(pose, workspace));
            });
        }))
    }

    /// Refuses all that a single question would refuse.
    fn check(&self, poses: &[Pose<D>], places: usize) -> Result<(), QueryError> {
        check_places(poses.len(), places)?;
        self.limits.check()?;
        if self.bodies.iter().all(|body| body.promise().bounds.is_none()) {
            return Err(QueryError::Unbounded);
        }
        poses.iter().enumerate().try_for_each(|(i, pose)| check_pose(i, pose))
    }

    fn ask(
        &self,
        pose: &Pose<D>,
        workspace: &mut PairWorkspace<D>,
    ) -> Option<Certified<Nearest<D>>> {
        let [a, b] = self.bodies;
        let b = Placed::new(b, *pose);
        match self.asked {
            Asked::Separation => separation(a, b, &self.limits, workspace),
            Asked::Overlap => overlap(a, b, &self.limits, workspace),
        }
        .ok()
    }
}

/// The first surface along each of many rays; `true` if `goes_on` let all be asked.
fn cast_rays<const D: usize>(
    shape: &Shape<D>,
    rays: &[Ray<D>],
    answers: &mut [Option<Certified<Option<RayHit<D>>>>],
    limits: impl Fn(&Ray<D>) -> Limits + Sync,
    goes_on: impl Fn() -> bool + Sync,
) -> Result<bool, QueryError> {
    check_places(rays.len(), answers.len())?;
    rays.iter().try_for_each(|ray| limits(ray).check())?;
    Ok(share(rays, answers, |rays, answers| {
        fill(rays, answers, &goes_on, |ray| cast_ray(shape, ray, &limits(ray)).ok());
    }))
}

fn check_places(questions: usize, places: usize) -> Result<(), QueryError> {
    if questions == places { Ok(()) } else { Err(QueryError::Places { questions, places }) }
}

/// Asks parts of all questions, on rayon's threads if there are; `true` if all were answered.
fn share<T: Sync, A: Send>(
    all: &[T],
    answers: &mut [Option<A>],
    ask: impl Fn(&[T], &mut [Option<A>]) + Sync,
) -> bool {
    #[cfg(feature = "parallel")]
    let parts = all.par_chunks(CHUNK).zip(answers.par_chunks_mut(CHUNK));
    #[cfg(not(feature = "parallel"))]
    let parts = all.chunks(CHUNK).zip(answers.chunks_mut(CHUNK));
    parts.for_each(|(all, answers)| ask(all, answers));
    answers.iter().all(Option::is_some)
}

/// Asks one question after the other, while `goes_on` says so.
fn fill<T, A>(
    all: &[T],
    answers: &mut [Option<A>],
    goes_on: &impl Fn() -> bool,
    mut ask: impl FnMut(&T) -> Option<A>,
) {
    for (one, answer) in all.iter().zip(answers) {
        *answer = if goes_on() { ask(one) } else { None };
    }
}

/// The workspaces of a query.
#[derive(Debug)]
struct Scratch<const D: usize> {
    pair: Option<Box<PairWorkspace<D>>>,
    sweep: Option<Box<SweepWorkspace<D>>>,
    ball: Option<Box<BallWorkspace<D>>>,
    segments: Option<Box<MeshWorkspace<2, D>>>,
    triangles: Option<Box<MeshWorkspace<3, D>>>,
    moving_segments: Option<Box<ElementSweep<2, D>>>,
    moving_triangles: Option<Box<ElementSweep<3, D>>>,
}

impl<const D: usize> Scratch<D> {
    fn new() -> Self {
        Self {
            pair: None,
            sweep: None,
            ball: None,
            segments: None,
            triangles: None,
            moving_segments: None,
            moving_triangles: None,
        }
    }

    fn pair(&mut self) -> &mut PairWorkspace<D> {
        self.pair.get_or_insert_default()
    }

    fn sweep(&mut self) -> &mut SweepWorkspace<D> {
        self.sweep.get_or_insert_default()
    }

    fn ball(&mut self) -> &mut BallWorkspace<D> {
        self.ball.get_or_insert_default()
    }
}

/// Memory for elements of `N` points: there are segments (2) and triangles (3). A bound of
/// the methods of [`Query`], to be named where code is generic in `N`.
pub trait ElementMemory<const N: usize, const D: usize> {
    /// The memory for these elements and for meshes of them.
    fn elements(&mut self) -> &mut MeshWorkspace<N, D>;

    /// The memory for these elements and for meshes of them while they move.
    fn moving_elements(&mut self) -> &mut ElementSweep<N, D>;
}

impl<const D: usize> ElementMemory<2, D> for Query<D> {
    fn elements(&mut self) -> &mut MeshWorkspace<2, D> {
        self.scratch.segments.get_or_insert_default()
    }

    fn moving_elements(&mut self) -> &mut ElementSweep<2, D> {
        self.scratch.moving_segments.get_or_insert_default()
    }
}

impl<const D: usize> ElementMemory<3, D> for Query<D> {
    fn elements(&mut self) -> &mut MeshWorkspace<3, D> {
        self.scratch.triangles.get_or_insert_default()
    }

    fn moving_elements(&mut self) -> &mut ElementSweep<3, D> {
        self.scratch.moving_triangles.get_or_insert_default()
    }
}

/// How far apart the bounds of an answer may be.
///
/// ```
/// use palpate_query::Tolerance;
///
/// assert_eq!(Tolerance::default(), Tolerance::Relative(1e-4));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Tolerance {
    /// As a share of the size of the smaller body: the diagonal of its box, the length of a
    /// ray, the diameter of a ball. Unbounded bodies have no size; where neither body has
    /// one, the tolerance is zero.
    Relative(f64),
    /// As a length [m].
    Absolute(f64),
}

impl Tolerance {
    /// The tolerance [m] for a smaller body of this size [m].
    #[must_use]
    pub fn for_size(self, size: f64) -> f64 {
        match self {
            Self::Relative(share) => share * size,
            Self::Absolute(length) => length,
        }
    }
}

impl Default for Tolerance {
    /// A ten-thousandth of the smaller body: below what is seen or felt of it.
    fn default() -> Self {
        Self::Relative(1e-4)
    }
}
