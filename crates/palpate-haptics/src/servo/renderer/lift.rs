// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A hand that is lifted off the bodies.

use super::Renderer;

impl Renderer {
    /// Whether the hand is [lifted](crate::Servo::lift) off the bodies.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn is_lifted(&self) -> bool {
        self.setting.is_lifted
    }

    /// Lifts the hand off the bodies, or sets it down.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[inline(never)]
    pub(crate) fn lift(&mut self, is_lifted: bool) {
        self.setting.is_lifted = is_lifted;
    }
}
