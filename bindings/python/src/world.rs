// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Bodies that move: sweeps and worlds.

use palpate::field::{Pose, Screw, Shape};
use palpate::query::{
    BodyId, BodyImpact, FirstTouch, ManifoldSettings, Motion, Moving, Neighbours, Query,
    SweepSettings, World, WorldSettings,
};
use palpate::scene::{AnyScene, BuiltScene};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::answers::Fields;
use crate::call::Call;
use crate::call::detached;
use crate::error::OrRaise;
use crate::guarded::Guarded;
use crate::pool::{self, Pool};
use crate::poses::{self, Posed};
use crate::query::{manifold_of, of_both, query};
use crate::scene::{PyScene, matrix};
use crate::shape::PyShape;

/// When two bodies touch first, while they move from their start to their end by a screw, over a time from 0 to 1.
///
/// `start` and `end` are poses of the second body, `a_start` and `a_end` of the first. Without an `end` a body rests at its
/// `start`; without a `start` it begins where its shape lies. Before `lower` the bodies are proven apart, at `upper` they
/// are within `gap` [m], a ten-thousandth of the smaller body if left out; `upper` is 1 if they are apart all the time,
/// infinite if the search ended first. `budget` is how often the fields are evaluated at most, 5 000 000 if left out.
///
/// Raises `QueryError` if neither body has bounds or the gap is negative, `ShapeError` if a pose is not finite.
///
/// >>> import palpate as pp
/// >>> found = pp.sweep(pp.ball(0.5), pp.ball(0.5), start=[3, 0, 0], end=[0, 0, 0], gap=1e-4)
/// >>> found.touches, found.lower <= 2 / 3 <= found.upper + 1e-3
/// (True, True)
#[pyfunction]
#[pyo3(signature = (a, b, *, start = None, end = None, a_start = None, a_end = None, gap = None, budget = None))]
pub(crate) fn sweep<'py>(
    py: Python<'py>,
    a: &PyShape,
    b: &PyShape,
    start: Option<&Bound<'py, PyAny>>,
    end: Option<&Bound<'py, PyAny>>,
    a_start: Option<&Bound<'py, PyAny>>,
    a_end: Option<&Bound<'py, PyAny>>,
    gap: Option<f64>,
    budget: Option<u32>,
) -> PyResult<Bound<'py, PyAny>> {
    of_both!(py, a, b, |a, b| {
        let mut query = query(gap, budget);
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
    Fields::of(py, found)?.with("touches", found.touches())
}

/// A world with the names of its bodies.
struct Named<const D: usize> {
    world: Guarded<World<D>>,
    bodies: Vec<(String, BodyId)>,
    /// The size of the smallest body [m]; 1 m if none has bounds.
    size: f64,
}

impl<const D: usize> Named<D> {
    /// The names of two bodies.
    fn names(&self, bodies: [BodyId; 2]) -> (&str, &str) {
        let name = |body| self.bodies.iter().find(|(_, own)| *own == body);
        let [a, b] = bodies.map(|body| name(body).map_or("", |(name, _)| name.as_str()));
        (a, b)
    }
}

enum AnyWorld {
    Planar(Named<2>),
    Spatial(Named<3>),
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

/// Many bodies, of a scene, a dict of shapes or a shape: all contacts after each step, with what pairs knew before.
///
/// `margin` is how near bodies are that have contacts [m]; left out, 0.2 % of the smallest body.
///
/// >>> import palpate as pp
/// >>> world = pp.World({"table": pp.cuboid([1, 0.1, 1]), "ball": pp.ball(0.05)}, margin=1e-3)
/// >>> world.set_poses({"ball": [0, 0.0995, 0]})
/// >>> [(near.bodies, near.verdict) for near in world.step()]
/// [(('table', 'ball'), 'touching')]
#[pyclass(frozen, module = "palpate", name = "World")]
pub(crate) struct PyWorld(AnyWorld);

#[pymethods]
impl PyWorld {
    #[new]
    #[pyo3(signature = (scene, *, margin = None))]
    fn new(scene: &Bound<'_, PyAny>, margin: Option<f64>) -> PyResult<Self> {
        let (py, scene) = (scene.py(), PyScene::given(scene)?);
        let settings = |own: WorldSettings| match margin {
            None => own,
            Some(margin) => {
                WorldSettings::new(ManifoldSettings { margin, ..own.manifold }, own.limits)
            }
        };
        Ok(Self(match scene.get().built() {
            AnyScene::Planar(scene) => {
                let settings = settings(scene.world_settings());
                AnyWorld::Planar(named(py, scene, settings)?)
            }
            AnyScene::Spatial(scene) => {
                let settings = settings(scene.world_settings());
                AnyWorld::Spatial(named(py, scene, settings)?)
            }
        }))
    }

    /// Moves bodies: a dict of their names and poses, as of `Shape.placed`.
    ///
    /// Raises `KeyError` if no body has a name, `QueryError` if a pose is not finite.
    ///
    /// >>> import palpate as pp
    /// >>> pp.World({"a": pp.ball(0.5)}).set_poses({"a": [0, 1, 0]})
    fn set_poses(&self, poses: &Bound<'_, PyDict>) -> PyResult<()> {
        of_either!(&self.0, named => {
            let (py, placed) = (poses.py(), poses::named(poses, &named.bodies)?);
            named.world.ask(py, |world| world.set_poses(&placed))?.or_raise(py)
        })
    }

    /// The pairs of bodies that are near each other, with their contacts. `threads` share the work, 0 for all
    /// processors.
    ///
    /// >>> import palpate as pp
    /// >>> len(pp.World({"a": pp.ball(0.5), "b": pp.ball(0.4)}).step())
    /// 1
    #[pyo3(signature = (*, threads = 1))]
    fn step<'py>(&self, py: Python<'py>, threads: isize) -> PyResult<Vec<Bound<'py, PyAny>>> {
        let pool = pool::of_at_least_one(threads)?;
        of_either!(&self.0, world => stepped(py, world, &pool))
    }

    /// When bodies touch first, if those of a dict of names and poses move there by a screw over a time from 0 to 1: all
    /// pairs that are not proven to be apart all the time, the earliest first. The bodies stay where they are.
    ///
    /// `gap` is how near is a touch [m], a millionth of the smallest body if left out; `budget` how often the fields of
    /// a pair are evaluated at most, 5 000 000 if left out.
    ///
    /// Raises `KeyError` if no body has a name, `QueryError` if the gap is negative.
    ///
    /// >>> import palpate as pp
    /// >>> world = pp.World({"table": pp.cuboid([1, 0.1, 1]), "ball": pp.ball(0.05).translated([0, 0.2, 0])})
    /// >>> [(hit.bodies, round(hit.upper, 3)) for hit in world.first_impacts({"ball": [0, -0.2, 0]})]
    /// [(('table', 'ball'), 0.5)]
    #[pyo3(signature = (ends, *, gap = None, budget = None))]
    fn first_impacts<'py>(
        &self,
        ends: &Bound<'py, PyDict>,
        gap: Option<f64>,
        budget: Option<u32>,
    ) -> PyResult<Vec<Bound<'py, PyAny>>> {
        of_either!(&self.0, world => impacts(ends, world, gap, budget))
    }

    /// Where a body is: a matrix of shape (D + 1, D + 1).
    ///
    /// Raises `KeyError` if no body has the name.
    ///
    /// >>> import palpate as pp
    /// >>> pp.World({"a": pp.ball(0.5)}).pose("a")[:3, 3]
    /// array([0., 0., 0.])
    fn pose<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        of_either!(&self.0, named => {
            let body = poses::body(name, &named.bodies)?;
            matrix(py, &named.world.ask(py, |world| world.pose(body))?.or_raise(py)?)
        })
    }
}

