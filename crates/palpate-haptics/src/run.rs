// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The servo loop: a servo and a device, tick by tick, and a report.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Duration;

use palpate_field::Vector;

use crate::clock::{Clock, WallClock};
use crate::device::{Device, DeviceLost, PointState};
use crate::error::{HapticsError, not_negative};
use crate::live::{Live, Progress};
use crate::recorder::{Recorder, TickTimes};
use crate::report::{Ending, RunReport, Tally};
use crate::servo::Servo;

/// When the ticks of a run happen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pace {
    /// At the servo's rate on the clock.
    #[default]
    RealTime,
    /// One after the other, without waiting; the servo's time is the same.
    AsFastAsPossible,
}

/// A closure that shows a run while it runs.
pub type Watch<'a> = &'a mut (dyn FnMut(&Progress) + Send);

/// What to run, and what to do with it beside the report.
pub struct RunOptions<'a, const D: usize> {
    /// The time the servo runs [s].
    pub duration: f64,
    /// When the ticks happen.
    pub pace: Pace,
    /// Keeps every tick, as long as it has room.
    pub recorder: Option<&'a mut Recorder<D>>,
    /// Called from a thread of its own every so often, and once at the end.
    pub watch: Option<(Duration, Watch<'a>)>,
}

impl<const D: usize> RunOptions<'_, D> {
    /// Runs for `duration` [s] in real time; keeps and shows nothing.
    #[must_use]
    pub fn new(duration: f64) -> Self {
        Self { duration, pace: Pace::RealTime, recorder: None, watch: None }
    }
}

impl<const D: usize> std::fmt::Debug for RunOptions<'_, D> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("RunOptions")
            .field("duration", &self.duration)
            .field("pace", &self.pace)
            .field("recorder", &self.recorder.is_some())
            .field("watch", &self.watch.as_ref().map(|(every, _)| every))
            .finish()
    }
}

/// Runs `servo` with `device` and reports what happened.
///
/// Tick `k` is at `k / rate` of the servo's time. In real time the loop sleeps, asks the field
/// once where each proxy is, so that the tick finds it in the caches, and spins up to each tick;
/// a tick that comes more than a period late moves all later ones, so that the servo never
/// hurries after lost time. The device's largest force becomes the servo's, if it is smaller.
/// Whatever ends the run, the last forces written are zero.
///
/// # Errors
///
/// If the duration is negative or not finite, or servo and device have different numbers of
/// contact points. What goes wrong during the run is in the report.
///
/// # Examples
///
/// ```
/// use palpate_field::{Shape, Vector, kernel::Ball};
/// use palpate_haptics::{
///     HandPath, Interpolation, Pace, RunOptions, Servo, ServoOptions, RecordedDevice, run,
/// };
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let ends = vec![Vector([0.0, 0.08, 0.0]), Vector([0.0, 0.05, 0.0])];
/// let press = HandPath::new(vec![0.0, 1.0], ends, Interpolation::Smooth)?;
/// let mut device = RecordedDevice::new(vec![press])?;
/// let ball = Shape::from_kernel(Ball::new(0.05)?);
/// let mut servo = Servo::new(ball, 1, ServoOptions::default())?;
///
/// let options = RunOptions { pace: Pace::AsFastAsPossible, ..RunOptions::new(1.0) };
/// let report = run(&mut servo, &mut device, options)?;
/// assert_eq!(report.ticks, 1000);
/// assert!((report.largest_depth - 0.002).abs() < 1e-5); // the probe's radius
/// # Ok(())
/// # }
/// ```
pub fn run<const D: usize>(
    servo: &mut Servo<D>,
    device: &mut dyn Device<D>,
    options: RunOptions<'_, D>,
) -> Result<RunReport, HapticsError> {
    run_on(&mut WallClock::new(), servo, device, options)
}

