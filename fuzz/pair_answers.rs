// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What must hold for what is said of two bodies, whatever they are.

use arbitrary::{Result, Unstructured};
use palpate_field::Vector;
use palpate_query::{Limits, PairWorkspace, Stop, overlap, separation};
use palpate_testkit::arbitrary::{self as draw, Turn};
use palpate_testkit::kernels::Space;
use palpate_testkit::tree::Solid;

/// Points at which a bound is tried, all over and close to the best.
const SAMPLES: usize = 400;

/// Asks of two trees of at most `depth`, and says what is wrong with the answers, or how the
/// search ended; `None` if neither tree has bounds.
pub fn check<const D: usize>(
    u: &mut Unstructured<'_>,
    depth: usize,
    workspace: &mut PairWorkspace<D>,
) -> Result<std::result::Result<Option<Stop>, String>>
where
    Space: Solid<D> + Turn<D>,
{
    let Some([a, b]) = draw::two::<D>(u, depth)? else { return Ok(Ok(None)) };
    let size = draw::size(&a);
    let limits = Limits::new(0.02 * size).with_budget(200_000);
    let Ok(answer) = separation(&a, &b, &limits, workspace) else {
        return Ok(Err("bounded bodies are refused".into()));
    };
    // By the definition, of which the values alone are a part.
    let scales = [&a, &b].map(|shape| 1.0 / shape.promise().lipschitz.max(1.0));
    for i in 0..SAMPLES {
        let spread = [2.0, 0.2, 1e-3][i % 3] * size;
        let p = answer.best.point + draw::direction::<D>(u)? * (spread * draw::unit(u)?);
        let value = (a.distance(p) * scales[0]).max(b.distance(p) * scales[1]);
        let far = [&a, &b].map(|shape| {
            shape.promise().bounds.map_or(0.0, |bounds| {
                let nearest = Vector(std::array::from_fn(|k| {
                    p[k].clamp(bounds.aabb.min[k], bounds.aabb.max[k])
                }));
                (p - nearest).norm()
            })
        });
        let rounding = a.promise().rounding.within(p.norm() + size)
            + b.promise().rounding.within(p.norm() + size);
        if 2.0 * (value.max(far[0]).max(far[1]) + rounding) < answer.lower {
            return Ok(Err(format!("{value} at {p:?} is below {answer:?}: {a:?} {b:?}")));
        }
    }
    // The other way round the bounds overlap, and the sign alone does not say otherwise.
    let others = [separation(&b, &a, &limits, workspace), overlap(&a, &b, &limits, workspace)];
    for other in others {
        let Ok(other) = other else { return Ok(Err("bounded bodies are refused".into())) };
        if other.lower > answer.upper || answer.lower > other.upper {
            return Ok(Err(format!(
                "{answer:?} and {other:?} exclude each other: {a:?} {b:?}"
            )));
        }
        if other.stop == Stop::SignKnown && other.is_hit().is_none() {
            return Ok(Err(format!("{other:?} does not know: {a:?} {b:?}")));
        }
    }
    Ok(Ok(Some(answer.stop)))
}