fn named<const D: usize>(
    py: Python<'_>,
    scene: &BuiltScene<D>,
    settings: WorldSettings,
) -> PyResult<Named<D>> {
    let world = scene.world_with(settings).or_raise(py)?;
    let names = scene.bodies.iter().map(|body| body.name.clone());
    let bodies = names.zip(world.bodies()).collect();
    let world = Guarded::new(world);
    Ok(Named { world, bodies, size: scene.smallest_size().unwrap_or(1.0) })
}

fn impacts<'py, const D: usize>(
    ends: &Bound<'py, PyDict>,
    named: &Named<D>,
    gap: Option<f64>,
    budget: Option<u32>,
) -> PyResult<Vec<Bound<'py, PyAny>>>
where
    Pose<D>: Posed,
{
    let py = ends.py();
    let ends = poses::named(ends, &named.bodies)?;
    let usual = SweepSettings::of_size(named.size);
    let settings = SweepSettings {
        gap: gap.unwrap_or(usual.gap),
        budget: budget.unwrap_or(usual.budget),
        ..usual
    };
    let found = named.world.ask(py, |world| {
        let mut motions: Vec<(BodyId, Motion<D>)> = Vec::new();
        for (body, end) in ends {
            motions.push((body, Screw::new(world.pose(body)?, end, 0)?.into()));
        }
        Ok::<_, palpate::Error>(world.first_impact(&motions, &settings)?)
    })?;
    let found = found.or_raise(py)?;
    let told = |BodyImpact { bodies, touch, .. }: &BodyImpact<D>| {
        first_touch(py, touch)?.with("bodies", named.names(*bodies))?.of_class("BodyImpact")
    };
    found.iter().map(told).collect()
}

fn stepped<'py, const D: usize>(
    py: Python<'py>,
    named: &Named<D>,
    pool: &Pool,
) -> PyResult<Vec<Bound<'py, PyAny>>> {
    let (found, margin): (Vec<Neighbours<D>>, f64) = named.world.ask(py, |world| {
        // Bodies of a scene are no functions of Python, whose exceptions a call would have to raise.
        let found = pool.run(&Call::default(), || world.step().into_iter().cloned().collect());
        (found, world.settings().manifold.margin)
    })?;
    let told = |near: &Neighbours<D>| {
        let [lower, upper] = near.bounds();
        let manifold =
            near.manifold.as_ref().map(|found| manifold_of(py, found)).transpose()?;
        Fields::new(py)
            .with("bodies", named.names(near.bodies))?
            .with("lower", lower)?
            .with("upper", upper)?
            .with("verdict", near.verdict(margin).to_string())?
            .with("manifold", manifold)?
            .of_class("Neighbours")
    };
    found.iter().map(told).collect()
}
