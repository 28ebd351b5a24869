// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Running a servo with a device for a time.

use crate::{Control, HandoffOptions, HapticsError, NextPose, Progress, Servo, handoff};
use palpate_device::{Device, NumberError};
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use super::clock::{Clock, WallClock};
use super::connection::Reconnection;
use super::pacer::{Pace, ticks};
use super::recorder::{Recorder, TraceRow};
use super::records::{Records, queue};
use super::report::RunReport;
use super::ticks::{RowSink, Schedule, ServoLoop};
use super::vibration::Vibration;

/// How often the thread of a sink takes rows: seldom enough to cost nothing.
const TAKEN_EVERY: Duration = Duration::from_millis(5);

/// How far a sink may fall behind before rows are lost [s]: longer than a disk that is busy
/// writes nothing.
const BACKLOG: f64 = 1.0;

/// The most rows by which a sink may fall behind, about 50 MB of them.
const MOST_BACKLOG: f64 = 1e5;

/// A closure that receives the progress of a run, on a separate thread.
pub struct Watch<'a> {
    /// The time between two calls.
    pub interval: Duration,
    /// The closure; it is called once more at the end.
    pub show: &'a mut (dyn FnMut(&Progress) + Send),
}

impl std::fmt::Debug for Watch<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Watch").field("interval", &self.interval).finish_non_exhaustive()
    }
}

/// A closure that moves bodies before each tick: it gets the time of the tick [s] and a function
/// that sets the pose of a body by its index, as [`Servo::set_pose`] does, or lets the body jump
/// there.
///
/// Set the poses of moving bodies at every tick: the velocity of a body is its motion since the
/// tick before.
///
/// Real-time: the closure runs in the loop, and should not allocate, wait or panic.
pub type BodyMotion<'a> = &'a mut dyn FnMut(f64, &mut dyn FnMut(usize, NextPose));

/// A closure that receives the rows of all ticks, in order of time, then of contact point.
///
/// In real time another thread calls it, through a queue of a second of rows, at most 100 000;
/// rows that find the queue full are [counted](RunReport::rows_dropped). Without pacing the
/// loop calls it and waits for it, so that no row is lost. It should not panic.
pub type Sink<'a> = &'a mut (dyn FnMut(&TraceRow) + Send);

/// Options of a run.
///
/// ```
/// use palpate_haptics::servo_loop::{Pace, RunOptions};
///
/// let options = RunOptions { pace: Pace::AsFastAsPossible, ..RunOptions::new(2.0) };
/// assert_eq!((options.duration, options.pace), (2.0, Pace::AsFastAsPossible));
/// ```
pub struct RunOptions<'a> {
    /// The time the servo runs [s].
    pub duration: f64,
    /// The pace.
    pub pace: Pace,
    /// Whether each tick is rehearsed until it begins, so that its code and data are in the
    /// caches: durations of ticks vary less, but fields are evaluated up to 64 times more
    /// often. Only in real time.
    pub rehearses: bool,
    /// Keeps every tick until its memory is full.
    pub recorder: Option<&'a mut Recorder>,
    /// Receives the rows of all ticks.
    pub sink: Option<Sink<'a>>,
    /// A closure that a separate thread calls.
    pub watch: Option<Watch<'a>>,
    /// Moves bodies before each tick.
    pub motion: Option<BodyMotion<'a>>,
    /// Ends the run before its next tick once the flag is `true`; a signal handler may set it.
    pub interrupt: Option<&'a AtomicBool>,
    /// How the run goes on when the device is lost; `None` to end it.
    pub reconnection: Option<Reconnection>,
    /// Plays the touches on a device that vibrates.
    pub vibration: Option<Vibration<'a>>,
}

impl<'a> RunOptions<'a> {
    /// A run of `duration` [s] in real time that ends when the device is lost, without rehearsals,
    /// recorder, sink, watch and vibration.
    #[must_use]
    pub fn new(duration: f64) -> Self {
        Self {
            duration,
            pace: Pace::RealTime,
            rehearses: false,
            recorder: None,
            sink: None,
            watch: None,
            motion: None,
            interrupt: None,
            reconnection: None,
            vibration: None,
        }
    }

    /// The same options with a closure that a separate thread calls at `interval`.
    #[must_use]
    pub fn with_watch(
        self,
        interval: Duration,
        show: &'a mut (dyn FnMut(&Progress) + Send),
    ) -> Self {
        Self { watch: Some(Watch { interval, show }), ..self }
    }
}

