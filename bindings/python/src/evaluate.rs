// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Distances and gradients at one point and at many.

use std::time::Instant;

use numpy::{Element, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use palpate::field::{Layout, Shape, ShapeError, Strided, StridedMut, Vector};
use palpate::query::evaluate_point;
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::answers::Fields;
use crate::arrays::{Numbers, few, misshapen, numbers, place, writable};
use crate::call::Call;
use crate::ending::detach;
use crate::error::OrRaise;
use crate::interrupt::A_WHILE;
use crate::pool::{self, Pool};
use crate::shape::{AnyShape, of_either};

/// Points that a thread takes at once: whole blocks, in memory that stays in its cache.
const CHUNK: usize = 4096;

/// What a caller calls an array to write to, and the array.
pub(crate) type Named<'a, 'py> = (&'a str, Option<&'a Bound<'py, PyAny>>);

/// Distances and gradients.
pub(crate) type Slopes<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>);

/// The distance at a point, or those at the points of an array.
pub(crate) fn distance<'py>(
    shape: &AnyShape,
    points: &Bound<'py, PyAny>,
    out: Option<&Bound<'py, PyAny>>,
    threads: isize,
) -> PyResult<Bound<'py, PyAny>> {
    of_either!(shape, shape => distances(shape, points, out, threads))
}

fn distances<'py, const D: usize>(
    shape: &Shape<D>,
    points: &Bound<'py, PyAny>,
    out: Option<&Bound<'py, PyAny>>,
    threads: isize,
) -> PyResult<Bound<'py, PyAny>> {
    let py = points.py();
    let one = |point: [f64; D]| {
        pool::check(threads)?;
        let call = Call::default();
        let distance = call.run(|| shape.distance(Vector(point)));
        call.ended()?;
        Ok(distance.into_pyobject(py)?.into_any())
    };
    if out.is_none()
        && let Some(point) = few(points)
    {
        return one(point);
    }
    match numbers(points, "points")? {
        Numbers::Double(array) => match <[f64; D]>::try_from(array.as_slice()?) {
            Ok(point) if out.is_none() && array.ndim() == 1 => one(point),
            _ => many(shape, &array, out, threads),
        },
        Numbers::Single(array) if out.is_none() && array.ndim() == 1 => {
            // A number, not an array without axes.
            many(shape, &array, None, threads)?.call_method0("item")
        }
        Numbers::Single(array) => many(shape, &array, out, threads),
    }
}

fn many<'py, T: Element + Copy + Send + Sync, const D: usize>(
    shape: &Shape<D>,
    points: &PyReadonlyArrayDyn<'py, T>,
    out: Option<&Bound<'py, PyAny>>,
    threads: isize,
) -> PyResult<Bound<'py, PyAny>>
where
    Shape<D>: Rows<T>,
{
    let py = points.py();
    let rows = rows::<D>(points.shape())?;
    let out = place::<T>(py, out, rows, "out")?;
    let mut written = writable(&out, "out")?;
    let pool = pool::of(threads)?;
    let outs = [(written.as_slice_mut()?, 1)];
    in_chunks(py, (points.as_slice()?, D), outs, pool.as_deref(), |points, [out]| {
        shape.distances_of(points, out)
    })?;
    drop(written);
    Ok(out.into_any())
}

/// The distances and gradients at the points of an array.
pub(crate) fn distance_gradient<'py>(
    shape: &AnyShape,
    points: &Bound<'py, PyAny>,
    outs: [Named<'_, 'py>; 2],
    threads: isize,
) -> PyResult<Slopes<'py>> {
    of_either!(shape, shape => match numbers(points, "points")? {
        Numbers::Double(array) => slopes(shape, &array, outs, threads),
        Numbers::Single(array) => slopes(shape, &array, outs, threads),
    })
}

fn slopes<'py, T: Element + Copy + Send + Sync, const D: usize>(
    shape: &Shape<D>,
    points: &PyReadonlyArrayDyn<'py, T>,
    [(of_distances, distances), (of_gradients, gradients)]: [Named<'_, 'py>; 2],
    threads: isize,
) -> PyResult<Slopes<'py>>
where
    Shape<D>: Rows<T>,
{
    let py = points.py();
    let rows = rows::<D>(points.shape())?;
    let distances = place::<T>(py, distances, rows, of_distances)?;
    let gradients = place::<T>(py, gradients, points.shape(), of_gradients)?;
    let mut written =
        [writable(&distances, of_distances)?, writable(&gradients, of_gradients)?];
    let pool = pool::of(threads)?;
    let [to_distances, to_gradients] = &mut written;
    let outs = [(to_distances.as_slice_mut()?, 1), (to_gradients.as_slice_mut()?, D)];
    in_chunks(py, (points.as_slice()?, D), outs, pool.as_deref(), |points, [to, slopes]| {
        shape.slopes_of(points, to, slopes)
    })?;
    drop(written);
    let distances = match rows {
        // A number, not an array without axes.
        [] => distances.call_method0("item")?,
        _ => distances.into_any(),
    };
    Ok((distances, gradients.into_any()))
}

