// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The hand-off between a servo and other threads.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use palpate_device::{
    EditReceiver, EditSender, LatestReader, LatestWriter, NumberError, edit_channel,
    latest_value,
};
use palpate_field::Pose;
use palpate_safety::Accepted;

use crate::accepted_bodies::{AcceptedBodies, Protection};
use crate::bodies::{Bodies, is_usable};
use crate::error::HapticsError;
use crate::event::Event;
use crate::guide::Guide;
use crate::live::{Progress, Snapshot};
use crate::servo::{Kind, Placement, Servo};
use crate::tool::Coupling;

/// Capacities of a hand-off, allocated when it is made; the servo allocates nothing later.
///
/// ```
/// use palpate_haptics::HandoffOptions;
///
/// let options = HandoffOptions { events: 64, ..HandoffOptions::default() };
/// assert_eq!((options.events, options.bodies), (64, 1024));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandoffOptions {
    /// The most events in the queue.
    pub events: usize,
    /// The most bodies in a scene.
    pub bodies: usize,
    /// A body that [`Control::set_poses`] would move faster than this at a contact point jumps
    /// instead [m/s]. With infinity no body jumps; with NaN every body that would move a contact
    /// point.
    pub largest_speed: f64,
}

/// Faster than a hand follows, slower than a body that is put somewhere else between two frames [m/s].
pub(crate) const LARGEST_SPEED: f64 = 2.0;

impl Default for HandoffOptions {
    /// 4096 events, 1024 bodies, 2 m/s.
    fn default() -> Self {
        Self { events: 4096, bodies: 1024, largest_speed: LARGEST_SPEED }
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
/// use std::time::Duration;
///
/// use palpate_field::{Pose, Shape, Vector, kernel::Ball};
/// use palpate_device::PointState;
/// use palpate_haptics::{HandoffOptions, Progress, ServoOptions, Servo, handoff};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let ball = Shape::<3>::from_kernel(Ball::new(0.5)?);
/// let mut servo = Servo::new(ball, 1, ServoOptions::default())?;
/// let (mut control, mut end) = handoff(&servo, HandoffOptions::default());
///
/// control.set_poses(&[(0, Pose::translation(Vector([0.0, -1.0, 0.0])))], Duration::ZERO)?;
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
        safety: servo.stage_effects(),
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
        largest_speed: options.largest_speed,
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
    poses: Vec<Option<Placement>>,
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

/// The emergency stop of running servos, for any thread: it sets all forces to zero and releases
/// them again. Clones are the same switch, and so are those of all servos that it was handed to.
///
/// Stops are numbered from 1. [`release_of`](Self::release_of) releases one stop and no later one, so
/// that a release which was meant for an earlier stop cannot lift a new one.
///
/// # Examples
///
/// ```
/// use palpate_haptics::StopSwitch;
///
/// let switch = StopSwitch::new();
/// let first = switch.stop();
/// let second = switch.stop();
/// assert_eq!((first, second, switch.stops()), (1, 2, 2));
/// assert!(!switch.release_of(first) && switch.is_stopped());
/// assert!(switch.release_of(second) && !switch.is_stopped());
/// ```
#[derive(Clone, Debug, Default)]
pub struct StopSwitch {
    /// Twice the number of stops, plus 1 while forces are stopped.
    state: Arc<AtomicU64>,
}

impl StopSwitch {
    /// A switch that stops nothing yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// From the next tick on, all written forces are zero. Returns the number of this stop.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn stop(&self) -> u64 {
        // One atomic operation, so that no release comes between.
        let next = |state: u64| (state & !1).wrapping_add(3);
        let before = self
            .state
            .fetch_update(Ordering::AcqRel, Ordering::Acquire, |state| Some(next(state)));
        // The update always succeeds.
        next(before.unwrap_or_default()) / 2
    }

    /// Ends the emergency stop; forces rise from zero.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn release(&self) {
        self.state.fetch_and(!1, Ordering::AcqRel);
    }

    /// Ends the emergency stop of this number; `false`, and nothing changes, if it was released or
    /// another stop came since.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn release_of(&self, number: u64) -> bool {
        let (stopped, released) = (2 * number + 1, 2 * number);
        let exchanged =
            self.state.compare_exchange(stopped, released, Ordering::AcqRel, Ordering::Acquire);
        exchanged.is_ok()
    }

    /// The number of stops so far, which is the number of the last one.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn stops(&self) -> u64 {
        self.state.load(Ordering::Acquire) / 2
    }

    /// Whether forces are held at zero.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        self.state.load(Ordering::Acquire) & 1 == 1
    }
}

