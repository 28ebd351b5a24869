// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Many questions of a kind in one call: a pair of bodies at many poses, and rays.

use std::time::Instant;

use palpate::field::Vector;
use palpate::query::{Certified, QueryError, Ray, Stop};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::answers::{Fields, stop_number};
use crate::arrays::{row, table};
use crate::call::detached_in;
use crate::error::OrRaise;
use crate::interrupt::A_WHILE;
use crate::pool;
use crate::poses::{self, at_index};
use crate::query::{of_both, query};
use crate::shape::{PyShape, of_either};

/// Questions that are asked from one look at Python to the next, at most.
const MOST: usize = 1 << 16;

/// How far apart two bodies are, with the second at each of many poses in the frame of the first.
///
/// Poses are an array of shape (n, D) of translations, in space (n, 7) of x, y, z, qx, qy, qz, qw or (n, 4, 4), in the
/// plane (n, 3) of x, y and angle [rad] or (n, 3, 3). `threads` share the work, 0 for all processors; the bits do not
/// depend on how many.
///
/// `tolerance` is how far apart the bounds may be [m], a ten-thousandth of the smaller body if left out; `budget` how
/// often the fields are evaluated at most, 200 000 if left out.
///
/// Raises `QueryError` if neither body has bounds, a pose is not finite or the tolerance is negative, `ValueError` if
/// `poses` have another shape.
///
/// >>> import palpate as pp
/// >>> found = pp.separations(pp.ball(0.5), pp.ball(0.5), [[1.5, 0, 0], [2, 0, 0]])
/// >>> found.upper.round(3)
/// array([0.5, 1. ])
#[pyfunction]
#[pyo3(signature = (a, b, poses, *, tolerance = None, budget = None, threads = 1))]
pub(crate) fn separations<'py>(
    a: &PyShape,
    b: &PyShape,
    poses: &Bound<'py, PyAny>,
    tolerance: Option<f64>,
    budget: Option<u32>,
    threads: isize,
) -> PyResult<Bound<'py, PyAny>> {
    of_both!(poses.py(), a, b, |a, b| {
        let (py, query) = (poses.py(), query(tolerance, budget));
        let found = each(py, &poses::many(poses)?, threads, |poses, found, goes_on| {
            query.separations([a, b], poses, found, goes_on)
        })?;
        let points = found.iter().map(|found| Some(found.best.point.0));
        let normals = found.iter().map(|found| Some(found.best.normal?.0));
        bounds(py, &found)?
            .with("points", rows(py, points)?)?
            .with("normals", rows(py, normals)?)?
            .of_class("Separations")
    })
}

/// Whether two bodies overlap, with the second at each of many poses: 1 yes, 0 no, -1 undecided; see `separations`.
///
/// Raises `QueryError` if neither body has bounds or a pose is not finite, `ValueError` if `poses` have another shape.
///
/// >>> import palpate as pp
/// >>> pp.overlaps(pp.ball(0.5), pp.ball(0.5), [[0.9, 0, 0], [1.1, 0, 0]])
/// array([1, 0], dtype=int8)
#[pyfunction]
#[pyo3(signature = (a, b, poses, *, budget = None, threads = 1))]
pub(crate) fn overlaps<'py>(
    a: &PyShape,
    b: &PyShape,
    poses: &Bound<'py, PyAny>,
    budget: Option<u32>,
    threads: isize,
) -> PyResult<Bound<'py, PyAny>> {
    of_both!(poses.py(), a, b, |a, b| {
        let (py, query) = (poses.py(), query(None, budget));
        let found = each(py, &poses::many(poses)?, threads, |poses, found, goes_on| {
            query.overlaps([a, b], poses, found, goes_on)
        })?;
        let verdict = |found: &Certified<_>| found.is_hit().map_or(-1_i8, i8::from);
        Ok(row(py, found.iter().map(verdict).collect()))
    })
}

