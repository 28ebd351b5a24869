// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A servo in a thread of its own.

use crate::{
    Control, HandoffOptions, HapticsError, NextPose, Servo, ServoEnd, StopSwitch, handoff_with,
};
use palpate_device::{Device, NumberError};
use std::fmt;
use std::panic::resume_unwind;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::clock::{Clock, WallClock};
use super::connection::Reconnection;
use super::pacer::{Pace, Priority, raise_priority, ticks};
use super::records::{Records, queue};
use super::report::RunReport;
use super::run::BodyMotion;
use super::ticks::{RowSink, Schedule, ServoLoop};
use super::vibration::{Player, Vibration};

/// How long a drop waits for the zero forces: a device takes them within a tick. A driven clock
/// that nobody advances lets it wait in vain.
const PATIENCE: Duration = Duration::from_secs(1);

/// A closure that moves bodies before each tick in a servo's thread, as [`BodyMotion`] does in a
/// call.
pub type ThreadMotion = Box<dyn FnMut(f64, &mut dyn FnMut(usize, NextPose)) + Send>;

/// How a thread runs a servo.
///
/// ```
/// use palpate_haptics::servo_loop::ThreadOptions;
///
/// let options = ThreadOptions {
///     duration: Some(2.0),
///     rows: Some(2000),
///     ..ThreadOptions::default()
/// };
/// assert_eq!((options.duration, options.rows), (Some(2.0), Some(2000)));
/// ```
pub struct ThreadOptions {
    /// The time for which the servo runs [s]; `None` means until [`ServoThread::end`].
    pub duration: Option<f64>,
    /// Whether the thread requests a raised priority.
    pub raises_priority: bool,
    /// Whether ticks are rehearsed, as by [`RunOptions::rehearses`](super::RunOptions::rehearses).
    pub rehearses: bool,
    /// How many rows wait to be [taken](ServoThread::take_records), one for each tick and contact
    /// point; `None` for no recorder.
    pub rows: Option<usize>,
    /// The capacities of the hand-off.
    pub handoff: HandoffOptions,
    /// Moves bodies before each tick.
    pub motion: Option<ThreadMotion>,
    /// How the loop goes on when the device is lost; `None` to end it.
    pub reconnection: Option<Reconnection>,
    /// The emergency stop, if it is shared with other servos; else the thread has its own.
    pub stop_switch: Option<StopSwitch>,
    /// Plays the touches on a device that vibrates.
    pub vibration: Option<Vibration<'static>>,
}

impl Default for ThreadOptions {
    /// No end but a lost device, raised priority, default hand-off; no rehearsals, recorder, motion
    /// and vibration.
    fn default() -> Self {
        Self {
            duration: None,
            raises_priority: true,
            rehearses: false,
            rows: None,
            handoff: HandoffOptions::default(),
            motion: None,
            reconnection: None,
            stop_switch: None,
            vibration: None,
        }
    }
}

impl ThreadOptions {
    /// The same options with a closure that moves bodies before each tick, as [`BodyMotion`] does in a
    /// call. That of a built scene of `palpate-scene` is `move |time, set_pose|
    /// scene.motion()(time, set_pose)`.
    ///
    /// # Examples
    ///
    /// A floor that rises by 1 m/s reaches a hand at rest 3 mm above it:
    ///
    /// ```
    /// use palpate_sim::{HandPath, Interpolation, RecordedDevice};
    /// use palpate_field::{Pose, Shape, Vector};
    /// use palpate_haptics::Servo;
    /// use palpate_haptics::servo_loop::{ServoThread, ThreadOptions, VirtualClock};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let rest = vec![Vector([0.0, 0.005, 0.0]); 2];
    /// let hand = HandPath::new(vec![0.0, 0.01], rest, Interpolation::Linear)?;
    /// let device = Box::new(RecordedDevice::new(vec![hand])?);
    /// let floor = Shape::half_space([0.0, 1.0], 0.0)?;
    /// let servo = Servo::for_device(floor, &*device)?; // with a probe of 2 mm
    /// let options = ThreadOptions {
    ///     raises_priority: false,
    ///     duration: Some(0.01),
    ///     ..ThreadOptions::default()
    /// }
    /// .with_motion(|time, set_pose| set_pose(0, Pose::translation([0.0, time, 0.0]).into()));
    /// let thread = ServoThread::start_on(VirtualClock::new(), servo, device, options)?;
    /// let report = thread.join().report;
    /// assert!((report.largest_depth - 0.006).abs() < 1e-9); // after 9 ms
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn with_motion(
        self,
        motion: impl FnMut(f64, &mut dyn FnMut(usize, NextPose)) + Send + 'static,
    ) -> Self {
        Self { motion: Some(Box::new(motion)), ..self }
    }
}

