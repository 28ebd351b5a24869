// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The servo: device points in, forces out, once a tick.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::{Point, Shape, Vector};

use crate::device::PointState;
use crate::error::{HapticsError, positive};
use crate::material::{Material, limited};
use crate::proxy::{Probe, Proxy};

/// What a servo renders, and how fast.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ServoOptions {
    /// Ticks a second [Hz].
    pub rate: f64,
    /// The ball that touches.
    pub probe: Probe,
    /// What the surface feels like.
    pub material: Material,
    /// The largest force on a contact point [N]; infinite for none.
    pub max_force: f64,
    /// The time over which the force of a contact rises from nothing to all of it, where the
    /// device point was inside the shape from the start [s].
    pub rise_time: f64,
}

impl Default for ServoOptions {
    /// 1 kHz, a ball of 2 mm, the default material, 3.3 N (a desktop stylus), 0.1 s.
    fn default() -> Self {
        let probe = Probe::default();
        let material = Material::default();
        Self { rate: 1000.0, probe, material, max_force: 3.3, rise_time: 0.1 }
    }
}

/// One contact point after a tick. World coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch<const D: usize> {
    /// The device point [m]; as read, even if it is not finite.
    pub device: Point<D>,
    /// The proxy [m]; the device point itself in free space.
    pub proxy: Point<D>,
    /// The force on the hand [N], always finite.
    pub force: Vector<f64, D>,
    /// The unit normal of the surface last seen, pointing out.
    pub normal: Vector<f64, D>,
    /// `true` if the surface keeps the proxy from the device point.
    pub contact: bool,
    /// Evaluations of the shape in this tick.
    pub evaluations: u32,
}

impl<const D: usize> Touch<D> {
    /// The distance from the device point to its proxy [m]: how deep the hand presses.
    #[must_use]
    pub fn depth(&self) -> f64 {
        if self.contact { (self.proxy - self.device).norm() } else { 0.0 }
    }
}

#[derive(Clone, Debug)]
struct ContactPoint<const D: usize> {
    proxy: Proxy<D>,
    /// The part of the force that is given, in [0, 1].
    rise: f64,
}

/// Renders a shape to some contact points, each on its own.
///
/// # Examples
///
/// A wall pressed to a depth of 1/256 m:
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Ball};
/// use palpate_haptics::{Material, PointState, Probe, Servo, ServoOptions};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let options = ServoOptions {
///     material: Material::new(512.0, 0.0)?,
///     probe: Probe::new(0.0)?,
///     ..ServoOptions::default()
/// };
/// let ball = Shape::from_kernel(Ball::new(0.5)?);
/// let mut servo = Servo::new(ball, 1, options)?;
/// servo.step(&[PointState::at_rest(Vector([0.0, 1.0]))]);
/// let touches = servo.step(&[PointState::at_rest(Vector([0.0, 0.5 - 1.0 / 256.0]))]);
///
/// assert!(touches[0].contact);
/// assert!((touches[0].force - Vector([0.0, 2.0])).norm() < 1e-4);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Servo<const D: usize> {
    shape: Shape<D>,
    points: Vec<ContactPoint<D>>,
    touches: Vec<Touch<D>>,
    options: ServoOptions,
    /// What is added to a force's part in a tick.
    rise_step: f64,
}

impl<const D: usize> Servo<D> {
    /// A servo that renders `shape` to `points` contact points.
    ///
    /// # Errors
    ///
    /// [`HapticsError::NoContactPoint`], or [`HapticsError::Number`] if the rate, the largest
    /// force or the rise time is not positive.
    pub fn new(
        shape: Shape<D>,
        points: usize,
        options: ServoOptions,
    ) -> Result<Self, HapticsError> {
        if points == 0 {
            return Err(HapticsError::NoContactPoint);
        }
        let rate = positive("rate", options.rate, "Hz")?;
        let rise_time = positive("rise_time", options.rise_time, "s")?;
        if options.max_force.is_nan() || options.max_force <= 0.0 {
            let (value, unit) = (options.max_force, "N");
            let (parameter, rule) = ("max_force", "positive");
            return Err(HapticsError::Number { parameter, rule, value, unit });
        }
        let point = ContactPoint { proxy: Proxy::new(options.probe), rise: 1.0 };
        let touch = Touch {
            device: Vector::ZERO,
            proxy: Vector::ZERO,
            force: Vector::ZERO,
            normal: Vector::ZERO,
            contact: false,
            evaluations: 0,
        };
        Ok(Self {
            shape,
            points: vec![point; points],
            touches: vec![touch; points],
            options,
            rise_step: 1.0 / (rate * rise_time),
        })
    }

    /// What is rendered, and how fast.
    #[must_use]
    pub fn options(&self) -> &ServoOptions {
        &self.options
    }

    /// What is touched.
    #[must_use]
    pub fn shape(&self) -> &Shape<D> {
        &self.shape
    }

    /// The contact points after the last tick.
    #[must_use]
    pub fn touches(&self) -> &[Touch<D>] {
        &self.touches
    }

    /// Renders `shape` from the next tick on. Returns the one rendered so far, to be dropped
    /// where freeing is allowed.
    ///
    /// A contact point that the new shape covers is placed anew, and its force rises gently.
    ///
    /// Real-time: allocates nothing, frees nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn replace_shape(&mut self, shape: Shape<D>) -> Shape<D> {
        for point in &mut self.points {
            point.proxy.forget_shape();
        }
        std::mem::replace(&mut self.shape, shape)
    }

    /// Lowers the largest force on a contact point to `max_force` [N]; never raises it.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn limit_force(&mut self, max_force: f64) {
        // `min` ignores NaN.
        self.options.max_force = self.options.max_force.min(max_force).max(0.0);
    }

    /// One tick: reads each point's state, moves its proxy, gives its force.
    ///
    /// A point that is not finite, or for which there is no state, touches nothing: its force is
    /// zero, and its proxy waits where it was.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic unless a custom field does;
    /// evaluates the shape at most [`Probe::budget`] times a point.
    pub fn step(&mut self, states: &[PointState<D>]) -> &[Touch<D>] {
        let missing = PointState::at_rest(Vector([f64::NAN; D]));
        let states = states.iter().copied().chain(std::iter::repeat(missing));
        let points = self.points.iter_mut().zip(&mut self.touches);
        for ((point, touch), state) in points.zip(states) {
            *touch = point.step(&self.shape, &state, (&self.options, self.rise_step));
        }
        &self.touches
    }
}

impl<const D: usize> ContactPoint<D> {
    fn step(
        &mut self,
        shape: &Shape<D>,
        state: &PointState<D>,
        (options, rise_step): (&ServoOptions, f64),
    ) -> Touch<D> {
        let device = state.position;
        // A proxy told of a point that is not finite stays where it is.
        let following = self.proxy.follow(shape, device);
        self.rise = if following.placed {
            0.0
        } else if following.contact {
            (self.rise + rise_step).min(1.0)
        } else {
            1.0
        };
        let force = if following.contact && state.is_finite() {
            let stretch = following.proxy - device;
            let force = options.material.force(stretch, state.velocity);
            limited(force, options.max_force) * self.rise
        } else {
            Vector::ZERO
        };
        Touch {
            device,
            proxy: following.proxy,
            force,
            normal: following.normal,
            contact: following.contact,
            evaluations: following.evaluations,
        }
    }
}
