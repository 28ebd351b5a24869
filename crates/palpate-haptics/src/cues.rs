// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Touches as vibration needs them.

use palpate_vibration::{Cue, Tap};

use crate::contact_point::Touch;
use crate::material::Impact;

impl From<&Impact> for Tap {
    /// The ringing of a tap on a material.
    fn from(impact: &Impact) -> Self {
        let Impact { amplitude, frequency, decay, .. } = *impact;
        Self { amplitude, frequency, decay }
    }
}

impl Touch {
    /// The cue of this touch on a smooth and mute surface; it does not depend on the force that
    /// the device gives. Set `began` if there was no contact in the tick before.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn cue(&self, began: bool) -> Cue {
        if !self.contact {
            return Cue::default();
        }
        let outward = self.velocity.dot(self.normal);
        Cue {
            depth: self.depth(),
            normal_force: self.wanted.dot(self.normal),
            normal_speed: -outward,
            slide_speed: (self.velocity - self.normal * outward).norm(),
            wavelength: None,
            impact: None,
            began,
        }
    }
}
