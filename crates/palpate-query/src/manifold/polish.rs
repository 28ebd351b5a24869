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

use palpate_field::{Point, Vector};

use super::patch::{self, settled_slopes};
use super::region::distance;
use super::{ManifoldSettings, Touch};
use crate::certified::Goal;
use crate::contact::{Contact, NormalSource};
use crate::pair::body_pair::BodyPair;
use crate::pair::distance_bound::descend;

/// Gradients are opposite if the length of the sum of the unit vectors is at most this.
pub(crate) const OPPOSITE: f64 = 1e-6;

/// Steps of Newton's method at most.
const STEPS: usize = 8;

/// The distance of the points whose gradients are compared, as a share of the spacing.
const PROBE: f64 = 1e-3;

/// A step is good if it leaves no more than this share of the sum.
const GOOD: f64 = 0.25;

/// The gap does not curve along a direction if its radius of curvature is more than so many spacings.
const FLAT: f64 = 1e4;

/// Gradients whose sum is longer, 0.8°, may be those of a face and an edge.
const EDGE: f64 = 0.014;

/// Nothing is exact where the gap is larger than so many margins.
const BEYOND: f64 = 1.5;

/// The first step to the lowest point of an edge, in spacings.
const LOWER: f64 = 0.25;

/// An edge is steep if it leads down by more than this share of the way, 6°.
const STEEP: f64 = 0.1;

/// How far a touch moves to where the gap is least, in spacings: the deepest, and another one, which spans
/// the patch.
const DEEPEST_MOVES: f64 = 2.0;
const OTHERS_MOVE: f64 = 0.5;

/// How far a touch may move to where the gap is least [m].
pub(crate) fn reach(is_deepest: bool, settings: &ManifoldSettings) -> f64 {
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
}

