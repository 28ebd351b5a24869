// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Bodies that move: sweeps, tracked pairs and worlds.

use std::sync::{Mutex, PoisonError};

use palpate::field::{Pose, Screw, Shape};
use palpate::query::{
    BodyId, FirstTouch, Limits, Moving, Neighbours, PairWorkspace, Query, Start, Track, World,
    WorldSettings,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::answers::{Fields, contact, stop};
use crate::error::OrRaise;
use crate::function::detached;
use crate::pool::{self, Pool};
use crate::poses::{self, Posed};
use crate::query::{manifold_of, nearest, of_both, query};
use crate::scene::PyScene;
use crate::shape::{AnyShape, PyShape};

/// When two bodies touch first, while they move from their start to their end by a screw, over a time from 0 to 1.
///
/// `start` and `end` are poses of the second body, `a_start` and `a_end` of the first; a body without them rests. Before
/// `lower` the bodies are proven apart, at `upper` they are within `gap` [m], a ten-thousandth of the smaller body if
/// left out; `upper` is 1 if they are apart all the time.
///
/// >>> import palpate as pp
/// >>> found = pp.sweep(pp.ball(0.5), pp.ball(0.5), start=[3, 0, 0], end=[0, 0, 0], gap=1e-4)
/// >>> found.touches, found.lower <= 2 / 3 <= found.upper + 1e-3
/// (True, True)
#[pyfunction]
#[pyo3(signature = (a, b, *, start = None, end = None, a_start = None, a_end = None, gap = None))]
pub(crate) fn sweep<'py>(
    py: Python<'py>,
    a: &PyShape,
    b: &PyShape,
    start: Option<&Bound<'py, PyAny>>,
    end: Option<&Bound<'py, PyAny>>,
    a_start: Option<&Bound<'py, PyAny>>,
    a_end: Option<&Bound<'py, PyAny>>,
    gap: Option<f64>,
) -> PyResult<Bound<'py, PyAny>> {
    of_both!(py, a, b, |a, b| {
        let mut query = query(gap, None);
        let motions = [moved(py, a_start, a_end)?, moved(py, start, end)?];
        let found = swept(py, &mut query, [a, b], motions)?;
        first_touch(py, &found)?.of_class("FirstTouch")
    })
}

fn moved<const D: usize>(
    py: Python<'_>,
    start: Option<&Bound<'_, PyAny>>,
    end: Option<&Bound<'_, PyAny>>,
) -> PyResult<Screw<D>>
where
    Pose<D>: Posed,
{
    let from = poses::or_identity(start)?;
    let to = if end.is_some() { poses::or_identity(end)? } else { from };
    Screw::new(from, to, 0).or_raise(py)
}

fn swept<const D: usize>(
    py: Python<'_>,
    query: &mut Query<D>,
    [a, b]: [&Shape<D>; 2],
    [one, two]: [Screw<D>; 2],
) -> PyResult<FirstTouch<D>> {
    detached(py, || query.cast_shape(Moving::new(a, one), Moving::new(b, two)))?.or_raise(py)
}

fn first_touch<'py, const D: usize>(
    py: Python<'py>,
    found: &FirstTouch<D>,
) -> PyResult<Fields<'py>> {
    let start = found.start.map(|start| match start {
        Start::Approaching => "approaching",
        Start::Receding => "receding",
        Start::Sliding => "sliding",
        Start::Resting => "resting",
    });
    let best = found.contact.as_ref().map(|best| contact(py, best)).transpose()?;
    Fields::new(py)
        .with("lower", found.lower)?
        .with("upper", found.upper)?
        .with("stop", stop(found.stop))?
        .with("evaluations", found.evaluations)?
        .with("touches", found.touches())?
        .with("contact", best)?
        .with("start", start)
}

/// What a pair knows from step to step.
struct Pair<const D: usize> {
    track: Track<D>,
    workspace: PairWorkspace<D>,
}

