// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Touch: a servo in a thread of its own, which never waits for Python, and runs on a virtual clock.

use std::sync::{Mutex, MutexGuard, PoisonError};

use palpate::devices::{
    Device, Hand, HandPath, Interpolation, SimulatedDevice, Tour, profile_named,
};
use palpate::field::{Pose, Vector};
use palpate::haptics::Servo;
use palpate::scene::{BuiltScene, ServoSettings};
use palpate::servo_loop::{
    EndedThread, Pace, Recorder, Records, RunOptions, RunReport, ServoThread, ThreadOptions,
    TraceRow, run,
};
use pyo3::exceptions::{PyRuntimeError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::answers::Fields;
use crate::arrays::{misshapen, numbers};
use crate::error::OrRaise;
use crate::interrupt::interruptible;
use crate::mailbox::PyMailbox;
use crate::poses::{self, Posed};
use crate::scene::PyScene;
use crate::touched::{event, read, snapshot, trace};

/// More rows are not kept at once.
const MOST_ROWS: f64 = 1e8;

/// What runs.
struct Ready<const D: usize> {
    servo: Servo<D>,
    device: Box<dyn Device<D> + Send>,
    names: Vec<String>,
    options: ThreadOptions<D>,
}

/// What runs in a thread.
struct Running<const D: usize> {
    thread: ServoThread<D>,
    records: Option<Records<D>>,
    names: Vec<String>,
}

/// Where a servo is between its making and its end.
enum Stage<const D: usize> {
    Ready(Box<Ready<D>>),
    Running(Box<Running<D>>),
    Ended {
        report: Box<RunReport>,
        rows: Vec<TraceRow<D>>,
        lost: u64,
    },
    /// While it goes from one to the next.
    Between,
}

enum AnyServo {
    Planar(Mutex<Stage<2>>),
    Spatial(Mutex<Stage<3>>),
}

/// Does the same with a servo of either dimension, whose stage is locked.
macro_rules! staged {
    ($any:expr, $stage:ident => $done:expr) => {
        match $any {
            AnyServo::Planar(stage) => {
                let $stage = &mut *locked(stage);
                $done
            }
            AnyServo::Spatial(stage) => {
                let $stage = &mut *locked(stage);
                $done
            }
        }
    };
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Makes what a servo needs of a scene, and what it is touched with.
fn ready<const D: usize>(
    scene: &BuiltScene<D>,
    device: Box<dyn Device<D> + Send>,
    rate: f64,
    py: Python<'_>,
) -> PyResult<Ready<D>> {
    let settings = ServoSettings::default().with_rate(rate);
    let servo = scene.servo_with(device.as_ref(), settings).or_raise(py)?;
    let names = scene.bodies.iter().map(|body| body.name.clone()).collect();
    Ok(Ready { servo, device, names, options: ThreadOptions::default() })
}

/// A simulated device in a hand that follows a path in the world, as the program does: rows of time [s] and position [m], one position to
/// rest at, or a tour over all bodies.
fn simulated<const D: usize>(
    scene: &BuiltScene<D>,
    profile: &str,
    hand: Option<&Bound<'_, PyAny>>,
    duration: f64,
    py: Python<'_>,
) -> PyResult<Box<dyn Device<D> + Send>> {
    let profile = profile_named(profile).or_raise(py)?;
    let map = scene.workspace_of(&profile, None).or_raise(py)?;
    let hand = match hand {
        None => {
            let bounds = scene.bounds().ok_or_else(|| {
                PyValueError::new_err("no body has bounds: tell where the hand goes, by hand=")
            })?;
            let bodies: Vec<_> = scene.bodies.iter().map(|body| body.shape.clone()).collect();
            let tour = py.detach(|| {
                Tour::new(bounds, duration)
                    .and_then(|tour| tour.over_each(&scene.whole, &bodies))
            });
            let path = tour.or_raise(py)?;
            Hand::new(path.mapped(|point| map.point_to_device(point)).or_raise(py)?)
        }
        Some(hand) => {
            let array = numbers(hand, "hand")?;
            let given = array.as_doubles()?;
            match array.shape() {
                [columns] if *columns == D => {
                    let place = Vector(std::array::from_fn(|i| given[i]));
                    Hand::resting(map.point_to_device(place)).or_raise(py)?
                }
                [_, columns] if *columns == D + 1 => {
                    let rows = given.chunks_exact(D + 1);
                    let place = |row: &[f64]| {
                        map.point_to_device(Vector(std::array::from_fn(|i| row[i + 1])))
                    };
                    let times = rows.clone().map(|row| row[0]).collect();
                    let places = rows.map(place).collect();
                    let path = HandPath::new(times, places, Interpolation::Monotone);
                    Hand::new(path.or_raise(py)?)
                }
                shape => {
                    let expected = format!("({D},), or (n, {}) with times first", D + 1);
                    return Err(misshapen("hand", &expected, shape));
                }
            }
        }
    };
    Ok(Box::new(SimulatedDevice::new(profile, vec![hand]).or_raise(py)?))
}

/// A servo in a thread of its own: it touches the bodies of a scene with a device, a thousand times a second and more,
/// and never waits for Python. `scene` is a `Scene`, or what makes one: a shape, or a dict of names and shapes.
///
/// `device` is the name of a profile, whose device is simulated in a hand, or a `Mailbox` for a device of your own.
/// `hand` is where that hand goes in the world: rows of time [s] and position [m], or one position to rest at; left
/// out, a tour over all bodies. `duration` [s] ends the servo by itself. `record` is for how long ticks are kept [s],
/// for `trace`. It runs inside of `with`.
///
/// >>> import palpate as pp
/// >>> with pp.Servo(pp.Scene(pp.ball(0.05)), hand=[0, 0.049, 0], duration=0.05, record=0.05) as servo:
/// ...     kinds = [event.kind for event in servo.events()]
/// >>> servo.report["ticks"], len(servo.trace.time)
/// (50, 50)
#[pyclass(frozen, module = "palpate", name = "Servo")]
pub(crate) struct PyServo(AnyServo);

#[pymethods]
impl PyServo {
    #[new]
    #[pyo3(signature = (scene, *, device = None, hand = None, duration = None, record = 0.0, rate = 1000.0))]
    fn new(
        py: Python<'_>,
        scene: &Bound<'_, PyAny>,
        device: Option<&Bound<'_, PyAny>>,
        hand: Option<&Bound<'_, PyAny>>,
        duration: Option<f64>,
        record: f64,
        rate: f64,
    ) -> PyResult<Self> {
        let scene = PyScene::given(scene)?;
        let asked = Asked { device, hand, duration, record, rate };
        Ok(Self(match scene.get().built() {
            palpate::scene::AnyScene::Planar(scene) => {
                let own = asked.mailbox(PyMailbox::planar)?;
                AnyServo::Planar(Mutex::new(asked.stage(py, scene, own)?))
            }
            palpate::scene::AnyScene::Spatial(scene) => {
                let own = asked.mailbox(PyMailbox::spatial)?;
                AnyServo::Spatial(Mutex::new(asked.stage(py, scene, own)?))
            }
        }))
    }

    fn __enter__(slf: PyRef<'_, Self>) -> PyResult<PyRef<'_, Self>> {
        let py = slf.py();
        staged!(&slf.0, stage => start(py, stage)?);
        Ok(slf)
    }

    #[pyo3(signature = (*_exception))]
    fn __exit__(&self, py: Python<'_>, _exception: &Bound<'_, pyo3::types::PyTuple>) -> bool {
        self.end(py);
        false
    }

    /// Ends the servo: forces go to zero, and its thread has ended when this returns.
    ///
    /// >>> import palpate as pp
    /// >>> with pp.Servo(pp.Scene(pp.ball(0.05)), hand=[0, 0.1, 0]) as servo:
    /// ...     servo.end()
    /// >>> servo.has_ended
    /// True
    fn end(&self, py: Python<'_>) {
        match &self.0 {
            AnyServo::Planar(stage) => end(py, stage),
            AnyServo::Spatial(stage) => end(py, stage),
        }
    }

    /// Whether its thread has ended.
    ///
    /// >>> import palpate as pp
    /// >>> with pp.Servo(pp.Scene(pp.ball(0.05)), hand=[0, 0.1, 0]) as servo:
    /// ...     servo.has_ended
    /// False
    #[getter]
    fn has_ended(&self) -> bool {
        staged!(&self.0, stage => match stage {
            Stage::Running(own) => own.thread.has_ended(),
            Stage::Ready(_) => false,
            _ => true,
        })
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
        staged!(&self.0, stage => match stage {
            Stage::Running(own) => {
                let Running { thread, names, .. } = &mut **own;
                thread.control().latest().map(|now| snapshot(py, now, names)).transpose()
            }
            _ => Ok(None),
        })
    }

    /// The events since the last call: what began and ended to touch, slip and stick.
    ///
    /// >>> import palpate as pp
    /// >>> with pp.Servo(pp.Scene(pp.ball(0.05)), hand=[0, 0.1, 0]) as servo:
    /// ...     servo.take_events()
    /// []
    fn take_events<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        staged!(&self.0, stage => match stage {
            Stage::Running(own) => {
                let Running { thread, names, .. } = &mut **own;
                std::iter::from_fn(|| thread.control().next_event())
                    .map(|found| event(py, &found, names))
                    .collect()
            }
            _ => Ok(Vec::new()),
        })
    }

    /// All events from now on, one after the other, in the thread that asks; ends with the servo.
    ///
    /// >>> import palpate as pp
    /// >>> with pp.Servo(pp.Scene(pp.ball(0.05)), hand=[0, 0.049, 0], duration=0.05) as servo:
    /// ...     [event.kind for event in servo.events()][:1]
    /// ['touch']
    fn events<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.get().begun()?;
        slf.py().import("palpate._servo")?.call_method1("events", (slf,))
    }

    /// Waits until the servo ends by itself, as by its `duration`, or until `timeout` [s] is over; whether it has ended.
    ///
    /// >>> import palpate as pp
    /// >>> with pp.Servo(pp.Scene(pp.ball(0.05)), hand=[0, 0.049, 0], duration=0.05) as servo:
    /// ...     servo.wait()
    /// True
    #[pyo3(signature = (timeout = None))]
    fn wait(slf: &Bound<'_, Self>, timeout: Option<f64>) -> PyResult<bool> {
        slf.get().begun()?;
        let wait = slf.py().import("palpate._servo")?.getattr("wait")?;
        wait.call1((slf, timeout))?.extract()
    }

    /// Moves bodies: a dict of their names and poses, as of `Shape.placed`.
    ///
    /// >>> import palpate as pp
    /// >>> with pp.Servo(pp.Scene({"ball": pp.ball(0.05)}), hand=[0, 0.1, 0]) as servo:
    /// ...     servo.set_poses({"ball": [0, 0.01, 0]})
    fn set_poses(&self, poses: &Bound<'_, PyDict>) -> PyResult<()> {
        staged!(&self.0, stage => match stage {
            Stage::Running(own) => set_poses(poses, own),
            _ => Err(PyRuntimeError::new_err(NOT_RUNNING)),
        })
    }

    /// Limits the force from the next tick on [N], below what device and safety chain allow.
    ///
    /// >>> import palpate as pp
    /// >>> with pp.Servo(pp.Scene(pp.ball(0.05)), hand=[0, 0.049, 0]) as servo:
    /// ...     servo.limit_force(0.5)
    fn limit_force(&self, py: Python<'_>, newtons: f64) -> PyResult<()> {
        staged!(&self.0, stage => match stage {
            Stage::Running(own) => own.thread.control().limit_force(newtons).or_raise(py),
            _ => Err(PyRuntimeError::new_err(NOT_RUNNING)),
        })
    }

    /// Sets all forces to zero from the next tick on, until `release`.
    ///
    /// >>> import palpate as pp
    /// >>> with pp.Servo(pp.Scene(pp.ball(0.05)), hand=[0, 0.049, 0]) as servo:
    /// ...     servo.stop()
    /// ...     servo.release()
    fn stop(&self) {
        staged!(&self.0, stage => if let Stage::Running(own) = stage {
            own.thread.control().stop_switch().stop();
        });
    }

    /// Lets forces rise from zero after a `stop`.
    ///
    /// >>> import palpate as pp
    /// >>> with pp.Servo(pp.Scene(pp.ball(0.05)), hand=[0, 0.049, 0]) as servo:
    /// ...     servo.release()
    fn release(&self) {
        staged!(&self.0, stage => if let Stage::Running(own) = stage {
            own.thread.control().stop_switch().release();
        });
    }

    /// What the run was like, of a servo that has ended: ticks, lateness, forces, safety, as `palpate feel --json`.
    ///
    /// >>> import palpate as pp
    /// >>> with pp.Servo(pp.Scene(pp.ball(0.05)), hand=[0, 0.1, 0], duration=0.02) as servo:
    /// ...     list(servo.events())
    /// []
    /// >>> servo.report["ticks"]
    /// 20
    #[getter]
    fn report<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        staged!(&self.0, stage => match stage {
            Stage::Ended { report, .. } => read(py, report),
            _ => Err(PyRuntimeError::new_err("the servo has not ended")),
        })
    }

    /// The ticks that were recorded, of a servo that has ended.
    ///
    /// >>> import palpate as pp
    /// >>> with pp.Servo(pp.Scene(pp.ball(0.05)), hand=[0, 0.1, 0], duration=0.02, record=0.01) as servo:
    /// ...     list(servo.events())
    /// []
    /// >>> len(servo.trace.time), servo.trace.lost
    /// (10, 10)
    #[getter]
    fn trace<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        staged!(&self.0, stage => match stage {
            Stage::Ended { rows, lost, .. } => trace(py, rows, *lost),
            _ => Err(PyRuntimeError::new_err("the servo has not ended")),
        })
    }
}

