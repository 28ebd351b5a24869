// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Two bodies as a search sees them.
//!
//! Bodies made with the same shape: a pin and the hole that an offset of the pin leaves.
//!
//! Over the whole of such a surface both bodies are equally near, so a search would have to
//! prove it free in boxes that are small against the gap. But where one field is at least
//! `f + α` and the other at least `β − f`, with the same f, one of both is at least
//! `(α + β)/2`, wherever it is and however f bends.
//!
//! # Derivation
//!
//! A body's field is at least the smaller of `σ·f + α`, with a sign σ and a shape f of its
//! tree, and of other shapes of the tree. This holds for the whole body with σ = 1 and α = 0;
//! and downwards in the tree, as long as a node is a minimum or maximum, an offset or a motion:
//! a maximum is at least any of its parts, a minimum the smallest of all, and a negative sign
//! exchanges them. With `gₐ ≥ sₐ(f + α)`, where sₐ is the body's scale, the mean of both, in
//! which f cancels, is `(α + β)·sₐs_b/(sₐ + s_b)`. Where the copies of f are moved against each
//! other by up to δ, it is less by the steepness of f times δ.
//!
//! So a box in which the other shapes are higher than this level holds nothing below it.

use palpate_field::scalar::Model;
use palpate_field::{Aabb, BLOCK, Block, Column, Gradients, Node, Point, Pose, Shape, Vector};

use super::distance_bound::DistanceBound;
use super::search::BoxCell;
use crate::error::QueryError;
use crate::sampler::{Placed, check_pose, larger, normal};

/// Roundings of a pose from one body to another, relative to where they are in the world.
const PLACE_ROUNDINGS: f64 = 8.0;

/// Pairs of points of two bodies, each nearest to the last one of the other, from one place.
const APPROACHES: u32 = 16;

/// Memory of questions to two bodies.
#[derive(Debug)]
pub(crate) struct Memory<const D: usize> {
    locals: [[Point<D>; BLOCK]; 2],
    points: Block<f64, D, BLOCK>,
    boxes: Block<Model, D, BLOCK>,
    values: Column<f64, BLOCK>,
    slopes: Gradients<f64, D, BLOCK>,
    models: [Column<Model, BLOCK>; 2],
}

impl<const D: usize> Memory<D> {
    pub(crate) fn new() -> Self {
        Self {
            locals: [[Vector::ZERO; BLOCK]; 2],
            points: Block::zero(),
            boxes: Block::zero(),
            values: Column::zero(),
            slopes: Gradients::zero(),
            models: [Column::zero(), Column::zero()],
        }
    }

    /// The centre of a box, in coordinates of the body that was asked there just before.
    #[inline]
    pub(crate) fn local(&self, body: usize, i: usize) -> Point<D> {
        self.locals[body][i]
    }

    /// Moves the entry of one box to another lane.
    #[inline]
    pub(crate) fn keep(&mut self, body: usize, from: usize, to: usize) {
        self.locals[body][to] = self.locals[body][from];
    }
}

/// `g` of both bodies and its gradients.
pub(crate) type Slopes<const D: usize> = [(f64, Vector<f64, D>); 2];

/// Two bodies in the frame of the first: bounds of the first body over boxes stay valid while both move.
#[derive(Clone, Copy)]
pub(crate) struct BodyPair<'a, const D: usize> {
    pub(crate) bodies: [DistanceBound<'a, D>; 2],
    /// Boxes of the frame that hold the bodies; one of them at least is there.
    aabbs: [Option<Aabb<D>>; 2],
    pub(crate) world_from_frame: Pose<D>,
    /// From the frame to the second shape's coordinates.
    pub(crate) second_from_frame: Pose<D>,
    /// The rounding of the second body's pose in the frame where both bodies are far from the
    /// world's origin [m].
    placing: f64,
    /// A gradient counts twice.
    pub(crate) evaluations: u32,
}