/// The first surfaces along many rays of a length [m], proven: none is passed over; see `cast_ray`.
///
/// `origins` and `directions` are arrays of shape (n, D), or one point or direction for all rays. Directions may have any
/// length but 0. `threads` share the work, 0 for all processors; the bits do not depend on how many.
///
/// `tolerance` is how far apart the bounds may be [m], a ten-thousandth of the smaller of shape and ray if left out;
/// `budget` how often the field is evaluated at most for a ray, 200 000 if left out.
///
/// Raises `QueryError` if the tolerance is negative, `ValueError` if arrays do not fit or a direction is zero.
///
/// >>> import palpate as pp
/// >>> found = pp.cast_rays(pp.ball(0.5), [[0, 2, 0], [0.3, 2, 0], [9, 2, 0]], [0, -1, 0])
/// >>> found.hits, found.points[:2].round(3)
/// (array([1, 1, 0], dtype=int8), array([[0. , 0.5, 0. ],
///        [0.3, 0.4, 0. ]]))
#[pyfunction]
#[pyo3(signature = (shape, origins, directions, length = 1e3, *, tolerance = None, budget = None, threads = 1))]
pub(crate) fn cast_rays<'py>(
    shape: &PyShape,
    origins: &Bound<'py, PyAny>,
    directions: &Bound<'py, PyAny>,
    length: f64,
    tolerance: Option<f64>,
    budget: Option<u32>,
    threads: isize,
) -> PyResult<Bound<'py, PyAny>> {
    of_either!(shape.made(origins.py())?, shape => {
        let (py, query) = (origins.py(), query(tolerance, budget));
        let found = each(py, &rays(origins, directions, length)?, threads, |rays, found, goes_on| {
            query.cast_rays(shape, rays, found, goes_on)
        })?;
        let points = found.iter().map(|found| Some(found.best?.point.0));
        let normals = found.iter().map(|found| Some(found.best?.normal?.0));
        let hits = found.iter().map(|found| match (found.best, found.stop) {
            (Some(_), _) => 1,
            (None, Stop::SignKnown) => 0,
            _ => -1_i8,
        });
        bounds(py, &found)?
            .with("hits", row(py, hits.collect()))?
            .with("points", rows(py, points)?)?
            .with("normals", rows(py, normals)?)?
            .of_class("RayHits")
    })
}

/// Rays from one origin or many, along one direction or many.
fn rays<const D: usize>(
    origins: &Bound<'_, PyAny>,
    directions: &Bound<'_, PyAny>,
    length: f64,
) -> PyResult<Vec<Ray<D>>> {
    let py = origins.py();
    let (from, along) =
        (poses::points(origins, "origins")?, poses::points(directions, "directions")?);
    let count = match (from.len(), along.len()) {
        (1, many) | (many, 1) => many,
        (from, along) if from == along => from,
        (from, along) => {
            let problem = format!(
                "there must be as many origins as directions, or one, got {from} and {along}"
            );
            return Err(PyValueError::new_err(problem));
        }
    };
    let of = |all: &[Vector<f64, D>], i: usize| all[if all.len() == 1 { 0 } else { i }];
    (0..count)
        .map(|i| {
            let ray = Ray::new(of(&from, i), of(&along, i), length).or_raise(py);
            ray.map_err(|error| at_index(py, "rays", i, error))
        })
        .collect()
}

/// The answers to all questions. Python may stop them at any time.
fn each<T: Copy + Sync, A: Clone + Send>(
    py: Python<'_>,
    all: &[T],
    threads: isize,
    ask: impl Fn(&[T], &mut [Option<A>], &(dyn Fn() -> bool + Sync)) -> Result<bool, QueryError>
    + Sync,
) -> PyResult<Vec<A>> {
    let pool = pool::of_at_least_one(threads)?;
    let mut answers: Vec<Option<A>> = vec![None; all.len()];
    for (part, (all, answers)) in all.chunks(MOST).zip(answers.chunks_mut(MOST)).enumerate() {
        let mut waiting: Vec<usize> = (0..all.len()).collect();
        while !waiting.is_empty() {
            let asked_now: Vec<_> = waiting.iter().map(|i| all[*i]).collect();
            let mut found: Vec<Option<A>> = vec![None; waiting.len()];
            let run = || {
                // The time begins when the threads of the pool do.
                let until = Instant::now() + A_WHILE;
                ask(&asked_now, &mut found, &|| Instant::now() < until)
            };
            let outcome = detached_in(py, &pool, run)?;
            outcome.map_err(|error| in_place(error, part * MOST, &waiting)).or_raise(py)?;
            py.check_signals()?;
            waiting = waiting
                .into_iter()
                .zip(found)
                .filter_map(|(i, found)| {
                    answers[i] = found;
                    answers[i].is_none().then_some(i)
                })
                .collect();
        }
    }
    Ok(answers.into_iter().flatten().collect())
}

/// The error of a pose with its place among all.
fn in_place(error: QueryError, before: usize, waiting: &[usize]) -> QueryError {
    match error {
        QueryError::Pose { index } => QueryError::Pose { index: before + waiting[index] },
        other => other,
    }
}

/// The bounds of many answers, and why their searches ended.
fn bounds<'py, T>(py: Python<'py>, found: &[Certified<T>]) -> PyResult<Fields<'py>> {
    Fields::new(py)
        .with("lower", row(py, found.iter().map(|found| found.lower).collect()))?
        .with("upper", row(py, found.iter().map(|found| found.upper).collect()))?
        .with("stops", row(py, found.iter().map(|found| stop_number(found.stop)).collect()))?
        .with("evaluations", row(py, found.iter().map(|found| found.evaluations).collect()))
}

/// Points or directions in rows; NaN where there is none.
fn rows<const D: usize>(
    py: Python<'_>,
    all: impl Iterator<Item = Option<[f64; D]>>,
) -> PyResult<Bound<'_, PyAny>> {
    table(py, all.flat_map(|one| one.unwrap_or([f64::NAN; D])).collect(), D)
}