impl PyServo {
    /// Refuses a servo that does not run yet, whose end nobody should wait for.
    fn begun(&self) -> PyResult<()> {
        staged!(&self.0, stage => match stage {
            Stage::Ready(_) => Err(PyRuntimeError::new_err(NOT_RUNNING)),
            _ => Ok(()),
        })
    }
}

const NOT_RUNNING: &str = "the servo does not run: use it in a with statement";

/// What a caller asks of a servo.
struct Asked<'a, 'py> {
    device: Option<&'a Bound<'py, PyAny>>,
    hand: Option<&'a Bound<'py, PyAny>>,
    duration: Option<f64>,
    record: f64,
    rate: f64,
}

impl Asked<'_, '_> {
    /// The device of a mailbox, if it is one.
    fn mailbox<const D: usize>(
        &self,
        take: impl FnOnce(&PyMailbox) -> PyResult<Box<dyn Device<D> + Send>>,
    ) -> PyResult<Option<Box<dyn Device<D> + Send>>> {
        match self.device.map(|device| device.cast::<PyMailbox>()) {
            Some(Ok(mailbox)) => take(mailbox.get()).map(Some),
            _ => Ok(None),
        }
    }

    fn stage<const D: usize>(
        &self,
        py: Python<'_>,
        scene: &BuiltScene<D>,
        own: Option<Box<dyn Device<D> + Send>>,
    ) -> PyResult<Stage<D>> {
        let device = match (own, self.device) {
            (Some(own), _) => own,
            (None, None) => {
                simulated(scene, DEVICE, self.hand, self.duration.unwrap_or(TOUR), py)?
            }
            (None, Some(name)) => {
                if name.is_instance_of::<PyMailbox>() {
                    let problem =
                        "a virtual clock has no device of its own: a Mailbox is for Servo";
                    return Err(PyTypeError::new_err(problem));
                }
                let name: String = name.extract().map_err(|_| {
                    PyTypeError::new_err("device must be the name of a profile or a Mailbox")
                })?;
                simulated(scene, &name, self.hand, self.duration.unwrap_or(TOUR), py)?
            }
        };
        let points = device.points() as f64;
        let mut ready = ready(scene, device, self.rate, py)?;
        if let Some(duration) = self.duration {
            ready.options = ready.options.with_duration(duration);
        }
        let rows = self.record * self.rate * points;
        if !(0.0..=MOST_ROWS).contains(&rows) {
            let problem = format!(
                "record must be 0 s to {} s, got {} s",
                MOST_ROWS / self.rate / points,
                self.record
            );
            return Err(PyValueError::new_err(problem));
        }
        if rows > 0.0 {
            ready.options = ready.options.with_recorder(rows.ceil() as usize);
        }
        Ok(Stage::Ready(Box::new(ready)))
    }
}

