// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Touch: a servo in a thread of its own, which never waits for Python, and runs on a virtual clock.

use std::time::Duration;

use palpate::field::Pose;
use palpate::scene::{AnyScene, BuiltScene, ServoSettings};
use palpate::servo_loop::{Ending, Pace, Recorder, RunOptions, ThreadOptions, run};
use pyo3::exceptions::{PyRuntimeError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::answers::{Fields, read};
use crate::error::OrRaise;
use crate::hand::{check_points, simulated};
use crate::interrupt::interruptible;
use crate::mailbox::{PyMailbox, check_rate};
use crate::pool;
use crate::poses;
use crate::scene::PyScene;
use crate::stage::{Motion, Ready, Staged};
use crate::touched::{event, snapshot, trace};

/// The most rows that are kept: some 3 GB.
const MOST_ROWS: f64 = 1e7;

/// How long ticks are kept at most unless the caller says so [s].
const RECORDED: f64 = 600.0;

/// The most ticks of a run: eleven days at 1 kHz.
const MOST_TICKS: f64 = 1e9;

/// The device that is simulated unless the caller names another.
const DEVICE: &str = "omega";

/// Ticks a second unless the caller or a slower device says otherwise [Hz].
const RATE: f64 = 1000.0;

/// How long a tour takes if the servo does not end by itself [s].
const TOUR: f64 = 10.0;

/// A servo in a thread of its own: it touches the bodies of a scene with a device, a thousand times a second and more,
/// and never waits for Python. `scene` is a `Scene`, or what makes one: a shape, or a dict of names and shapes.
///
/// `device` is the name of a profile, whose device is simulated in a hand, or a `Mailbox` for a device of your own.
/// `hand` is where that hand goes in the world: rows of time [s] and position [m], or one position to rest at, which
/// carry the contact points of the scene's tool; or such rows for each contact point, shape (points, n, D + 1). Left
/// out, it is a tour over all bodies, of `points` contact points one behind the other, or of the scene's tool.
/// `duration` [s] ends the servo by itself. `record` is for how long ticks are kept [s], for `trace`: left out, for the
/// duration, but no longer than 600 s and 10 million rows, and without a duration not at all. `rate` is how many ticks a
/// second has [Hz]: left out, 1000, or as many as a slower `Mailbox` tells. It runs inside of `with`, which raises `DeviceLostError` at its end if the device was lost meanwhile.
///
/// Raises `UnknownNameError` if no profile has the name, `DeviceError`, `HapticsError` or `SceneError` if the hand, the
/// tool or a body cannot be, `ValueError` if a number is out of range, `RuntimeError` if another servo has the mailbox.
///
/// >>> import palpate as pp
/// >>> with pp.Servo(pp.Scene(pp.ball(0.05)), hand=[0, 0.049, 0], duration=0.05) as servo:
/// ...     kinds = [event.kind for event in servo.events()]
/// >>> servo.report["ticks"], len(servo.trace.time)
/// (50, 50)
#[pyclass(frozen, module = "palpate", name = "Servo")]
pub(crate) struct PyServo {
    servo: Staged,
    /// The dimension of the scene.
    dimension: usize,
    /// The names of the bodies, in their order.
    names: Vec<String>,
}

#[pymethods]
impl PyServo {
    #[new]
    #[pyo3(signature = (scene, *, device = None, hand = None, points = 1, duration = None, record = None, rate = None))]
    fn new(
        py: Python<'_>,
        scene: &Bound<'_, PyAny>,
        device: Option<&Bound<'_, PyAny>>,
        hand: Option<&Bound<'_, PyAny>>,
        points: usize,
        duration: Option<f64>,
        record: Option<f64>,
        rate: Option<f64>,
    ) -> PyResult<Self> {
        let scene = PyScene::given(scene)?;
        let mailbox = device.and_then(|device| device.cast::<PyMailbox>().ok());
        let mailbox = mailbox.map(Bound::get);
        let of_mailbox = mailbox.and_then(PyMailbox::rate).unwrap_or(RATE);
        let rate = rate.unwrap_or(of_mailbox.min(RATE));
        let asked = Asked { device, hand, points, duration, record, rate };
        let (ready, dimension) = match scene.get().built() {
            AnyScene::Planar(scene) => (asked.ready(py, scene, mailbox)?, 2),
            AnyScene::Spatial(scene) => (asked.ready(py, scene, mailbox)?, 3),
        };
        Ok(Self { servo: Staged::new(ready), dimension, names: scene.get().body_names() })
    }

    fn __enter__(slf: PyRef<'_, Self>) -> PyResult<PyRef<'_, Self>> {
        let py = slf.py();
        slf.servo.start(py)?;
        Ok(slf)
    }

    #[pyo3(signature = (*exception))]
    fn __exit__(
        &self,
        py: Python<'_>,
        exception: &Bound<'_, pyo3::types::PyTuple>,
    ) -> PyResult<()> {
        self.end(py);
        let is_raised = exception.iter().any(|part| !part.is_none());
        // What the block itself raises says more.
        let broken = self.servo.broken();
        match broken {
            Some(ending) if !is_raised => Err(ended_early(py, &ending)),
            _ => Ok(()),
        }
    }

    /// Ends the servo: forces go to zero, and its thread has ended when this returns.
    ///
    /// >>> import palpate as pp
    /// >>> with pp.Servo(pp.Scene(pp.ball(0.05)), hand=[0, 0.1, 0]) as servo:
    /// ...     servo.end()
    /// >>> servo.has_ended
    /// True
    fn end(&self, py: Python<'_>) {
        self.servo.end(py);
    }

    /// Whether its thread has ended.
    ///
    /// >>> import palpate as pp
    /// >>> with pp.Servo(pp.Scene(pp.ball(0.05)), hand=[0, 0.1, 0]) as servo:
    /// ...     servo.has_ended
    /// False
    #[getter]
    fn has_ended(&self) -> bool {
        self.servo.has_ended()
    }

    /// The newest state: time, force and touches; None before the first tick and after the end.
    ///
    /// >>> import palpate as pp, time
    /// >>> with pp.Servo(pp.Scene(pp.ball(0.05)), hand=[0, 0.049, 0]) as servo:
    /// ...     while servo.latest() is None:
    /// ...         time.sleep(0.001)
    /// ...     servo.latest().touches[0].device.shape
    /// (3,)
    fn latest<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let now = self.servo.latest();
        now.map(|now| snapshot(py, &now, &self.names, self.dimension)).transpose()
    }

    /// The events since the last call: what began and ended to touch, slip and stick.
    ///
    /// >>> import palpate as pp
    /// >>> with pp.Servo(pp.Scene(pp.ball(0.05)), hand=[0, 0.1, 0]) as servo:
    /// ...     servo.take_events()
    /// []
    fn take_events<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        let events = self.servo.take_events();
        events.iter().map(|found| event(py, found, &self.names)).collect()
    }

    /// All events from now on, one after the other, in the thread that asks; ends with the servo.
    ///
    /// Raises `RuntimeError` before the servo runs.
    ///
    /// >>> import palpate as pp
    /// >>> with pp.Servo(pp.Scene(pp.ball(0.05)), hand=[0, 0.049, 0], duration=0.05) as servo:
    /// ...     "touch" in [event.kind for event in servo.events()]
    /// True
    fn events<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.get().servo.begun()?;
        slf.py().import("palpate._servo")?.call_method1("events", (slf,))
    }

    /// Waits until the servo ends by itself, as by its `duration`, or until `timeout` [s] is over; whether it has ended.
    ///
    /// Raises `RuntimeError` before the servo runs.
    ///
    /// >>> import palpate as pp
    /// >>> with pp.Servo(pp.Scene(pp.ball(0.05)), hand=[0, 0.049, 0], duration=0.05) as servo:
    /// ...     servo.wait()
    /// True
    #[pyo3(signature = (timeout = None))]
    fn wait(slf: &Bound<'_, Self>, timeout: Option<f64>) -> PyResult<bool> {
        slf.get().servo.begun()?;
        let wait = slf.py().import("palpate._servo")?.getattr("wait")?;
        wait.call1((slf, timeout))?.extract()
    }

    /// Moves bodies to new poses over a time: a dict of their names and poses, as of `Shape.placed`, and `over` [s].
    ///
    /// A physics engine that sets poses at 60 Hz passes `over=1/60`: bodies then move smoothly, and arrive one call
    /// late. A body that would move a contact point faster than 2 m/s jumps instead: the force rises from what it was.
    ///
    /// Raises `KeyError` if a name is that of no body, `ValueError` if a pose has another shape or is not finite, or
    /// `over` is negative or not finite, `RuntimeError` unless the servo runs.
    ///
    /// >>> import palpate as pp
    /// >>> with pp.Servo(pp.Scene({"ball": pp.ball(0.05)}), hand=[0, 0.1, 0]) as servo:
    /// ...     servo.set_poses({"ball": [0, 0.01, 0]})
    #[pyo3(signature = (poses, over = 0.0))]
    fn set_poses(&self, poses: &Bound<'_, PyDict>, over: f64) -> PyResult<()> {
        let over = Duration::try_from_secs_f64(over).map_err(|_| {
            PyValueError::new_err(format!("over must be zero or more and finite, got {over} s"))
        })?;
        let numbered: Vec<(String, usize)> = self.names.iter().cloned().zip(0..).collect();
        let all = if self.dimension == 2 {
            let all = poses::named::<_, Pose<2>>(poses, &numbered)?.into_iter();
            all.map(|(body, pose)| (body, pose.in_space())).collect()
        } else {
            poses::named(poses, &numbered)?
        };
        let done = self.servo.running(|own| own.thread.control().set_poses(&all, over))?;
        done.or_raise(poses.py())
    }

    /// Limits the force from the next tick on [N], below what device and safety chain allow.
    ///
    /// Raises `HapticsError` if the limit is negative or not finite, `RuntimeError` unless the servo runs.
    ///
    /// >>> import palpate as pp
    /// >>> with pp.Servo(pp.Scene(pp.ball(0.05)), hand=[0, 0.049, 0]) as servo:
    /// ...     servo.limit_force(0.5)
    fn limit_force(&self, py: Python<'_>, newtons: f64) -> PyResult<()> {
        self.servo.running(|own| own.thread.control().limit_force(newtons))?.or_raise(py)
    }

    /// Sets all forces to zero from the next tick on, until `release`.
    ///
    /// Raises `RuntimeError` unless the servo runs.
    ///
    /// >>> import palpate as pp
    /// >>> with pp.Servo(pp.Scene(pp.ball(0.05)), hand=[0, 0.049, 0]) as servo:
    /// ...     servo.stop()
    /// ...     servo.release()
    fn stop(&self) -> PyResult<()> {
        self.servo.running(|own| _ = own.thread.control().stop_switch().stop())
    }

    /// Lets forces rise from zero after a `stop`.
    ///
    /// Raises `RuntimeError` unless the servo runs.
    ///
    /// >>> import palpate as pp
    /// >>> with pp.Servo(pp.Scene(pp.ball(0.05)), hand=[0, 0.049, 0]) as servo:
    /// ...     servo.release()
    fn release(&self) -> PyResult<()> {
        self.servo.running(|own| own.thread.control().stop_switch().release())
    }

    /// What the run was like, of a servo that has ended: why it ended, ticks, lateness, forces, safety, as
    /// `palpate feel --json`. After a `duration` the servo ends by itself, as `wait` tells.
    ///
    /// Raises `RuntimeError` before the end.
    ///
    /// >>> import palpate as pp
    /// >>> with pp.Servo(pp.Scene(pp.ball(0.05)), hand=[0, 0.1, 0], duration=0.02) as servo:
    /// ...     list(servo.events())
    /// []
    /// >>> servo.report["ticks"]
    /// 20
    #[getter]
    fn report<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        read(py, &self.servo.ended(py)?.report)
    }

    /// The ticks that were recorded, of a servo that has ended. Each access makes new arrays: keep them.
    ///
    /// Raises `RuntimeError` before the end, or if no ticks were to be kept.
    ///
    /// >>> import palpate as pp
    /// >>> with pp.Servo(pp.Scene(pp.ball(0.05)), hand=[0, 0.1, 0], duration=0.02, record=0.01) as servo:
    /// ...     list(servo.events())
    /// []
    /// >>> len(servo.trace.time), servo.trace.lost
    /// (10, 10)
    #[getter]
    fn trace<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let ended = self.servo.ended(py)?;
        if ended.rows.is_empty() && ended.lost == 0 {
            let problem = "no tick was recorded: tell for how long ticks are kept, by record=";
            return Err(PyRuntimeError::new_err(problem));
        }
        trace(py, &ended.rows, ended.lost, self.dimension)
    }
}

