// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Two bodies: their separation.

use palpate::local::PairMethod;
use palpate::query::{PairWorkspace, Placed, separation};
use palpate::scene::{BuiltBody, BuiltScene};

use super::{limits, named};
use crate::stage::points::point_of;
use crate::wire::{Answered, Local, Timed};

/// The most starts of local descents.
const MOST_STARTS: usize = 1000;

/// The separation of two bodies, proven, and by local searches from some starts.
pub(super) fn between<const D: usize>(
    scene: &BuiltScene<D>,
    bodies: [usize; 2],
    starts: &[Vec<f64>],
    method: Option<&str>,
) -> Result<Answered<D>, String> {
    let [a, b] = [named(scene, bodies[0])?, named(scene, bodies[1])?];
    let limits = limits(scene);
    let certified = Timed::of(|| {
        separation(placed(a), placed(b), &limits, &mut PairWorkspace::new())
            .map_err(|error| error.to_string())
    })?;
    let contact = certified.result.best.contact(placed(a), placed(b));
    let method = method.unwrap_or(PairMethod::AlternatingProjection.name());
    let method: PairMethod = method.parse().map_err(|error| format!("{error}"))?;
    if starts.len() > MOST_STARTS {
        let count = starts.len();
        return Err(format!("a pair has at most {MOST_STARTS} starts, got {count}"));
    }
    let descent = |start: &Vec<f64>| {
        let start = point_of(start)?;
        Timed::of(|| {
            let found = method.descend(&a.shape, &b.shape, start, limits.tolerance);
            found
                .map(|found| Local::new(method.name(), found))
                .map_err(|error| error.to_string())
        })
    };
    let local = starts.iter().map(descent).collect::<Result<_, String>>()?;
    Ok(Answered::Pair { certified, contact, local })
}

fn placed<const D: usize>(body: &BuiltBody<D>) -> Placed<'_, D> {
    Placed::new(&body.shape_in_body, body.world_from_body)
}