impl<'a, const D: usize> BodyPair<'a, D> {
    #[inline(never)]
    pub(crate) fn new(a: Placed<'a, D>, b: Placed<'a, D>) -> Result<Self, QueryError> {
        check_pose(0, &a.world_from_body)?;
        check_pose(1, &b.world_from_body)?;
        let second_from_frame = b.world_from_body.inverse() * a.world_from_body;
        let bodies = [
            DistanceBound::new(a.shape, Pose::identity()),
            DistanceBound::new(b.shape, second_from_frame),
        ];
        let aabbs = bodies.map(|body| body.aabb());
        if aabbs == [None, None] {
            return Err(QueryError::Unbounded);
        }
        let world_from_frame = a.world_from_body;
        let far = a.world_from_body.translation.norm() + b.world_from_body.translation.norm();
        let placing = PLACE_ROUNDINGS * f64::EPSILON * far;
        Ok(Self { bodies, aabbs, world_from_frame, second_from_frame, placing, evaluations: 0 })
    }

    /// The rounding of values within `reach` of the frame's origin [m].
    pub(crate) fn slack(&self, reach: f64) -> f64 {
        self.bodies[0].slack(reach).max(self.bodies[1].slack(reach)) + self.placing
    }

    /// `g` of both at a point of the frame, with gradients.
    #[inline]
    pub(crate) fn slopes(&mut self, p: Point<D>) -> Slopes<D> {
        [self.slope(0, p), self.slope(1, p)]
    }

    /// `g` of one body at a point of the frame, with its gradient.
    #[inline]
    pub(crate) fn slope(&mut self, body: usize, p: Point<D>) -> (f64, Vector<f64, D>) {
        self.evaluations += 2;
        self.bodies[body].distance_gradient(p)
    }

    /// The separation that the values at a point of the frame show: twice the larger `g` [m].
    pub(crate) fn gap_at(&mut self, p: Point<D>) -> f64 {
        self.evaluations += 2;
        let [a, b] = [0, 1].map(|i| {
            let body = &self.bodies[i];
            let local = body.local(p);
            body.value(local, body.shape.distance(local))
        });
        2.0 * larger(a, b)
    }

    /// A point of a body's surface near a point of the frame, in the frame.
    pub(crate) fn surface_point(&self, body: usize, p: Point<D>) -> Option<Point<D>> {
        let body = &self.bodies[body];
        Some(body.in_frame(body.shape.surface_point(body.local(p))?))
    }

    /// An upper bound of the bodies' distance [m]: that of their separation, where it bounds the distance, else
    /// the distance of two points of the bodies found near `places` of the frame. Ends at the first of at
    /// most `enough`; infinite if none is found.
    pub(crate) fn distance_at_most(
        &self,
        upper: f64,
        places: impl IntoIterator<Item = Point<D>>,
        enough: f64,
    ) -> f64 {
        if upper <= 0.0 {
            return 0.0;
        }
        if self.bodies.iter().all(DistanceBound::is_exact_outside) {
            return upper;
        }
        let mut least = f64::INFINITY;
        for place in places {
            let points = [0, 1].map(|body| self.bodies[body].point_within(place));
            let [Some(mut a), Some(mut b)] = points else { continue };
            let mut last = f64::INFINITY;
            for _ in 0..APPROACHES {
                // Each of the points is within two roundings of its body.
                let distance = (a - b).norm() + 4.0 * self.slack(a.norm().max(b.norm()));
                least = least.min(distance);
                if least <= enough {
                    return least;
                }
                let is_nearer = distance < last;
                let (Some(to_b), true) = (self.bodies[0].point_within(b), is_nearer) else {
                    break;
                };
                last = distance;
                let Some(to_a) = self.bodies[1].point_within(to_b) else { break };
                (a, b) = (to_b, to_a);
            }
        }
        least
    }

    /// The longest side of the smaller of the bodies' boxes [m].
    pub(crate) fn smaller_size(&self) -> f64 {
        let size = |aabb: &Aabb<D>| {
            (0..D).fold(0.0_f64, |longest, k| longest.max(aabb.max[k] - aabb.min[k]))
        };
        self.aabbs.iter().flatten().map(size).fold(f64::INFINITY, f64::min)
    }

    /// From the middle of the first body's box to that of the second's; zero if one has
    /// none.
    pub(crate) fn between_centres(&self) -> Vector<f64, D> {
        match self.aabbs {
            [Some(a), Some(b)] => b.centre() - a.centre(),
            _ => Vector::ZERO,
        }
    }