/// The exception of a servo whose device was lost, or whose thread panicked.
fn ended_early(py: Python<'_>, ending: &Ending) -> PyErr {
    let Ending::DeviceLost { reason } = ending else {
        return PyRuntimeError::new_err(format!("the servo ended early: {ending:?}"));
    };
    let made = || -> PyResult<PyErr> {
        let class = py.import("palpate._errors")?.getattr("DeviceLostError")?;
        let problem =
            format!("the device was lost: {reason}. The servo has its report and trace");
        Ok(PyErr::from_value(class.call1((problem,))?))
    };
    made().unwrap_or_else(|error| error)
}

/// What a caller asks of a servo.
struct Asked<'a, 'py> {
    device: Option<&'a Bound<'py, PyAny>>,
    hand: Option<&'a Bound<'py, PyAny>>,
    points: usize,
    duration: Option<f64>,
    record: Option<f64>,
    rate: f64,
}

impl Asked<'_, '_> {
    /// What is made of the scene, and what it is touched with.
    fn ready<const D: usize>(
        &self,
        py: Python<'_>,
        scene: &BuiltScene<D>,
        mailbox: Option<&PyMailbox>,
    ) -> PyResult<Ready> {
        mailbox.map_or(Ok(()), |mailbox| mailbox.check(D))?;
        check_rate(self.rate)?;
        let is_run = |duration: f64| {
            let ticks = (duration * self.rate).round();
            (1.0..=MOST_TICKS).contains(&ticks)
        };
        if let Some(duration) = self.duration.filter(|duration| !is_run(*duration)) {
            let (least, most) = (0.5 / self.rate, MOST_TICKS / self.rate);
            let problem = format!(
                "duration must be {least} s to {most} s at {} Hz, got {duration} s",
                self.rate
            );
            return Err(PyValueError::new_err(problem));
        }
        if self.hand.is_none() && mailbox.is_none() {
            // A tour takes long: its ticks are refused before.
            check_points(self.points)?;
            self.rows(self.points)?;
        }
        let tour = (self.points, self.duration.unwrap_or(TOUR));
        let device = match (mailbox, self.device) {
            (Some(_), _) if self.hand.is_some() || self.points != 1 => {
                let problem = "hand= and points= are of a simulated device: a Mailbox sets its own positions";
                return Err(PyTypeError::new_err(problem));
            }
            (Some(mailbox), _) => mailbox.take()?,
            (None, None) => simulated(scene, DEVICE, self.hand, tour, py)?,
            (None, Some(name)) => {
                if name.is_instance_of::<PyMailbox>() {
                    let problem = "feel runs on a virtual clock, so its device is simulated: give a Mailbox to Servo";
                    return Err(PyTypeError::new_err(problem));
                }
                let name: String = name.extract().map_err(|_| {
                    PyTypeError::new_err("device must be the name of a profile or a Mailbox")
                })?;
                simulated(scene, &name, self.hand, tour, py)?
            }
        };
        let settings = ServoSettings { rate: self.rate, ..ServoSettings::default() };
        let made = self.rows(device.points()).and_then(|rows| {
            Ok((rows, scene.servo_with(device.as_ref(), settings).or_raise(py)?))
        });
        let (rows, servo) = match (made, mailbox) {
            (Ok(made), _) => made,
            (Err(error), None) => return Err(error),
            (Err(error), Some(mailbox)) => {
                mailbox.give_back(device);
                return Err(error);
            }
        };
        let options = ThreadOptions {
            duration: self.duration,
            rows: (rows > 0).then_some(rows),
            ..ThreadOptions::default()
        };
        let motion =
            (!scene.motions.is_empty()).then(|| -> Motion { Box::new(scene.motion()) });
        Ok(Ready { servo, device, options, motion })
    }