/// The servo's end of a hand-off: receives edits and publishes the state of the servo. Made by
/// [`handoff`](crate::handoff).
pub struct ServoEnd {
    receiver: EditReceiver<Edits>,
    writer: LatestWriter<Snapshot>,
    events: rtrb::Producer<Event>,
    flags: Arc<Flags>,
    stop: StopSwitch,
    largest_speed: f64,
    events_lost: u64,
    is_stopped: bool,
    /// The bodies sent last were accepted for another servo.
    is_foreign: bool,
}

impl ServoEnd {
    /// Applies the edits of the other end to `servo`; call it before each tick.
    ///
    /// Bodies that were accepted for another servo are not taken, nor their poses. The servo stops as
    /// by [`stop`](crate::StopSwitch::stop), until [`release`](crate::StopSwitch::release). An
    /// unprotected servo takes the bodies of any.
    ///
    /// Real-time: allocates nothing, frees nothing, takes no lock, cannot panic.
    pub fn receive(&mut self, servo: &mut Servo<impl Kind>) {
        let servo = servo.renderer_mut();
        let is_stopped = self.stop.is_stopped();
        if is_stopped != self.is_stopped {
            self.is_stopped = is_stopped;
            servo.stop(is_stopped);
        }
        let Some(mut parcel) = self.receiver.take() else { return };
        let edits = &mut parcel.content;
        if let Some(bodies) = &mut edits.bodies {
            self.is_foreign = !servo.adopt(bodies);
            if self.is_foreign {
                self.stop.stop();
                self.is_stopped = true;
                servo.stop(true);
            }
        }
        // Poses are those of the bodies that were sent last.
        let poses = edits.poses.iter().enumerate().filter(|_| !self.is_foreign);
        for (body, placement) in poses {
            if let Some(placement) = placement {
                servo.move_body(body, placement, self.largest_speed);
            }
        }
        servo.limit_force(edits.max_force);
        servo.limit_torque(edits.max_torque);
        if let Some(force) = edits.gripper_force {
            servo.set_gripper_force(force);
        }
        if let Some(is_lifted) = edits.is_lifted {
            servo.lift(is_lifted);
        }
        if let Some(guides) = &mut edits.guides {
            servo.exchange_guides(guides);
        }
        self.receiver.give_back(parcel);
    }

    /// Whether the loop must end: the other end asked for it, or was dropped.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn is_to_end(&self) -> bool {
        self.flags.end.load(Ordering::Acquire) || self.events.is_abandoned()
    }

    /// Publishes the state of `servo` to the other end; call it after each tick.
    ///
    /// Real-time: allocates nothing, frees nothing, takes no lock, cannot panic.
    pub fn publish(&mut self, servo: &Servo<impl Kind>, progress: &Progress) {
        let servo = servo.renderer();
        for event in servo.events() {
            self.events_lost += u64::from(self.events.push(*event).is_err());
        }
        let events_lost = self.events_lost;
        self.writer.set(|snapshot| {
            snapshot.progress = *progress;
            snapshot.events_lost = events_lost;
            snapshot.tool = servo.held_tool();
            snapshot.is_stopped = servo.is_stopped();
            snapshot.is_lifted = servo.is_lifted();
            snapshot.safety = servo.stage_effects();
            snapshot.buttons = servo.buttons();
            snapshot.gripper = servo.gripper();
            snapshot.gripper_force = servo.gripper_force();
            refill(&mut snapshot.touches, servo.touches());
            refill(&mut snapshot.reactions, servo.reactions());
        });
    }

    /// Tells the other end that the loop has ended.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn finish(&self) {
        self.flags.ended.store(true, Ordering::Release);
    }
}

impl fmt::Debug for ServoEnd {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ServoEnd")
            .field("events_lost", &self.events_lost)
            .field("is_stopped", &self.is_stopped)
            .finish_non_exhaustive()
    }
}

