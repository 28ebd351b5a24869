// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The frictionless proxy: a ball that follows the device point but cannot enter the shape.
//!
//! Zilles and Salisbury, "A constraint-based god-object method for haptic display" (1995);
//! Ruspini, Kolarov and Khatib, "The haptic display of complex graphical environments" (1997),
//! who gave it a radius; Salisbury and Tarr, "Haptic rendering of surfaces defined by implicit
//! functions" (1997), who slid it over `f = 0`. The sweep and the certified slide are ours.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::{LARGEST_LENGTH, Point, Shape, Vector};

use crate::contact::{Rest, slide};
use crate::error::{HapticsError, not_negative};
use crate::sampler::{Sample, Sampler};

/// The evaluations a tick may cost, unless asked otherwise. Sliding takes one to three, a corner
/// up to eight, a strike about ten; the rest is for grazing flights, slots and fast hands.
pub const DEFAULT_BUDGET: u32 = 64;

/// The fewest evaluations a tick can work with: two to see a surface, one to leave it.
const LEAST_BUDGET: u32 = 4;

/// A flight whose next safe step is below this part of the way left goes on along the surface it
/// meets: steps along a line that grazes or hits it would shrink without end.
const WORTH_FLYING: f64 = 0.1;

/// The ball that touches: the proxy's radius, and what a tick may cost.
///
/// The force stays continuous over a convex edge if the radius is at least the depth pressed to;
/// a radius of `max_force / stiffness` is enough for every force a device can give.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Probe {
    radius: f64,
    budget: u32,
}

impl Probe {
    /// A ball of `radius` [m]; a point if it is zero.
    ///
    /// A point is held by walls thicker than 1e-4 of the radius of the shape's bounding ball; a ball by any
    /// wall.
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if the radius is negative or not finite.
    pub fn new(radius: f64) -> Result<Self, HapticsError> {
        let radius = not_negative("radius", radius, "m")?;
        Ok(Self { radius, budget: DEFAULT_BUDGET })
    }

    /// The same, with at most `budget` evaluations of the shape a tick.
    ///
    /// A tick that would need more leaves its proxy behind, outside the shape, to catch up in
    /// the next ones.
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if the budget is below 4.
    pub fn with_budget(self, budget: u32) -> Result<Self, HapticsError> {
        if budget < LEAST_BUDGET {
            let value = f64::from(budget);
            let (parameter, rule, unit) = ("budget", "at least 4", "evaluations");
            return Err(HapticsError::Number { parameter, rule, value, unit });
        }
        Ok(Self { budget, ..self })
    }

    /// The radius [m].
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The most evaluations a tick may cost.
    #[must_use]
    pub fn budget(&self) -> u32 {
        self.budget
    }
}

impl Default for Probe {
    /// A ball of 2 mm: wide enough for 1 N at 500 N/m to pass every edge smoothly.
    fn default() -> Self {
        Self { radius: 0.002, budget: DEFAULT_BUDGET }
    }
}

/// Where a proxy is after a tick. World coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Following<const D: usize> {
    /// The proxy: on or outside the surface offset by the probe's radius; the device point
    /// itself where nothing is touched, as far as the field's promise goes [m].
    pub proxy: Point<D>,
    /// The unit normal of the surface last seen, pointing out.
    pub normal: Vector<f64, D>,
    /// `true` if the surface keeps the proxy from the device point.
    pub contact: bool,
    /// `true` if the proxy was placed anew because the shape covered it, so that the force
    /// should rise gently: in the first tick, or after the shape changed.
    pub placed: bool,
    /// Evaluations of the shape in this tick.
    pub evaluations: u32,
}

/// The constrained point that follows one device point.
///
/// # Examples
///
/// A point pressed 2 mm into a ball of 50 mm, off centre:
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Ball};
/// use palpate_haptics::{Probe, Proxy};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let ball = Shape::from_kernel(Ball::new(0.05)?);
/// let mut proxy = Proxy::new(Probe::new(0.0)?);
/// proxy.follow(&ball, Vector([0.0, 0.06, 0.0]));
/// let following = proxy.follow(&ball, Vector([0.048 * 0.6, 0.048 * 0.8, 0.0]));
///
/// assert!(following.contact);
/// assert!((following.proxy - Vector([0.03, 0.04, 0.0])).norm() < 1e-7);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Proxy<const D: usize> {
    probe: Probe,
    /// The last point found on or outside the offset surface; none before the first tick.
    at: Option<Sample<D>>,
    /// The device point of the last tick [m].
    device: Point<D>,
    normal: Vector<f64, D>,
    contact: bool,
}