impl fmt::Debug for ThreadOptions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ThreadOptions")
            .field("duration", &self.duration)
            .field("raises_priority", &self.raises_priority)
            .field("rehearses", &self.rehearses)
            .field("rows", &self.rows)
            .field("handoff", &self.handoff)
            .field("motion", &self.motion.is_some())
            .field("reconnection", &self.reconnection)
            .field("stop_switch", &self.stop_switch)
            .field("vibration", &self.vibration)
            .finish()
    }
}

/// Why a thread does not run a servo.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StartError {
    /// Servo, device and options do not fit; as for [`run`](super::run()).
    #[error(transparent)]
    Haptics(#[from] HapticsError),
    /// The operating system starts no thread.
    #[error("the servo's thread did not start: {reason}")]
    ThreadNotStarted {
        /// Its error.
        reason: String,
    },
}

impl From<NumberError> for StartError {
    fn from(error: NumberError) -> Self {
        Self::Haptics(error.into())
    }
}

/// A servo that runs with its device in a thread.
///
/// The loop is that of [`run`](super::run()): tick `k` is at `k / rate`, a panic in a tick ends
/// the loop, and the last forces written are always zero. Dropping a `ServoThread` ends the loop
/// and waits up to a second for those forces, and for the silence of a device that vibrates: a
/// process that ends at once would stop the thread before they are written.
///
/// # Examples
///
/// Two ticks of 1 ms on a virtual clock, with a body that moves between them:
///
/// ```
/// use std::time::Duration;
///
/// use palpate_field::{Pose, Shape, Vector, kernel::Ball};
/// use palpate_sim::{HandPath, Interpolation, RecordedDevice};
/// use palpate_haptics::Servo;
/// use palpate_haptics::servo_loop::{ServoThread, ThreadOptions, VirtualClock};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// // A hand that rests 1/128 m above a ball.
/// let rest = vec![Vector([0.0, 0.5 + 1.0 / 128.0, 0.0]); 2];
/// let hand = HandPath::new(vec![0.0, 1.0], rest, Interpolation::Linear)?;
/// let device = Box::new(RecordedDevice::new(vec![hand])?);
/// let ball = Shape::<3>::from_kernel(Ball::new(0.5)?);
/// let servo = Servo::for_device(ball, &*device)?;
///
/// let (clock, mut driver) = VirtualClock::driven();
/// let options = ThreadOptions { raises_priority: false, ..ThreadOptions::default() };
/// let mut thread = ServoThread::start_on(clock, servo, device, options)?;
/// driver.advance(Duration::ZERO);
/// let snapshot = thread.control().latest().ok_or("tick 0 is over")?;
/// assert_eq!((snapshot.progress.ticks, snapshot.touches[0].contact), (1, false));
///
/// thread.control().set_poses(&[(0, Pose::translation(Vector([0.0, 1.0 / 64.0, 0.0])))], Duration::ZERO)?;
/// driver.advance(Duration::from_millis(1));
/// let snapshot = thread.control().latest().ok_or("tick 1 is over")?;
/// assert_eq!((snapshot.progress.ticks, snapshot.touches[0].contact), (2, true));
///
/// drop(driver); // the clock then runs freely
/// let ended = thread.end();
/// assert!(ended.report.ticks >= 2);
/// # Ok(())
/// # }
/// ```
pub struct ServoThread {
    /// Dropped before the handle: that ends the loop, for which the handle then waits.
    control: Control,
    thread: Handle,
    records: Option<Records>,
}

