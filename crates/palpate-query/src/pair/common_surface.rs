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

use palpate_field::{Aabb, Node, Point, Pose, Shape, Vector};

use super::body_pair::BodyPair;
use super::distance_bound::DistanceBound;
use crate::larger::larger;

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
