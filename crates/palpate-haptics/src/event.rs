// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Events and energies of touch.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fmt;

use palpate_field::{Point, Vector};
use palpate_vibration::{Cue, Tap};

use crate::contact_point::Touch;
use crate::material::Impact;

/// An event at a contact point, or of a button.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Event {
    /// The tick, counted from 0.
    pub tick: u64,
    /// The index of the contact point.
    pub point: u32,
    /// The index of the body.
    pub body: u32,
    /// The kind of the event.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub kind: EventKind,
}

/// The kinds of events at a contact point.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(tag = "kind", rename_all = "snake_case"))]
#[non_exhaustive]
pub enum EventKind {
    /// The contact point begins to touch the body.
    Touch {
        /// The approach speed, along the normal and relative to the body [m/s].
        speed: f64,
    },
    /// The contact point no longer touches the body.
    Leave,
    /// The proxy begins to slip.
    Slip,
    /// The proxy begins to stick.
    Stick,
    /// A layer of a material gave way.
    Pop {
        /// The force that broke the layer [N].
        force: f64,
    },
    /// An edit of the bodies covered the proxy, or the tool, which was carried out of them.
    Carried {
        /// How far it was carried, the shortest way [m].
        distance: f64,
    },
    /// An edit of the bodies covered the proxy, or the tool, by more than it may be carried, or a
    /// body jumped to it or away from it: it was placed anew. A larger force then rises slowly:
    /// from zero after an edit, from the last force after a jump.
    Placed,
    /// The body moved, and left the proxy or the tool no room beside bodies that stand still. It
    /// yields: the proxy lies in it until there is room.
    Squeezed,
    /// A button of the device was pressed. Contact point and body are 0.
    ButtonDown {
        /// The index of the button.
        button: u8,
    },
    /// A button of the device was released.
    ButtonUp {
        /// The index of the button.
        button: u8,
    },
}

/// The number of events of each kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct EventCounts {
    /// Contacts that began.
    pub touches: u64,
    /// Contacts that ended.
    pub leaves: u64,
    /// Proxies that began to slip.
    pub slips: u64,
    /// Proxies that began to stick.
    pub sticks: u64,
    /// A layer of a material gave way.
    pub pops: u64,
    /// Edits that carried a proxy or a tool.
    pub carries: u64,
    /// Edits and jumps that placed a proxy or a tool anew.
    pub placements: u64,
    /// Bodies that moved and left a proxy or a tool no room.
    pub squeezes: u64,
    /// Buttons that were pressed.
    pub presses: u64,
    /// Buttons that were released.
    pub releases: u64,
}

impl EventCounts {
    /// Counts an event.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn count(&mut self, event: &Event) {
        *match event.kind {
            EventKind::Touch { .. } => &mut self.touches,
            EventKind::Leave => &mut self.leaves,
            EventKind::Slip => &mut self.slips,
            EventKind::Stick => &mut self.sticks,
            EventKind::Pop { .. } => &mut self.pops,
            EventKind::Carried { .. } => &mut self.carries,
            EventKind::Placed => &mut self.placements,
            EventKind::Squeezed => &mut self.squeezes,
            EventKind::ButtonDown { .. } => &mut self.presses,
            EventKind::ButtonUp { .. } => &mut self.releases,
        } += 1;
    }
}

impl fmt::Display for EventCounts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { touches, leaves: _, slips, sticks, pops, presses, releases: _, .. } = self;
        let Self { carries, placements, squeezes, .. } = self;
        write!(f, "{touches} touches, {slips} slips, {sticks} sticks, {pops} pops")?;
        if *carries > 0 {
            write!(f, ", {carries} carried by edits")?;
        }
        if *placements > 0 {
            write!(f, ", {placements} placed anew")?;
        }
        if *squeezes > 0 {
            write!(f, ", {squeezes} squeezed without room")?;
        }
        if *presses > 0 { write!(f, ", {presses} presses of buttons") } else { Ok(()) }
    }
}

/// Force and torque of all contact points on a body in a tick, in world coordinates: input for
/// a physics engine that moves the body.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Reaction {
    /// The force [N].
    pub force: Vector<f64, 3>,
    /// The torque about the body's origin [N·m]; in the plane about z alone.
    pub torque: Vector<f64, 3>,
}

impl Reaction {
    pub(crate) const NONE: Self = Self { force: Vector::ZERO, torque: Vector::ZERO };

    /// Adds a force that acts at `arm` from the body's origin, if the sum is finite.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn add(&mut self, force: Vector<f64, 3>, arm: Point<3>) {
        let torque = arm.cross(force);
        let sum = Self { force: self.force + force, torque: self.torque + torque };
        if sum.force.is_finite() && sum.torque.is_finite() {
            *self = sum;
        }
    }
}

/// Energy at a contact point since the start [J].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Energy {
    /// Energy that the rendered forces took from the hand.
    pub taken: f64,
    /// Energy that the rendered forces gave to the hand.
    pub given: f64,
    /// The work on the hand of bodies that are moved from outside. The energies above are those of the
    /// hand's motion relative to the bodies.
    pub driven: f64,
    /// Energy that the wanted forces would have given, but the rendered forces did not: what the
    /// safety chain held back (passivity controller, limits, ramps, stops).
    pub kept: f64,
}

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_said_in_their_order() {
        let counts = EventCounts {
            touches: 5,
            leaves: 4,
            slips: 3,
            sticks: 2,
            pops: 1,
            ..EventCounts::default()
        };
        assert_eq!(counts.to_string(), "5 touches, 3 slips, 2 sticks, 1 pops");
        let said = EventCounts { presses: 7, ..counts }.to_string();
        assert_eq!(said, "5 touches, 3 slips, 2 sticks, 1 pops, 7 presses of buttons");
        let said = EventCounts { carries: 8, placements: 6, squeezes: 9, ..counts }.to_string();
        let more = ", 8 carried by edits, 6 placed anew, 9 squeezed without room";
        assert_eq!(said, format!("5 touches, 3 slips, 2 sticks, 1 pops{more}"));
    }

    /// The sum of finite forces may overflow. Found by fuzzing.
    #[test]
    fn a_reaction_is_finite_whatever_is_added() {
        let mut reaction = Reaction::NONE;
        for (force, arm) in [(0.9, 0.0), (0.9, 0.0), (-0.1, 50.0), (f64::INFINITY, 0.0)] {
            reaction.add(Vector([0.0, force * f64::MAX, 0.0]), Vector([arm, 0.0, 0.0]));
        }
        assert_eq!(reaction.force, Vector([0.0, 0.9 * f64::MAX, 0.0]));
        assert_eq!(reaction.torque, Vector::ZERO);
        reaction.add(Vector([2.0, 0.0, 0.0]), Vector([0.0, 3.0, 0.0]));
        assert_eq!(reaction.torque, Vector([0.0, 0.0, -6.0]));
    }
}
