// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The edge of one body on a face of the other.

use palpate_field::{Point, Vector};

use super::patch;
use super::polish::{FLAT, OPPOSITE, PROBE, Polished, SLOPE, reach};
use super::region::distance;
use super::{ManifoldSettings, Touch};
use crate::contact::{Contact, NormalSource};
use crate::pair::body_pair::BodyPair;

/// The first step to the lowest point of an edge, in spacings.
pub(super) const LOWER: f64 = 0.25;

/// The precision of the lowest point of an edge, as a share of [`ManifoldSettings::precision_length`].
const LOWEST: f64 = 1e-5;

/// An edge is near a touch of nearly parallel faces within so many spacings.
const NEAR: f64 = 0.15;

/// An edge is steep if it leads down by more than this share of the way, 6°.
const STEEP: f64 = 0.1;

/// The point of a body that is nearest to another one is tested from so many spacings below it. Its gradient
/// there leads away from it, to this cosine.
const BELOW: f64 = 0.01;
const NEAREST: f64 = 1.0 - 1e-6;

/// The way down is tried at these shares of the reach, and then halved so many times.
const TRIED: [f64; 4] = [0.125, 0.25, 0.5, 1.0];
const HALVED: usize = 40;

/// A way is level if it leads down by less than this share of its length: a few roundings.
const LEVEL: f64 = 1e-12;

/// Normals with a smaller cosine are those of both sides of an edge, 0.8°.
const ONE_NORMAL: f64 = 0.9999;

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

/// A point of a body above a face of the other.
struct Low<const D: usize> {
    edge: Edge<D>,
    /// How high it is [m].
    height: f64,
    /// Whether the way to it leads down steeply, or to an edge.
    is_found: bool,
    /// Whether it is the point of its body that is nearest to a point below it, towards the face.
    is_nearest: bool,
}

impl<const D: usize> Edge<D> {
    /// The edge at a touch: of the body that has one, if the other has a face there, else of the body that
    /// lies deeper in the other.
    pub(super) fn of(
        pair: &mut BodyPair<'_, D>,
        touch: &Touch<D>,
        is_deepest: bool,
        settings: &ManifoldSettings,
    ) -> Option<Self> {
        let slopes = pair.slopes(touch.point);
        if let Some(face) = pair.face(touch.point, slopes) {
            let on = Self::on(pair, face.body, touch, (is_deepest, settings));
            return on.map(|low| low.edge);
        }
        let low = [0, 1].map(|face| Self::on(pair, face, touch, (is_deepest, settings)));
        // A field that is a bound does not tell which point is nearest.
        let is_edge =
            |low: &Low<D>| low.is_nearest || !pair.bodies[low.edge.body].is_exact_outside();
        let found = low
            .into_iter()
            .flatten()
            .filter(|low| is_deepest || (low.is_found && is_edge(low)));
        let best = found.min_by(|one, other| {
            let is_nearest = other.is_nearest.cmp(&one.is_nearest);
            is_nearest.then(one.height.total_cmp(&other.height))
        });
        best.map(|low| low.edge)
    }

    /// The edge at a touch of nearly parallel faces, of the one body that has an edge near.
    pub(super) fn of_tilted(
        pair: &mut BodyPair<'_, D>,
        touch: &Touch<D>,
        is_deepest: bool,
        settings: &ManifoldSettings,
    ) -> Option<Self> {
        let slopes = pair.slopes(touch.point);
        let body = pair.body_with_edge(touch.point, slopes, NEAR * settings.spacing)?;
        let on = Self::on(pair, 1 - body, touch, (is_deepest, settings));
        on.map(|low| low.edge)
    }

    /// The edge of one body on a face of the other, at a touch. If the touch is the deepest or the edge descends
    /// steeply from it, the result is the lowest point of the edge. Otherwise it is the edge straight down from
    /// the touch, if there is one in reach, or else the point of the body next to the touch. `None` if the
    /// steep way is longer than the reach of the touch.
    fn on(
        pair: &mut BodyPair<'_, D>,
        face: usize,
        touch: &Touch<D>,
        (is_deepest, settings): (bool, &ManifoldSettings),
    ) -> Option<Low<D>> {
        let body = 1 - face;
        let next = pair.surface_point(body, touch.point);
        let near = settings.spacing.max(touch.gap.abs());
        let start = next.filter(|p| distance(*p, touch.point) <= near)?;
        let at_start = pair.slope(face, start);
        let first = LOWER * settings.spacing;
        let precise = LOWEST * settings.precision_length();
        let (lowest, at_lowest) = patch::lowest(pair, face, (start, first), precise);
        let way = distance(lowest, start);
        let is_steep = at_start.0 - at_lowest.0 >= STEEP * way;
        if is_steep && !is_deepest && way > reach(true, settings) {
            return None;
        }
        let (mut p, mut height, mut slope) = (start, at_start.0, at_start.1);
        let mut is_found = is_steep;
        if is_steep || is_deepest {
            (p, (height, slope)) = (lowest, at_lowest);
        } else if let Some(Foot { point, kind: FootKind::Edge }) =
            (Way { pair, face }).foot(start, reach(false, settings))
            && let Some(edge) = pair.surface_point(body, point)
        {
            (p, (height, slope)) = (edge, pair.slope(face, edge));
            is_found = true;
        }
        let outwards = slope.normalized()?;
        let below = pair.slope(body, p - outwards * BELOW * settings.spacing).1;
        let is_nearest = below.normalized().is_some_and(|below| below.dot(outwards) < -NEAREST);
        let normal = if face == 0 { outwards } else { -outwards };
        let point = if body == 0 { p } else { pair.second_from_frame.transform_point(p) };
        let edge = Self { body, point, normal };
        Some(Low { edge, height, is_found, is_nearest })
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
        let touch = Touch::of_contact(&contact);
        Some(Polished { touch, contact, edge: Some(*self), is_slope: false })
    }
}

