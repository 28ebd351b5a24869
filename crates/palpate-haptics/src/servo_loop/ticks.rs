// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The loop around a servo and a device, tick by tick; in a call or in a thread of its own.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::{NextPose, Servo, ServoEnd};
use palpate_device::{Buttons, Device, DeviceLost, PointState, Reading};
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use palpate_field::Vector;

use super::clock::Clock;
use super::connection::{Connection, Reconnection};
use super::pacer::{Follower, Pace, Pacer, nanoseconds};
use super::recorder::{Recorder, TickTimes, TraceRow, rows};
use super::records::RowQueue;
use super::report::{Ended, Ending, RunReport, Tally};
use super::run::BodyMotion;
use super::vibration::Player;

/// How long before a tick its rehearsals begin: the first loads the caches, the others train
/// the branch predictors.
const REHEARSAL: Duration = Duration::from_micros(60);

/// Where the rows of ticks go, beside a recorder.
pub(crate) enum RowSink<'a> {
    /// To another thread, which may fall behind.
    Queue(RowQueue),
    /// To a closure in the loop, which the loop waits for.
    Call(&'a mut (dyn FnMut(&TraceRow) + Send)),
}

/// A servo with its device, recorder and hand-off, and a player whose device lives for `'v`.
pub(crate) struct ServoLoop<'a, 'v> {
    servo: &'a mut Servo,
    device: &'a mut dyn Device,
    recorder: Option<&'a mut Recorder>,
    sink: Option<RowSink<'a>>,
    end: Option<&'a mut ServoEnd>,
    motion: Option<BodyMotion<'a>>,
    interrupt: Option<&'a AtomicBool>,
    states: Vec<PointState>,
    /// The states with which the next tick is rehearsed.
    expected: Vec<PointState>,
    /// Zero forces, written at the end.
    no_forces: Vec<Vector<f64, 3>>,
    connection: Connection,
    vibration: Option<&'a mut Player<'v>>,
    /// Whether the servo limits the force of a gripper.
    has_gripper: bool,
    /// The time of the tick since the servo started [s].
    time: f64,
    /// Whether the device has rotation, and so takes a torque.
    is_turned: bool,
    tally: Tally,
}

/// The pace and the number of ticks.
pub(crate) struct Schedule {
    /// The number of ticks, unless the other end of the hand-off ends the loop before.
    pub(crate) ticks: u64,
    pub(crate) pace: Pace,
    /// Whether ticks are rehearsed.
    pub(crate) rehearses: bool,
}

impl<'a, 'v> ServoLoop<'a, 'v> {
    /// A loop with a device that was [checked](Servo::check_device).
    #[inline(never)]
    pub(crate) fn new(servo: &'a mut Servo, device: &'a mut dyn Device) -> Self {
        let points = device.points();
        let has_gripper = servo.protection().profile.gripper.is_some();
        let (tally, servo_rate) = (Tally::new(servo), servo.options().rate);
        Self {
            servo,
            device,
            recorder: None,
            sink: None,
            end: None,
            motion: None,
            interrupt: None,
            states: vec![PointState::at_rest(Vector::ZERO); points],
            expected: vec![PointState::at_rest(Vector::ZERO); points],
            no_forces: vec![Vector::ZERO; points],
            connection: Connection::new(servo_rate, None),
            vibration: None,
            has_gripper,
            time: 0.0,
            is_turned: false,
            tally,
        }
    }

    pub(crate) fn recording(mut self, recorder: Option<&'a mut Recorder>) -> Self {
        self.recorder = recorder;
        self
    }

    pub(crate) fn sending(mut self, sink: Option<RowSink<'a>>) -> Self {
        self.sink = sink;
        self
    }

    pub(crate) fn handing_off(mut self, end: Option<&'a mut ServoEnd>) -> Self {
        self.end = end;
        self
    }

    pub(crate) fn moving(mut self, motion: Option<BodyMotion<'a>>) -> Self {
        self.motion = motion;
        self
    }

    pub(crate) fn reconnecting(mut self, reconnection: Option<Reconnection>) -> Self {
        self.connection = Connection::new(self.servo.options().rate, reconnection);
        self
    }

    pub(crate) fn vibrating(mut self, vibration: Option<&'a mut Player<'v>>) -> Self {
        self.vibration = vibration;
        self
    }

