// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The bodies near a place, as one field.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::{LARGEST_LENGTH, Point, Vector};

use crate::bodies::{Bodies, Body};

/// The punctured layers of bodies, which no longer constrain the proxy.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Punctured {
    bodies: [u32; Self::CAPACITY],
    /// The number of punctured layers of each body; zero marks a free entry.
    levels: [u8; Self::CAPACITY],
}

impl Punctured {
    /// The most bodies with punctured layers at a time.
    const CAPACITY: usize = 4;

    /// Whether no layer is punctured.
    #[inline]
    pub(crate) fn is_empty(&self) -> bool {
        self.levels == [0; Self::CAPACITY]
    }

    fn entries(&mut self) -> impl Iterator<Item = (&mut u32, &mut u8)> {
        self.bodies.iter_mut().zip(&mut self.levels)
    }

    /// The number of punctured layers of a body.
    #[inline]
    pub(crate) fn level(&self, body: u32) -> usize {
        if self.is_empty() {
            return 0;
        }
        let mut entries = self.bodies.iter().zip(&self.levels);
        let found = entries.find(|(punctured, level)| **punctured == body && **level > 0);
        found.map_or(0, |(_, level)| usize::from(*level))
    }

    /// Records one more punctured layer of a body; `false` if the table is full.
    pub(crate) fn puncture(&mut self, body: u32) -> bool {
        let known =
            self.entries().find(|(punctured, level)| **punctured == body && **level > 0);
        if let Some((_, level)) = known {
            *level = level.saturating_add(1);
            return true;
        }
        let room = self.entries().find(|(_, level)| **level == 0);
        room.map(|(place, level)| (*place, *level) = (body, 1)).is_some()
    }

    /// Restores the layers for which `is_away` says that the hand has left them.
    pub(crate) fn restore(&mut self, mut is_away: impl FnMut(u32, usize) -> bool) {
        for (body, level) in self.entries() {
            if *level > 0 && is_away(*body, usize::from(*level)) {
                *level = 0;
            }
        }
    }
}

/// Bodies that yield: they moved, and left a probe no room beside bodies that did not. They do not
/// constrain it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Yielding {
    bodies: [u32; Self::CAPACITY],
    count: u8,
    /// Whether every body that moved in this tick yields.
    has_all_moved: bool,
}

impl Yielding {
    /// The most bodies that yield at a time.
    const CAPACITY: usize = 4;

    /// Whether no body yields.
    #[inline]
    pub(crate) fn is_empty(&self) -> bool {
        self.count == 0 && !self.has_all_moved
    }

    /// These bodies, and every body that moved in this tick.
    pub(crate) fn and_all_moved(self) -> Self {
        Self { has_all_moved: true, ..self }
    }

    /// The bodies by their indices.
    pub(crate) fn bodies(&self) -> impl Iterator<Item = u32> + Clone + use<> {
        self.bodies.into_iter().take(usize::from(self.count))
    }

    /// Whether a body yields.
    #[inline]
    pub(crate) fn has(&self, index: u32, body: &Body) -> bool {
        !self.is_empty()
            && (self.has_all_moved && body.has_moved() || self.bodies().any(|it| it == index))
    }

    /// Adds a body; `false` if no more can be recorded.
    pub(crate) fn add(&mut self, body: u32) -> bool {
        if self.bodies().any(|it| it == body) {
            return true;
        }
        let Some(place) = self.bodies.get_mut(usize::from(self.count)) else { return false };
        *place = body;
        self.count += 1;
        true
    }
}

/// The field at a place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FieldValue {
    /// The field [m].
    pub(crate) distance: f64,
    /// The gradient of the field.
    pub(crate) gradient: Vector<f64, 3>,
    /// The index of the body whose field is least.
    pub(crate) body: u32,
}

/// The bodies near a place, as one field: the least of their fields and of the distance to the
/// horizon. All other bodies lie beyond the horizon.
#[derive(Clone, Copy, Debug)]
pub struct Nearby<'a> {
    pub(crate) bodies: &'a Bodies,
    /// Indices of the near bodies; `None` means all bodies.
    pub(crate) list: Option<&'a [u32]>,
    pub(crate) centre: Point<3>,
    /// The radius of the horizon about the centre [m]: bodies not in the list are farther away.
    pub(crate) horizon: f64,
    /// The bodies that do not count.
    yielding: Yielding,
}