enum AnyPair {
    Planar(Mutex<Box<Pair<2>>>),
    Spatial(Mutex<Box<Pair<3>>>),
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
        match (a.made(py)?, b.made(py)?) {
            (AnyShape::Planar(a), AnyShape::Planar(b)) => Ok(Self(AnyPair::Planar(pair(a, b)))),
            (AnyShape::Spatial(a), AnyShape::Spatial(b)) => {
                Ok(Self(AnyPair::Spatial(pair(a, b))))
            }
            (a, b) => {
                let (a, b) = (a.dimension(), b.dimension());
                let problem = format!("both shapes must have one dimension, got {a}D and {b}D");
                Err(PyValueError::new_err(problem))
            }
        }
    }

    /// How far apart the bodies are at these poses, to a tolerance [m]; see `separation`.
    ///
    /// >>> import palpate as pp
    /// >>> round(pp.Track(pp.ball(0.5), pp.ball(0.5)).separation(b=[1.5, 0, 0]).upper, 3)
    /// 0.5
    #[pyo3(signature = (*, a = None, b = None, tolerance = 1e-4, budget = 200_000))]
    fn separation<'py>(
        &self,
        py: Python<'py>,
        a: Option<&Bound<'py, PyAny>>,
        b: Option<&Bound<'py, PyAny>>,
        tolerance: f64,
        budget: u32,
    ) -> PyResult<Bound<'py, PyAny>> {
        let limits = Limits::new(tolerance).with_budget(budget);
        match &self.0 {
            AnyPair::Planar(pair) => tracked(py, pair, [a, b], &limits),
            AnyPair::Spatial(pair) => tracked(py, pair, [a, b], &limits),
        }
    }

    /// Forgets what was proven: after a jump nothing of it helps.
    ///
    /// >>> import palpate as pp
    /// >>> pp.Track(pp.ball(0.5), pp.ball(0.5)).forget()
    fn forget(&self) {
        match &self.0 {
            AnyPair::Planar(pair) => {
                pair.lock().unwrap_or_else(PoisonError::into_inner).track.forget();
            }
            AnyPair::Spatial(pair) => {
                pair.lock().unwrap_or_else(PoisonError::into_inner).track.forget();
            }
        }
    }
}

fn pair<const D: usize>(a: &Shape<D>, b: &Shape<D>) -> Mutex<Box<Pair<D>>> {
    let track = Track::new(a.clone(), b.clone());
    Mutex::new(Box::new(Pair { track, workspace: PairWorkspace::new() }))
}

fn tracked<'py, const D: usize>(
    py: Python<'py>,
    pair: &Mutex<Box<Pair<D>>>,
    [a, b]: [Option<&Bound<'py, PyAny>>; 2],
    limits: &Limits,
) -> PyResult<Bound<'py, PyAny>>
where
    Pose<D>: Posed,
{
    let poses = [poses::or_identity(a)?, poses::or_identity(b)?];
    let found = detached(py, || {
        let mut own = pair.lock().unwrap_or_else(PoisonError::into_inner);
        let Pair { track, workspace } = &mut **own;
        track.separation(poses, limits, workspace)
    })?;
    nearest(py, &found.or_raise(py)?)?.of_class("Separation")
}

/// A world with the names of its bodies.
struct Named<const D: usize> {
    world: World<D>,
    bodies: Vec<(String, BodyId)>,
}

enum AnyWorld {
    Planar(Mutex<Named<2>>),
    Spatial(Mutex<Named<3>>),
}

/// Does the same with a world of either dimension.
macro_rules! of_either {
    ($any:expr, $world:ident => $done:expr) => {
        match $any {
            AnyWorld::Planar($world) => $done,
            AnyWorld::Spatial($world) => $done,
        }
    };
}

/// Many bodies: all contacts after each step, with what pairs knew before.
///
/// `margin` is how near bodies are that have contacts [m]; left out, 0.2 % of the smallest body.
///
/// >>> import palpate as pp
/// >>> world = pp.World(pp.Scene({"table": pp.cuboid([1, 0.1, 1]), "ball": pp.ball(0.05)}), margin=1e-3)
/// >>> world.set_poses({"ball": [0, 0.0995, 0]})
/// >>> [(near.a, near.b, near.verdict) for near in world.step()]
/// [('table', 'ball', 'touching')]
#[pyclass(frozen, module = "palpate", name = "World")]
pub(crate) struct PyWorld(AnyWorld);

