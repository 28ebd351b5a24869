// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A pull towards a surface from outside.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::Magnet;

use crate::error::HapticsError;
use palpate_device::NumberError;

/// The height of the largest pull, as a part of the reach.
const PEAK: f64 = 0.25;

/// A pull that snaps the hand onto a surface.
///
/// With height above the surface, the pull rises linearly from zero to its largest value at a
/// quarter of the reach, and falls linearly to zero at the reach. The pull depends on the
/// height alone, so it does no work over a closed path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pull {
    force: f64,
    /// The height at which the pull ends [m].
    pub(crate) reach: f64,
}

impl Pull {
    pub(crate) fn new(magnet: &Magnet) -> Result<Self, HapticsError> {
        let force = NumberError::check_positive("magnet.force", magnet.force, "N")?;
        Ok(Self {
            force,
            reach: NumberError::check_positive("magnet.distance", magnet.distance, "m")?,
        })
    }

    /// The steepest change of the pull, next to the surface [N/m].
    pub(crate) fn stiffness(&self) -> f64 {
        self.force / (PEAK * self.reach)
    }

    /// This pull with `part` of its force.
    pub(crate) fn scaled(&self, part: f64) -> Self {
        Self { force: self.force * part, ..*self }
    }

    /// The pull at `height` above the surface [N].
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn at(&self, height: f64) -> f64 {
        let part = height / self.reach;
        let share = (part / PEAK).min((1.0 - part) / (1.0 - PEAK));
        // Written so that NaN gives no pull.
        if share > 0.0 { self.force * share } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pull_is_greatest_at_a_quarter_of_its_reach() {
        let pull = Pull { force: 3.0, reach: 0.5 };
        let pulls = [-0.1, 0.0, 0.0625, 0.125, 0.3125, 0.5, 0.6, f64::NAN].map(|h| pull.at(h));
        assert_eq!(pulls, [0.0, 0.0, 1.5, 3.0, 1.5, 0.0, 0.0, 0.0]);
    }
}
