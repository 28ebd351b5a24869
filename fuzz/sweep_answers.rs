// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What must hold for what is said of two bodies that move, whatever they are.

use arbitrary::{Result, Unstructured};
use palpate_field::Vector;
use palpate_query::{
    Limits, Moving, PairWorkspace, Placed, Stop, SweepSettings, SweepWorkspace, separation,
    sweep,
};
use palpate_testkit::arbitrary::{self as draw, Turn};
use palpate_testkit::kernels::Space;
use palpate_testkit::tree::Solid;

/// Times before the touch that are looked at, and points at each.
const TIMES: u32 = 20;
const POINTS: u32 = 20;

/// Asks when two trees of at most `depth` on screws touch, and says what is wrong with the answer, or
/// how the search ended; `None` if neither tree has bounds.
pub fn check<const D: usize>(
    u: &mut Unstructured<'_>,
    depth: usize,
    (workspace, still): (&mut SweepWorkspace<D>, &mut PairWorkspace<D>),
) -> Result<std::result::Result<Option<Stop>, String>>
where
    Space: Solid<D> + Turn<D>,
{
    let Some([a, b]) = draw::two::<D>(u, depth)? else { return Ok(Ok(None)) };
    let size = draw::size(&a).max(draw::size(&b));
    let (of_a, of_b) = (draw::screw(u, size, 0)?, draw::screw(u, size, 2)?);
    let moving = [Moving::new(&a, of_a), Moving::new(&b, of_b)];
    let settings =
        SweepSettings { gap: 1e-4 * size, budget: 100_000, ..SweepSettings::of_size(size) };
    let Ok(found) = sweep(moving[0], moving[1], &settings, workspace) else {
        return Ok(Err("bounded bodies are refused".into()));
    };
    let wrong = |what: String| {
        Ok(Err(format!("{what}: {found:?} of {a:?} on {of_a:?}, {b:?} on {of_b:?}")))
    };
    if !(found.lower <= found.upper && found.lower >= 0.0) {
        return wrong("bounds that are none".into());
    }
    for i in 0..TIMES {
        let time = found.lower * f64::from(i) / f64::from(TIMES);
        let placed = moving.map(|body| body.at(time));
        let bounded = placed.iter().find_map(|it| Some((it, it.shape.promise().bounds?.aabb)));
        let Some((placed_box, aabb)) = bounded else { break };
        for _ in 0..POINTS {
            let mut p = Vector::ZERO;
            for k in 0..D {
                p[k] = draw::within(u, aabb.min[k], aabb.max[k])?;
            }
            let p = placed_box.world_from_body.transform_point(p);
            let is_in = |it: &Placed<'_, D>| {
                let local = it.world_from_body.inverse().transform_point(p);
                it.shape.distance(local)
                    < -it.shape.promise().rounding.within(local.norm() + size)
            };
            if found.lower > 0.0 && placed.iter().all(is_in) {
                return wrong(format!("{p:?} is in both at {time}"));
            }
        }
    }
    if found.touches() == Some(true) {
        let [first, second] = moving.map(|body| body.at(found.upper));
        let limits = Limits::new(1e-5 * size);
        let Ok(apart) = separation(first, second, &limits, still) else {
            return wrong("no separation".into());
        };
        if apart.lower > settings.gap {
            return wrong(format!("{} m where they touch", apart.lower));
        }
    }
    Ok(Ok(Some(found.stop)))
}
