// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A pull towards a centre, with a finite reach.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_field::{Point, Vector};

use super::{GuideOptions, finite};
use crate::error::HapticsError;
use palpate_device::NumberError;

#[derive(Clone, Copy, Debug)]
pub(super) struct Well {
    pub(super) centre: Point<3>,
    /// The distance at which the pull is largest [m].
    inner: f64,
    /// The distance at which the pull ends [m].
    pub(super) reach: f64,
    /// The largest pull [N].
    max_force: f64,
}

impl Well {
    pub(super) fn new(
        centre: Point<3>,
        reach: f64,
        options: &GuideOptions,
    ) -> Result<Self, HapticsError> {
        let max_force = NumberError::check_positive("max_force", options.max_force, "N")?;
        let inner = max_force / options.stiffness;
        let reach = NumberError::check_positive("reach", reach, "m")?;
        if reach > inner {
            return Ok(Self { centre: finite("centre", centre)?, inner, reach, max_force });
        }
        let (parameter, rule) = ("reach", "more than max_force / stiffness");
        Err(HapticsError::Number(NumberError::new(parameter, rule, reach, "m")))
    }

    /// This well with `part` of its pull.
    pub(super) fn scaled(self, part: f64) -> Self {
        Self { max_force: self.max_force * part, ..self }
    }

    /// The pull at `position` [N], and the part of the damper that acts there; `None` beyond
    /// the reach.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(super) fn pull(&self, position: Point<3>) -> Option<(Vector<f64, 3>, f64)> {
        let inward = self.centre - position;
        let distance = inward.norm();
        if distance <= self.inner {
            return Some((inward * (self.max_force / self.inner), 1.0));
        }
        // Written so that NaN is beyond.
        if distance < self.reach {
            let fade = (self.reach - distance) / (self.reach - self.inner);
            return Some((inward * (self.max_force * fade / distance), fade));
        }
        None
    }
}
