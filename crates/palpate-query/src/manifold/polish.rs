// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The point of least gap, exactly.
//!
//! A search for the deepest point to a tolerance δ may end √(2Rδ) beside it, where R is the radius of
//! curvature, and its normal is then tilted. Where bodies roll, such a normal pushes them along.
//!
//! # Derivation
//!
//! On the surface `g_a = g_b` between two bodies with unit gradients `n_a` and `n_b`, the gradient of the
//! gap `g_a + g_b` is `n_a + n_b`. It lies in the surface, as `n_a − n_b` is the surface's normal. So the gap
//! is stationary where the gradients are opposite. Newton's method solves `n_a + n_b = 0` there. Its matrix is
//! the curvature of the gap, from differences of the gradients at two close points. Along a principal
//! direction without curvature, as on two flat faces, the gap has no least point: a touch stays where it is
//! along this direction. So it does where the least point is far.

use palpate_field::Vector;

use super::edge::{self, Edge, LOWER};
use super::patch::settled_slopes;
use super::region::distance;
use super::{ManifoldSettings, Touch};
use crate::certified::Goal;
use crate::contact::{Contact, NormalSource};
use crate::pair::body_pair::BodyPair;
use crate::pair::distance_bound::descend;

/// Gradients are opposite if the length of the sum of the unit vectors is at most this.
pub(crate) const OPPOSITE: f64 = 1e-6;

/// The gap falls if the part of the sum along a direction is longer.
pub(super) const SLOPE: f64 = 1e-5;

/// Steps of Newton's method at most.
const STEPS: usize = 8;

/// The distance of the points whose gradients are compared, as a share of the spacing.
pub(super) const PROBE: f64 = 1e-3;

/// A step is good if it leaves no more than this share of the sum.
const GOOD: f64 = 0.25;

/// The gap does not curve along a direction if its radius of curvature is more than so many spacings.
pub(super) const FLAT: f64 = 1e4;

/// Gradients whose sum is longer, 0.8°, may be those of a face and an edge.
const EDGE: f64 = 0.014;

/// Nothing is exact where the gap is larger than so many margins.
const BEYOND: f64 = 1.5;

/// How far a touch moves to where the gap is least, in spacings: the deepest, and another one, which spans
/// the patch.
const DEEPEST_MOVES: f64 = 2.0;
const OTHERS_MOVE: f64 = 0.5;

/// How far a touch may move to where the gap is least [m].
pub(super) fn reach(is_deepest: bool, settings: &ManifoldSettings) -> f64 {
    settings.spacing * if is_deepest { DEEPEST_MOVES } else { OTHERS_MOVE }
}

/// A direction along the surface between two bodies, and how the gap curves along it.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Principal<const D: usize> {
    /// A unit vector.
    direction: Vector<f64, D>,
    /// The second derivative of the gap [1/m].
    curvature: f64,
}

impl<const D: usize> Principal<D> {
    /// Whether the gap has a least point along this direction.
    fn is_curved(&self, settings: &ManifoldSettings) -> bool {
        self.curvature * FLAT * settings.spacing > 1.0
    }
}

/// How the gap curves at a touch: along one direction in the plane, along two in space.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Curvature<const D: usize> {
    most: Principal<D>,
    least: Option<Principal<D>>,
}

/// A touch and the sum of the unit gradients of both bodies there.
#[derive(Clone, Copy, Debug)]
struct Opposed<const D: usize> {
    touch: Touch<D>,
    sum: Vector<f64, D>,
    /// Whether the gap falls to a least point that was not reached.
    is_slope: bool,
}

