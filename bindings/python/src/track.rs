// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Pairs of bodies that are tracked from step to step.

use palpate::field::Shape;
use palpate::query::{Limits, ManifoldSettings, PairWorkspace, Tolerance, Track};
use pyo3::prelude::*;

use crate::answers::Fields;
use crate::error::OrRaise;
use crate::guarded::Guarded;
use crate::poses;
use crate::query::{manifold_of, of_both, settings};
use crate::shape::PyShape;

/// What a pair knows from step to step.
struct Pair<const D: usize> {
    track: Track<D>,
    workspace: PairWorkspace<D>,
}

enum AnyPair {
    Planar(Guarded<Box<Pair<2>>>),
    Spatial(Guarded<Box<Pair<3>>>),
}

impl From<Guarded<Box<Pair<2>>>> for AnyPair {
    fn from(pair: Guarded<Box<Pair<2>>>) -> Self {
        Self::Planar(pair)
    }
}

impl From<Guarded<Box<Pair<3>>>> for AnyPair {
    fn from(pair: Guarded<Box<Pair<3>>>) -> Self {
        Self::Spatial(pair)
    }
}

/// Does the same with a pair of either dimension.
macro_rules! of_either {
    ($any:expr, $pair:ident => $done:expr) => {
        match $any {
            AnyPair::Planar($pair) => $done,
            AnyPair::Spatial($pair) => $done,
        }
    };
}

/// Two bodies that move a little from question to question: what was proven is kept, and contacts keep their names.
///
/// >>> import palpate as pp
/// >>> track = pp.Track(pp.ball(0.5), pp.ball(0.5))
/// >>> [round(track.separation(b=[1.5 + 1e-4 * i, 0, 0]).upper, 3) for i in range(3)]
/// [0.5, 0.5, 0.5]
#[pyclass(frozen, module = "palpate", name = "Track")]
pub(crate) struct PyTrack(AnyPair);

#[pymethods]
impl PyTrack {
    #[new]
    fn new(py: Python<'_>, a: &PyShape, b: &PyShape) -> PyResult<Self> {
        of_both!(py, a, b, |a, b| Ok(Self(pair(a, b).into())))
    }

    /// How far apart the bodies are at these poses; see `separation`.
    ///
    /// Raises `QueryError` if neither body has bounds or a pose is not finite.
    ///
    /// >>> import palpate as pp
    /// >>> round(pp.Track(pp.ball(0.5), pp.ball(0.5)).separation(b=[1.5, 0, 0]).upper, 3)
    /// 0.5
    #[pyo3(signature = (*, a = None, b = None, tolerance = None, budget = None))]
    fn separation<'py>(
        &self,
        py: Python<'py>,
        a: Option<&Bound<'py, PyAny>>,
        b: Option<&Bound<'py, PyAny>>,
        tolerance: Option<f64>,
        budget: Option<u32>,
    ) -> PyResult<Bound<'py, PyAny>> {
        of_either!(&self.0, pair => {
            let poses = [poses::or_identity(a)?, poses::or_identity(b)?];
            let found = pair.ask(py, |own| {
                let Pair { track, workspace } = &mut **own;
                track.separation(poses, &limits(track.size(), tolerance, budget), workspace)
            })?;
            Fields::of(py, &found.or_raise(py)?)?.of_class("Separation")
        })
    }

    /// The contacts of the bodies at these poses; see `manifold`. A contact near one of the last question, on either
    /// body, has its number among `contacts.id` again.
    ///
    /// Raises `QueryError` if neither body has bounds or a pose is not finite.
    ///
    /// >>> import palpate as pp
    /// >>> track = pp.Track(pp.cuboid([1, 1, 1]), pp.cuboid([1, 1, 1]))
    /// >>> first = track.manifold(b=[0, 0.999, 0])
    /// >>> bool((track.manifold(b=[1e-4, 0.999, 0]).contacts.id == first.contacts.id).all())
    /// True
    #[pyo3(signature = (*, a = None, b = None, margin = None, spacing = None, most = None, tolerance = None, budget = None))]
    fn manifold<'py>(
        &self,
        py: Python<'py>,
        a: Option<&Bound<'py, PyAny>>,
        b: Option<&Bound<'py, PyAny>>,
        margin: Option<f64>,
        spacing: Option<f64>,
        most: Option<usize>,
        tolerance: Option<f64>,
        budget: Option<u32>,
    ) -> PyResult<Bound<'py, PyAny>> {
        of_either!(&self.0, pair => {
            let poses = [poses::or_identity(a)?, poses::or_identity(b)?];
            let found = pair.ask(py, |own| {
                let Pair { track, workspace } = &mut **own;
                let size = track.size();
                let settings = settings(ManifoldSettings::of_size(size), margin, spacing, most);
                track.manifold(poses, &settings, &limits(size, tolerance, budget), workspace)
            })?;
            manifold_of(py, &found.or_raise(py)?)
        })
    }

    /// Forgets what was proven: after a jump nothing of it helps.
    ///
    /// >>> import palpate as pp
    /// >>> pp.Track(pp.ball(0.5), pp.ball(0.5)).forget()
    fn forget(&self, py: Python<'_>) -> PyResult<()> {
        of_either!(&self.0, pair => pair.ask(py, |own| own.track.forget()))
    }
}

fn pair<const D: usize>(a: &Shape<D>, b: &Shape<D>) -> Guarded<Box<Pair<D>>> {
    let track = Track::new(a.clone(), b.clone());
    Guarded::new(Box::new(Pair { track, workspace: PairWorkspace::new() }))
}

fn limits(size: f64, tolerance: Option<f64>, budget: Option<u32>) -> Limits {
    let tolerance = tolerance.map_or_else(Tolerance::default, Tolerance::Absolute);
    let limits = Limits::new(tolerance.for_size(size));
    budget.map_or(limits, |budget| limits.with_budget(budget))
}
