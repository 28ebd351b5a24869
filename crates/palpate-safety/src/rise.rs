// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The rise of a force that was zeroed.
//!
//! Each place that restarts a rise, from which force, and what lets the force rise again:
//!
//! | what happens | from | lets it rise |
//! |---|---|---|
//! | a servo begins: a new chain | zero | [`Recovery`] |
//! | an emergency stop is released | zero | [`Recovery`] |
//! | a hand that was lifted is set down in a body | zero | [`Recovery`] |
//! | a device is not ready: it has no state yet, or was lost | zero | [`Recovery`] |
//! | late ticks, and ticks without a new reading, trip the watchdog | the force that was written | at once |
//! | an input is not finite | zero | at once |
//! | a proxy or a tool is placed anew, by an edit or since a body moves onto it | zero | at once |
//! | bodies are replaced by ones that push harder | the force before | at once |
//!
//! In the first four the hand may be anywhere, and in a body for any reason: these are beginnings. In
//! the others a hand is at work, and what zeroed the force is not its doing: a wall that stayed soft
//! would let it through. Neither of them ends a wait that goes on. An edit that carries a proxy out
//! of a body restarts no rise: see [`Change::Carried`].

use palpate_field::Vector;

/// What lets a force rise after a beginning in a body: of a servo, after an emergency stop, where a
/// hand is set down, or when a device that was not ready comes.
///
/// After late ticks, readings that are missed or not finite, and edits, and where a body moves onto
/// the hand, the force rises at once, whichever this is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum Recovery {
    /// It rises at once, by [`SafetySettings::rise_rate`](crate::SafetySettings::rise_rate): a hand
    /// that sank into a wall is lifted out gently.
    #[default]
    Rise,
    /// It stays zero until no body pushes the hand, as in CHAI3D's `setWaitForSmallForce`.
    OnceOut,
}

/// What happened to a contact point or a tool in a tick, beside the motion of the hand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Change {
    /// Nothing.
    #[default]
    None,
    /// The hand begins anew: it is set down in a body, or the device is not ready. The force is
    /// zero, and [`Recovery`] says what lets it rise.
    Begins,
    /// An edit of the bodies carried the proxy, or the tool, out of them: the wanted force follows at
    /// once, and the force changes by at most 0.3 N a tick until it is there.
    Carried,
}

/// A limit on a force that was zeroed, which rises until the force is below it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rise {
    /// The increase of the limit in a tick [N].
    step: f64,
    recovery: Recovery,
    /// The largest force [N]; infinite if no force was zeroed.
    limit: f64,
    /// Whether the limit waits until the hand is out.
    is_waiting: bool,
    /// Whether the hand begins in this tick: whether it is out shows in the next.
    has_begun: bool,
}

impl Rise {
    /// A rise from zero by `rise_rate` [N/s], at `rate` [Hz].
    pub(crate) fn new(rise_rate: f64, recovery: Recovery, rate: f64) -> Self {
        let is_waiting = recovery == Recovery::OnceOut;
        let step = rise_rate / rate;
        Self { step, recovery, limit: 0.0, is_waiting, has_begun: false }
    }

    /// Rises by so many times the step.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn in_units(&mut self, longer: f64) {
        self.step *= longer;
    }

    /// Lowers the limit to `force` [N], from where it rises at once, or after the wait that goes on.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn restart(&mut self, force: f64) {
        // `min` ignores NaN.
        self.limit = self.limit.min(if force >= 0.0 { force } else { 0.0 });
    }

    /// Begins anew: from zero, and as [`Recovery`] says.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn begin(&mut self) {
        self.restart(0.0);
        self.is_waiting = self.recovery == Recovery::OnceOut;
        self.has_begun = self.is_waiting;
    }

    /// One tick: the part, in [0, 1], of the sum of a force `wanted` by bodies and a `free` one
    /// that may pass; `None` if the force had risen before.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[inline]
    pub(crate) fn step(&mut self, wanted: Vector<f64, 3>, free: Vector<f64, 3>) -> Option<f64> {
        (self.limit < f64::INFINITY).then(|| self.rise(wanted, free))
    }

    #[cold]
    fn rise(&mut self, wanted: Vector<f64, 3>, free: Vector<f64, 3>) -> f64 {
        let has_begun = std::mem::take(&mut self.has_begun);
        self.is_waiting &= has_begun || wanted != Vector::ZERO;
        let force = (wanted + free).norm();
        if !self.is_waiting {
            self.limit += self.step;
            if force <= self.limit {
                self.limit = f64::INFINITY;
            }
        }
        if force <= self.limit {
            return 1.0;
        }
        self.limit / force
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn steps(rise: &mut Rise, forces: &[f64]) -> Vec<f64> {
        let part =
            |rise: &mut Rise, x| rise.step(Vector([x, 0.0, 0.0]), Vector::ZERO).unwrap_or(1.0);
        forces.iter().map(|x| x * part(rise, *x)).collect()
    }

    #[test]
    fn it_rises_until_it_has_caught_up() {
        let mut rise = Rise::new(20.0, Recovery::Rise, 10.0);
        assert_eq!(steps(&mut rise, &[8.0, 8.0, 5.0, 9.0]), [2.0, 4.0, 5.0, 9.0]);
        assert_eq!(rise.step(Vector([0.0, 9.0, 0.0]), Vector::ZERO), None);
        rise.restart(3.0);
        assert_eq!(steps(&mut rise, &[8.0, 8.0]), [5.0, 7.0]);
        rise.restart(f64::NAN);
        assert_eq!(steps(&mut rise, &[8.0]), [2.0]);
    }

    #[test]
    fn it_waits_until_the_hand_is_out() {
        let mut rise = Rise::new(20.0, Recovery::OnceOut, 10.0);
        assert_eq!(steps(&mut rise, &[8.0, 8.0, 0.0, 8.0]), [0.0, 0.0, 0.0, 8.0]);
        rise.begin();
        // A body that covers the hand may push it in the next tick.
        assert_eq!(steps(&mut rise, &[0.0, 8.0]), [0.0, 0.0]);
        assert_eq!(rise.step(Vector::ZERO, Vector([0.0, 4.0, 0.0])), Some(0.5));
        assert_eq!(steps(&mut rise, &[16.0, 4.0]), [4.0, 4.0]);
    }

    #[test]
    fn a_restart_neither_begins_nor_ends_a_wait() {
        let mut rise = Rise::new(20.0, Recovery::OnceOut, 10.0);
        rise.restart(5.0);
        assert_eq!(steps(&mut rise, &[8.0, 8.0, 0.0, 8.0]), [0.0, 0.0, 0.0, 8.0]);
        rise.restart(3.0);
        assert_eq!(steps(&mut rise, &[8.0, 8.0, 8.0]), [5.0, 7.0, 8.0]);
        rise.begin();
        rise.restart(3.0);
        assert_eq!(steps(&mut rise, &[8.0, 8.0]), [0.0, 0.0]);
    }
}
