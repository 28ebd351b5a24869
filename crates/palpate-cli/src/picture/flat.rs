// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Pictures of the plane.

use palpate::field::scalar::Model;
use palpate::field::{
    BLOCK, Block, Column, Gradients, LARGEST_LENGTH, Quality, Rotation, Shape, Vector,
};
use palpate::plot::{
    BoundedField, Cell, Comparison, DrawnBody, Isolines, PlaneView, PlotError, Promised,
    SampledSlope, Sampling, Slice, SurfaceLines,
};
use palpate::query::{BallWorkspace, Limits, contact_ball};
use palpate::scene::{BuiltBody, BuiltScene};
use rayon::prelude::*;

use super::{Colours, Dimensions, Drawable};

/// The isolines of `shape` on `plane`.
pub(crate) fn isolines<const D: usize>(
    shape: &Shape<D>,
    plane: &Slice,
    view: &PlaneView,
    sampling: Sampling,
) -> Result<Isolines, PlotError>
where
    Dimensions: Drawable<D>,
{
    let isolines = Isolines::sample(plane, view, sampling, values(shape, plane))?;
    Ok(isolines.with_outline(outline(shape, plane, view, sampling)?))
}

/// A function of plane coordinates that gives values of `shape` on `plane`.
pub(crate) fn values<const D: usize>(
    shape: &Shape<D>,
    plane: &Slice,
) -> impl FnMut(&[[f64; 2]], &mut [f64])
where
    Dimensions: Drawable<D>,
{
    let mut points = Vec::new();
    move |st, values| {
        points.clear();
        points.extend(st.iter().map(|st| Dimensions::point(plane, *st)));
        shape.distances(&points, values);
    }
}

/// A function of plane coordinates that gives values and gradients of `shape` on `plane`.
pub(crate) fn slopes<const D: usize>(
    shape: &Shape<D>,
    plane: &Slice,
) -> impl FnMut(&[[f64; 2]], &mut [SampledSlope])
where
    Dimensions: Drawable<D>,
{
    let mut block = Block::<f64, D, BLOCK>::zero();
    let mut found = Gradients::<f64, D, BLOCK>::zero();
    move |points, slopes| {
        for (points, slopes) in points.chunks(BLOCK).zip(slopes.chunks_mut(BLOCK)) {
            for (i, st) in points.iter().enumerate() {
                block.set(i, Dimensions::point(plane, *st));
            }
            shape.block_gradients(&block, points.len(), &mut found);
            for (i, slope) in slopes.iter_mut().enumerate() {
                let gradient = Dimensions::gradient(plane, found.gradient.get(i));
                *slope = SampledSlope { value: found.distance.get(i), gradient };
            }
        }
    }
}

/// The surface of `shape` on `plane`, followed.
pub(crate) fn outline<const D: usize>(
    shape: &Shape<D>,
    plane: &Slice,
    view: &PlaneView,
    sampling: Sampling,
) -> Result<SurfaceLines, PlotError>
where
    Dimensions: Drawable<D>,
{
    let (turn, extent) = Dimensions::cells(plane);
    let flat = Flat {
        shape,
        plane,
        values: values(shape, plane),
        slopes: slopes(shape, plane),
        turn,
        extent,
        cells: Block::zero(),
        models: Column::zero(),
    };
    SurfaceLines::follow(view, sampling, flat)
}

/// The isolines of a scene on `plane`, with its bodies.
pub(crate) fn scene<const D: usize>(
    scene: &BuiltScene<D>,
    plane: &Slice,
    view: &PlaneView,
) -> Result<Isolines, PlotError>
where
    Dimensions: Drawable<D>,
{
    noted(scene, plane, view, |_| String::new())
}

/// The isolines of a scene on `plane`, with its bodies and a `note` below the name of each, by its
/// number.
pub(crate) fn noted<const D: usize>(
    scene: &BuiltScene<D>,
    plane: &Slice,
    view: &PlaneView,
    note: impl Fn(usize) -> String,
) -> Result<Isolines, PlotError>
where
    Dimensions: Drawable<D>,
{
    let sampling = Sampling::default();
    let body = |(number, body): (usize, &BuiltBody<D>)| {
        let outline = outline(&body.shape, plane, view, sampling)?;
        Ok(DrawnBody::new(&body.name, outline).with_note(note(number)))
    };
    let bodies = scene.bodies.iter().enumerate().map(body).collect::<Result<Vec<_>, _>>()?;
    let isolines = Isolines::sample(plane, view, sampling, values(&scene.whole, plane))?;
    Ok(isolines.with_bodies(bodies))
}