/// What is known of a field at a point.
pub(crate) fn at<'py>(
    shape: &AnyShape,
    point: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let py = point.py();
    of_either!(shape, shape => {
        let point = crate::poses::point(point, "point")?;
        let call = Call::default();
        let found = call.run(|| evaluate_point(shape, point));
        call.ended()?;
        Fields::of(py, &found.or_raise(py)?)?.of_class("AtPoint")
    })
}

/// The axes of an array of points but the last, which holds their coordinates.
fn rows<const D: usize>(shape: &[usize]) -> PyResult<&[usize]> {
    match shape {
        [rows @ .., last] if *last == D => Ok(rows),
        _ => Err(misshapen("points", &format!("(…, {D})"), shape)),
    }
}

/// The distances and gradients at rows of coordinates.
trait Rows<T>: Sync {
    fn distances_of(&self, points: &[T], to: &mut [T]) -> Result<(), ShapeError>;

    fn slopes_of(&self, points: &[T], to: &mut [T], slopes: &mut [T])
    -> Result<(), ShapeError>;
}

macro_rules! rows_of {
    ($T:ty) => {
        impl<const D: usize> Rows<$T> for Shape<D> {
            fn distances_of(&self, points: &[$T], to: &mut [$T]) -> Result<(), ShapeError> {
                let rows = to.len();
                self.distances_strided(
                    Strided::new(points, Layout::contiguous(rows, D))?,
                    StridedMut::new(to, Layout::contiguous(rows, 1))?,
                );
                Ok(())
            }

            fn slopes_of(
                &self,
                points: &[$T],
                to: &mut [$T],
                slopes: &mut [$T],
            ) -> Result<(), ShapeError> {
                let rows = to.len();
                self.distances_gradients_strided(
                    Strided::new(points, Layout::contiguous(rows, D))?,
                    StridedMut::new(to, Layout::contiguous(rows, 1))?,
                    StridedMut::new(slopes, Layout::contiguous(rows, D))?,
                );
                Ok(())
            }
        }
    };
}

rows_of!(f64);
rows_of!(f32);

/// Does work on the rows of an array and of those that it fills, each with its columns, without the interpreter's lock.
/// Between chunks Python may stop it.
fn in_chunks<T: Copy + Send + Sync, const K: usize>(
    py: Python<'_>,
    (mut given, columns): (&[T], usize),
    outs: [(&mut [T], usize); K],
    pool: Option<&Pool>,
    work: impl Fn(&[T], [&mut [T]; K]) -> Result<(), ShapeError> + Send + Sync,
) -> PyResult<()> {
    let widths = outs.each_ref().map(|(_, width)| *width);
    let mut left = outs.map(|(out, _)| out);
    let threads = pool.map_or(1, Pool::count);
    // Chunks from one look at Python to the next.
    let mut chunks = threads;
    while !given.is_empty() {
        let mut batch = Vec::with_capacity(chunks);
        for _ in 0..chunks {
            if given.is_empty() {
                break;
            }
            let rows = CHUNK.min(given.len() / columns);
            let (points, rest) = given.split_at(rows * columns);
            given = rest;
            let mut widths = widths.iter();
            let outs = left.each_mut().map(|out| {
                let width = widths.next().copied().unwrap_or_default();
                let (own, rest) = std::mem::take(out).split_at_mut(rows * width);
                *out = rest;
                own
            });
            batch.push((points, outs));
        }
        let start = Instant::now();
        let call = Call::default();
        let work = |(points, outs)| work(points, outs);
        let done = detach(py, || match pool {
            Some(pool) if batch.len() > 1 => {
                pool.run(&call, || batch.into_par_iter().try_for_each(work))
            }
            _ => call.run(|| batch.into_iter().try_for_each(work)),
        });
        call.ended()?;
        done.or_raise(py)?;
        py.check_signals()?;
        let spent = start.elapsed();
        chunks = match () {
            () if spent > A_WHILE => (chunks / 2).max(threads),
            () if spent < A_WHILE / 4 => chunks * 2,
            () => chunks,
        };
    }
    Ok(())
}