/// As [`run`], on a clock of the caller's.
///
/// # Errors
///
/// As [`run`].
pub fn run_on<const D: usize>(
    clock: &mut dyn Clock,
    servo: &mut Servo<D>,
    device: &mut dyn Device<D>,
    options: RunOptions<'_, D>,
) -> Result<RunReport, HapticsError> {
    let duration = not_negative("duration", options.duration, "s")?;
    let points = servo.touches().len();
    if points != device.points() {
        let (servo, device) = (points, device.points());
        return Err(HapticsError::ContactPoints { servo, device });
    }
    servo.limit_force(device.profile().max_force);
    let rate = servo.options().rate;
    let schedule = Schedule {
        rate,
        // Rounded, so that 10 s at 1 kHz are 10 000 ticks whatever the last bit.
        ticks: (duration * rate).round() as u64,
        pace: options.pace,
    };
    let live = Live::default();
    let mut tally = Tally::new(points, rate);
    let mut recorder = options.recorder;
    let mut work = || {
        let looped = AssertUnwindSafe(|| {
            let mut servo_loop = ServoLoop {
                servo,
                device: &mut *device,
                states: vec![PointState::at_rest(Vector::ZERO); points],
                tally: &mut tally,
                recorder: recorder.as_deref_mut(),
                live: &live,
            };
            servo_loop.run(clock, &schedule)
        });
        let ending = match catch_unwind(looped) {
            Ok(Ok(())) => Ending::Finished,
            Ok(Err(lost)) => Ending::DeviceLost { reason: lost.reason },
            Err(panic) => Ending::Panicked { message: message_of(&*panic) },
        };
        live.finish();
        // A device that is lost takes no force; nothing is left to do about that.
        let _ = device.write(&vec![Vector::ZERO; points]);
        ending
    };
    let ending = match options.watch {
        None => work(),
        Some((every, watch)) => watched(&live, every, watch, work),
    };
    let dropped = recorder.map_or(0, |r| r.dropped());
    Ok(tally.report(ending, dropped, servo.safety()))
}

/// Works while another thread shows what is `live`.
fn watched<T>(live: &Live, every: Duration, watch: Watch<'_>, work: impl FnOnce() -> T) -> T {
    std::thread::scope(|scope| {
        let watcher = scope.spawn(move || {
            while !live.is_finished() {
                if let Some(progress) = live.latest().filter(|p| p.ticks > 0) {
                    watch(&progress);
                }
                std::thread::park_timeout(every);
            }
            if let Some(progress) = live.latest() {
                watch(&progress);
            }
        });
        let result = work();
        watcher.thread().unpark();
        result
    })
}

fn message_of(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().copied();
    let text = text.or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    text.unwrap_or("no message").to_owned()
}

struct Schedule {
    rate: f64,
    ticks: u64,
    pace: Pace,
}

struct ServoLoop<'a, const D: usize> {
    servo: &'a mut Servo<D>,
    device: &'a mut dyn Device<D>,
    states: Vec<PointState<D>>,
    tally: &'a mut Tally,
    recorder: Option<&'a mut Recorder<D>>,
    live: &'a Live,
}

/// How long before a tick the field is asked once more.
const REHEARSAL: Duration = Duration::from_micros(20);

impl<const D: usize> ServoLoop<'_, D> {
    /// Asks the field where the proxies are: the sleep between ticks has let caches and
    /// predictors go cold, and the tick finds them warm again.
    fn rehearse(&self) {
        for touch in self.servo.touches() {
            let near = self.servo.bodies().everything().look(touch.proxy);
            std::hint::black_box(near);
        }
    }

    fn run(&mut self, clock: &mut dyn Clock, schedule: &Schedule) -> Result<(), DeviceLost> {
        let period = Duration::from_secs_f64(1.0 / schedule.rate);
        let mut deadline = clock.now();
        for tick in 0..schedule.ticks {
            let time_s = tick as f64 / schedule.rate;
            let mut lateness_ns = 0;
            if schedule.pace == Pace::RealTime {
                clock.wait_until(deadline.saturating_sub(REHEARSAL));
                self.rehearse();
                clock.wait_until(deadline);
                let late = clock.now().saturating_sub(deadline);
                lateness_ns = nanoseconds(late);
                self.tally.late(lateness_ns, late > period);
                self.servo.set_late(late > period);
                if late > period {
                    deadline += late;
                }
                deadline += period;
            }
            let cost_ns = self.tick(clock, time_s)?;
            self.account(TickTimes { time_s, cost_ns, lateness_ns });
        }
        Ok(())
    }

    /// One tick, from reading to writing. Returns what the servo's step cost [ns]; the device's
    /// transport is not part of it.
    fn tick(&mut self, clock: &mut dyn Clock, time_s: f64) -> Result<u64, DeviceLost> {
        self.device.read(time_s, &mut self.states)?;
        let start = clock.now();
        self.servo.step(&self.states);
        let cost = clock.now().saturating_sub(start);
        self.device.write(self.servo.forces())?;
        Ok(nanoseconds(cost))
    }

    /// Everything that is not part of a tick: it may make the next one late, but not wrong.
    fn account(&mut self, times: TickTimes) {
        let progress = self.tally.tick(times, self.servo);
        self.live.publish(&progress);
        if let Some(recorder) = &mut self.recorder {
            recorder.record(times, self.servo);
        }
    }
}

fn nanoseconds(duration: Duration) -> u64 {
    u64::try_from(duration.as_nanos()).unwrap_or(u64::MAX)
}