impl<const D: usize> Curvature<D> {
    /// The curvature at a touch, from gradients next to it.
    fn at(
        pair: &mut BodyPair<'_, D>,
        here: &Opposed<D>,
        settings: &ManifoldSettings,
    ) -> Option<Self> {
        let far = PROBE * settings.spacing;
        // Of both sides the one where the gradients turn less: beyond the other there is an edge.
        let mut change = |way: Vector<f64, D>| {
            let [one, other] = [far, -far].map(|far| {
                let slopes = pair.slopes(here.touch.point + way * far);
                Some((sum(slopes)? - here.sum) * (1.0 / far))
            });
            let (one, other) = (one?, other?);
            Some(if one.dot(one) <= other.dot(other) { one } else { other })
        };
        let one = across(here.touch.normal);
        let by_one = change(one)?;
        if D == 2 {
            let most = Principal { direction: one, curvature: by_one.dot(one) };
            return Some(Self { most, least: None });
        }
        let normal = here.touch.normal.in_space();
        let other: Vector<f64, D> = normal.cross(one.in_space()).truncated();
        let by_other = change(other)?;
        // The eigenvectors of a symmetric matrix of two rows.
        let (xx, yy) = (by_one.dot(one), by_other.dot(other));
        let xy = 0.5 * (by_one.dot(other) + by_other.dot(one));
        let (mean, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
        let spread = half.hypot(xy);
        let angle = 0.5 * xy.atan2(half);
        let (sine, cosine) = angle.sin_cos();
        let most =
            Principal { direction: one * cosine + other * sine, curvature: mean + spread };
        let least =
            Principal { direction: other * cosine - one * sine, curvature: mean - spread };
        Some(Self { most, least: Some(least) })
    }

    /// Whether the gap falls along a direction in which it has a least point.
    fn is_slope(&self, sum: Vector<f64, D>, settings: &ManifoldSettings) -> bool {
        std::iter::once(&self.most).chain(&self.least).any(|principal| {
            principal.is_curved(settings) && sum.dot(principal.direction).abs() > SLOPE
        })
    }

    /// The step of Newton's method, without the directions along which the gap has no least point within
    /// `far` [m].
    fn step(
        &self,
        sum: Vector<f64, D>,
        far: f64,
        settings: &ManifoldSettings,
    ) -> Vector<f64, D> {
        let principals = std::iter::once(&self.most).chain(&self.least);
        let mut step = Vector::ZERO;
        for principal in principals {
            let way = -sum.dot(principal.direction) / principal.curvature;
            if principal.is_curved(settings) && way.abs() <= far {
                step += principal.direction * way;
            }
        }
        step
    }
}

/// A unit vector square to a unit vector.
fn across<const D: usize>(normal: Vector<f64, D>) -> Vector<f64, D> {
    if D == 2 {
        let [x, y, _] = normal.in_space().0;
        return Vector([-y, x, 0.0]).truncated();
    }
    let least = (0..D).fold(0, |k, i| if normal[i].abs() < normal[k].abs() { i } else { k });
    let axis = Vector::<f64, 3>::unit(least);
    let across = normal.in_space().cross(axis);
    (across * (1.0 / across.norm())).truncated()
}

/// The sum of the unit vectors along both gradients.
fn sum<const D: usize>(
    [(_, slope_a), (_, slope_b)]: [(f64, Vector<f64, D>); 2],
) -> Option<Vector<f64, D>> {
    Some(slope_a.normalized()? + slope_b.normalized()?)
}

/// A touch where the gap is least, and its contact, in the pair's frame.
pub(crate) struct Polished<const D: usize> {
    pub(crate) touch: Touch<D>,
    pub(crate) contact: Contact<D>,
    /// The edge of one body that touches a face of the other, if one does.
    pub(crate) edge: Option<Edge<D>>,
    /// Whether the gap falls from here to a least point that is farther than a touch moves: a place of a patch
    /// whose deepest contact is elsewhere.
    pub(crate) is_slope: bool,
}

/// What is known of a touch from an earlier step: it saves evaluations.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Polish<const D: usize> {
    curvature: Option<Curvature<D>>,
    /// Whether neither body has an edge there.
    is_smooth: bool,
}

/// A touch next to `touch` where the gap is least, if there is one within its [`reach`] along the surface
/// between. `None` where the bodies no longer face each other as they did. The function updates `known`.
pub(crate) fn polished<const D: usize>(
    pair: &mut BodyPair<'_, D>,
    touch: &Touch<D>,
    is_deepest: bool,
    known: &mut Polish<D>,
    settings: &ManifoldSettings,
) -> Option<Polished<D>> {
    if touch.source != NormalSource::Gradients {
        return None;
    }
    let far = reach(is_deepest, settings);
    let mut found = opposed(pair, touch, far, &mut known.curvature, settings);
    if found.is_some_and(|found| found.sum.norm() > EDGE) && !is_deepest {
        // From the slope of a valley to its bottom.
        found = opposed(pair, touch, reach(true, settings), &mut known.curvature, settings);
    }
    if let Some(found) = found
        && found.touch.gap >= -settings.margin
        && found.sum.norm() <= EDGE
    {
        return Some(found.on_flat(pair, is_deepest, known, settings));
    }
    if let Some(Opposed { touch, .. }) = found
        && touch.gap > BEYOND * settings.margin
        && !is_deepest
    {
        let contact = Contact::estimated(touch.point, touch.normal, touch.gap);
        return Some(Polished { touch, contact, edge: None, is_slope: true });
    }
    // Next to a corner, the bodies may face each other at no point.
    let here = found
        .map_or_else(|| Touch { gap: pair.gap_at(touch.point), ..*touch }, |found| found.touch);
    let edge = Edge::of(pair, &here, is_deepest, settings);
    // A contact is no less deep than the values say.
    let precise = super::SAME_DEPTH * settings.precision_length();
    let is_deep =
        |edge: &Polished<D>| here.gap >= 0.0 || edge.contact.gap <= here.gap + precise;
    let edge = edge.and_then(|edge| edge.contact(pair, settings)).filter(is_deep);
    let lower = edge.or_else(|| edge::lowest_of_valley(pair, &here, settings).filter(is_deep));
    lower.or_else(|| {
        let is_slope = !is_deepest && here.gap > -settings.margin;
        found.map(|found| Polished { is_slope, ..found.touch.usual(pair, settings) })
    })
}

