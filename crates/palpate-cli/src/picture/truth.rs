// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Values beside true distances, which are searched.

use palpate::field::{LARGEST_LENGTH, Quality, Shape, Vector};
use palpate::plot::{Comparison, Isolines, PlotError, Promised, Slice};
use palpate::query::{BallWorkspace, Limits, contact_ball};
use rayon::prelude::*;

use super::{Colours, Dimensions, Drawable};

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