/// A shape on a plane.
struct Flat<'a, V, S, const D: usize> {
    shape: &'a Shape<D>,
    plane: &'a Slice,
    values: V,
    slopes: S,
    turn: Option<Rotation<D>>,
    /// Half the edges of a cell of which half the edge in the plane is one.
    extent: Vector<f64, D>,
    cells: Block<Model, D, BLOCK>,
    models: Column<Model, BLOCK>,
}

impl<V, S, const D: usize> BoundedField for Flat<'_, V, S, D>
where
    V: FnMut(&[[f64; 2]], &mut [f64]),
    S: FnMut(&[[f64; 2]], &mut [SampledSlope]),
    Dimensions: Drawable<D>,
{
    fn values(&mut self, points: &[[f64; 2]], values: &mut [f64]) {
        (self.values)(points, values);
    }

    fn slopes(&mut self, points: &[[f64; 2]], slopes: &mut [SampledSlope]) {
        (self.slopes)(points, slopes);
    }

    fn safe_radii(&mut self, points: &[[f64; 2]], radii: &mut [f64]) {
        self.values(points, radii);
        let promise = self.shape.promise();
        for (point, radius) in points.iter().zip(radii) {
            let point = Dimensions::point(self.plane, *point);
            let rounding = promise.rounding.within(point.norm());
            *radius = promise.safe_radius(point, *radius) - rounding;
        }
    }

    fn bounds(&mut self, cells: &[Cell], bounds: &mut [[f64; 2]]) {
        for (cells, bounds) in cells.chunks(BLOCK).zip(bounds.chunks_mut(BLOCK)) {
            self.cells.fill_boxes(cells.len(), self.turn.as_ref(), |i| {
                let Cell { centre, half } = cells[i];
                (Dimensions::point(self.plane, centre), self.extent * half)
            });
            self.shape.block_distances(&self.cells, cells.len(), &mut self.models);
            for (i, bounds) in bounds.iter_mut().enumerate() {
                let model = self.models.get(i);
                *bounds = [model.minimum(), model.maximum()];
            }
        }
    }
}

/// How close the bounds of the ratio of value to distance come.
const CLOSE: f64 = 0.005;

/// The most evaluations of the search for a distance, which leaves little open in most scenes;
/// where bounds are loose, ten times as many decide few more places.
const BUDGET: u32 = 2000;

/// The picture with promises in place of bands, and with values compared with true distances;
/// `None` if it is ended before.
pub(super) fn with_promise<const D: usize>(
    shape: &Shape<D>,
    plane: &Slice,
    isolines: Isolines,
    Colours { grid, watch, .. }: Colours<'_>,
) -> Result<Option<Isolines>, PlotError>
where
    Dimensions: Drawable<D>,
{
    let promise = shape.promise();
    let promised = [promise.outside, promise.inside].map(|quality| match quality {
        Quality::Exact => Promised::Exact,
        Quality::Bound => Promised::Bound,
        Quality::Lipschitz => Promised::Lipschitz(promise.lipschitz),
    });
    let places = isolines.compared_places(grid);
    let compared: Vec<_> = places
        .par_iter()
        .map_init(BallWorkspace::new, |workspace, place| {
            let point = Dimensions::point(plane, *place);
            watch().then(|| compare(shape, point, workspace))
        })
        .while_some()
        .collect();
    if compared.len() < places.len() {
        return Ok(None);
    }
    isolines.with_promise(promised, grid, &compared).map(Some)
}

/// The value at a point, beside the bounds of its distance from the surface.
pub(super) fn compare<const D: usize>(
    shape: &Shape<D>,
    point: Vector<f64, D>,
    workspace: &mut BallWorkspace<D>,
) -> Comparison {
    let value = shape.distance(point);
    let promise = shape.promise();
    let quality = if value < 0.0 { promise.inside } else { promise.outside };
    if quality == Quality::Exact {
        return Comparison { value, distance: [value.abs(); 2] };
    }
    // A search with the largest tolerance tells roughly how far the surface is.
    let mut search = |tolerance: f64, budget: u32| {
        let limits = Limits::new(tolerance).with_budget(budget);
        contact_ball(shape, point, 0.0, &limits, workspace)
    };
    let found = search(LARGEST_LENGTH, 1).and_then(|rough| {
        let farthest = rough.lower.abs().max(rough.upper.abs());
        let distance = if farthest.is_finite() { farthest } else { value.abs() };
        let ratio = (value.abs() / distance).max(1.0);
        search(CLOSE * distance / ratio, BUDGET)
    });
    // Of a point beyond the range of searches nothing is known.
    let distance = found.map_or([0.0, f64::INFINITY], |found| match value < 0.0 {
        true => [-found.upper, -found.lower],
        false => [found.lower, found.upper],
    });
    Comparison { value, distance: distance.map(|bound| bound.max(0.0)) }
}