/// A time for which a servo runs [s].
///
/// ```
/// use palpate_haptics::servo_loop::{RunOptions, Seconds};
///
/// assert_eq!(RunOptions::from(Seconds(10.0)).duration, 10.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seconds(pub f64);

impl From<Seconds> for RunOptions<'_> {
    /// In real time, without rehearsals, recorder, sink and watch.
    fn from(duration: Seconds) -> Self {
        Self::new(duration.0)
    }
}

/// Adds [`run`] as a method to [`Servo`]; no other type implements it.
pub trait Run {
    /// Runs the servo with `device` as [`run`] does; `options` may be a time, [`Seconds`].
    ///
    /// # Errors
    ///
    /// As [`run`].
    ///
    /// # Examples
    ///
    /// ```
    /// use palpate_sim::{HandPath, Interpolation, RecordedDevice};
    /// use palpate_field::Shape;
    /// use palpate_haptics::Servo;
    /// use palpate_haptics::servo_loop::{Run as _, Seconds};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let ends = vec![[0.0, 0.08, 0.0].into(), [0.0, 0.05, 0.0].into()];
    /// let press = HandPath::new(vec![0.0, 0.05], ends, Interpolation::Smooth)?;
    /// let mut device = RecordedDevice::new(vec![press])?;
    /// let mut servo = Servo::for_device(Shape::circle(0.05)?, &device)?;
    /// assert_eq!(servo.run(&mut device, Seconds(0.05))?.ticks, 50);
    /// # Ok(())
    /// # }
    /// ```
    fn run<'a>(
        &mut self,
        device: &mut dyn Device,
        options: impl Into<RunOptions<'a>>,
    ) -> Result<RunReport, HapticsError>;
}

impl Run for Servo {
    fn run<'a>(
        &mut self,
        device: &mut dyn Device,
        options: impl Into<RunOptions<'a>>,
    ) -> Result<RunReport, HapticsError> {
        run(self, device, options.into())
    }
}

impl std::fmt::Debug for RunOptions<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("RunOptions")
            .field("duration", &self.duration)
            .field("pace", &self.pace)
            .field("rehearses", &self.rehearses)
            .field("recorder", &self.recorder.is_some())
            .field("sink", &self.sink.is_some())
            .field("watch", &self.watch)
            .field("motion", &self.motion.is_some())
            .field("interrupt", &self.interrupt)
            .field("reconnection", &self.reconnection)
            .field("vibration", &self.vibration)
            .finish()
    }
}

/// Runs `servo` with `device` and returns a report.
///
/// Tick `k` is at the servo's time `k / rate`. In real time the loop sleeps between ticks; a
/// tick that starts more than a period late shifts all later ones, so that the loop does not
/// hurry to catch up. The loop opens the device before the first tick, sets its watchdog and
/// switches its motors on. However the run ends, the last forces written are zero, and the device is
/// closed; [`RunReport::is_released`] says whether it took them.
///
/// # Errors
///
/// [`HapticsError::Number`] if the duration is negative or not finite;
/// [`HapticsError::ContactPoints`] if servo and device have different numbers of contact
/// points, or a device that vibrates has another number of channels; [`HapticsError::Rate`] and [`HapticsError::Pace`] if the device measures more seldom than
/// the servo ticks, or one of both sets another pace than the options;
/// [`SafetyError::OtherDevice`](palpate_safety::SafetyError) if the device has tighter
/// limits than the one that the servo was made for. Failures during the run are in the report.
///
/// # Examples
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Ball};
/// use palpate_sim::{HandPath, Interpolation, RecordedDevice};
/// use palpate_haptics::Servo;
/// use palpate_haptics::servo_loop::{Pace, RunOptions, run};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let ends = vec![Vector([0.0, 0.08, 0.0]), Vector([0.0, 0.05, 0.0])];
/// let press = HandPath::new(vec![0.0, 1.0], ends, Interpolation::Smooth)?;
/// let mut device = RecordedDevice::new(vec![press])?;
/// let ball = Shape::<3>::from_kernel(Ball::new(0.05)?);
/// let mut servo = Servo::for_device(ball, &device)?;
///
/// let options = RunOptions { pace: Pace::AsFastAsPossible, ..RunOptions::new(1.0) };
/// let report = run(&mut servo, &mut device, options)?;
/// assert_eq!(report.ticks, 1000);
/// assert!((report.largest_depth - 0.002).abs() < 1e-5); // the probe's radius
/// # Ok(())
/// # }
/// ```
///
/// A servo without protection does not run with a device:
///
/// ```compile_fail,E0308
/// use palpate_field::{Shape, kernel::Ball};
/// use palpate_device::Device;
/// use palpate_haptics::{ServoOptions, Servo};
/// use palpate_haptics::servo_loop::{RunOptions, run};
///
/// fn feel(device: &mut dyn Device) -> Result<(), Box<dyn std::error::Error>> {
///     let ball = Shape::<3>::from_kernel(Ball::new(0.05)?);
///     let mut servo = Servo::new(ball, 1, ServoOptions::default())?;
///     run(&mut servo, device, RunOptions::new(1.0))?;
///     Ok(())
/// }
/// ```
pub fn run(
    servo: &mut Servo,
    device: &mut dyn Device,
    options: RunOptions<'_>,
) -> Result<RunReport, HapticsError> {
    run_on(&mut WallClock::new(), servo, device, options)
}

