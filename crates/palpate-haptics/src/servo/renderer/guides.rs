// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The guides of contact points.

use std::mem::swap;

use super::Renderer;
use crate::guide::Guide;

impl Renderer {
    /// The guides of a contact point, as the last tick left them; none for a point that is not
    /// there.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    ///
    /// ```
    /// use palpate_field::{Shape, Vector};
    /// use palpate_device::PointState;
    /// use palpate_haptics::{Guide, GuideOptions, Servo};
    /// let mut servo = Servo::new(Shape::circle(0.05)?, 1, Default::default())?;
    /// servo.guide(&[Guide::to_point([0.0, 0.1, 0.0], GuideOptions::default())?]);
    /// servo.step(&[PointState::at_rest(Vector([0.0, 0.103, 0.0]))]);
    /// assert!(servo.guides(0)[0].is_engaged());
    /// assert!((servo.guides(0)[0].last_force() - Vector([0.0, -0.9, 0.0])).norm() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn guides(&self, point: u32) -> &[Guide] {
        self.contacts.points.get(point as usize).map_or(&[], |point| &point.guides)
    }

    /// Sets the guides of every contact point.
    #[inline(never)]
    pub(crate) fn guide(&mut self, guides: &[Guide]) {
        for point in &mut self.contacts.points {
            point.guides = guides.to_vec();
        }
    }

    /// Swaps the guides of each contact point with those of a list.
    ///
    /// Real-time: allocates nothing, frees nothing, takes no lock, cannot panic.
    #[inline(never)]
    pub(crate) fn exchange_guides(&mut self, guides: &mut [Vec<Guide>]) {
        let points = self.contacts.points.iter_mut();
        points.zip(guides).for_each(|(point, new)| swap(&mut point.guides, new));
    }
}
