// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A field's gradient as a force.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::{Point, Shape, Vector};

use super::limit::Motion;
use crate::error::HapticsError;
use palpate_device::NumberError;

/// A force down the gradient of a field, within a band of its values.
///
/// ```text
/// F = −gain · w(f) ∇f
/// ```
///
/// where w rises from 0 at the lower end of the band to 1 and falls to 0 at the upper end, as
/// `3t² − 2t³` over the `edge`. The force is the gradient of `−gain ∫ w(f) df`, so it does no
/// work over a closed path as long as it stays below the largest force. The force is continuous
/// where ∇f is. A positive gain attracts to the shape, a negative gain repels.
///
/// # Examples
///
/// Attraction to a ball of 1/2 m radius from up to 1/4 m away, with half of the force in the
/// middle of the edge:
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Ball};
/// use palpate_haptics::{Guide, GuideOptions, Slope};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let ball = Shape::<3>::from_kernel(Ball::new(0.5)?);
/// let slope = Slope::new(ball, 1.5, [-0.125, 0.25])?.with_edge(0.125)?;
/// let mut guide = Guide::down(slope, GuideOptions::default())?;
/// let mut pull = |y: f64| guide.force(Vector([0.0, y, 0.0]), Vector::ZERO);
/// assert_eq!(pull(0.5625), Vector([0.0, -1.5, 0.0]));
/// assert_eq!(pull(0.6875), Vector([0.0, -0.75, 0.0]));
/// assert_eq!(pull(0.75), Vector::ZERO);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Slope {
    shape: Shape<3>,
    gain: f64,
    band: [f64; 2],
    edge: f64,
}

impl Slope {
    /// The slope of `shape` where its field is in `band` [m]; a gradient of length one gives
    /// the force `gain` [N]. Each edge takes a quarter of the band.
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if the band is empty or not finite, or the gain is not finite.
    pub fn new(shape: Shape<3>, gain: f64, band: [f64; 2]) -> Result<Self, HapticsError> {
        if !gain.is_finite() {
            let (parameter, rule, unit) = ("gain", "finite", "N");
            return Err(HapticsError::Number(NumberError::new(parameter, rule, gain, unit)));
        }
        let [near, far] = band;
        let width = NumberError::check_positive("band", far - near, "m wide")?;
        Ok(Self { shape, gain, band, edge: 0.25 * width })
    }

    /// This slope with edges of `edge` [m].
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if the edge is not positive, or more than half of the band.
    pub fn with_edge(self, edge: f64) -> Result<Self, HapticsError> {
        NumberError::check_positive("edge", edge, "m")?;
        let [near, far] = self.band;
        if edge <= 0.5 * (far - near) {
            return Ok(Self { edge, ..self });
        }
        let (parameter, rule) = ("edge", "at most half of the band");
        Err(HapticsError::Number(NumberError::new(parameter, rule, edge, "m")))
    }

    /// The steepest change of the force where the gradient has the length one [N/m]: the largest
    /// slope of `3t² − 2t³` is 3/2.
    pub(super) fn stiffness(&self) -> f64 {
        1.5 * self.gain.abs() / self.edge
    }

    /// This slope with `part` of its force.
    pub(super) fn scaled(self, part: f64) -> Self {
        Self { gain: self.gain * part, ..self }
    }

    /// Force and damper along the gradient; `None` outside the band.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic unless a custom field does; one
    /// evaluation.
    pub(super) fn motion(
        &self,
        position: Point<3>,
        velocity: Vector<f64, 3>,
        damping: f64,
    ) -> Option<Motion> {
        let (value, gradient) = self.shape.distance_gradient(position);
        let [near, far] = self.band;
        let inside = (value - near).min(far - value);
        // Written so that NaN is outside.
        if !(inside > 0.0 && value.is_finite()) {
            return None;
        }
        let part = (inside / self.edge).min(1.0);
        let weight = part * part * (3.0 - 2.0 * part);
        let along = gradient.normalized()?;
        Some(Motion {
            spring: gradient * (-self.gain * weight),
            damper: along * (-damping * weight * velocity.dot(along)),
        })
    }
}