/// The thread; `None` once it is joined.
struct Handle(Option<JoinHandle<Left>>);

impl Drop for Handle {
    fn drop(&mut self) {
        let Some(thread) = &self.0 else { return };
        let start = Instant::now();
        while !thread.is_finished() && start.elapsed() < PATIENCE {
            std::thread::sleep(Duration::from_millis(1));
        }
    }
}

/// What remains of a servo thread that has ended.
#[non_exhaustive]
pub struct EndedThread {
    /// The servo after its last tick.
    pub servo: Servo,
    /// The device; zero was written to it.
    pub device: Box<dyn Device + Send>,
    /// What played the touches, if anything did, with its device, which was silenced; it can play
    /// those of another run.
    pub vibration: Option<Vibration<'static>>,
    /// The hand-off, with the last snapshot and the events not taken yet.
    pub control: Control,
    /// The report of the run.
    pub report: RunReport,
    /// The recorded rows not taken yet, if a recorder was requested and left to the thread.
    pub records: Option<Records>,
    /// The priority that the thread had.
    pub priority: Priority,
}

/// The results that the thread returns.
struct Left {
    servo: Servo,
    device: Box<dyn Device + Send>,
    player: Option<Player<'static>>,
    /// Returned, as the motion is, so that its content is not freed in the servo's thread.
    _end: ServoEnd,
    _motion: Option<ThreadMotion>,
    report: RunReport,
    priority: Priority,
}

impl ServoThread {
    /// Starts a thread that runs `servo` with `device` in real time, at the pace of a device that
    /// [sets it](Pace::Device).
    ///
    /// # Errors
    ///
    /// [`StartError::Haptics`] as [`run`](super::run()); [`StartError::ThreadNotStarted`].
    #[inline(never)]
    pub fn start(
        servo: Servo,
        device: Box<dyn Device + Send>,
        options: ThreadOptions,
    ) -> Result<Self, StartError> {
        Self::start_with(WallClock::suited_to, servo, device, options)
    }

    /// As [`start`](Self::start), on the caller's clock.
    ///
    /// # Errors
    ///
    /// As [`start`](Self::start).
    pub fn start_on(
        clock: impl Clock + Send + 'static,
        servo: Servo,
        device: Box<dyn Device + Send>,
        options: ThreadOptions,
    ) -> Result<Self, StartError> {
        Self::start_with(|_| clock, servo, device, options)
    }

