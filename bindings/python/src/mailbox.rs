// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The class `Mailbox`: a device whose driver is written in Python.

use std::sync::{Mutex, MutexGuard, PoisonError};

use palpate::device::{Device, Mailbox, MailboxDevice, PointState, profile_named};
use palpate::field::Vector;
use pyo3::exceptions::{PyRuntimeError, PyTypeError, PyValueError};
use pyo3::prelude::*;

use crate::arrays::{misshapen, numbers, table};
use crate::error::OrRaise;
use crate::hand::check_points;

/// A device for a servo.
pub(crate) type Own = Box<dyn Device + Send>;

/// A device of your own: its driver sets where the points are, as often as it likes, and takes the newest forces.
///
/// The servo never waits for the driver. `rate` is how often a second the driver sets positions [Hz]: tell it if that is less
/// than 1000, as of a game with 90 frames a second. The servo ticks as often then, and bodies are as stiff as that rate allows.
/// A driver that sets less than half of what the servo takes would get no force: after half a second the device is lost. So it
/// is if nothing more is set for 0.1 s (for five periods of a rate below 50 Hz), or after `lose`: forces go to zero, the servo
/// ends, and its `with` block raises `DeviceLostError`, which says why, with both rates. `profile` is the name of the profile whose limits
/// hold, `points` how many contact points the device has. Positions and forces are those of the device: unless the tool of
/// the scene has a `workspace`, the one of the profile is scaled so that it holds the scene; with
/// `tool={"workspace": {"scale": 1}}` they are those of the world.
///
/// Raises `UnknownNameError` if no profile has the name, `ValueError` if `points`, `rate` or `dimension` is out of range.
///
/// >>> import palpate as pp, time
/// >>> mailbox = pp.Mailbox("omega")
/// >>> with pp.Servo(pp.Scene(pp.ball(0.05)), device=mailbox) as servo:
/// ...     while mailbox.ticks < 20:
/// ...         mailbox.set([[0, 0.1, 0]])
/// ...         time.sleep(0.001)
/// ...     mailbox.forces.shape
/// (1, 3)
///
/// A driver with 90 frames a second:
///
/// >>> pp.Mailbox("omega", rate=90).rate
/// 90.0
#[pyclass(frozen, module = "palpate", name = "Mailbox")]
pub(crate) struct PyMailbox {
    /// The servo's end, until a servo takes it.
    device: Mutex<Option<Own>>,
    mailbox: Mutex<Mailbox>,
    /// The dimension of the scenes that it touches.
    dimension: usize,
    /// The rate at which its driver sets positions [Hz]; `None` if nobody gave one.
    rate: Option<f64>,
}

#[pymethods]
impl PyMailbox {
    #[new]
    #[pyo3(signature = (profile = "omega", *, points = 1, rate = None, dimension = 3))]
    fn new(
        py: Python<'_>,
        profile: &str,
        points: usize,
        rate: Option<f64>,
        dimension: usize,
    ) -> PyResult<Self> {
        if !(2..=3).contains(&dimension) {
            let problem = format!("dimension must be 2 or 3, got {dimension}");
            return Err(PyValueError::new_err(problem));
        }
        check_points(points)?;
        let profile = profile_named(profile).or_raise(py)?;
        let (device, mailbox) = MailboxDevice::new(profile, points).or_raise(py)?;
        let device: Own = match rate {
            Some(rate) => Box::new(device.with_rate(check_rate(rate)?)),
            None => Box::new(device),
        };
        let (device, mailbox) = (Mutex::new(Some(device)), Mutex::new(mailbox));
        Ok(Self { device, mailbox, dimension, rate })
    }

    /// Sets where the points are, shape (points, D) [m] at the device, at `time` [s] if it is known.
    ///
    /// Raises `ValueError` if the array has another number of columns or a number is not finite, `DeviceError` if it has
    /// another number of points.
    ///
    /// >>> import palpate as pp
    /// >>> pp.Mailbox().set([[0, 0.1, 0]])
    #[pyo3(signature = (positions, *, time = None))]
    fn set(&self, positions: &Bound<'_, PyAny>, time: Option<f64>) -> PyResult<()> {
        let (array, columns) = (numbers(positions, "positions")?, self.dimension);
        if !matches!(array.shape(), [_, given] if *given == columns) {
            return Err(misshapen("positions", &format!("(points, {columns})"), array.shape()));
        }
        let given = array.as_doubles()?;
        if let Some(place) = given.iter().position(|x| !x.is_finite()) {
            let problem = format!(
                "positions[{}, {}] must be finite, got {} m",
                place / columns,
                place % columns,
                given[place]
            );
            return Err(PyValueError::new_err(problem));
        }
        let state = |row: &[f64]| {
            let place = |axis| row.get(axis).copied().unwrap_or(0.0);
            PointState::at_rest(Vector(std::array::from_fn(place)))
        };
        let states: Vec<PointState> = given.chunks_exact(columns).map(state).collect();
        let done = match time {
            None => self.locked().set(&states),
            Some(time) => self.locked().set_at(time, &states),
        };
        done.or_raise(positions.py())
    }

    /// The newest forces, shape (points, D) [N]; shape (0, D) before the first tick.
    ///
    /// >>> import palpate as pp
    /// >>> pp.Mailbox().forces.shape
    /// (0, 3)
    #[getter]
    fn forces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let forces = self.locked().forces().to_vec();
        let along = |force: &Vector<f64, 3>| force.0.into_iter().take(self.dimension);
        table(py, forces.iter().flat_map(along).collect(), self.dimension)
    }

    /// How often a second the driver sets positions, as it was told [Hz]; None if it was not.
    ///
    /// >>> import palpate as pp
    /// >>> pp.Mailbox(rate=250).rate
    /// 250.0
    #[getter]
    pub(crate) fn rate(&self) -> Option<f64> {
        self.rate
    }

    /// How often the servo has written forces: if that no longer grows, motors must be set to zero.
    ///
    /// >>> import palpate as pp
    /// >>> pp.Mailbox().ticks
    /// 0
    #[getter]
    fn ticks(&self) -> u64 {
        self.locked().ticks()
    }

    /// Says that the device no longer answers.
    ///
    /// >>> import palpate as pp
    /// >>> pp.Mailbox().lose()
    fn lose(&self) {
        self.locked().lose();
    }
}

/// Refuses a rate [Hz] that is none.
pub(crate) fn check_rate(rate: f64) -> PyResult<f64> {
    if rate > 0.0 && rate.is_finite() {
        return Ok(rate);
    }
    let problem = format!("rate must be positive and finite, got {rate} Hz");
    Err(PyValueError::new_err(problem))
}

impl PyMailbox {
    /// Refuses a scene of another dimension.
    pub(crate) fn check(&self, dimension: usize) -> PyResult<()> {
        if self.dimension == dimension {
            return Ok(());
        }
        let own = self.dimension;
        let problem = format!("the scene is {dimension}D, the mailbox {own}D");
        Err(PyTypeError::new_err(problem))
    }

    /// The driver's end: not held while code of Python may run.
    fn locked(&self) -> MutexGuard<'_, Mailbox> {
        self.mailbox.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The servo's end.
    pub(crate) fn take(&self) -> PyResult<Own> {
        let device = self.device.lock().unwrap_or_else(PoisonError::into_inner).take();
        device.ok_or_else(|| PyRuntimeError::new_err("a mailbox has one servo: make another"))
    }

    /// Takes the servo's end back, from one that could not be made.
    pub(crate) fn give_back(&self, device: Own) {
        *self.device.lock().unwrap_or_else(PoisonError::into_inner) = Some(device);
    }
}
