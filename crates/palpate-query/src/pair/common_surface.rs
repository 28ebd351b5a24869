// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

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

use palpate_field::{Aabb, Node, Point, Pose, Shape};

use super::body_pair::BodyPair;
use super::distance_bound::DistanceBound;
use crate::larger::larger;

/// No more parts of a body are compared with those of the other.
const MOST_PARTS: usize = 64;

/// Roundings of places and levels, relative to the largest coordinate.
const ROUNDINGS: f64 = 32.0 * f64::EPSILON;

/// A signed and shifted shape of a body's tree.
#[derive(Clone, Copy, Debug)]
struct Term<'a, const D: usize> {
    shape: &'a Shape<D>,
    /// From the frame of the search to the shape's.
    shape_from_frame: Pose<D>,
    is_negative: bool,
    shift: f64,
}

impl<'a, const D: usize> Term<'a, D> {
    fn with(self, shape: &'a Shape<D>) -> Self {
        Self { shape, ..self }
    }

    fn negative(self) -> Self {
        Self { is_negative: !self.is_negative, ..self }
    }

    fn value(&self, p: Point<D>) -> f64 {
        let f = self.shape.distance(self.shape_from_frame.transform_point(p));
        self.shift + if self.is_negative { -f } else { f }
    }
}

/// A lower bound of a body's field: the smallest of all terms, the first of which is looked
/// for in the other body.
#[derive(Clone, Debug)]
struct Part<'a, const D: usize> {
    term: Term<'a, D>,
    others: Vec<Term<'a, D>>,
}

impl<'a, const D: usize> Part<'a, D> {
    /// The part with one term in place of its own, and perhaps more others.
    fn replaced(&self, term: Term<'a, D>, more: impl IntoIterator<Item = Term<'a, D>>) -> Self {
        Self { term, others: self.others.iter().copied().chain(more).collect() }
    }

    /// The parts that follow from the operator of its term.
    fn below(&self) -> Vec<Self> {
        let term = self.term;
        match term.shape.node() {
            Node::Union(of) if term.is_negative => self.any(of.iter().map(|s| term.with(s))),
            Node::Union(of) => self.all(of.iter().map(|s| term.with(s)).collect()),
            Node::Intersection(of) if term.is_negative => {
                self.all(of.iter().map(|s| term.with(s)).collect())
            }
            Node::Intersection(of) => self.any(of.iter().map(|s| term.with(s))),
            Node::Difference(of) => {
                let signed = |(i, shape): (usize, &'a Shape<D>)| {
                    let term = term.with(shape);
                    if i == 0 { term } else { term.negative() }
                };
                let of = of.iter().enumerate().map(signed);
                if term.is_negative { self.all(of.collect()) } else { self.any(of) }
            }
            // A shape that is no bound of the distance to its box grows with its box.
            Node::Offset { distance, of }
                if !term.is_negative || *distance <= 0.0 || of.promise().above_bounds =>
            {
                let moved = if term.is_negative { *distance } else { -*distance };
                let shift = term.shift + moved;
                vec![self.replaced(Term { shift, ..term.with(of) }, [])]
            }
            Node::Placed { pose, of } => {
                let shape_from_frame = pose.inverse() * term.shape_from_frame;
                vec![self.replaced(Term { shape_from_frame, ..term.with(of) }, [])]
            }
            _ => Vec::new(),
        }
    }

    /// Parts of a maximum: at least any of its terms.
    fn any(&self, of: impl Iterator<Item = Term<'a, D>>) -> Vec<Self> {
        of.map(|term| self.replaced(term, [])).collect()
    }

    /// Parts of a minimum: the smallest of its terms.
    fn all(&self, of: Vec<Term<'a, D>>) -> Vec<Self> {
        let without = |i| of.iter().enumerate().filter(move |(j, _)| *j != i).map(|(_, t)| *t);
        (0..of.len()).map(|i| self.replaced(of[i], without(i))).collect()
    }
}

