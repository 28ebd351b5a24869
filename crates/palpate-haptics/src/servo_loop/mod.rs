// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The loop around a servo and its device. The loop paces, counts, records and reports.
//!
//! [`run`] runs the loop in a call. A [`ServoThread`] runs the same loop in a thread; its
//! [`Control`](crate::Control) replaces bodies and reads snapshots without ever
//! making the servo wait. `run` and the thread accept only a [`Servo`](crate::Servo),
//! which has a safety chain. The last that they write are zero forces, after a panic too; the
//! report says whether the device took them.
//!
//! The loop opens its device, sets the watchdog of the device, and closes it. It runs at the pace of
//! a clock or of the [device](Pace::Device); a lost device ends the run, or is looked for by a
//! [`Reconnection`] while ticks go on without force. A [`Vibration`] plays the touches on a device
//! that shakes, and silences it at the end.
//!
//! The loop runs on the machine's clock, a [`WallClock`], or, in tests, on a [`VirtualClock`]. A
//! [`Recorder`] keeps every tick, [`Records`] hand them to another thread while the servo runs, a
//! [`TraceWriter`] writes them as CSV, a [`RunReport`] summarises a run, and [`Lateness`] measures
//! how late a machine wakes up.
//!
//! # Examples
//!
//! ```
//! use palpate_sim::{RecordedDevice, Tour};
//! use palpate_field::{Shape, kernel::Ball};
//! use palpate_haptics::Servo;
//! use palpate_haptics::servo_loop::{Pace, RunOptions, run};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let ball = Shape::<3>::from_kernel(Ball::new(0.05)?);
//! let bounds = ball.promise().bounds.ok_or("a ball has bounds")?;
//! let hand = Tour::new(bounds.aabb, 5.0)?.over(&ball)?;
//! let mut device = RecordedDevice::new(vec![hand])?;
//! let mut servo = Servo::for_device(ball, &device)?;
//!
//! let options = RunOptions { pace: Pace::AsFastAsPossible, ..RunOptions::new(5.0) };
//! let report = run(&mut servo, &mut device, options)?;
//! assert!(report.contact_time > 2.5 && report.largest_force < 1.0);
//! assert!(report.evaluations.mean < 4.0);
//! # Ok(())
//! # }
//! ```
mod clock;
mod connection;
mod display;
mod lines;
mod pacer;
mod recorder;
mod records;
mod report;
mod run;
mod statistics;
mod thread;
pub(crate) mod ticks;
mod trace;
mod vibration;

pub use clock::{Clock, ClockDriver, ClockSpeed, ScaledClock, VirtualClock, WallClock};
pub use connection::{ConnectionReport, Reconnection};
pub use pacer::{Lateness, Pace, Priority, raise_priority};
pub use recorder::{Recorder, TraceRow};
pub use records::Records;
pub use report::{
    Ending, EvaluationCounts, GuideReport, RunError, RunReport, StartInside, TextureReport,
    ToolReport,
};
pub use run::{BodyMotion, Run, RunOptions, Seconds, Sink, Watch, run, run_on};
pub use statistics::{Bucket, Distribution};
pub use thread::{EndedThread, ServoThread, StartError, ThreadMotion, ThreadOptions};
pub use trace::TraceWriter;
pub use vibration::{Vibration, VibrationReport};