/// Copies `content` into `list`, up to the capacity of `list`.
fn refill<T: Copy>(list: &mut Vec<T>, content: &[T]) {
    list.clear();
    let room = list.capacity();
    list.extend(content.iter().take(room).copied());
}

/// The end of a hand-off for an ordinary thread: edits what a running servo renders, and reads
/// its state. Made by [`handoff`](crate::handoff) or a [`ServoThread`](crate::servo_loop::ServoThread).
///
/// Edits that the servo has not received yet are merged: before its next tick the servo
/// receives all of them or none. Replaced bodies are dropped on this thread, by the next call.
pub struct Control {
    sender: EditSender<Edits>,
    reader: LatestReader<Snapshot>,
    events: rtrb::Consumer<Event>,
    flags: Arc<Flags>,
    stop: StopSwitch,
    /// The number of bodies in the newest scene.
    bodies: usize,
    most_bodies: usize,
    /// The number of contact points.
    points: usize,
    /// The protection of a [`Servo`](crate::Servo) and its rate [Hz]; `None` for an
    /// [unprotected](crate::Unprotected) servo.
    protection: Option<(Arc<Protection>, f64)>,
    /// The requested virtual coupling of the tool; `None` for contact points.
    requested_coupling: Option<Coupling>,
}

impl Control {
    /// Replaces all bodies from the next tick on. Poses that were set before belong to the old
    /// bodies and are dropped. For what a hand feels that touches them see
    /// [`Servo::replace_bodies`](crate::Servo::replace_bodies).
    ///
    /// For a [`Servo`](crate::Servo), the bodies and the tool's coupling are scaled to what its
    /// device can render; the result is returned as in
    /// [`Servo::accepted`](crate::Servo::accepted). For an
    /// [unprotected](crate::Unprotected) servo the bodies stay unchanged and the list is
    /// empty.
    ///
    /// # Errors
    ///
    /// [`HapticsError::TooManyBodies`] if there are more than the hand-off has room for; as
    /// [`Servo::accept`](crate::Servo::accept).
    pub fn replace_bodies(
        &mut self,
        bodies: impl TryInto<Bodies, Error: Into<HapticsError>>,
    ) -> Result<Vec<Accepted>, HapticsError> {
        let bodies = bodies.try_into().map_err(Into::into)?;
        let count = bodies.bodies().len();
        if count > self.most_bodies {
            return Err(HapticsError::TooManyBodies { bodies: count, most: self.most_bodies });
        }
        let bodies = match &self.protection {
            Some((protection, rate)) => {
                protection.accepted_bodies(bodies, self.requested_coupling, *rate)?
            }
            None => AcceptedBodies::unchanged(bodies),
        };
        let accepted = bodies.accepted.clone();
        self.bodies = count;
        self.edit(|edits| {
            edits.poses.clear();
            edits.bodies = Some(bodies);
        });
        Ok(accepted)
    }

    /// Moves bodies along screws to these poses, all of them from the same tick on, over the time
    /// `over`; at once if it is zero. If a body gets several poses before a tick, the last one holds. A body
    /// that is still on its way goes on from where it is.
    ///
    /// A physics engine that sets poses at 60 Hz gives its frame time: a body then arrives one call late,
    /// and a hand that touches it feels a smooth motion instead of 60 steps a second.
    ///
    /// A body that would move a contact point faster than [`HandoffOptions::largest_speed`] jumps: the
    /// proxy is placed anew where the body covers it, and the force rises from what it was, by
    /// [`SafetySettings::rise_rate`](palpate_safety::SafetySettings::rise_rate).
    ///
    /// # Errors
    ///
    /// [`HapticsError::NoSuchBody`] or [`HapticsError::Pose`]; then no body moves.
    #[inline(never)]
    #[expect(clippy::indexing_slicing, reason = "the bodies are checked before")]
    pub fn set_poses(
        &mut self,
        poses: &[(usize, Pose<3>)],
        over: Duration,
    ) -> Result<(), HapticsError> {
        for (body, pose) in poses {
            if *body >= self.bodies {
                return Err(HapticsError::NoSuchBody { body: *body, bodies: self.bodies });
            }
            if !is_usable(pose) {
                return Err(HapticsError::Pose);
            }
        }
        let (bodies, over) = (self.bodies, over.as_secs_f64());
        self.edit(|edits| {
            edits.poses.resize(bodies, None);
            for (body, pose) in poses {
                edits.poses[*body] = Some(Placement { pose: *pose, over });
            }
        });
        Ok(())
    }