/// As [`run`], on the caller's clock.
///
/// # Errors
///
/// As [`run`].
#[inline(never)]
pub fn run_on(
    clock: &mut dyn Clock,
    servo: &mut Servo,
    device: &mut dyn Device,
    options: RunOptions<'_>,
) -> Result<RunReport, HapticsError> {
    let schedule = Schedule {
        ticks: ticks(
            NumberError::check_not_negative("duration", options.duration, "s")?,
            servo.options().rate,
        ),
        pace: options.pace,
        rehearses: options.rehearses,
    };
    let room = HandoffOptions { events: 0, bodies: 0, ..HandoffOptions::default() };
    let (control, mut end) = options.watch.is_some().then(|| handoff(&*servo, room)).unzip();
    servo.check_device(device)?;
    options.pace.check(device)?;
    let mut player = options.vibration.map(|vibration| vibration.start(servo)).transpose()?;
    // Within an option the closure's lifetime would have to be that of the loop.
    let motion = options.motion.map(|motion| -> BodyMotion<'_> { motion });
    let (rows, queued) = match (options.sink, options.pace) {
        (None, _) => (None, None),
        (Some(sink), Pace::AsFastAsPossible) => (Some(RowSink::Call(sink)), None),
        (Some(sink), Pace::RealTime | Pace::Device) => {
            let backlog = BACKLOG * servo.options().rate * device.points() as f64;
            let (writer, reader) = queue(backlog.min(MOST_BACKLOG).ceil() as usize);
            (Some(RowSink::Queue(writer)), Some((reader, sink)))
        }
    };
    let servo_loop = ServoLoop::new(servo, device)
        .recording(options.recorder)
        .sending(rows)
        .moving(motion)
        .interrupted_by(options.interrupt)
        .reconnecting(options.reconnection)
        .vibrating(player.as_mut())
        .handing_off(end.as_mut());
    let run = || servo_loop.run(clock, &schedule);
    Ok(accompanied(control.zip(options.watch), queued, run))
}

/// Runs `work` while other threads call the watch and the sink.
fn accompanied<T>(
    watched: Option<(Control, Watch<'_>)>,
    queued: Option<(Records, Sink<'_>)>,
    work: impl FnOnce() -> T,
) -> T {
    std::thread::scope(|scope| {
        let watcher = watched.map(|(control, show)| scope.spawn(|| watch(control, show)));
        let taker = queued.map(|(records, sink)| scope.spawn(|| take(records, sink)));
        let result = work();
        for helper in watcher.iter().chain(&taker) {
            helper.thread().unpark();
        }
        result
    })
}

/// Calls a watch until the loop has ended.
fn watch(mut control: Control, watch: Watch<'_>) {
    loop {
        // Read before the snapshot, so that the last snapshot is that of the last tick.
        let is_last = control.has_ended();
        if let Some(snapshot) = control.latest() {
            (watch.show)(&snapshot.progress);
        }
        if is_last {
            return;
        }
        std::thread::park_timeout(watch.interval);
    }
}

/// Hands rows to a sink until the loop has ended.
fn take(mut records: Records, sink: Sink<'_>) {
    loop {
        // Read before the rows, so that the last rows are not missed.
        let is_last = records.has_ended();
        records.take().for_each(|row| sink(&row));
        if is_last {
            return;
        }
        std::thread::park_timeout(TAKEN_EVERY);
    }
}