    pub(crate) fn interrupted_by(mut self, interrupt: Option<&'a AtomicBool>) -> Self {
        self.interrupt = interrupt;
        self
    }

    /// Runs the loop. However it ends, the last that it writes are zero forces and a zero torque,
    /// it closes the device, and it silences the one that vibrates; the report says whether the
    /// devices took that.
    #[inline(never)]
    pub(crate) fn run(mut self, clock: &mut dyn Clock, schedule: &Schedule) -> RunReport {
        let ticks = AssertUnwindSafe(|| self.ticks(clock, schedule));
        let ending = match catch_unwind(ticks) {
            Ok(Ok(ending)) => ending,
            Ok(Err(lost)) => Ending::DeviceLost { reason: lost.reason },
            Err(panic) => Ending::Panicked { message: message_of(&*panic) },
        };
        let is_released = self.release();
        let vibration = self.vibration.take().map(Player::finish);
        if let Some(end) = &self.end {
            end.finish();
        }
        let lost = match &self.sink {
            Some(RowSink::Queue(queue)) => queue.lost(),
            Some(RowSink::Call(_)) | None => 0,
        };
        let dropped = lost + self.recorder.map_or(0, |recorder| recorder.dropped());
        let ended = Ended {
            ending,
            is_released,
            rows_dropped: dropped,
            safety: self.servo.safety(),
            connection: self.connection.report(self.time),
            vibration,
        };
        self.tally.report(ended)
    }

    /// Writes zeros and closes the device. `false` if it did not take the zeros.
    fn release(&mut self) -> bool {
        if !self.connection.was_opened() {
            return true;
        }
        let took = self.write_zeros().iter().all(|zeros| matches!(zeros, Ok(Ok(()))));
        let Self { device, connection, .. } = self;
        let is_closed = catch_unwind(AssertUnwindSafe(|| connection.close(*device)));
        took && is_closed.is_ok()
    }

    fn ticks(
        &mut self,
        clock: &mut dyn Clock,
        schedule: &Schedule,
    ) -> Result<Ending, DeviceLost> {
        self.connect()?;
        let rate = self.servo.options().rate;
        let mut pacer = Pacer::new(clock, rate);
        let mut follower = Follower::new(rate);
        for tick in 0..schedule.ticks {
            let is_followed = schedule.pace == Pace::Device && self.connection.is_open();
            let mut late = None;
            if schedule.pace == Pace::RealTime || schedule.pace == Pace::Device && !is_followed
            {
                late = Some(if schedule.rehearses {
                    pacer.wait_warm(clock, REHEARSAL, || self.rehearse())
                } else {
                    pacer.wait(clock)
                });
            }
            if schedule.pace != Pace::Device {
                self.time = tick as f64 / rate;
            }
            if self.end.as_ref().is_some_and(|end| end.is_to_end()) {
                break;
            }
            if self.interrupt.is_some_and(|asked| asked.load(Ordering::Relaxed)) {
                return Ok(Ending::Interrupted);
            }
            let reading = self.read()?;
            let elapsed = self.connection.see(reading);
            if schedule.pace == Pace::Device {
                let followed = follower.follow(clock, elapsed, reading);
                self.time += followed.time;
                if is_followed {
                    late = Some(followed.late);
                    pacer.restart(clock);
                }
            }
            if let Some(late) = late {
                self.tally.late(late.ns, late.is_missed);
                self.servo.set_late(if late.is_missed { late.ns as f64 * 1e-9 } else { 0.0 });
            }
            let cost_ns = self.tick(clock, reading)?;
            let lateness_ns = late.map_or(0, |late| late.ns);
            self.account(TickTimes { time_s: self.time, cost_ns, lateness_ns });
        }
        Ok(Ending::Finished)
    }

    /// Opens the device.
    ///
    /// # Errors
    ///
    /// As [`Connection::lose`].
    fn connect(&mut self) -> Result<(), DeviceLost> {
        let servo = &*self.servo;
        // Another device may have been plugged in.
        let fits = |device: &dyn Device| {
            servo.check_device(device).map_err(|error| DeviceLost::new(error.to_string()))
        };
        let opened = self.connection.open(&mut *self.device, self.time, fits);
        opened.or_else(|lost| self.lose(lost))
    }

