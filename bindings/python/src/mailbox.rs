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
pub(crate) type Own<const D: usize> = Box<dyn Device<D> + Send>;

/// Both ends of a mailbox; that of the servo until it takes it.
pub(crate) struct Post<const D: usize> {
    device: Mutex<Option<Own<D>>>,
    mailbox: Mutex<Mailbox<D>>,
}

impl<const D: usize> Post<D> {
    /// The driver's end: not held while code of Python may run.
    fn locked(&self) -> MutexGuard<'_, Mailbox<D>> {
        self.mailbox.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The servo's end.
    pub(crate) fn take(&self) -> PyResult<Own<D>> {
        let device = self.device.lock().unwrap_or_else(PoisonError::into_inner).take();
        device.ok_or_else(|| PyRuntimeError::new_err("a mailbox has one servo: make another"))
    }

    /// Takes the servo's end back, from one that could not be made.
    pub(crate) fn give_back(&self, device: Own<D>) {
        *self.device.lock().unwrap_or_else(PoisonError::into_inner) = Some(device);
    }
}

/// The coordinates of a vector.
const fn columns<const D: usize>(_: &Post<D>) -> usize {
    D
}

enum AnyPost {
    Planar(Post<2>),
    Spatial(Post<3>),
}

/// Does the same with the mailbox of either dimension.
macro_rules! of_either {
    ($any:expr, $post:ident => $done:expr) => {
        match $any {
            AnyPost::Planar($post) => $done,
            AnyPost::Spatial($post) => $done,
        }
    };
}

/// A device of your own: its driver sets where the points are, as often as it likes, and takes the newest forces.
///
/// The servo never waits for the driver. If nothing more is set for 0.1 s, or after `lose`, the device is lost: forces go to
/// zero, the servo ends, and its `with` block raises `DeviceLostError`. `profile` is the name of the profile whose limits
/// hold, `points` how many contact points the device has. Positions and forces are those of the device: unless the tool of
/// the scene has a `workspace`, the one of the profile is scaled so that it holds the scene; with
/// `tool={"workspace": {"scale": 1}}` they are those of the world.
///
/// Raises `UnknownNameError` if no profile has the name, `ValueError` if `points` or `dimension` is out of range.
///
/// >>> import palpate as pp, time
/// >>> mailbox = pp.Mailbox("omega")
/// >>> with pp.Servo(pp.Scene(pp.ball(0.05)), device=mailbox) as servo:
/// ...     while mailbox.ticks < 20:
/// ...         mailbox.set([[0, 0.1, 0]])
/// ...         time.sleep(0.001)
/// ...     mailbox.forces.shape
/// (1, 3)
#[pyclass(frozen, module = "palpate", name = "Mailbox")]
pub(crate) struct PyMailbox(AnyPost);

#[pymethods]
impl PyMailbox {
    #[new]
    #[pyo3(signature = (profile = "omega", *, points = 1, dimension = 3))]
    fn new(py: Python<'_>, profile: &str, points: usize, dimension: usize) -> PyResult<Self> {
        match dimension {
            2 => Ok(Self(AnyPost::Planar(post(py, profile, points)?))),
            3 => Ok(Self(AnyPost::Spatial(post(py, profile, points)?))),
            _ => {
                Err(PyValueError::new_err(format!("dimension must be 2 or 3, got {dimension}")))
            }
        }
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
        of_either!(&self.0, post => set(post, positions, time))
    }

    /// The newest forces, shape (points, D) [N]; shape (0, D) before the first tick.
    ///
    /// >>> import palpate as pp
    /// >>> pp.Mailbox().forces.shape
    /// (0, 3)
    #[getter]
    fn forces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        of_either!(&self.0, post => {
            let forces: Vec<Vector<f64, _>> = post.locked().forces().to_vec();
            table(py, forces.iter().flat_map(|force| force.0).collect(), columns(post))
        })
    }

    /// How often the servo has written forces: if that no longer grows, motors must be set to zero.
    ///
    /// >>> import palpate as pp
    /// >>> pp.Mailbox().ticks
    /// 0
    #[getter]
    fn ticks(&self) -> u64 {
        of_either!(&self.0, post => {
            post.locked().ticks()
        })
    }

    /// Says that the device no longer answers.
    ///
    /// >>> import palpate as pp
    /// >>> pp.Mailbox().lose()
    fn lose(&self) {
        of_either!(&self.0, post => {
            post.locked().lose();
        });
    }
}

impl PyMailbox {
    /// Both ends, in the plane.
    pub(crate) fn planar(&self) -> PyResult<&Post<2>> {
        match &self.0 {
            AnyPost::Planar(post) => Ok(post),
            AnyPost::Spatial(_) => Err(PyTypeError::new_err("the scene is 2D, the mailbox 3D")),
        }
    }

    /// Both ends, in space.
    pub(crate) fn spatial(&self) -> PyResult<&Post<3>> {
        match &self.0 {
            AnyPost::Spatial(post) => Ok(post),
            AnyPost::Planar(_) => Err(PyTypeError::new_err("the scene is 3D, the mailbox 2D")),
        }
    }
}

fn post<const D: usize>(py: Python<'_>, profile: &str, points: usize) -> PyResult<Post<D>> {
    check_points(points)?;
    let profile = profile_named(profile).or_raise(py)?;
    let (device, mailbox) = MailboxDevice::new(profile, points).or_raise(py)?;
    Ok(Post { device: Mutex::new(Some(Box::new(device))), mailbox: Mutex::new(mailbox) })
}

fn set<const D: usize>(
    post: &Post<D>,
    positions: &Bound<'_, PyAny>,
    time: Option<f64>,
) -> PyResult<()> {
    let array = numbers(positions, "positions")?;
    if !matches!(array.shape(), [_, columns] if *columns == D) {
        return Err(misshapen("positions", &format!("(points, {D})"), array.shape()));
    }
    let given = array.as_doubles()?;
    if let Some(place) = given.iter().position(|x| !x.is_finite()) {
        let problem = format!(
            "positions[{}, {}] must be finite, got {} m",
            place / D,
            place % D,
            given[place]
        );
        return Err(PyValueError::new_err(problem));
    }
    let state = |row: &[f64]| PointState::at_rest(Vector(std::array::from_fn(|i| row[i])));
    let states: Vec<PointState<D>> = given.chunks_exact(D).map(state).collect();
    let done = match time {
        None => post.locked().set(&states),
        Some(time) => post.locked().set_at(time, &states),
    };
    done.or_raise(positions.py())
}