/// The device that is simulated unless the caller names another.
const DEVICE: &str = "omega";

/// How long a tour takes if the servo does not end by itself [s].
const TOUR: f64 = 10.0;

fn start<const D: usize>(py: Python<'_>, stage: &mut Stage<D>) -> PyResult<()> {
    match std::mem::replace(stage, Stage::Between) {
        Stage::Ready(ready) => {
            let Ready { servo, device, names, options } = *ready;
            let mut thread = ServoThread::start(servo, device, options).or_raise(py)?;
            let records = thread.take_records();
            *stage = Stage::Running(Box::new(Running { thread, records, names }));
            Ok(())
        }
        other => {
            *stage = other;
            Err(PyRuntimeError::new_err("a servo runs once: make another"))
        }
    }
}

/// Waits for the thread without the interpreter's lock and without that of the stage, which another thread of Python
/// may wait for.
fn end<const D: usize>(py: Python<'_>, stage: &Mutex<Stage<D>>) {
    let taken = std::mem::replace(&mut *locked(stage), Stage::Between);
    let next = match taken {
        Stage::Running(own) => py.detach(|| {
            let Running { thread, records, .. } = *own;
            let EndedThread { report, .. } = thread.end();
            let (rows, lost) = records.map_or((Vec::new(), 0), |mut records| {
                let rows = records.take().collect();
                (rows, records.lost())
            });
            Stage::Ended { report: Box::new(report), rows, lost }
        }),
        other => other,
    };
    *locked(stage) = next;
}