    /// `g` of one body at the centres of cells.
    pub(crate) fn values(
        &mut self,
        body: usize,
        cells: &[BoxCell<D>],
        memory: &mut Memory<D>,
        values: &mut [f64; BLOCK],
    ) {
        self.evaluations += cells.len() as u32;
        let (body, locals) = (&self.bodies[body], &mut memory.locals[body]);
        for (cell, local) in cells.iter().zip(&mut *locals) {
            *local = body.local(cell.centre);
        }
        memory.points.fill(cells.len(), |i| locals[i]);
        body.shape.block_distances(&memory.points, cells.len(), &mut memory.values);
        let found = locals[..cells.len()].iter().zip(memory.values.as_slice());
        for ((local, f), value) in found.zip(values) {
            *value = body.value(*local, *f);
        }
    }

    /// `g` of both at points, with gradients.
    pub(crate) fn block_slopes(
        &mut self,
        points: &[Point<D>],
        memory: &mut Memory<D>,
        slopes: &mut [[(f64, Vector<f64, D>); BLOCK]; 2],
    ) {
        self.evaluations += 4 * points.len() as u32;
        for (body, slopes) in self.bodies.iter().zip(slopes) {
            memory.points.fill(points.len(), |i| body.local(points[i]));
            body.shape.block_gradients(&memory.points, points.len(), &mut memory.slopes);
            for (i, slope) in slopes[..points.len()].iter_mut().enumerate() {
                let local = memory.points.get(i);
                let (f, gradient) =
                    (memory.slopes.distance.get(i), memory.slopes.gradient.get(i));
                *slope = body.slope_of(local, f, gradient);
            }
        }
    }

    /// What `g` of one body is at least within `radius` of a point in its coordinates, where it
    /// is `value`.
    #[inline]
    pub(crate) fn floor(&self, body: usize, local: Point<D>, value: f64, radius: f64) -> f64 {
        self.bodies[body].floor(local, value, radius)
    }

    /// Keeps of the cells, asked for their values just before, those that `open` names in
    /// which both fields are known to be as steep as promised.
    pub(crate) fn keep_known(
        &self,
        cells: &[BoxCell<D>],
        open: &mut Vec<usize>,
        memory: &Memory<D>,
    ) {
        for (body, locals) in self.bodies.iter().zip(&memory.locals) {
            if !body.is_known_everywhere() {
                open.retain(|&i| body.is_known(locals[i], cells[i].radius()));
            }
        }
    }

    /// Models of one body over those of the cells, asked for their values just before,
    /// that `open` names.
    pub(crate) fn models(
        &mut self,
        body: usize,
        cells: &[BoxCell<D>],
        open: &[usize],
        memory: &mut Memory<D>,
    ) {
        if open.is_empty() {
            return;
        }
        self.evaluations += open.len() as u32;
        let (locals, models) = (&memory.locals[body], &mut memory.models[body]);
        let body = &self.bodies[body];
        memory.boxes.fill_boxes(open.len(), body.turn(), |lane| {
            let i = open[lane];
            (locals[i], cells[i].half)
        });
        body.shape.block_distances(&memory.boxes, open.len(), models);
    }

    /// The model of `f/L` of one body in a lane.
    #[inline]
    pub(crate) fn model(&self, body: usize, memory: &Memory<D>, lane: usize) -> Model {
        self.bodies[body].scaled(memory.models[body].get(lane))
    }

    /// Boxes of the frame that hold the bodies; one of them at least is there.
    pub(crate) fn boxes(&self) -> &[Option<Aabb<D>>; 2] {
        &self.aabbs
    }

    /// A box of the frame that holds all points at which both `g` are at most `least`.
    pub(crate) fn root(&self, least: f64) -> Aabb<D> {
        let grown = self.aabbs.iter().flatten().map(|aabb| aabb.grown(least));
        let nowhere = Aabb { min: Vector::ZERO, max: Vector::ZERO };
        grown.reduce(|a, b| common(&a, &b)).unwrap_or(nowhere)
    }

    /// The part of a box of the frame in which the second body's own box, grown by `least`,
    /// leaves room for such points.
    pub(crate) fn tightened(&self, root: &Aabb<D>, least: f64) -> Aabb<D> {
        self.bodies[1].tightened(root, least).unwrap_or(*root)
    }