    /// Lowers the largest force on a contact point to `max_force` [N]; never raises it.
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if the limit is negative or not finite.
    pub fn limit_force(&mut self, max_force: f64) -> Result<(), HapticsError> {
        let max_force = NumberError::check_not_negative("max_force", max_force, "N")?;
        self.edit(|edits| edits.max_force = edits.max_force.min(max_force));
        Ok(())
    }

    /// Lowers the largest torque on a tool's device to `max_torque` [N·m]; never raises it.
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if the limit is negative or not finite.
    pub fn limit_torque(&mut self, max_torque: f64) -> Result<(), HapticsError> {
        let max_torque = NumberError::check_not_negative("max_torque", max_torque, "N·m")?;
        self.edit(|edits| edits.max_torque = edits.max_torque.min(max_torque));
        Ok(())
    }

    /// Sets the force wanted on the fingers in the gripper [N], which holds until the next one;
    /// positive opens the jaws. The device's gripper limits it, and without one nothing is written.
    ///
    /// # Errors
    ///
    /// [`HapticsError::Number`] if the force is not finite.
    pub fn set_gripper_force(&mut self, force: f64) -> Result<(), HapticsError> {
        if !force.is_finite() {
            return Err(NumberError::new("gripper_force", "finite", force, "N").into());
        }
        self.edit(|edits| edits.gripper_force = Some(force));
        Ok(())
    }

    /// Lifts the hand off the bodies, or sets it down; see [`Servo::lift`](crate::Servo::lift).
    pub fn lift(&mut self, is_lifted: bool) {
        self.edit(|edits| edits.is_lifted = Some(is_lifted));
    }

    /// Replaces the guides of every contact point from the next tick on. For a
    /// [`Servo`](crate::Servo), they are as soft as its device requires; the result is returned as in
    /// [`Servo::accepted_guides`](crate::Servo::accepted_guides). For an
    /// [unprotected](crate::Unprotected) servo they stay unchanged and the list is empty.
    ///
    /// # Errors
    ///
    /// As [`Protection::accept_guides`].
    #[inline(never)]
    pub fn replace_guides(&mut self, guides: &[Guide]) -> Result<Vec<Accepted>, HapticsError> {
        let (guides, accepted) = match &self.protection {
            Some((protection, rate)) => protection.accept_guides(guides, *rate)?,
            None => (guides.to_vec(), Vec::new()),
        };
        let points = self.points;
        self.edit(|edits| edits.guides = Some(vec![guides; points]));
        Ok(accepted)
    }

    /// Drops replaced bodies that the servo has returned; every edit does so too.
    pub fn collect(&mut self) {
        self.sender.collect(|edits| {
            edits.bodies = None;
            edits.poses.clear();
            edits.max_force = f64::INFINITY;
            edits.max_torque = f64::INFINITY;
            edits.gripper_force = None;
            edits.is_lifted = None;
            edits.guides = None;
        });
    }

    /// The emergency stop, for any thread.
    #[must_use]
    pub fn stop_switch(&self) -> StopSwitch {
        self.stop.clone()
    }

    /// The state of the servo after its last tick; `None` before the first tick.
    #[must_use]
    #[inline(never)]
    pub fn latest(&mut self) -> Option<&Snapshot> {
        self.reader.latest()
    }

    /// The next event, in order; `None` if the queue is empty. Events that found the queue full
    /// are [counted](Snapshot::events_lost).
    #[must_use]
    pub fn next_event(&mut self) -> Option<Event> {
        self.events.pop().ok()
    }

    /// Asks the loop to end before its next tick, with zero force.
    pub fn end(&self) {
        self.flags.end.store(true, Ordering::Release);
    }

    /// Whether the loop has ended.
    #[must_use]
    pub fn has_ended(&self) -> bool {
        self.flags.ended.load(Ordering::Acquire)
    }

    fn edit(&mut self, edit: impl FnOnce(&mut Edits)) {
        self.collect();
        self.sender.edit(edit);
    }
}

impl fmt::Debug for Control {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Control")
            .field("bodies", &self.bodies)
            .field("most_bodies", &self.most_bodies)
            .finish_non_exhaustive()
    }
}
