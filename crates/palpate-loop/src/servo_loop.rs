// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The loop around a servo and a device, tick by tick; in a call or in a thread of its own.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate_haptics::{Device, DeviceLost, PointState, Servo, ServoEnd};
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use palpate_field::Vector;

use crate::clock::Clock;
use crate::pacer::{Pace, Pacer, nanoseconds};
use crate::recorder::{Recorder, TickTimes, TraceRow, rows};
use crate::records::RowQueue;
use crate::report::{Ending, RunReport, Tally};
use crate::run::Motion;

/// How long before a tick its rehearsals begin: the first loads the caches, the others train
/// the branch predictors.
const REHEARSAL: Duration = Duration::from_micros(60);

/// Where the rows of ticks go, beside a recorder.
pub(crate) enum RowSink<'a, const D: usize> {
    /// To another thread, which may fall behind.
    Queue(RowQueue<D>),
    /// To a closure in the loop, which the loop waits for.
    Call(&'a mut (dyn FnMut(&TraceRow<D>) + Send)),
}

/// A servo with its device, recorder and hand-off.
pub(crate) struct ServoLoop<'a, const D: usize> {
    servo: &'a mut Servo<D>,
    device: &'a mut dyn Device<D>,
    recorder: Option<&'a mut Recorder<D>>,
    sink: Option<RowSink<'a, D>>,
    end: Option<&'a mut ServoEnd<D>>,
    motion: Option<Motion<'a, D>>,
    interrupt: Option<&'a AtomicBool>,
    states: Vec<PointState<D>>,
    /// The states with which the next tick is rehearsed.
    expected: Vec<PointState<D>>,
    /// Zero forces, written at the end.
    no_forces: Vec<Vector<f64, D>>,
    /// Whether the device has rotation, and so takes a torque.
    is_turned: bool,
    tally: Tally<D>,
}

/// The pace and the number of ticks.
pub(crate) struct Schedule {
    /// The number of ticks, unless the other end of the hand-off ends the loop before.
    pub(crate) ticks: u64,
    pub(crate) pace: Pace,
    /// Whether ticks are rehearsed.
    pub(crate) rehearses: bool,
}

impl<'a, const D: usize> ServoLoop<'a, D> {
    /// A loop with a device that was [checked](Servo::check_device).
    pub(crate) fn new(servo: &'a mut Servo<D>, device: &'a mut dyn Device<D>) -> Self {
        let points = device.points();
        let tally = Tally::new(servo);
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
            is_turned: false,
            tally,
        }
    }

    pub(crate) fn recording(mut self, recorder: Option<&'a mut Recorder<D>>) -> Self {
        self.recorder = recorder;
        self
    }

    pub(crate) fn sending(mut self, sink: Option<RowSink<'a, D>>) -> Self {
        self.sink = sink;
        self
    }

    pub(crate) fn handing_off(mut self, end: Option<&'a mut ServoEnd<D>>) -> Self {
        self.end = end;
        self
    }

    pub(crate) fn moving(mut self, motion: Option<Motion<'a, D>>) -> Self {
        self.motion = motion;
        self
    }

    pub(crate) fn interrupted_by(mut self, interrupt: Option<&'a AtomicBool>) -> Self {
        self.interrupt = interrupt;
        self
    }

    /// Runs the loop. However it ends, the last that it writes are zero forces and a zero torque;
    /// the report says whether the device took them.
    pub(crate) fn run(mut self, clock: &mut dyn Clock, schedule: &Schedule) -> RunReport {
        let ticks = AssertUnwindSafe(|| self.ticks(clock, schedule));
        let ending = match catch_unwind(ticks) {
            Ok(Ok(ending)) => ending,
            Ok(Err(lost)) => Ending::DeviceLost { reason: lost.reason },
            Err(panic) => Ending::Panicked { message: message_of(&*panic) },
        };
        // A panic of the device must not unwind through the servo.
        let zero_forces = AssertUnwindSafe(|| self.device.write(&self.no_forces));
        let zero_forces = catch_unwind(zero_forces);
        let zero_torque = AssertUnwindSafe(|| self.device.write_torque(Vector::ZERO));
        let zero_torque = catch_unwind(zero_torque);
        let is_released = matches!((zero_forces, zero_torque), (Ok(Ok(())), Ok(Ok(()))));
        if let Some(end) = &self.end {
            end.finish();
        }
        let lost = match &self.sink {
            Some(RowSink::Queue(queue)) => queue.lost(),
            Some(RowSink::Call(_)) | None => 0,
        };
        let dropped = lost + self.recorder.map_or(0, |recorder| recorder.dropped());
        self.tally.report(ending, is_released, dropped, self.servo.safety())
    }

    fn ticks(
        &mut self,
        clock: &mut dyn Clock,
        schedule: &Schedule,
    ) -> Result<Ending, DeviceLost> {
        let rate = self.servo.options().rate;
        let mut pacer = Pacer::new(clock, rate);
        for tick in 0..schedule.ticks {
            let time_s = tick as f64 / rate;
            let mut lateness_ns = 0;
            if schedule.pace == Pace::RealTime {
                let late = if schedule.rehearses {
                    pacer.wait_warm(clock, REHEARSAL, || self.rehearse())
                } else {
                    pacer.wait(clock)
                };
                self.tally.late(late.ns, late.is_missed);
                self.servo.set_late(if late.is_missed { late.ns as f64 * 1e-9 } else { 0.0 });
                lateness_ns = late.ns;
            }
            if self.end.as_ref().is_some_and(|end| end.is_to_end()) {
                break;
            }
            if self.interrupt.is_some_and(|asked| asked.load(Ordering::Relaxed)) {
                return Ok(Ending::Interrupted);
            }
            let cost_ns = self.tick(clock, time_s)?;
            self.account(TickTimes { time_s, cost_ns, lateness_ns });
        }
        Ok(Ending::Finished)
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

    /// One tick, from reading to writing. Returns the duration of the servo's step [ns],
    /// without the device's transport.
    fn tick(&mut self, clock: &mut dyn Clock, time_s: f64) -> Result<u64, DeviceLost> {
        if let Some(end) = &mut self.end {
            end.receive(self.servo);
        }
        if let Some(motion) = &mut self.motion {
            motion(time_s, &mut |body, pose| self.servo.set_pose(body, pose));
        }
        self.device.read(time_s, &mut self.states)?;
        let turn = self.device.read_turn()?;
        self.is_turned |= turn.is_some();
        self.servo.set_turn(turn);
        let start = clock.now();
        self.servo.step(&self.states);
        let cost = clock.now().saturating_sub(start);
        self.device.write(self.servo.forces())?;
        if self.is_turned {
            self.device.write_torque(self.servo.torque())?;
        }
        Ok(nanoseconds(cost))
    }

    /// Records and publishes a tick after its forces were written: this may delay the next
    /// tick, but not change it.
    fn account(&mut self, times: TickTimes) {
        let progress = self.tally.tick(times, self.servo);
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