#[pymethods]
impl PyWorld {
    #[new]
    #[pyo3(signature = (scene, *, margin = None))]
    fn new(py: Python<'_>, scene: &PyScene, margin: Option<f64>) -> PyResult<Self> {
        let settings = |own: WorldSettings| match margin {
            None => own,
            Some(margin) => WorldSettings::new(own.manifold.with_margin(margin), own.limits),
        };
        Ok(Self(match scene.built() {
            palpate::scene::AnyScene::Planar(scene) => AnyWorld::Planar(Mutex::new(named(
                py,
                scene,
                settings(scene.world_settings()),
            )?)),
            palpate::scene::AnyScene::Spatial(scene) => AnyWorld::Spatial(Mutex::new(named(
                py,
                scene,
                settings(scene.world_settings()),
            )?)),
        }))
    }

    /// Moves bodies: a dict of their names and poses, as of `Shape.placed`.
    ///
    /// >>> import palpate as pp
    /// >>> pp.World(pp.Scene({"a": pp.ball(0.5)})).set_poses({"a": [0, 1, 0]})
    fn set_poses(&self, poses: &Bound<'_, PyDict>) -> PyResult<()> {
        of_either!(&self.0, world => {
            let mut world = world.lock().unwrap_or_else(PoisonError::into_inner);
            let placed = poses::named(poses, &world.bodies)?;
            world.world.set_poses(&placed).or_raise(poses.py())
        })
    }

    /// The pairs of bodies that are near each other, with their contacts. `threads` share the work, 0 for all
    /// processors.
    ///
    /// >>> import palpate as pp
    /// >>> len(pp.World(pp.Scene({"a": pp.ball(0.5), "b": pp.ball(0.4)})).step())
    /// 1
    #[pyo3(signature = (*, threads = 1))]
    fn step<'py>(&self, py: Python<'py>, threads: usize) -> PyResult<Vec<Bound<'py, PyAny>>> {
        let pool = pool::of_at_least_one(threads)?;
        of_either!(&self.0, world => stepped(py, world, &pool))
    }
}

fn named<const D: usize>(
    py: Python<'_>,
    scene: &palpate::scene::BuiltScene<D>,
    settings: WorldSettings,
) -> PyResult<Named<D>> {
    let world = scene.world_with(settings).or_raise(py)?;
    let names = scene.bodies.iter().map(|body| body.name.clone());
    let bodies = names.zip(world.bodies()).collect();
    Ok(Named { world, bodies })
}

fn stepped<'py, const D: usize>(
    py: Python<'py>,
    world: &Mutex<Named<D>>,
    pool: &Pool,
) -> PyResult<Vec<Bound<'py, PyAny>>> {
    let (found, names, margin) = detached(py, || {
        let mut own = world.lock().unwrap_or_else(PoisonError::into_inner);
        let own = &mut *own;
        let step = || own.world.step().into_iter().cloned().collect();
        let found: Vec<Neighbours<D>> = pool.install(step);
        (found, own.bodies.clone(), own.world.settings().manifold.margin)
    })?;
    let name = |body: BodyId| {
        names.iter().find(|(_, own)| *own == body).map_or("", |(name, _)| name.as_str())
    };
    let told = |near: &Neighbours<D>| {
        let [a, b] = near.bodies.map(name);
        let [lower, upper] = near.bounds();
        let manifold =
            near.manifold.as_ref().map(|found| manifold_of(py, found)).transpose()?;
        Fields::new(py)
            .with("a", a)?
            .with("b", b)?
            .with("lower", lower)?
            .with("upper", upper)?
            .with("verdict", near.verdict(margin).to_string())?
            .with("manifold", manifold)?
            .of_class("Neighbours")
    };
    found.iter().map(told).collect()
}