    fn start_with<C: Clock>(
        clock: impl FnOnce(&Priority) -> C + Send + 'static,
        mut servo: Servo,
        mut device: Box<dyn Device + Send>,
        options: ThreadOptions,
    ) -> Result<Self, StartError> {
        servo.check_device(&*device)?;
        let ticks = match options.duration {
            None => u64::MAX,
            Some(duration) => ticks(
                NumberError::check_not_negative("duration", duration, "s")?,
                servo.options().rate,
            ),
        };
        let pace = Pace::of(&*device);
        let schedule = Schedule { ticks, pace, rehearses: options.rehearses };
        let ThreadOptions { raises_priority, mut motion, reconnection, vibration, .. } =
            options;
        let mut player = vibration.map(|vibration| vibration.start(&servo)).transpose()?;
        let (rows, records) = options.rows.map(queue).unzip();
        let stop = options.stop_switch.unwrap_or_default();
        let (control, mut end) = handoff_with(&servo, options.handoff, stop);
        let work = move || {
            let priority = if raises_priority { raise_priority() } else { Priority::Normal };
            let mut clock = clock(&priority);
            let report = ServoLoop::new(&mut servo, &mut *device)
                .sending(rows.map(RowSink::Queue))
                .moving(motion.as_deref_mut().map(|motion| -> BodyMotion<'_> { motion }))
                .handing_off(Some(&mut end))
                .reconnecting(reconnection)
                .vibrating(player.as_mut())
                .run(&mut clock, &schedule);
            Left { servo, device, player, _end: end, _motion: motion, report, priority }
        };
        let thread =
            std::thread::Builder::new()
                .name("palpate servo".to_owned())
                .spawn(work)
                .map_err(|error| StartError::ThreadNotStarted { reason: error.to_string() })?;
        Ok(Self { control, thread: Handle(Some(thread)), records })
    }

    /// The hand-off to the servo: edits what is rendered, and reads its state.
    #[must_use]
    pub fn control(&mut self) -> &mut Control {
        &mut self.control
    }

    /// The recorded rows, if a [recorder](ThreadOptions::rows) was requested; `None` from
    /// the second call on. Any thread may take rows from them while the servo runs, and after;
    /// rows that nobody takes are in [`EndedThread::records`].
    ///
    /// # Examples
    ///
    /// A recorder for 100 rows records 250, as they are taken meanwhile:
    ///
    /// ```
    /// use std::time::Duration;
    ///
    /// use palpate_sim::{HandPath, Interpolation, RecordedDevice};
    /// use palpate_field::Shape;
    /// use palpate_haptics::Servo;
    /// use palpate_haptics::servo_loop::{ServoThread, ThreadOptions, VirtualClock};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let ends = vec![[0.0, 0.08, 0.0].into(), [0.0, 0.05, 0.0].into()];
    /// let press = HandPath::new(vec![0.0, 0.25], ends, Interpolation::Smooth)?;
    /// let device = Box::new(RecordedDevice::new(vec![press])?);
    /// let servo = Servo::for_device(Shape::circle(0.05)?, &*device)?;
    ///
    /// let (clock, mut driver) = VirtualClock::driven();
    /// let options = ThreadOptions {
    ///     raises_priority: false,
    ///     duration: Some(0.25),
    ///     rows: Some(100),
    ///     ..ThreadOptions::default()
    /// };
    /// let mut thread = ServoThread::start_on(clock, servo, device, options)?;
    /// let mut records = thread.take_records().ok_or("a recorder was requested")?;
    /// let mut rows = Vec::new();
    /// for _ in 0..10 {
    ///     driver.advance(Duration::from_millis(25));
    ///     rows.extend(records.take());
    /// }
    /// drop(driver);
    /// let ended = thread.join();
    /// rows.extend(records.take());
    /// assert_eq!((rows.len(), records.lost(), ended.report.rows_dropped), (250, 0, 0));
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn take_records(&mut self) -> Option<Records> {
        self.records.take()
    }

    /// Whether the loop has ended, by its duration or by a failure.
    #[must_use]
    pub fn has_ended(&self) -> bool {
        self.control.has_ended()
    }

    /// Ends the loop before its next tick; see [`join`](Self::join).
    #[must_use]
    #[inline(never)]
    pub fn end(self) -> EndedThread {
        self.control.end();
        self.join()
    }

    /// Waits until the loop has ended, by its duration or by a failure. Without a duration this
    /// may be never. A [driven](super::VirtualClock::driven) clock must have been advanced to
    /// the end, or its driver dropped.
    #[must_use]
    #[expect(
        clippy::expect_used,
        clippy::missing_panics_doc,
        reason = "only this method takes the thread, and it consumes the handle"
    )]
    #[inline(never)]
    pub fn join(self) -> EndedThread {
        let Self { control, mut thread, records } = self;
        let thread = thread.0.take().expect("a thread that was not joined");
        // Panics in the loop are part of the report.
        let left = thread.join().unwrap_or_else(|panic| resume_unwind(panic));
        let Left { servo, device, player, report, priority, .. } = left;
        let vibration = player.map(Player::into_vibration);
        EndedThread { servo, device, vibration, control, report, records, priority }
    }
}

impl fmt::Debug for ServoThread {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ServoThread").field("control", &self.control).finish_non_exhaustive()
    }
}

impl fmt::Debug for EndedThread {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("EndedThread")
            .field("report", &self.report)
            .field("priority", &self.priority)
            .finish_non_exhaustive()
    }
}