impl<const D: usize> Curvature<D> {
    /// The curvature at a touch, from gradients next to it.
    fn at(
        pair: &mut BodyPair<'_, D>,
        here: &Opposed<D>,
        settings: &ManifoldSettings,
    ) -> Option<Self> {
        let far = PROBE * settings.spacing;
        let mut change = |way: Vector<f64, D>| {
            let slopes = pair.slopes(here.touch.point + way * far);
            Some((sum(slopes)? - here.sum) * (1.0 / far))
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
        for Principal { direction, curvature } in principals {
            let way = -sum.dot(*direction) / curvature;
            if curvature * FLAT * settings.spacing > 1.0 && way.abs() <= far {
                step += *direction * way;
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
}

/// A touch next to `touch` where the gap is least, if there is one within `far` [m] along the surface
/// between. `None` where the bodies do not face each other as they did. A known `curvature` saves evaluations,
/// and the new one replaces it.
pub(crate) fn polished<const D: usize>(
    pair: &mut BodyPair<'_, D>,
    touch: &Touch<D>,
    far: f64,
    curvature: &mut Option<Curvature<D>>,
    settings: &ManifoldSettings,
) -> Option<Polished<D>> {
    if touch.source != NormalSource::Gradients {
        return None;
    }
    let found = opposed(pair, touch, far, curvature, settings);
    if let Some(Opposed { touch, sum }) = found
        && touch.gap >= -settings.margin
        && sum.norm() <= EDGE
    {
        let contact = touch.opposed_contact(pair, settings);
        let contact = contact.unwrap_or_else(|| touch.contact_in_frame(pair, settings.spacing));
        return Some(Polished { touch, contact, edge: None });
    }
    let is_deepest = far > OTHERS_MOVE * settings.spacing;
    if let Some(Opposed { touch, .. }) = found
        && touch.gap > BEYOND * settings.margin
        && !is_deepest
    {
        let contact = Contact::estimated(touch.point, touch.normal, touch.gap);
        return Some(Polished { touch, contact, edge: None });
    }
    // Next to a corner, the bodies may face each other at no point.
    let here = found
        .map_or_else(|| Touch { gap: pair.gap_at(touch.point), ..*touch }, |found| found.touch);
    let edge = Edge::of(pair, &here, far, settings);
    // A contact is no less deep than the values say.
    let precise = super::SAME_DEPTH * settings.precision_length();
    let is_deep =
        |edge: &Polished<D>| here.gap >= 0.0 || edge.contact.gap <= here.gap + precise;
    edge.and_then(|edge| edge.contact(pair, settings))
        .filter(is_deep)
        .or_else(|| found.map(|found| found.touch.usual(pair, settings)))
}

/// A point of an edge of one body that touches a face of the other: it stays where it is in its body.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Edge<const D: usize> {
    body: usize,
    /// In coordinates of that body.
    point: Point<D>,
    /// From the first body to the second, in the first one's coordinates.
    normal: Vector<f64, D>,
}

impl<const D: usize> Edge<D> {
    /// The edge at a touch: of the body that has one, if the other has a face there, else of the body that
    /// lies deeper in the other.
    fn of(
        pair: &mut BodyPair<'_, D>,
        touch: &Touch<D>,
        far: f64,
        settings: &ManifoldSettings,
    ) -> Option<Self> {
        let slopes = pair.slopes(touch.point);
        if let Some(face) = pair.face(touch.point, slopes) {
            return Self::on(pair, face.body, touch, (far, settings)).map(|(_, edge)| edge);
        }
        let edges = [0, 1].map(|face| Self::on(pair, face, touch, (far, settings)));
        let deeper = edges.into_iter().flatten().min_by(|one, other| one.0.total_cmp(&other.0));
        deeper.map(|(_, edge)| edge)
    }

    /// The edge of one body on a face of the other at a touch, and its height above it [m]: the lowest
    /// point, if it is within `far` [m] and the way there leads down steeply, or the touch is the deepest; else
    /// the point next to the touch.
    fn on(
        pair: &mut BodyPair<'_, D>,
        face: usize,
        touch: &Touch<D>,
        (far, settings): (f64, &ManifoldSettings),
    ) -> Option<(f64, Self)> {
        let body = 1 - face;
        let next = pair.surface_point(body, touch.point);
        let near = settings.spacing.max(touch.gap.abs());
        let start = next.filter(|p| distance(*p, touch.point) <= near)?;
        let at_start = pair.slope(face, start);
        let first = LOWER * settings.spacing;
        let precise = super::SAME_DEPTH * settings.precision_length();
        let (lowest, at_lowest) = patch::lowest(pair, face, (start, first), precise);
        let way = distance(lowest, start);
        let is_far = way > far || at_start.0 - at_lowest.0 < STEEP * way;
        let is_deepest = far > OTHERS_MOVE * settings.spacing;
        let (p, (height, slope)) =
            if is_far && !is_deepest { (start, at_start) } else { (lowest, at_lowest) };
        let outwards = slope.normalized()?;
        let normal = if face == 0 { outwards } else { -outwards };
        let point = if body == 0 { p } else { pair.second_from_frame.transform_point(p) };
        Some((height, Self { body, point, normal }))
    }

    /// The contact of the edge where both bodies are now. `None` where the other body no longer faces it as
    /// it did.
    pub(crate) fn contact(
        &self,
        pair: &mut BodyPair<'_, D>,
        settings: &ManifoldSettings,
    ) -> Option<Polished<D>> {
        let edge = if self.body == 0 {
            self.point
        } else {
            pair.second_from_frame.inverse().transform_point(self.point)
        };
        let (value, slope) = pair.slope(1 - self.body, edge);
        let outwards = slope.normalized()?;
        let normal = if self.body == 0 { -outwards } else { outwards };
        if normal.dot(self.normal) < super::LIKE || value.abs() > settings.spacing {
            return None;
        }
        let face = edge - outwards * (value / slope.norm());
        let [a, b] = if self.body == 0 { [edge, face] } else { [face, edge] };
        let contact = Contact::new(a, b, normal);
        let touch = Touch {
            point: (a + b) * 0.5,
            normal,
            gap: contact.gap,
            source: NormalSource::Gradients,
        };
        Some(Polished { touch, contact, edge: Some(*self) })
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
        Some(Opposed { touch, sum: sum(slopes)? })
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
        Polished { touch: *self, contact, edge: None }
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