impl Bodies {
    /// All bodies, however far away.
    #[must_use]
    pub fn everything(&self) -> Nearby<'_> {
        let yielding = Yielding::default();
        let (centre, horizon) = (Vector::ZERO, f64::INFINITY);
        Nearby { bodies: self, list: None, centre, horizon, yielding }
    }

    /// The bodies within `radius` of `centre` [m]; `list` receives their indices. If `list` is
    /// full, the horizon moves nearer, so that the bodies left out lie beyond it.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn nearby<'a>(
        &'a self,
        centre: Point<3>,
        radius: f64,
        list: &'a mut [u32],
    ) -> Nearby<'a> {
        let (mut horizon, mut count) = (f64::INFINITY, 0);
        for (index, body) in (0..).zip(self.bodies()) {
            let away = body.above_way(centre);
            // Written so that NaN counts as near.
            let is_far = away > radius;
            match list.get_mut(count) {
                Some(place) if !is_far => {
                    *place = index;
                    count += 1;
                }
                _ => horizon = horizon.min(away),
            }
        }
        let yielding = Yielding::default();
        Nearby { bodies: self, list: list.get(..count), centre, horizon, yielding }
    }
}

impl<'a> Nearby<'a> {
    /// These bodies without those of `yielding`.
    pub(crate) fn without(&self, yielding: Yielding) -> Self {
        // Where no body counts, the field is finite too.
        let most = if yielding.is_empty() { f64::INFINITY } else { LARGEST_LENGTH };
        Self { yielding, horizon: self.horizon.min(most), ..*self }
    }

