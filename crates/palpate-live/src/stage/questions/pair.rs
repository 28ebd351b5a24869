// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Two bodies: their separation.

use std::time::Instant;

use palpate::local::PairMethod;
use palpate::query::{PairWorkspace, separation};
use palpate::scene::BuiltScene;
use serde_json::{Value, json};

use super::{limits, named, nanoseconds, placed};
use crate::stage::points::point_of;

/// The most starts of local descents.
const MOST_STARTS: usize = 1000;

/// The separation of two bodies, proven, and by local searches from some starts.
pub(super) fn between<const D: usize>(
    scene: &BuiltScene<D>,
    bodies: [usize; 2],
    starts: &[Vec<f64>],
    method: Option<&str>,
) -> Result<Value, String> {
    let [a, b] = [named(scene, bodies[0])?, named(scene, bodies[1])?];
    let limits = limits(scene);
    let begin = Instant::now();
    let found = separation(placed(a), placed(b), &limits, &mut PairWorkspace::new())
        .map_err(|error| error.to_string())?;
    let contact = found.best.contact(placed(a), placed(b));
    let certified = json!({
        "lower": found.lower, "upper": found.upper, "evaluations": found.evaluations,
        "stop": found.stop.to_string(), "ns": nanoseconds(begin),
        "point": found.best.point.0.to_vec(),
        "points": contact.map(|contact| [contact.point_a.0.to_vec(), contact.point_b.0.to_vec()]),
        "normal": contact.map(|contact| contact.normal.0.to_vec()),
    });
    let method = method.unwrap_or(PairMethod::AlternatingProjection.name());
    let method: PairMethod = method.parse().map_err(|error| format!("{error}"))?;
    let descent = |start: &Vec<f64>| {
        let begin = Instant::now();
        let local = method
            .descend(&a.shape, &b.shape, point_of(start)?, limits.tolerance)
            .map_err(|error| error.to_string())?;
        Ok(json!({
            "method": method.name(), "start": start, "value": local.value,
            "point": local.best.0.to_vec(), "evaluations": local.evaluations,
            "path": local.path.iter().map(|point| point.0.to_vec()).collect::<Vec<_>>(),
            "ns": nanoseconds(begin),
        }))
    };
    if starts.len() > MOST_STARTS {
        let count = starts.len();
        return Err(format!("a pair has at most {MOST_STARTS} starts, got {count}"));
    }
    let local = starts.iter().map(descent).collect::<Result<Vec<_>, String>>()?;
    Ok(json!({ "do": "pair", "certified": certified, "local": local }))
}