    /// How far the boxes of both bodies are apart along a side of either, if they are [m].
    pub(crate) fn gap_of_boxes(&self) -> Option<f64> {
        let inside_out = |both: Aabb<D>| {
            (0..D).fold(f64::NEG_INFINITY, |gap, k| gap.max(both.min[k] - both.max[k]))
        };
        let [Some(a), Some(b)] = self.aabbs else { return None };
        let mut gap = inside_out(common(&a, &b));
        if let Some(second) = self.bodies[1].own_box() {
            gap = gap.max(inside_out(common(&a.placed(&self.second_from_frame), &second)));
        }
        (gap > 0.0).then_some(gap)
    }
}

/// The intersection of two boxes; its corners are swapped along sides where they are apart.
pub(crate) fn common<const D: usize>(a: &Aabb<D>, b: &Aabb<D>) -> Aabb<D> {
    let mut both = *a;
    for k in 0..D {
        both.min[k] = a.min[k].max(b.min[k]);
        both.max[k] = a.max[k].min(b.max[k]);
    }
    both
}

/// The cosine from which on gradients count as opposite, 0.8°.
const OPPOSITE: f64 = 0.9999;

/// The cosine from which on the gradients of a face count as one, 8°.
const ALIKE: f64 = 0.99;

/// The cosine below which a gradient has turned as at an edge, 26°.
const TURNED: f64 = 0.9;

/// How far around a point a body is asked for edges, as a share of the smaller body; twice the gap
/// where that is more.
const AROUND: f64 = 1e-4;

/// A face of one body at which the other has an edge or a corner.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Face<const D: usize> {
    /// The body that has the face.
    pub(crate) body: usize,
    /// The unit vector from the first body to the second.
    pub(crate) normal: Vector<f64, D>,
}

impl<const D: usize> BodyPair<'_, D> {
    /// The normal at a point between the bodies, and the values of both there [m]. `None` where the
    /// gradients of both are equal or vanish.
    pub(crate) fn normal(&mut self, p: Point<D>) -> (Option<Vector<f64, D>>, [f64; 2]) {
        let slopes = self.slopes(p);
        let [(a, slope_a), (b, slope_b)] = slopes;
        let face = self.face(p, slopes).map(|face| face.normal);
        (face.or_else(|| normal(slope_a - slope_b)), [a, b])
    }

    /// The face at a point with these slopes, if one of the bodies alone has an edge there: at an
    /// edge the gradient may point along the normal of either adjacent face.
    pub(crate) fn face(
        &mut self,
        p: Point<D>,
        [(a, slope_a), (b, slope_b)]: [(f64, Vector<f64, D>); 2],
    ) -> Option<Face<D>> {
        let units = [normal(slope_a)?, normal(slope_b)?];
        if units[0].dot(units[1]) < -OPPOSITE {
            return None;
        }
        let far = (4.0 * a.max(b).abs()).max(AROUND * self.smaller_size());
        match self.body_with_edge_near(p, units, far)? {
            1 => Some(Face { body: 0, normal: units[0] }),
            _ => Some(Face { body: 1, normal: -units[1] }),
        }
    }

    /// The one body that has an edge within `far` [m] of a point with these slopes, where the other has a
    /// face.
    pub(crate) fn body_with_edge(
        &mut self,
        p: Point<D>,
        [(_, slope_a), (_, slope_b)]: Slopes<D>,
        far: f64,
    ) -> Option<usize> {
        self.body_with_edge_near(p, [normal(slope_a)?, normal(slope_b)?], far)
    }

    fn body_with_edge_near(
        &mut self,
        p: Point<D>,
        units: [Vector<f64, D>; 2],
        far: f64,
    ) -> Option<usize> {
        let mut least = [1.0_f64; 2];
        for k in 0..D {
            for side in [-far, far] {
                let around = self.slopes(p + Vector::unit(k) * side);
                for body in 0..2 {
                    let cosine = normal(around[body].1).map_or(-1.0, |u| u.dot(units[body]));
                    least[body] = least[body].min(cosine);
                }
            }
        }
        let is_face = |body: usize| least[body] > ALIKE && least[1 - body] < TURNED;
        match [is_face(0), is_face(1)] {
            [true, _] => Some(1),
            [_, true] => Some(0),
            _ => None,
        }
    }
}