impl<const D: usize> Proxy<D> {
    /// A proxy that starts where the device point first is.
    #[must_use]
    pub fn new(probe: Probe) -> Self {
        // Up: y in the plane and in space.
        let normal = Vector(std::array::from_fn(|axis| f64::from(u8::from(axis == 1))));
        Self { probe, at: None, device: Vector::ZERO, normal, contact: false }
    }

    /// The ball that touches.
    #[must_use]
    pub fn probe(&self) -> Probe {
        self.probe
    }

    /// Forgets what is known of the shape: it changed, or another one is followed.
    ///
    /// The next tick looks again where the proxy is, and places it anew if it is covered.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn forget_shape(&mut self) {
        if let Some(at) = &mut self.at {
            at.gap = f64::NEG_INFINITY;
        }
    }

    /// Follows the device point to `device` [m] as far as `shape` lets it.
    ///
    /// One evaluation in free space. The proxy moves only along ways that are proven free of the
    /// shape, so it crosses no wall at any speed; it rests at points with `f ≥ r − 1e-9` of the
    /// size of the shape's bounding ball, with the field's value `f` and the probe's radius `r`.
    ///
    /// Of a field that outside its surface promises a Lipschitz constant in a region only
    /// ([`Promise::region`](palpate_field::Promise::region)), nothing is known beyond: the proxy
    /// stays in the region, at the point of it closest to the device where that is free. A device
    /// point that starts outside has no proxy, and touches nothing, until it enters.
    ///
    /// A device point that is not finite, or beyond 1e15 m, moves nothing and touches nothing.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic; evaluates the shape at most
    /// [`Probe::budget`] times.
    pub fn follow(&mut self, shape: &Shape<D>, device: Point<D>) -> Following<D> {
        let last = self.at.map_or(device, |at| at.point);
        // Written so that NaN fails.
        if !device.0.iter().all(|x| x.abs() <= LARGEST_LENGTH) {
            return Following { contact: false, ..self.following(last, false, 0) };
        }
        let extent = last.norm().max(device.norm()) + 2.0 * self.probe.radius;
        let moved = if self.at.is_some() { (device - self.device).norm() } else { 0.0 };
        self.device = device;
        let motion = (device - last).norm().max(moved);
        let Probe { radius, budget } = self.probe;
        let mut sampler = Sampler::new(shape, radius, budget, (extent, motion));

        let known = self.at.filter(|at| at.gap >= -sampler.tolerance());
        let (start, placed) = match known {
            Some(start) => (Some(start), false),
            None => self.place(&mut sampler, last),
        };
        self.at = start;
        let Some(start) = start else {
            self.contact = false;
            return self.following(device, false, sampler.evaluations());
        };
        let goal = sampler.within_region(device);
        let rest = self.pursue(&mut sampler, start, (goal, moved));
        self.at = Some(rest.sample);
        self.normal = rest.normal;
        self.contact = rest.contact;
        self.following(rest.sample.point, placed, sampler.evaluations())
    }

    fn following(&self, proxy: Point<D>, placed: bool, evaluations: u32) -> Following<D> {
        let contact = self.contact;
        Following { proxy, normal: self.normal, contact, placed, evaluations }
    }

    /// A point on or outside the offset surface near `from`, and whether it had to be moved
    /// there: up the gradient by `(r − f) / ‖∇f‖` until it is out. None if half the budget does
    /// not lead out.
    fn place(
        &mut self,
        sampler: &mut Sampler<'_, D>,
        from: Point<D>,
    ) -> (Option<Sample<D>>, bool) {
        let mut point = from;
        while sampler.evaluations() < self.probe.budget / 2 {
            let Some(sample) = sampler.gradient(point) else { break };
            let (normal, gap) = sampler.tangent(&sample, self.normal);
            if sample.gap >= -sampler.tolerance() {
                return (Some(sample), point != from);
            }
            self.normal = normal;
            point -= normal * gap;
        }
        (None, false)
    }

    /// Flies straight to the device where that is free, and slides from where it is not.
    fn pursue(
        &self,
        sampler: &mut Sampler<'_, D>,
        start: Sample<D>,
        (device, moved): (Point<D>, f64),
    ) -> Rest<D> {
        let mut here = start;
        loop {
            let way = device - here.point;
            let length = way.norm();
            let free = sampler.free_radius(&here);
            let next = if free > length {
                device
            } else if free > WORTH_FLYING * length {
                // Conservative advancement (Mirtich 1996): nothing is within `free`.
                here.point + way * (free / length)
            } else {
                return slide(sampler, here, self.normal, (device, moved));
            };
            match sampler.distance(next) {
                Some(sample) if sample.gap >= -sampler.tolerance() => here = sample,
                _ => return Rest { sample: here, normal: self.normal, contact: false },
            }
            if free > length {
                return Rest { sample: here, normal: self.normal, contact: false };
            }
        }
    }
}
