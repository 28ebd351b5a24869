// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Contacts of bodies that overlap by more than one of them is thick.
//!
//! Deep in a wall, its gradient leads out of its next side, through its thickness, and says nothing of
//! where it came from. The gradient of the thicker body does, which is the *host* here: a normal out of
//! the host, and the point of the other body, the *guest*, that lies deepest in it.

use palpate_field::{Point, Vector};

use super::{ManifoldSettings, Touch};
use crate::contact::NormalSource;
use crate::pair::body_pair::BodyPair;

/// A body is thick if, over a way against its gradient, its value falls by more than this share of it.
const THICK: f64 = 0.5;

/// Steps to the deepest point at most.
const STEPS: usize = 32;

/// A step leads down if it does by this share of the last step's length.
const DOWN: f64 = 0.5;

/// What a step is multiplied by after one that leads down and stays in the guest, and after another.
const GROW: f64 = 1.5;
const SHRINK: f64 = 0.5;

/// The last step, as a share of [`ManifoldSettings::precision_length`].
const PRECISE: f64 = 0.05;

/// The host of a touch: the body that is thick where the other is thin; `None` if both are the one or
/// the other.
pub(super) fn host<const D: usize>(
    pair: &mut BodyPair<'_, D>,
    touch: &Touch<D>,
) -> Option<usize> {
    let slopes = pair.slopes(touch.point);
    let way = touch.gap.abs();
    let mut is_thick = |body: usize| {
        let (value, slope) = slopes[body];
        let inwards = slope.normalized()? * -way;
        let deeper = pair.slopes(touch.point + inwards)[body].0;
        Some(value - deeper > THICK * way)
    };
    match [is_thick(0)?, is_thick(1)?] {
        [true, false] => Some(0),
        [false, true] => Some(1),
        _ => None,
    }
}

/// The touch along the gradient of the host, at the point of the guest that lies deepest in it, from a
/// point of the guest on down. `None` where the host has no gradient, or the point is not in it.
pub(super) fn in_host<const D: usize>(
    pair: &mut BodyPair<'_, D>,
    host: usize,
    from: Point<D>,
    settings: &ManifoldSettings,
) -> Option<Touch<D>> {
    let guest = 1 - host;
    let precise = PRECISE * settings.precision_length();
    let mut here = from;
    let mut slopes = pair.slopes(here);
    let mut step = slopes[host].0.abs().max(settings.spacing);
    for _ in 0..STEPS {
        if step < precise {
            break;
        }
        let Some(outwards) = slopes[host].1.normalized() else { break };
        let mut next = here - outwards * step;
        let mut there = pair.slopes(next);
        // Back into the guest, where the step has left it.
        for _ in 0..2 {
            let (value, slope) = there[guest];
            let squared = slope.dot(slope);
            if value > 0.0 && squared > 0.0 {
                next -= slope * (value / squared);
                there = pair.slopes(next);
            }
        }
        let is_deeper = there[host].0 < slopes[host].0 - DOWN * precise;
        if is_deeper && there[guest].0 <= precise {
            (here, slopes) = (next, there);
            step *= GROW;
        } else {
            step *= SHRINK;
        }
    }
    let gap = slopes[host].0;
    let outwards = slopes[host].1.normalized().filter(|_| gap < 0.0)?;
    let normal = if host == 0 { outwards } else { -outwards };
    let point = here - outwards * (0.5 * gap);
    Some(Touch { point, normal, gap, source: NormalSource::ThickerBody })
}

/// The touch along the host's gradient, where a touch is deeper than the margin and one of the bodies is
/// too thin to say where it came from.
pub(super) fn pushed<const D: usize>(
    pair: &mut BodyPair<'_, D>,
    touch: &Touch<D>,
    settings: &ManifoldSettings,
) -> Option<Touch<D>> {
    if touch.gap >= -settings.margin {
        return None;
    }
    let host = host(pair, touch)?;
    in_host(pair, host, touch.point, settings).filter(|found| found.gap <= touch.gap)
}

/// The touch of bodies that were followed to where they overlap: along `normals`, those of the first
/// touch carried with the first body and with the second, from the `points` of that touch, carried
/// likewise. All are in the pair's frame.
///
/// A body whose gradient still leads along its own normal is the host. Where neither's does, both are
/// thin: the gap is what the points have moved past each other.
pub(crate) fn followed<const D: usize>(
    pair: &mut BodyPair<'_, D>,
    points: [Point<D>; 2],
    normals: [Vector<f64, D>; 2],
    settings: &ManifoldSettings,
) -> Option<Touch<D>> {
    for host in 0..2 {
        let guest = points[1 - host];
        let side = if host == 0 { 1.0 } else { -1.0 };
        let Some(outwards) = pair.slopes(guest)[host].1.normalized() else { continue };
        if (outwards * side).dot(normals[host]) > super::LIKE
            && let Some(found) = in_host(pair, host, guest, settings)
            && found.normal.dot(normals[host]) > super::LIKE
        {
            return Some(Touch { source: NormalSource::History, ..found });
        }
    }
    let normal = (normals[0] + normals[1]).normalized()?;
    let gap = (points[1] - points[0]).dot(normal);
    let point = points[1] - normal * (0.5 * gap);
    (gap < 0.0).then_some(Touch { point, normal, gap, source: NormalSource::History })
}