/// No more parts of a body are compared with those of the other.
const MOST_PARTS: usize = 64;

/// With more other shapes, a box is bounded as fast by the bodies themselves.
const MOST_OTHERS: usize = 16;

/// Roundings of places and levels, relative to the largest coordinate.
const ROUNDINGS: f64 = 32.0 * f64::EPSILON;

/// A signed and shifted shape of a body's tree, times the body's scale.
#[derive(Clone, Copy, Debug)]
struct Term<'a, const D: usize> {
    shape: &'a Shape<D>,
    /// From the frame of the search to the shape's.
    shape_from_frame: Pose<D>,
    is_negative: bool,
    shift: f64,
    scale: f64,
}

impl<'a, const D: usize> Term<'a, D> {
    fn of_body(body: &DistanceBound<'a, D>) -> Self {
        Self {
            shape: body.shape,
            shape_from_frame: body.body_from_frame(),
            is_negative: false,
            shift: 0.0,
            scale: body.scale(),
        }
    }

    /// `true` if it is the smallest of its children; otherwise it is at least any of them.
    fn is_smallest(&self) -> bool {
        match self.shape.node() {
            Node::Union(_) => !self.is_negative,
            Node::Intersection(_) | Node::Difference(_) => self.is_negative,
            _ => false,
        }
    }

    /// The term of the child `i` of its shape.
    fn child(&self, i: usize) -> Option<Self> {
        match self.shape.node() {
            Node::Union(of) | Node::Intersection(of) => {
                Some(Self { shape: of.get(i)?, ..*self })
            }
            Node::Difference(of) => {
                let is_negative = self.is_negative != (i > 0);
                Some(Self { shape: of.get(i)?, is_negative, ..*self })
            }
            // A shape whose value may be less than the distance to its box grows with its box.
            Node::Offset { distance, of }
                if i == 0
                    && (!self.is_negative || *distance <= 0.0 || of.promise().above_bounds) =>
            {
                let moved = if self.is_negative { *distance } else { -*distance };
                Some(Self { shape: of, shift: self.shift + moved, ..*self })
            }
            Node::Placed { pose, of } if i == 0 => {
                let shape_from_frame = pose.inverse() * self.shape_from_frame;
                Some(Self { shape: of, shape_from_frame, ..*self })
            }
            _ => None,
        }
    }

    fn value(&self, p: Point<D>) -> f64 {
        let f = self.shape.distance(self.shape_from_frame.transform_point(p));
        self.scale * (self.shift + if self.is_negative { -f } else { f })
    }

    fn steepness(&self) -> f64 {
        self.shape.promise().lipschitz.max(1.0)
    }
}

/// A term of a body's tree, and where it is there.
#[derive(Clone, Copy, Debug)]
struct Part<'a, const D: usize> {
    term: Term<'a, D>,
    /// The place of the part above it, and which child of that it is.
    above: Option<[usize; 2]>,
}

/// The first terms of a body's tree, each after that above it.
struct Parts<'a, const D: usize> {
    parts: [Part<'a, D>; MOST_PARTS],
    count: usize,
}

impl<'a, const D: usize> Parts<'a, D> {
    fn of(body: &DistanceBound<'a, D>) -> Self {
        let root = Part { term: Term::of_body(body), above: None };
        let mut all = Self { parts: [root; MOST_PARTS], count: 1 };
        let mut next = 0;
        while next < all.count {
            let term = all.parts[next].term;
            let children = (0..MOST_PARTS - all.count).map_while(|i| Some((i, term.child(i)?)));
            for (i, term) in children {
                all.parts[all.count] = Part { term, above: Some([next, i]) };
                all.count += 1;
            }
            next += 1;
        }
        all
    }

    fn iter(&self) -> impl Iterator<Item = &Part<'a, D>> {
        self.parts[..self.count].iter()
    }

    /// The other terms: the body's field is at least the smallest of them and of the part's.
    fn others(&self, part: &Part<'a, D>) -> impl Iterator<Item = Term<'a, D>> {
        let up = std::iter::successors(part.above, |[place, _]| self.parts[*place].above);
        let smallest = up.filter(|[place, _]| self.parts[*place].term.is_smallest());
        smallest.flat_map(move |[place, child]| {
            let all = (0..).map_while(move |i| Some((i, self.parts[place].term.child(i)?)));
            all.filter(move |(i, _)| *i != child).map(|(_, term)| term)
        })
    }
}