fn set_poses<const D: usize>(
    poses: &Bound<'_, PyDict>,
    Running { thread, names, .. }: &mut Running<D>,
) -> PyResult<()>
where
    Pose<D>: Posed,
{
    let numbered: Vec<(String, usize)> = names.iter().cloned().zip(0..).collect();
    let all = poses::named(poses, &numbered)?;
    thread.control().set_poses(&all).or_raise(poses.py())
}

/// Feels a scene on a virtual clock, as fast as it goes: the same every time. See `Servo`; `duration` is in seconds.
///
/// >>> import palpate as pp
/// >>> felt = pp.feel(pp.ball(0.05), hand=[[0, 0, 0.06, 0], [0.1, 0, 0.045, 0]], duration=0.1)
/// >>> len(felt.trace.time), bool(felt.trace.force[-1, 1] > 0)
/// (100, True)
#[pyfunction]
#[pyo3(signature = (scene, *, device = None, hand = None, duration = 10.0, rate = 1000.0))]
pub(crate) fn feel<'py>(
    py: Python<'py>,
    scene: &Bound<'py, PyAny>,
    device: Option<&Bound<'py, PyAny>>,
    hand: Option<&Bound<'py, PyAny>>,
    duration: f64,
    rate: f64,
) -> PyResult<Bound<'py, PyAny>> {
    let scene = PyScene::given(scene)?;
    let asked = Asked { device, hand, duration: Some(duration), record: duration, rate };
    match scene.get().built() {
        palpate::scene::AnyScene::Planar(scene) => {
            felt(py, asked.stage(py, scene, None)?, &asked)
        }
        palpate::scene::AnyScene::Spatial(scene) => {
            felt(py, asked.stage(py, scene, None)?, &asked)
        }
    }
}

fn felt<'py, const D: usize>(
    py: Python<'py>,
    stage: Stage<D>,
    asked: &Asked<'_, '_>,
) -> PyResult<Bound<'py, PyAny>> {
    let Stage::Ready(ready) = stage else {
        return Err(PyRuntimeError::new_err("the servo has run"));
    };
    let Ready { mut servo, mut device, .. } = *ready;
    let seconds = asked.duration.unwrap_or_default();
    let mut recorder =
        Recorder::new((asked.record * asked.rate).ceil() as usize * device.points());
    let report = interruptible(py, |stop| {
        let options = RunOptions::new(seconds)
            .with_pace(Pace::AsFastAsPossible)
            .with_interrupt(stop)
            .with_recorder(&mut recorder);
        run(&mut servo, device.as_mut(), options)
    })?;
    let report = report.or_raise(py)?;
    Fields::new(py)
        .with("report", read(py, &report)?)?
        .with("trace", trace(py, recorder.rows(), recorder.dropped())?)?
        .of_class("Felt")
}
