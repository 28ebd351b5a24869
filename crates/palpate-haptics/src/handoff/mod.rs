// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The way between an ordinary thread and the servo, on which the servo never waits.

mod control;
mod exchange;
mod latest;
#[cfg(test)]
mod model;
mod servo_end;

use std::sync::Arc;

use palpate_field::Pose;

pub use control::{Control, StopSwitch};
pub use latest::{LatestReader, LatestWriter, latest_value};
pub use servo_end::ServoEnd;

use exchange::{Medium, Native, counter, latest};

use crate::accepted_bodies::AcceptedBodies;
use crate::live::{Progress, Snapshot};
use crate::servo::AnyServo;

/// What a hand-off has room for; the servo allocates nothing later.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HandoffOptions {
    /// Events that wait to be taken.
    pub events: usize,
    /// Bodies of a scene.
    pub bodies: usize,
}

impl Default for HandoffOptions {
    /// 4096 events, 1024 bodies.
    fn default() -> Self {
        Self { events: 4096, bodies: 1024 }
    }
}

/// The two ends of a hand-off to and from `servo`: one for an ordinary thread, one for the
/// servo's. There is always room for the bodies that the servo has.
///
/// [`ServoThread`](crate::ServoThread) makes them itself. A loop of one's own, as where a
/// device's driver calls back, [receives](ServoEnd::receive) before each
/// [step](crate::Servo::step) and [publishes](ServoEnd::publish) after it.
///
/// # Examples
///
/// ```
/// use palpate_field::{Pose, Shape, Vector, kernel::Ball};
/// use palpate_haptics::{
///     HandoffOptions, PointState, Progress, ServoOptions, UnprotectedServo, handoff,
/// };
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let ball = Shape::from_kernel(Ball::new(0.5)?);
/// let mut servo = UnprotectedServo::new(ball, 1, ServoOptions::default())?;
/// let (mut control, mut end) = handoff(&servo, HandoffOptions::default());
///
/// control.set_poses(&[(0, Pose::translation(Vector([0.0, -1.0])))])?;
/// // In a tick:
/// end.receive(&mut servo);
/// servo.step(&[PointState::at_rest(Vector([0.0, 0.25]))]);
/// end.publish(&servo, &Progress { ticks: 1, ..Progress::default() });
///
/// let snapshot = control.latest().ok_or("there was a tick")?;
/// assert!(!snapshot.touches[0].contact); // the ball went down by 1 m
/// # Ok(())
/// # }
/// ```
#[must_use]
pub fn handoff<const D: usize>(
    servo: &impl AnyServo<D>,
    options: HandoffOptions,
) -> (Control<D>, ServoEnd<D>) {
    let protection = servo.any_protection().cloned();
    let servo = servo.renderer();
    let bodies = servo.bodies().bodies().len();
    let most_bodies = options.bodies.max(bodies);
    let (sender, receiver) = counter();
    let snapshot = Snapshot {
        progress: Progress::default(),
        touches: servo.touches().to_vec(),
        tool: servo.held_tool(),
        reactions: vec![crate::Reaction::NONE; most_bodies],
        events_lost: 0,
    };
    let (writer, reader) = latest(snapshot);
    let (producer, consumer) = rtrb::RingBuffer::new(options.events);
    let flags = Arc::new(Flags::default());
    let rate = servo.options().rate;
    let control = Control {
        sender,
        reader,
        events: consumer,
        flags: flags.clone(),
        bodies,
        most_bodies,
        protection: protection.map(|protection| (protection, rate)),
        requested_coupling: servo.requested_coupling(),
    };
    let end = ServoEnd {
        receiver,
        writer,
        events: producer,
        flags,
        events_lost: 0,
        is_stopped: false,
    };
    (control, end)
}

/// What the servo is to change before a tick, all of it together.
struct Edits<const D: usize> {
    /// The new bodies, as they are rendered; after that tick, those to be dropped.
    bodies: Option<AcceptedBodies<D>>,
    /// New poses, by the number of the body.
    poses: Vec<Option<Pose<D>>>,
    /// The largest force on a contact point [N].
    max_force: f64,
    /// The largest torque on a tool's device [N·m].
    max_torque: f64,
}

impl<const D: usize> Default for Edits<D> {
    fn default() -> Self {
        let none = f64::INFINITY;
        Self { bodies: None, poses: Vec::new(), max_force: none, max_torque: none }
    }
}

/// What is so or not, for both ends.
#[derive(Debug, Default)]
struct Flags {
    /// An emergency: no forces.
    stop: <Native as Medium>::Flag,
    /// The loop is to end.
    end: <Native as Medium>::Flag,
    /// The loop has ended.
    ended: <Native as Medium>::Flag,
}