/// The contact at the bottom of a valley, next to a touch on its slope: Newton's method does not get there
/// where the valley ends at an edge. `None` if it is farther than a touch moves.
pub(super) fn lowest_of_valley<const D: usize>(
    pair: &mut BodyPair<'_, D>,
    touch: &Touch<D>,
    settings: &ManifoldSettings,
) -> Option<Polished<D>> {
    let near = settings.spacing.max(touch.gap.abs());
    let mut bottom = |face: usize| {
        let start = pair.surface_point(1 - face, touch.point);
        let start = start.filter(|p| distance(*p, touch.point) <= near)?;
        let mut way = Way { pair, face };
        let foot = way.foot(start, reach(true, settings))?;
        if foot.kind != FootKind::Smooth {
            return None;
        }
        let is_slope = way.is_curved_slope(foot.point, settings);
        let p = pair.surface_point(1 - face, foot.point)?;
        let (value, slope) = pair.slope(face, p);
        let outwards = slope.normalized()?;
        let on_face = p - outwards * (value / slope.norm());
        let contact = if face == 0 {
            Contact::new(on_face, p, outwards)
        } else {
            Contact::new(p, on_face, -outwards)
        };
        Some((contact, is_slope))
    };
    let bottoms = [bottom(0), bottom(1)].into_iter().flatten();
    let (contact, is_slope) =
        bottoms.min_by(|(one, _), (other, _)| one.gap.total_cmp(&other.gap))?;
    Some(Polished { touch: Touch::of_contact(&contact), contact, edge: None, is_slope })
}

impl<const D: usize> Touch<D> {
    /// The touch in the middle of a contact.
    fn of_contact(contact: &Contact<D>) -> Self {
        Self {
            point: (contact.point_a + contact.point_b) * 0.5,
            normal: contact.normal,
            gap: contact.gap,
            source: NormalSource::Gradients,
        }
    }
}

/// Where the way along a body's surface, straight down to a face of the other, leads down no longer.
pub(super) struct Foot<const D: usize> {
    /// A point of the plane that is tangent to the body where the way begins.
    pub(super) point: Point<D>,
    kind: FootKind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum FootKind {
    /// An edge of the body.
    Edge,
    /// The bottom of a valley: both bodies are smooth there.
    Smooth,
    /// Another part of the face's body is nearer from there on.
    OtherFace,
}

/// The way along the surface of one body, straight down to the face of the other.
struct Way<'p, 'a, const D: usize> {
    pair: &'p mut BodyPair<'a, D>,
    /// The body with the face.
    face: usize,
}

/// The unit gradients at a point of a way.
#[derive(Clone, Copy, Debug)]
struct Units<const D: usize> {
    /// Of the body with the face, and of the one that the way is on.
    face: Vector<f64, D>,
    body: Vector<f64, D>,
}

impl<const D: usize> Units<D> {
    /// The direction along the body's surface that leads straight down.
    fn down(&self) -> Option<Vector<f64, D>> {
        (self.body * self.face.dot(self.body) - self.face).normalized()
    }

    /// How fast the value of the face rises along the body's surface.
    fn rise(&self, way: Vector<f64, D>) -> f64 {
        (self.face - self.body * self.face.dot(self.body)).dot(way)
    }
}

impl<const D: usize> Way<'_, '_, D> {
    fn units(&mut self, p: Point<D>) -> Option<Units<D>> {
        let [face, body] = [self.face, 1 - self.face].map(|body| self.pair.slope(body, p).1);
        Some(Units { face: face.normalized()?, body: body.normalized()? })
    }

    /// The foot of the way from a point of the surface, within `far` [m]. `None` if the way leads down
    /// farther, or nowhere.
    fn foot(&mut self, start: Point<D>, far: f64) -> Option<Foot<D>> {
        let first = self.units(start)?;
        let down = first.down()?;
        if first.rise(down) > -OPPOSITE {
            return None;
        }
        let mut last = (0.0, first);
        let mut next = None;
        for share in TRIED {
            let there = self.units(start + down * (share * far))?;
            if there.rise(down) > -OPPOSITE {
                next = Some((share * far, there));
                break;
            }
            last = (share * far, there);
        }
        let mut next = next?;
        for _ in 0..HALVED {
            let middle = 0.5 * (last.0 + next.0);
            let there = self.units(start + down * middle)?;
            let half = if there.rise(down) > -LEVEL { &mut next } else { &mut last };
            *half = (middle, there);
        }
        let is_one = |one: Vector<f64, D>, other: Vector<f64, D>| one.dot(other) >= ONE_NORMAL;
        let kind = if !is_one(last.1.face, next.1.face) {
            FootKind::OtherFace
        } else if is_one(last.1.body, next.1.body) {
            FootKind::Smooth
        } else {
            FootKind::Edge
        };
        Some(Foot { point: start + down * last.0, kind })
    }

    /// Whether the way leads on down from a point, to a least point elsewhere: not to an edge next to it, and not
    /// evenly as along a line.
    fn is_curved_slope(&mut self, p: Point<D>, settings: &ManifoldSettings) -> bool {
        let mut rises = || {
            let here = self.units(p)?;
            let down = here.down()?;
            let next = self.units(p + down * (PROBE * settings.spacing))?;
            Some([here, next].map(|units| units.rise(down)))
        };
        rises().is_some_and(|[here, next]| {
            here < -SLOPE && next < -SLOPE && (next - here) * FLAT > PROBE
        })
    }
}
