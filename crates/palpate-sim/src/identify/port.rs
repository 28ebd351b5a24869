// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The device during an identification: one axis is pushed, and limits are kept.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::time::Duration;

use palpate_device::{Device, DeviceLost, PointState, Reading as Measured};
use palpate_field::{Rotation, Vector};

use super::options::{Bounds, IdentifyOptions, SPEED_RESERVE};
use super::{DeviceAxis, IdentifyError, IdentifyProgress};

/// Gives the time of the next tick [s], when that has come; `None` to stop.
pub(super) type NextTick<'a> = dyn FnMut(&IdentifyProgress) -> Option<f64> + 'a;

/// The time over which the speed limit is checked [s].
const SPEED_WINDOW: f64 = 0.004;

/// The time over which the speed of a known mass is measured [s].
const LONG_WINDOW: f64 = 0.016;

/// The longest that a force may be held because a tick is late [s]: the handle moves by some
/// millimetres meanwhile.
const LONGEST_HOLD: f64 = 0.02;

/// The longest that a device without a force may not be measured [s].
const LONGEST_WAIT: f64 = 1.0;

/// How long a device is to hold a force without a new one: longer than [`LONGEST_HOLD`].
const WATCHDOG: Duration = Duration::from_millis(30);

/// One reading of the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Reading {
    /// The time [s].
    pub(super) time: f64,
    /// The place from the start of the identification [m], or the angle [rad].
    pub(super) place: f64,
    /// The force held since the reading before [N], or the torque [N·m].
    pub(super) held: f64,
}

/// A device of which one axis is pushed. Once it is open, zero forces are written when it is dropped.
pub(super) struct Port<'a> {
    device: &'a mut dyn Device,
    next_tick: &'a mut NextTick<'a>,
    pub(super) progress: IdentifyProgress,
    options: IdentifyOptions,
    pub(super) bounds: Bounds,
    points: Vec<PointState>,
    forces: Vec<Vector<f64, 3>>,
    /// The time of the first tick [s].
    first_tick: Option<f64>,
    start: Option<PointState>,
    start_turn: Option<Rotation<3>>,
    /// Angles from the start of the identification [rad].
    turned: Vector<f64, 3>,
    /// The angle about the other axes at the start of the axis [rad].
    pub(super) tilt: f64,
    /// Whether the device is to be closed.
    is_open: bool,
    /// The time of the last tick, at most a period [s].
    shortest: f64,
    has_torque: bool,
    last: Reading,
    /// Readings of the last [`LONG_WINDOW`], the newest first.
    recent: VecDeque<Reading>,
}

impl<'a> Port<'a> {
    pub(super) fn new(
        device: &'a mut dyn Device,
        options: IdentifyOptions,
        next_tick: &'a mut NextTick<'a>,
    ) -> Self {
        let count = device.points();
        let axis = DeviceAxis::Along(0);
        let bounds = options.along(device.profile());
        Self {
            has_torque: options.about(device.profile()).is_some(),
            device,
            next_tick,
            progress: IdentifyProgress { axis, axis_number: 0, axes: 0, strokes: 0 },
            options,
            bounds,
            points: vec![PointState::at_rest(Vector::ZERO); count],
            forces: vec![Vector::ZERO; count],
            first_tick: None,
            start: None,
            start_turn: None,
            turned: Vector::ZERO,
            tilt: 0.0,
            is_open: false,
            shortest: 1.0 / options.rate,
            last: Reading { time: f64::NEG_INFINITY, place: 0.0, held: 0.0 },
            recent: VecDeque::new(),
        }
    }

    /// Opens the device, and lets it give forces.
    pub(super) fn open(&mut self) -> Result<(), IdentifyError> {
        let axis = self.axis();
        let lost = |lost| IdentifyError::Lost { axis, lost };
        self.device.open().map_err(|lost| IdentifyError::NotOpened { lost })?;
        self.is_open = true;
        let _ = self.device.set_watchdog(WATCHDOG).map_err(lost)?;
        self.device.enable().map_err(lost)
    }

    /// Takes up another axis, and reads where it is.
    pub(super) fn turn_to(
        &mut self,
        axis: DeviceAxis,
        bounds: Bounds,
    ) -> Result<(), IdentifyError> {
        self.progress.axis = axis;
        self.progress.axis_number += 1;
        self.progress.strokes = 0;
        self.bounds = bounds;
        let window = (LONG_WINDOW * self.options.rate).ceil().max(2.0) as usize;
        self.recent.clear();
        let reading = self.tick(0.0)?;
        self.recent = vec![reading; window].into();
        let mut others = self.turned;
        if let DeviceAxis::About(i) = axis
            && let Some(own) = others.0.get_mut(i)
        {
            *own = 0.0;
        }
        self.tilt = others.norm();
        Ok(())
    }