    /// Takes note that the device was lost.
    ///
    /// # Errors
    ///
    /// As [`Connection::lose`].
    fn lose(&mut self, lost: DeviceLost) -> Result<(), DeviceLost> {
        if self.connection.is_open() && self.connection.reconnects() {
            // What can still be written may reach the hand; that it need not is known.
            drop(self.write_zeros());
        }
        self.connection.lose(&mut *self.device, lost, self.time)
    }

    /// Reads the device; one that is lost is not ready.
    fn read(&mut self) -> Result<Reading, DeviceLost> {
        if self.connection.is_due(self.time) {
            self.connect()?;
        }
        if self.connection.is_open() {
            match self.read_open() {
                Ok(reading) => return Ok(reading),
                Err(lost) => self.lose(lost)?,
            }
        }
        self.servo.set_buttons(Buttons::NONE);
        self.servo.set_gripper(None);
        Ok(Reading::NotReady)
    }

    fn read_open(&mut self) -> Result<Reading, DeviceLost> {
        let reading = self.device.read(self.time, &mut self.states)?;
        let turn = self.device.read_turn()?;
        self.is_turned |= turn.is_some();
        self.servo.set_turn(turn);
        self.servo.set_buttons(self.device.buttons());
        let gripper = self.device.read_gripper()?;
        self.servo.set_gripper(gripper);
        Ok(reading)
    }

    /// Writes each zero, whether or not the device took the others, and even if it panics.
    fn write_zeros(&mut self) -> [std::thread::Result<Result<(), DeviceLost>>; 3] {
        let Self { device, no_forces, .. } = self;
        [
            catch_unwind(AssertUnwindSafe(|| device.write(no_forces))),
            catch_unwind(AssertUnwindSafe(|| device.write_torque(Vector::ZERO))),
            catch_unwind(AssertUnwindSafe(|| device.write_gripper_force(0.0))),
        ]
    }

    fn write(&mut self) -> Result<(), DeviceLost> {
        self.device.write(self.servo.forces())?;
        if self.is_turned {
            self.device.write_torque(self.servo.torque())?;
        }
        if self.has_gripper {
            self.device.write_gripper_force(self.servo.gripper_force())?;
        }
        Ok(())
    }

    /// Rehearses the next tick, because the sleep between ticks lets caches and branch
    /// predictors go cold.
    fn rehearse(&mut self) {
        let period = 1.0 / self.servo.options().rate;
        for (expected, PointState { position, velocity }) in
            self.expected.iter_mut().zip(&self.states)
        {
            let (position, velocity) = (*position + *velocity * period, *velocity);
            *expected = PointState { position, velocity };
        }
        self.servo.rehearse(&self.expected);
    }

    /// One tick after its reading, to its writing. Returns the duration of the servo's step [ns],
    /// without the device's transport.
    fn tick(&mut self, clock: &mut dyn Clock, reading: Reading) -> Result<u64, DeviceLost> {
        if let Some(end) = &mut self.end {
            end.receive(self.servo);
        }
        if let Some(motion) = &mut self.motion {
            let servo = self.servo.renderer_mut();
            motion(self.time, &mut |body, NextPose { pose, jumps }| {
                if jumps { servo.jump(body, pose) } else { servo.set_pose(body, pose) }
            });
        }
        self.servo.set_reading(reading);
        let start = clock.now();
        self.servo.step(&self.states);
        let cost = clock.now().saturating_sub(start);
        let written = if self.connection.is_open() { self.write() } else { Ok(()) };
        written.or_else(|lost| self.lose(lost))?;
        Ok(nanoseconds(cost))
    }

    /// Records and publishes a tick after its forces were written: this may delay the next
    /// tick, but not change it.
    fn account(&mut self, times: TickTimes) {
        let progress = self.tally.tick(times, self.servo);
        if let Some(vibration) = &mut self.vibration {
            vibration.tick(self.servo);
        }
        if let Some(end) = &mut self.end {
            end.publish(&*self.servo, &progress);
        }
        if self.recorder.is_none() && self.sink.is_none() {
            return;
        }
        for row in rows(times, self.servo) {
            if let Some(recorder) = &mut self.recorder {
                recorder.keep(row);
            }
            match &mut self.sink {
                Some(RowSink::Queue(queue)) => queue.push(row),
                Some(RowSink::Call(take)) => take(&row),
                None => {}
            }
        }
    }
}

fn message_of(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().copied();
    let text = text.or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    text.unwrap_or("no message").to_owned()
}