    /// The only body, if there is one and it counts.
    #[inline(always)]
    fn only(&self) -> Option<&'a Body> {
        match self.bodies.bodies() {
            [body] if self.yielding.is_empty() => Some(body),
            _ => None,
        }
    }

    /// The body with this index.
    pub(crate) fn body(&self, body: u32) -> Option<&'a Body> {
        self.bodies.bodies().get(body as usize)
    }

    /// The field at a point and its gradient.
    #[must_use]
    #[inline(never)]
    pub fn look(&self, p: Point<3>) -> (f64, Vector<f64, 3>) {
        let seen = self.gradient(p, &Punctured::default());
        (seen.distance, seen.gradient)
    }

    /// The least of the fields at a point [m], and the index of its body. Of the bodies near a
    /// contact point, [`Bodies::nearby`], the value is at most the distance to the horizon within
    /// which they were selected; where that is less than all fields, the index is 0.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic unless a custom field does.
    ///
    /// ```
    /// use palpate_field::{Pose, Shape, Vector};
    /// use palpate_haptics::{Bodies, Body, Surface};
    /// let disc = || Body::new(Shape::circle(0.5)?, Surface::default());
    /// let right = disc()?.at(Pose::translation(Vector([2.0, 0.0, 0.0])))?;
    /// let bodies = Bodies::new(vec![disc()?, right])?;
    /// assert_eq!(bodies.everything().nearest(Vector([1.75, 0.0, 0.0])), (-0.25, 1));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    #[inline(never)]
    pub fn nearest(&self, p: Point<3>) -> (f64, u32) {
        self.distance(p, &Punctured::default())
    }

    pub(crate) fn all(&self) -> impl Iterator<Item = (u32, &'a Body)> {
        let bodies = self.bodies.bodies();
        let count = self.list.map_or(bodies.len(), <[u32]>::len);
        let (list, yielding) = (self.list, &self.yielding);
        (0..count).filter_map(move |i| {
            let index = list.map_or(Some(i as u32), |list| list.get(i).copied())?;
            let body = bodies.get(index as usize)?;
            (!yielding.has(index, body)).then_some((index, body))
        })
    }

    pub(crate) fn lipschitz(&self) -> f64 {
        self.bodies.lipschitz
    }

    pub(crate) fn size(&self) -> Option<f64> {
        self.bodies.size
    }

    /// The error of the field at points at most `extent` from the origin [m].
    pub(crate) fn rounding_within(&self, extent: f64) -> f64 {
        match self.only() {
            Some(body) => body.rounding_within(extent),
            None => {
                self.all().map(|(_, body)| body.rounding_within(extent)).fold(0.0, f64::max)
            }
        }
    }

    /// Whether all bodies are planar shapes.
    pub(crate) fn is_flat(&self) -> bool {
        self.bodies.is_flat
    }

    /// Whether any body moved in this tick.
    pub(crate) fn has_moved(&self) -> bool {
        self.bodies.has_moved
    }

    /// The field at a point, and the body whose field is least there.
    #[inline]
    pub(crate) fn distance(&self, p: Point<3>, punctured: &Punctured) -> (f64, u32) {
        if let (Some(body), true) = (self.only(), punctured.is_empty()) {
            return (body.distance(p), 0);
        }
        let mut least = (self.horizon - (p - self.centre).norm(), 0);
        for (index, body) in self.all() {
            let above = body.above_ball(p);
            // Written so that NaN is evaluated.
            if above >= least.0 {
                continue;
            }
            let Some(layer_depth) = layer_depth(body, punctured.level(index)) else { continue };
            let mut distance = body.distance(p) + layer_depth;
            if body.is_below_ball {
                distance = distance.max(above);
            }
            if distance.is_nan() {
                return (distance, index);
            }
            if distance < least.0 {
                least = (distance, index);
            }
        }
        least
    }

    /// The field and its gradient at a point, and the body whose field is least there.
    #[inline(never)]
    pub(crate) fn gradient(&self, p: Point<3>, punctured: &Punctured) -> FieldValue {
        if let (Some(body), true) = (self.only(), punctured.is_empty()) {
            let (distance, gradient) = body.distance_gradient(p);
            return FieldValue { distance, gradient, body: 0 };
        }
        let way = p - self.centre;
        let length = way.norm();
        let inwards = if length > 0.0 { way * (-1.0 / length) } else { Vector::ZERO };
        let mut least =
            FieldValue { distance: self.horizon - length, gradient: inwards, body: 0 };
        for (index, body) in self.all() {
            let above = body.above_ball(p);
            if above >= least.distance {
                continue;
            }
            let Some(seen) = field_of(body, index, p, above, punctured) else { continue };
            if seen.distance.is_nan() {
                return seen;
            }
            if seen.distance < least.distance {
                least = seen;
            }
        }
        least
    }

    /// The field and its gradient at a point, with gaps between bodies narrower than `crack` [m]
    /// filled.
    ///
    /// With the two least fields `a ≤ b` the field is `min(a, (a + b − crack) / 2)`. It is no steeper
    /// than the fields, and differs from their least only within a crack of two surfaces: bodies that
    /// touch leave no way between them for a point.
    pub(crate) fn gradient_filled(
        &self,
        p: Point<3>,
        punctured: &Punctured,
        crack: f64,
    ) -> FieldValue {
        let least = self.gradient(p, punctured);
        let near = |body| (body != least.body).then_some(least.distance + crack);
        let others = self.each_within(p, punctured, near);
        let second = others.min_by(|a, b| a.distance.total_cmp(&b.distance));
        let Some(second) = second else { return least };
        let filled = 0.5 * (least.distance + second.distance - crack);
        // Written so that NaN counts as the least.
        if filled >= least.distance {
            return least;
        }
        let gradient = (least.gradient + second.gradient) * 0.5;
        FieldValue { distance: filled, gradient, body: least.body }
    }

    /// The fields at a point of the bodies whose bounding balls are at most `most` away; a body for
    /// which it is `None` is left out.
    pub(crate) fn each_within(
        &self,
        p: Point<3>,
        punctured: &Punctured,
        most: impl Fn(u32) -> Option<f64>,
    ) -> impl Iterator<Item = FieldValue> {
        self.all().filter_map(move |(index, body)| {
            let above = body.above_ball(p);
            let is_near = most(index).is_some_and(|most| above <= most);
            is_near.then(|| field_of(body, index, p, above, punctured)).flatten()
        })
    }

    /// `true` if the promise of every near body holds at a point.
    pub(crate) fn is_proven(&self, p: Point<3>) -> bool {
        if !self.bodies.has_regions {
            return true;
        }
        self.all().all(|(_, body)| body.is_proven(p))
    }

    /// The point closest to `goal` at which the promises hold. With several regions, `goal` is
    /// projected on one after another, which gives a nearby point.
    pub(crate) fn within_regions(&self, goal: Point<3>, edge: f64) -> Point<3> {
        if !self.bodies.has_regions {
            return goal;
        }
        let mut goal = goal;
        for region in self.all().filter_map(|(_, body)| body.region) {
            let (way, radius) = (goal - region.centre, region.radius * (1.0 - edge));
            let length = way.norm();
            if length > radius {
                goal = region.centre + way * (radius / length);
            }
        }
        goal
    }
}

/// The field of one body at a point that is `above` its ball; `None` if all its layers are
/// punctured.
#[inline(always)]
fn field_of(
    body: &Body,
    index: u32,
    p: Point<3>,
    above: f64,
    punctured: &Punctured,
) -> Option<FieldValue> {
    let layer_depth = layer_depth(body, punctured.level(index))?;
    let (distance, gradient) = body.distance_gradient(p);
    let mut seen = FieldValue { distance: distance + layer_depth, gradient, body: index };
    if body.is_below_ball
        && above > seen.distance
        && let Some(outwards) = body.off_centre(p)
    {
        seen.distance = above;
        seen.gradient = outwards.normalized().unwrap_or(Vector::ZERO);
    }
    Some(seen)
}

/// The depth of the layer that constrains the proxy after `level` layers were punctured [m];
/// `None` if no layer is left.
#[inline]
fn layer_depth(body: &Body, level: usize) -> Option<f64> {
    if level == 0 { Some(0.0) } else { body.surface().strata.top(level).map(|top| top.depth) }
}