impl<const D: usize> Opposed<D> {
    /// The contact where gradients are opposite, or nearly so as at a tilted face: there the edge of one body
    /// touches the face of the other.
    fn on_flat(
        self,
        pair: &mut BodyPair<'_, D>,
        is_deepest: bool,
        known: &mut Polish<D>,
        settings: &ManifoldSettings,
    ) -> Polished<D> {
        let Self { touch, sum, is_slope } = self;
        if sum.norm() > OPPOSITE && !known.is_smooth {
            let edge = Edge::of_tilted(pair, &touch, is_deepest, settings);
            let found = edge.and_then(|edge| edge.contact(pair, settings));
            if let Some(found) = found {
                return found;
            }
            known.is_smooth = true;
        }
        let contact = touch.opposed_contact(pair, settings);
        let contact = contact.unwrap_or_else(|| touch.contact_in_frame(pair, settings.spacing));
        let is_slope = is_slope && !is_deepest;
        Polished { touch, contact, edge: None, is_slope }
    }
}

fn opposed<const D: usize>(
    pair: &mut BodyPair<'_, D>,
    touch: &Touch<D>,
    far: f64,
    curvature: &mut Option<Curvature<D>>,
    settings: &ManifoldSettings,
) -> Option<Opposed<D>> {
    let at = |pair: &mut BodyPair<'_, D>, p| {
        let (touch, slopes) = settled_slopes(pair, p, settings.spacing, settings)?;
        Some(Opposed { touch, sum: sum(slopes)?, is_slope: false })
    };
    let mut here = at(pair, touch.point)?;
    if here.touch.normal.dot(touch.normal) <= super::LIKE {
        return None;
    }
    for _ in 0..STEPS {
        if here.sum.norm() <= OPPOSITE {
            break;
        }
        let is_known = curvature.is_some();
        if !is_known {
            *curvature = Curvature::at(pair, &here, settings);
        }
        let Some(known) = curvature else { break };
        let left = far - (here.touch.point - touch.point).norm();
        let step = known.step(here.sum, left, settings);
        // Along the directions that are left out, the sum stays.
        let is_there = step.norm() <= OPPOSITE / known.most.curvature.abs();
        let next = (!is_there).then(|| at(pair, here.touch.point + step)).flatten();
        let is_good = |next: &Opposed<D>| {
            let way = step * (1.0 / step.norm());
            next.sum.dot(way).abs() <= GOOD * here.sum.dot(way).abs()
                && next.sum.norm() <= here.sum.norm()
                && next.touch.normal.dot(touch.normal) > super::LIKE
        };
        match next.filter(is_good) {
            Some(next) => here = next,
            None if is_known => *curvature = None,
            None => break,
        }
    }
    here.is_slope = curvature.is_some_and(|known| known.is_slope(here.sum, settings));
    Some(here)
}

impl<const D: usize> Touch<D> {
    /// The touch as it is found, where it is nowhere exact.
    pub(crate) fn usual(
        &self,
        pair: &mut BodyPair<'_, D>,
        settings: &ManifoldSettings,
    ) -> Polished<D> {
        let along = self.along_surface(pair, settings).unwrap_or(*self);
        let contact = along.contact_in_frame(pair, settings.spacing);
        Polished { touch: *self, contact, edge: None, is_slope: false }
    }

    /// The touch at the deepest point near, where the bodies no longer face each other as they did: edges that
    /// pass each other turn the normal. `None` if there is none near, or no gradient tells the normal.
    pub(crate) fn found_again(
        &self,
        pair: &mut BodyPair<'_, D>,
        settings: &ManifoldSettings,
    ) -> Option<Polished<D>> {
        let goal = Goal::least(super::SAME_DEPTH * settings.precision_length());
        let first = Some(LOWER * settings.spacing);
        let (_, p) = descend(pair, self.point, first, goal, 0.0);
        let touch = Touch::at(pair, p);
        let is_near = distance(p, self.point) <= settings.spacing;
        let is_told = touch.source == NormalSource::Gradients;
        (is_near && is_told).then(|| touch.usual(pair, settings))
    }

    /// The contact of a touch whose gradients are opposite: the points of the surfaces are along the
    /// normal. `None` where a field says otherwise.
    fn opposed_contact(
        &self,
        pair: &mut BodyPair<'_, D>,
        settings: &ManifoldSettings,
    ) -> Option<Contact<D>> {
        let precise = super::SAME_DEPTH * settings.precision_length();
        let half = self.normal * (0.5 * self.gap);
        let mut points = [self.point - half, self.point + half];
        for (body, p) in points.iter_mut().enumerate() {
            let (value, slope) = pair.slope(body, *p);
            let squared = slope.dot(slope);
            if value.abs() > precise || squared == 0.0 {
                return None;
            }
            *p -= slope * (value / squared);
        }
        Some(Contact::new(points[0], points[1], self.normal))
    }
}
