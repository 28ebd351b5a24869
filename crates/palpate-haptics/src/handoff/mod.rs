// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The hand-off between an ordinary thread and the servo, which never makes the servo wait.

mod control;
mod servo_end;
mod stop_switch;

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use palpate_device::{edit_channel, latest_value};
use palpate_field::Pose;

pub use control::Control;
pub use servo_end::ServoEnd;
pub use stop_switch::StopSwitch;

use crate::accepted_bodies::AcceptedBodies;
use crate::guide::Guide;
use crate::live::{Progress, Snapshot};
use crate::servo::{Kind, Servo};

/// Capacities of a hand-off, allocated when it is made; the servo allocates nothing later.
///
/// ```
/// use palpate_haptics::HandoffOptions;
///
/// let options = HandoffOptions { events: 64, ..HandoffOptions::default() };
/// assert_eq!((options.events, options.bodies), (64, 1024));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HandoffOptions {
    /// The most events in the queue.
    pub events: usize,
    /// The most bodies in a scene.
    pub bodies: usize,
}

impl Default for HandoffOptions {
    /// 4096 events, 1024 bodies.
    fn default() -> Self {
        Self { events: 4096, bodies: 1024 }
    }
}

/// The two ends of a hand-off: the first for an ordinary thread, the second for the thread of
/// `servo`. The capacity for bodies is at least the number of bodies that the servo has.
///
/// A [`ServoThread`](crate::servo_loop::ServoThread) makes its own hand-off. A custom loop, for
/// example the callback of a device driver, first [checks the device](crate::Servo::check_device);
/// [receives](ServoEnd::receive) before each [step](crate::Servo::step) and
/// [publishes](ServoEnd::publish) after it; and writes zero force and zero torque last, however it
/// ends.
///
/// # Examples
///
/// ```
/// use palpate_field::{Pose, Shape, Vector, kernel::Ball};
/// use palpate_device::PointState;
/// use palpate_haptics::{HandoffOptions, Progress, ServoOptions, Servo, handoff};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let ball = Shape::<3>::from_kernel(Ball::new(0.5)?);
/// let mut servo = Servo::new(ball, 1, ServoOptions::default())?;
/// let (mut control, mut end) = handoff(&servo, HandoffOptions::default());
///
/// control.set_poses(&[(0, Pose::translation(Vector([0.0, -1.0, 0.0])))])?;
/// // In a tick:
/// end.receive(&mut servo);
/// servo.step(&[PointState::at_rest(Vector([0.0, 0.25, 0.0]))]);
/// let mut progress = Progress::default();
/// progress.ticks = 1;
/// end.publish(&servo, &progress);
///
/// let snapshot = control.latest().ok_or("there was a tick")?;
/// assert!(!snapshot.touches[0].contact); // the ball went down by 1 m
/// # Ok(())
/// # }
/// ```
#[must_use]
pub fn handoff(servo: &Servo<impl Kind>, options: HandoffOptions) -> (Control, ServoEnd) {
    handoff_with(servo, options, StopSwitch::new())
}

/// As [`handoff`], with an emergency stop that other servos may share: a servo that begins while the
/// switch is stopped begins without forces.
#[must_use]
pub fn handoff_with(
    servo: &Servo<impl Kind>,
    options: HandoffOptions,
    stop: StopSwitch,
) -> (Control, ServoEnd) {
    let protection = servo.protection_of_any().cloned();
    let servo = servo.renderer();
    let bodies = servo.bodies().bodies().len();
    let most_bodies = options.bodies.max(bodies);
    let (sender, receiver) = edit_channel();
    let snapshot = Snapshot {
        progress: Progress::default(),
        touches: servo.touches().to_vec(),
        tool: servo.held_tool(),
        is_stopped: servo.is_stopped(),
        is_lifted: servo.is_lifted(),
        safety: servo.stage_ticks(),
        buttons: servo.buttons(),
        gripper: servo.gripper(),
        gripper_force: servo.gripper_force(),
        reactions: vec![crate::Reaction::NONE; most_bodies],
        events_lost: 0,
    };
    let (writer, reader) = latest_value(snapshot);
    let (producer, consumer) = rtrb::RingBuffer::new(options.events);
    let flags = Arc::new(Flags::default());
    let rate = servo.options().rate;
    let control = Control {
        sender,
        reader,
        events: consumer,
        flags: flags.clone(),
        stop: stop.clone(),
        bodies,
        most_bodies,
        points: servo.touches().len(),
        protection: protection.map(|protection| (protection, rate)),
        requested_coupling: servo.requested_coupling(),
    };
    let end = ServoEnd {
        receiver,
        writer,
        events: producer,
        flags,
        stop,
        events_lost: 0,
        is_stopped: false,
        is_foreign: false,
    };
    (control, end)
}

/// Edits that the servo applies together before a tick.
struct Edits {
    /// The new bodies; after the tick that applies them, the old bodies, for the sender to
    /// drop.
    bodies: Option<AcceptedBodies>,
    /// New poses, by body index.
    poses: Vec<Option<Pose<3>>>,
    /// The largest force on a contact point [N].
    max_force: f64,
    /// The largest torque on a tool's device [N·m].
    max_torque: f64,
    /// The force wanted of the gripper [N]; `None` to leave it as it is.
    gripper_force: Option<f64>,
    /// Whether the hand is lifted off the bodies; `None` to leave it as it is.
    is_lifted: Option<bool>,
    /// The new guides of each contact point; after the tick that applies them, the old ones, for the
    /// sender to drop.
    guides: Option<Vec<Vec<Guide>>>,
}

impl Default for Edits {
    fn default() -> Self {
        let none = f64::INFINITY;
        Self {
            bodies: None,
            poses: Vec::new(),
            max_force: none,
            max_torque: none,
            gripper_force: None,
            is_lifted: None,
            guides: None,
        }
    }
}

/// Flags that both ends share. Everything a thread did before it set one, with
/// [`Release`](std::sync::atomic::Ordering::Release), is visible to a thread that sees it set.
#[derive(Debug, Default)]
struct Flags {
    /// A request to end the loop.
    end: AtomicBool,
    /// The loop has ended.
    ended: AtomicBool,
}