    /// How many rows are kept, of so many contact points.
    fn rows(&self, points: usize) -> PyResult<usize> {
        let a_second = self.rate * points as f64;
        let most = MOST_ROWS / a_second;
        let own = self.duration.map_or(0.0, |duration| duration.min(RECORDED).min(most));
        let given = self.record.unwrap_or(own);
        let rows = given * a_second;
        if !(0.0..=MOST_ROWS).contains(&rows) {
            let problem = format!(
                "ticks of {points} contact points at {} Hz are kept for 0 s to {most} s, got {given} s",
                self.rate
            );
            return Err(PyValueError::new_err(problem));
        }
        Ok(rows.ceil() as usize)
    }
}

/// Feels a scene on a virtual clock, as fast as it goes: the same every time. See `Servo`; `duration` is in seconds.
///
/// Raises `UnknownNameError` if no profile has the name, `DeviceError`, `HapticsError` or `SceneError` if the hand, the
/// tool or a body cannot be, `ValueError` if a number is out of range: at most 10 million rows are kept.
///
/// >>> import palpate as pp
/// >>> felt = pp.feel(pp.ball(0.05), hand=[[0, 0, 0.06, 0], [0.1, 0, 0.045, 0]], duration=0.1)
/// >>> len(felt.trace.time), bool(felt.trace.force[-1, 1] > 0)
/// (100, True)
#[pyfunction]
#[pyo3(signature = (scene, *, device = None, hand = None, points = 1, duration = 10.0, rate = 1000.0))]
pub(crate) fn feel<'py>(
    py: Python<'py>,
    scene: &Bound<'py, PyAny>,
    device: Option<&Bound<'py, PyAny>>,
    hand: Option<&Bound<'py, PyAny>>,
    points: usize,
    duration: f64,
    rate: f64,
) -> PyResult<Bound<'py, PyAny>> {
    let scene = PyScene::given(scene)?;
    let asked =
        Asked { device, hand, points, duration: Some(duration), record: Some(duration), rate };
    match scene.get().built() {
        AnyScene::Planar(scene) => felt(py, asked.ready(py, scene, None)?, &asked, 2),
        AnyScene::Spatial(scene) => felt(py, asked.ready(py, scene, None)?, &asked, 3),
    }
}

fn felt<'py>(
    py: Python<'py>,
    ready: Ready,
    asked: &Asked<'_, '_>,
    dimension: usize,
) -> PyResult<Bound<'py, PyAny>> {
    let Ready { mut servo, mut device, mut motion, .. } = ready;
    let seconds = asked.duration.unwrap_or_default();
    let mut recorder = Recorder::new(asked.rows(device.points())?);
    let report = interruptible(py, &*pool::of_at_least_one(1)?, |stop| {
        let mut options = RunOptions {
            pace: Pace::AsFastAsPossible,
            interrupt: Some(stop),
            recorder: Some(&mut recorder),
            ..RunOptions::new(seconds)
        };
        if let Some(motion) = &mut motion {
            options = RunOptions { motion: Some(motion.as_mut()), ..options };
        }
        run(&mut servo, device.as_mut(), options)
    })?;
    let report = report.or_raise(py)?;
    Fields::new(py)
        .with("report", read(py, &report)?)?
        .with("trace", trace(py, recorder.rows(), recorder.dropped(), dimension)?)?
        .of_class("Felt")
}