/// A surface that two bodies have in common, with a gap.
#[derive(Debug)]
pub(crate) struct CommonSurface<'a, const D: usize> {
    /// What the larger `g` is at least where the others are no lower [m].
    pub(crate) level: f64,
    others: [Option<Term<'a, D>>; MOST_OTHERS],
}

impl<'a, const D: usize> CommonSurface<'a, D> {
    /// The one with the highest level in a box of the frame, of those that are above zero.
    pub(crate) fn of(pair: &BodyPair<'a, D>, aabb: &Aabb<D>) -> Option<Self> {
        let bodies = &pair.bodies;
        if !bodies.iter().all(DistanceBound::is_known_everywhere) {
            return None;
        }
        let [first, second] = [Parts::of(&bodies[0]), Parts::of(&bodies[1])];
        let mut best: Option<Self> = None;
        for a in first.iter() {
            let opposite = |b: &&Part<'a, D>| a.term.is_negative != b.term.is_negative;
            for b in second.iter().filter(opposite) {
                let least = best.as_ref().map_or(0.0, |best| best.level);
                // Shapes are compared only if that may matter.
                if a.term.shift + b.term.shift <= least || a.term.shape != b.term.shape {
                    continue;
                }
                let level = level(&a.term, &b.term, aabb);
                if level > least {
                    let others = first.others(a).chain(second.others(b));
                    best = with_others(level, others).or(best);
                }
            }
        }
        best
    }

    fn others(&self) -> impl Iterator<Item = &Term<'a, D>> {
        self.others.iter().flatten()
    }

    /// How many fields a floor evaluates.
    pub(crate) fn evaluations(&self) -> usize {
        self.others().count()
    }

    /// What the larger `g` is at least within `radius` of a point of the frame [m].
    pub(crate) fn floor(&self, p: Point<D>, radius: f64) -> f64 {
        let others = self.others().map(|term| {
            // No steeper than the body, whose scale it has.
            term.value(p) - radius * larger(term.scale * term.steepness(), 1.0)
        });
        // NaN proves nothing, wherever it stands.
        others.fold(self.level, |floor, other| {
            if other.is_nan() {
                f64::NEG_INFINITY
            } else {
                if other > floor { floor } else { other }
            }
        })
    }
}

/// A surface with a level and all `others`, if there is room for them.
fn with_others<'a, const D: usize>(
    level: f64,
    others: impl Iterator<Item = Term<'a, D>>,
) -> Option<CommonSurface<'a, D>> {
    let mut all = CommonSurface { level, others: [None; MOST_OTHERS] };
    for (i, term) in others.enumerate() {
        *all.others.get_mut(i)? = Some(term);
    }
    Some(all)
}

/// The level of two terms of the same shape and different signs, in a box.
fn level<const D: usize>(a: &Term<'_, D>, b: &Term<'_, D>, aabb: &Aabb<D>) -> f64 {
    let (mut apart, mut farthest) = (0.0_f64, 0.0_f64);
    for corner in 0..1_u32 << D {
        let side = |k: usize| if corner >> k & 1 == 0 { aabb.min[k] } else { aabb.max[k] };
        let p: Point<D> = Vector(std::array::from_fn(side));
        let [at_a, at_b] = [a, b].map(|term| term.shape_from_frame.transform_point(p));
        // The distance between the two places is convex, so it is largest at a corner.
        apart = larger((at_a - at_b).norm(), apart);
        farthest = larger(p.norm() + at_a.norm() + at_b.norm(), farthest);
    }
    // Roundings of nested motions and offsets that cancel are in the slack of the search.
    apart += ROUNDINGS * farthest;
    let rounding = ROUNDINGS * (a.shift.abs() + b.shift.abs());
    let gap = a.shift + b.shift - rounding - a.steepness() * apart;
    gap * a.scale * b.scale / (a.scale + b.scale)
}
