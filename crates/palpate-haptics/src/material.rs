// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What a surface feels like: a spring and a one-sided damper.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::Vector;

use crate::error::{HapticsError, not_negative, positive};

/// A spring towards the proxy, with a damper against the approach.
///
/// With the stretch `s = p − x` from the device point `x` to the proxy `p`, its direction
/// `n = s / ‖s‖` (the surface normal, where one surface is touched) and the velocity `v` of the
/// device point,
///
/// ```text
/// F = K s − B min(v·n, 0) n
/// ```
///
/// The damper acts on the approach alone, so `F·n ≥ 0`: the force never pulls the hand in.
/// The spring is that of Zilles and Salisbury, "A constraint-based god-object method for haptic
/// display" (1995), section 3.
///
/// # Examples
///
/// ```
/// use palpate_field::Vector;
/// use palpate_haptics::Material;
///
/// # fn main() -> Result<(), palpate_haptics::HapticsError> {
/// let material = Material::new(512.0, 2.0)?;
/// let stretch = Vector([0.0, 0.25]);
/// let (approach, retreat) = (Vector([3.0, -0.5]), Vector([3.0, 0.5]));
/// assert_eq!(material.force(stretch, approach), Vector([0.0, 129.0]));
/// assert_eq!(material.force(stretch, retreat), Vector([0.0, 128.0]));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    stiffness: f64,
    damping: f64,
}

impl Material {
    /// A surface of `stiffness` [N/m] and `damping` [N·s/m].
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if the stiffness is not positive, the damping negative, or
    /// either not finite.
    pub fn new(stiffness: f64, damping: f64) -> Result<Self, HapticsError> {
        Ok(Self {
            stiffness: positive("stiffness", stiffness, "N/m")?,
            damping: not_negative("damping", damping, "N·s/m")?,
        })
    }

    /// Force per length of stretch [N/m].
    #[must_use]
    pub fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// Force per speed of approach [N·s/m].
    #[must_use]
    pub fn damping(&self) -> f64 {
        self.damping
    }

    /// The force on the hand [N] for a `stretch` from device point to proxy [m] and a
    /// `velocity` of the device point [m/s].
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn force<const D: usize>(
        &self,
        stretch: Vector<f64, D>,
        velocity: Vector<f64, D>,
    ) -> Vector<f64, D> {
        let spring = stretch * self.stiffness;
        match stretch.normalized() {
            Some(normal) => {
                let approach = (-velocity.dot(normal)).max(0.0);
                spring + normal * (self.damping * approach)
            }
            None => spring,
        }
    }
}

impl Default for Material {
    /// 500 N/m and 1 N·s/m: firm, and passive at 1 kHz on a device with 0.25 N·s/m of its own.
    fn default() -> Self {
        Self { stiffness: 500.0, damping: 1.0 }
    }
}

/// Shortens `force` to `max_force`, keeping its direction; zero if it is not finite.
///
/// Real-time: allocates nothing, takes no lock, cannot panic.
#[must_use]
pub(crate) fn limited<const D: usize>(force: Vector<f64, D>, max_force: f64) -> Vector<f64, D> {
    let norm = force.norm();
    if norm <= max_force {
        force
    } else {
        // The norm of a huge but finite force overflows; its direction does not.
        force.normalized().map_or(Vector::ZERO, |direction| direction * max_force)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cases::cases;

    #[test]
    fn the_limit_keeps_the_direction() {
        assert_eq!(limited(Vector([3.0, -4.0]), 2.5), Vector([1.5, -2.0]));
        assert_eq!(limited(Vector([3.0, -4.0]), 5.0), Vector([3.0, -4.0]));
        assert_eq!(limited(Vector([0.0, 1e300, 0.0]), 2.0), Vector([0.0, 2.0, 0.0]));
    }

    #[test]
    fn a_force_that_is_not_finite_is_none() {
        assert_eq!(limited(Vector([f64::NAN, 1.0]), 2.0), Vector::ZERO);
        assert_eq!(limited(Vector([f64::INFINITY, 1.0]), 2.0), Vector::ZERO);
    }

    #[test]
    fn wrong_numbers_are_named() {
        let error = Material::new(-3.0, 0.0).unwrap_err();
        assert_eq!(error.to_string(), "stiffness must be positive and finite, got -3 N/m");
        assert!(Material::new(f64::NAN, 0.0).is_err());
        assert!(Material::new(1.0, f64::INFINITY).is_err());
        assert!(Material::new(1.0, -0.1).is_err());
    }

    #[test]
    fn the_force_never_pulls() {
        let material = Material::new(100.0, 50.0).unwrap();
        cases(1000, |u| {
            let mut unit = || u.int_in_range(-1000..=1000).map(|i: i32| f64::from(i) * 1e-3);
            let stretch = Vector([unit()?, unit()?, unit()?]);
            let velocity = Vector([unit()?, unit()?, unit()?]) * 10.0;
            assert!(material.force(stretch, velocity).dot(stretch) >= 0.0);
            Ok(())
        });
    }
}