/// The first parts of a body, from its root on.
fn parts<'a, const D: usize>(body: &DistanceBound<'a, D>) -> Vec<Part<'a, D>> {
    let shape_from_frame = body.body_from_frame();
    let root = Term { shape: body.shape, shape_from_frame, is_negative: false, shift: 0.0 };
    let mut found = vec![Part { term: root, others: Vec::new() }];
    let mut next = 0;
    while next < found.len() && found.len() < MOST_PARTS {
        let below = found[next].below();
        found.extend(below);
        next += 1;
    }
    found.truncate(MOST_PARTS);
    found
}

/// A surface that two bodies have in common, with a gap.
#[derive(Debug)]
pub(crate) struct CommonSurface<'a, const D: usize> {
    /// What the larger `g` is at least where the others are no lower [m].
    pub(crate) level: f64,
    /// Of the bodies, with their scales.
    others: Vec<(Term<'a, D>, f64)>,
}

impl<'a, const D: usize> CommonSurface<'a, D> {
    /// The one with the highest level in a box of the frame, of those that are above zero.
    pub(crate) fn of(pair: &BodyPair<'a, D>, aabb: &Aabb<D>) -> Option<Self> {
        let bodies = &pair.bodies;
        if !bodies.iter().all(DistanceBound::is_known_everywhere) {
            return None;
        }
        let [first, second] = [parts(&bodies[0]), parts(&bodies[1])];
        let scales = [0, 1].map(|body| bodies[body].scale());
        let mut best: Option<Self> = None;
        for a in &first {
            for b in second.iter().filter(|b| a.term.is_negative != b.term.is_negative) {
                let least = best.as_ref().map_or(0.0, |best| best.level);
                // Shapes are compared only if that may matter.
                let most = level(a.term.shift + b.term.shift, scales);
                if most > least && a.term.shape == b.term.shape {
                    let level = level(gap(&a.term, &b.term, aabb), scales);
                    if level > least {
                        let of = |part: &Part<'a, D>, scale| {
                            part.others.iter().map(move |term| (*term, scale)).collect()
                        };
                        let mut others: Vec<_> = of(a, scales[0]);
                        others.extend::<Vec<_>>(of(b, scales[1]));
                        best = Some(Self { level, others });
                    }
                }
            }
        }
        best
    }

    /// How many fields a floor evaluates.
    pub(crate) fn evaluations(&self) -> usize {
        self.others.len()
    }

    /// What the larger `g` is at least within `radius` of a point of the frame [m].
    pub(crate) fn floor(&self, p: Point<D>, radius: f64) -> f64 {
        let others = self.others.iter().map(|(term, scale)| {
            let steepness = term.shape.promise().lipschitz.max(1.0);
            scale * (term.value(p) - steepness * radius)
        });
        // Written so that NaN proves nothing.
        others.fold(self.level, |floor, other| if other > floor { floor } else { other })
    }
}

/// The level of two bodies whose terms add up to `gap`.
fn level(gap: f64, [a, b]: [f64; 2]) -> f64 {
    gap * a * b / (a + b)
}

/// What two terms of the same shape and different signs add up to at least, in a box.
fn gap<const D: usize>(a: &Term<'_, D>, b: &Term<'_, D>, aabb: &Aabb<D>) -> f64 {
    let mut apart = 0.0_f64;
    for corner in 0..1_u32 << D {
        let side = |k: usize| if corner >> k & 1 == 0 { aabb.min[k] } else { aabb.max[k] };
        let p = palpate_field::Vector(std::array::from_fn(side));
        let [at_a, at_b] = [a, b].map(|term| term.shape_from_frame.transform_point(p));
        apart = larger((at_a - at_b).norm(), apart);
        apart = larger(ROUNDINGS * (p.norm() + at_a.norm() + at_b.norm()), apart);
    }
    let steepness = a.shape.promise().lipschitz.max(1.0);
    let shift = a.shift + b.shift;
    let rounding = ROUNDINGS * (a.shift.abs() + b.shift.abs());
    shift - rounding - steepness * apart
}