    pub(super) fn axis(&self) -> DeviceAxis {
        self.progress.axis
    }

    pub(super) fn rate(&self) -> f64 {
        self.options.rate
    }

    /// Waits for the first tick in which the device was measured again since the time `before` [s],
    /// while it holds `force`, and gives its time [s].
    fn wait(&mut self, force: f64, before: f64) -> Result<f64, IdentifyError> {
        let axis = self.axis();
        let mut last = before;
        loop {
            let time =
                (self.next_tick)(&self.progress).ok_or(IdentifyError::Interrupted { axis })?;
            // Written so that NaN is refused.
            let goes_on = time > last && time < f64::INFINITY;
            if !goes_on {
                return Err(IdentifyError::TimeNotIncreasing { axis, before: last, time });
            }
            let reading = self.device.read(time, &mut self.points);
            let reading = reading.map_err(|lost| IdentifyError::Lost { axis, lost })?;
            if force != 0.0 && time - before > LONGEST_HOLD {
                return Err(IdentifyError::Late { axis, late: time - before });
            }
            if matches!(reading, Measured::Fresh { .. }) {
                return Ok(time);
            }
            // Before the first reading there is no time to count from.
            let since = before.max(self.first_tick.unwrap_or(time));
            if time - since > LONGEST_WAIT {
                return Err(IdentifyError::NotMeasured { axis, since: time - since });
            }
            self.first_tick.get_or_insert(time);
            last = time;
        }
    }

    /// Holds `force` until the next tick, and reads then. A change that is faster than the
    /// device allows takes several ticks; the reading says what was held.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic, if the device and the clock
    /// keep that.
    pub(super) fn tick(&mut self, force: f64) -> Result<Reading, IdentifyError> {
        let axis = self.axis();
        let force = self.within_rate(force);
        let lost = |lost| IdentifyError::Lost { axis, lost };
        self.write(force).map_err(lost)?;
        let before = self.last.time;
        let time = self.wait(force, before)?;
        let turn = if self.has_torque { self.device.read_turn().map_err(lost)? } else { None };
        let point = self.points.first().copied();
        let point = point.filter(|point| point.position.is_finite());
        let Some(point) = point else { return Err(IdentifyError::NotFinite { axis, time }) };
        if turn.is_none() && self.has_torque {
            return Err(IdentifyError::NoOrientation { axis, time });
        }
        let start = *self.start.get_or_insert(point);
        let moved = point.position - start.position;
        let turned = turn.map_or(Vector::ZERO, |turn| {
            let start = self.start_turn.get_or_insert(turn.orientation);
            start.turn_to(&turn.orientation)
        });
        self.turned = turned;
        self.check_range(moved, turned)?;
        let place = match axis {
            DeviceAxis::Along(i) => moved.0.get(i).copied(),
            DeviceAxis::About(i) => turned.0.get(i).copied(),
        };
        // A range check lets no NaN through.
        let reading = Reading { time, place: place.unwrap_or_default(), held: force };
        if self.recent.pop_back().is_some() {
            self.recent.push_front(reading);
        }
        if before > f64::NEG_INFINITY {
            self.shortest = (time - before).min(1.0 / self.options.rate);
        }
        self.last = reading;
        let (speed, limit) = (self.speed().abs(), SPEED_RESERVE * self.bounds.speed);
        if speed > limit {
            return Err(IdentifyError::TooFast { axis, speed, limit });
        }
        Ok(reading)
    }

    /// The mean velocity over the last [`SPEED_WINDOW`] [m/s], or [rad/s].
    pub(super) fn speed(&self) -> f64 {
        let time = |earlier: &&Reading| self.last.time - earlier.time;
        let earlier = self.recent.iter().find(|earlier| time(earlier) >= SPEED_WINDOW);
        // Of ticks that come faster than asked, the oldest.
        let earlier = earlier.or(self.recent.back()).filter(|earlier| time(earlier) > 0.0);
        earlier.map_or(0.0, |earlier| (self.last.place - earlier.place) / time(&earlier))
    }

    /// The velocity now of a handle of a known mass [m/s], or [rad/s]: the slope of the line
    /// through the readings of the last [`LONG_WINDOW`], without what the forces moved. Encoder
    /// steps average out, and it does not lag behind as a mean does.
    pub(super) fn speed_of(&self, mass: f64) -> f64 {
        velocity_now(self.recent.iter(), mass)
    }

    /// The last reading.
    pub(super) fn last(&self) -> Reading {
        self.last
    }

    /// Writes zero forces.
    pub(super) fn release(&mut self) -> Result<(), DeviceLost> {
        self.last.held = 0.0;
        self.write(0.0)
    }

    fn within_rate(&self, force: f64) -> f64 {
        let change = self.bounds.force_rate * self.shortest;
        let bound = self.bounds.force;
        let held = self.last.held;
        if force.is_nan() {
            return 0.0;
        }
        // Not `clamp`, which panics where a bound is NaN.
        force.max(held - change).min(held + change).max(-bound).min(bound)
    }

    fn write(&mut self, force: f64) -> Result<(), DeviceLost> {
        let (mut along, mut about) = (Vector::ZERO, Vector::ZERO);
        let place = match self.axis() {
            DeviceAxis::Along(i) => along.0.get_mut(i),
            DeviceAxis::About(i) => about.0.get_mut(i),
        };
        if let Some(place) = place {
            *place = force;
        }
        if let Some(first) = self.forces.first_mut() {
            *first = along;
        }
        // Each is written even if the device does not take the other, or panics: it may be a zero.
        let along = catch_unwind(AssertUnwindSafe(|| self.device.write(&self.forces)));
        let about = if self.has_torque {
            catch_unwind(AssertUnwindSafe(|| self.device.write_torque(about)))
        } else {
            Ok(Ok(()))
        };
        match (along, about) {
            (Ok(along), Ok(about)) => along.and(about),
            (Err(panic), _) | (_, Err(panic)) => resume_unwind(panic),
        }
    }

    /// Refuses a handle that left its range along or about any axis.
    fn check_range(
        &self,
        moved: Vector<f64, 3>,
        turned: Vector<f64, 3>,
    ) -> Result<(), IdentifyError> {
        let along = moved.0.iter().enumerate();
        let along = along.map(|(i, x)| (DeviceAxis::Along(i), *x, self.options.travel));
        let about = turned.0.iter().enumerate();
        let about = about.map(|(i, x)| (DeviceAxis::About(i), *x, self.options.angle));
        // Written so that NaN is refused.
        match along
            .chain(about)
            .find(|(_, x, limit)| !matches!(x.abs().partial_cmp(limit), Some(o) if o.is_le()))
        {
            Some((axis, moved, limit)) => {
                Err(IdentifyError::LeftRange { axis, moved: moved.abs(), limit })
            }
            None => Ok(()),
        }
    }
}

/// The velocity of a mass at the first of its readings, the newest, by least squares.
fn velocity_now<'r>(recent: impl Iterator<Item = &'r Reading> + Clone, mass: f64) -> f64 {
    // Backwards from now: time, and what the forces added to the place and the velocity.
    let (mut time, mut place, mut velocity) = (0.0, 0.0, 0.0);
    let mut sums = Sums::default();
    if let Some(now) = recent.clone().next() {
        sums.add(0.0, now.place);
    }
    for (after, before) in recent.clone().zip(recent.skip(1)) {
        let duration = after.time - before.time;
        if duration <= 0.0 {
            break;
        }
        let gained = duration * after.held / mass;
        velocity += gained;
        place += (velocity - 0.5 * gained) * duration;
        time += duration;
        sums.add(-time, before.place - place);
    }
    sums.slope()
}

/// Sums for a line by least squares.
#[derive(Default)]
struct Sums {
    count: f64,
    x: f64,
    y: f64,
    xx: f64,
    xy: f64,
}

impl Sums {
    fn add(&mut self, x: f64, y: f64) {
        self.count += 1.0;
        self.x += x;
        self.y += y;
        self.xx += x * x;
        self.xy += x * y;
    }

    /// The slope; zero of a point.
    fn slope(&self) -> f64 {
        let spread = self.count * self.xx - self.x * self.x;
        if spread > 0.0 { (self.count * self.xy - self.x * self.y) / spread } else { 0.0 }
    }
}

impl Drop for Port<'_> {
    fn drop(&mut self) {
        if !self.is_open {
            return;
        }
        // Ignored: the error that ends the identification says more, and a device that is lost
        // takes no zero. A panic within another one would end the process before the device is
        // closed.
        drop(catch_unwind(AssertUnwindSafe(|| self.release())));
        drop(catch_unwind(AssertUnwindSafe(|| self.device.close())));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_velocity_of_an_accelerated_mass_is_exact() {
        // x = 0.1 t + ½ (F/m) t² at uneven times; now at t = 5 ms.
        let (force, mass) = (3.0, 0.2);
        let at = |time: f64| Reading {
            time,
            place: 0.1 * time + 0.5 * force / mass * time * time,
            held: force,
        };
        let readings = [0.005, 0.004, 0.0025, 0.0011, 0.0].map(at);
        let velocity = velocity_now(readings.iter(), mass);
        assert!((velocity - (0.1 + force / mass * 0.005)).abs() < 1e-14, "{velocity} m/s");
    }

    #[test]
    fn a_single_reading_rests() {
        let alone = [Reading { time: 1.0, place: 2.0, held: 3.0 }];
        assert_eq!(velocity_now(alone.iter(), 1.0), 0.0);
    }
}
