// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The slices of a scene with most contacts.

use palpate::field::{Aabb, Vector};
use palpate::plot::{PlotError, Slice};
use palpate::servo_loop::TraceRow;

/// The distance that counts as near a slice, as a share of the scene's shortest edge: within it
/// a body's cross-section changes little.
const NEAR: f64 = 0.1;

/// The least such distance, as a share of the longest edge: one or two widths of a line in a
/// picture.
const LEAST_NEAR: f64 = 0.02;

/// The weight of a contact at the border of a scene, over its weight in the middle.
const BORDER: f64 = 0.4;

/// The most contacts that are weighed to choose a slice; a sample of the ticks gives the same
/// choice.
const MOST_CONTACTS: usize = 2000;

/// A slice to be drawn, and the distance that counts as near it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FeltSlice {
    pub(super) plane: Slice,
    /// The view's direction and the slice's position; empty in the plane.
    pub(super) heading: String,
    /// The largest distance that counts as near [m]; infinite in the plane.
    pub(super) near: f64,
}

/// The slices to draw: the plane itself in 2D; in space an upright one, seen from the front or
/// the side, and a level one, each where most contacts lie.
///
/// # Errors
///
/// [`PlotError::NotFinite`] for bounds that are not finite.
pub(super) fn felt_slices<const D: usize>(
    bounds: &Aabb<D>,
    rows: &[TraceRow],
) -> Result<Vec<FeltSlice>, PlotError> {
    if D < 3 {
        let plane = Slice::planar();
        return Ok(vec![FeltSlice { plane, heading: String::new(), near: f64::INFINITY }]);
    }
    let touching: Vec<_> = rows.iter().filter(|row| row.contact).collect();
    let every = touching.len().div_ceil(MOST_CONTACTS).max(1);
    let contacts: Vec<_> =
        touching.iter().step_by(every).map(|row| (row.proxy, row.normal)).collect();
    let (bounds, near) = (&bounds.in_space(), nearness(&bounds.in_space()));
    let best = |axis: usize| best_place(bounds, &contacts, axis, near);
    let (front, side, level) = (best(2), best(0), best(1));
    let slice = |plane: Slice, seen: &str, place: f64| {
        let heading = format!("{seen} = {} m", written(place, near));
        FeltSlice { plane, heading, near }
    };
    let upright = if side.felt > front.felt {
        slice(Slice::yz(side.place)?, "From the side: slice at x", side.place)
    } else {
        slice(Slice::xy(front.place)?, "From the front: slice at z", front.place)
    };
    let level = slice(Slice::xz(level.place)?, "From above: slice at y", level.place);
    Ok(vec![upright, level])
}

/// The distance that counts as near a slice of a scene [m]: a round number.
fn nearness(bounds: &Aabb<3>) -> f64 {
    let edges = bounds.half_extents().0.map(|half| 2.0 * half);
    let shortest = edges.into_iter().fold(f64::INFINITY, f64::min);
    let longest = edges.into_iter().fold(0.0, f64::max);
    let near = (NEAR * shortest).max(LEAST_NEAR * longest);
    let power = 10_f64.powf(near.log10().floor());
    let round = [5.0, 2.0, 1.0].into_iter().find(|digit| digit * power <= near);
    power * round.unwrap_or(1.0)
}

/// A place [m] with enough decimals for a tenth of `near`, without trailing zeros.
fn written(place: f64, near: f64) -> String {
    let decimals = (1.0 - near.log10().floor()).clamp(0.0, 12.0) as usize;
    let text = format!("{place:.decimals$}");
    let short =
        if decimals > 0 { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if short == "-0" { "0".to_owned() } else { short.replace('-', "−") }
}

/// A place along an axis [m], and the weight of the contacts near it.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Place {
    place: f64,
    felt: f64,
}

/// The place at which a slice across `axis` has the largest weight of contacts near it.
///
/// A contact's weight is the squared sine of the angle between its normal and the axis: a slice
/// across the normal would only graze the face and not show the force. The weight falls to
/// [`BORDER`] at the border of the scene, because slices near the middle show most of the
/// bodies. Of equal places the one nearest the middle is chosen.
fn best_place(
    bounds: &Aabb<3>,
    contacts: &[(Vector<f64, 3>, Vector<f64, 3>)],
    axis: usize,
    near: f64,
) -> Place {
    let (middle, half) = (bounds.centre()[axis], bounds.half_extents()[axis]);
    // Rounded, so that the heading gives the place exactly.
    let unit = 0.1 * near;
    let steps = (half / (0.5 * near)) as i32;
    let places = (0..=steps)
        .flat_map(|step| [step, -step])
        .map(|step| ((middle + 0.5 * near * f64::from(step)) / unit).round() * unit);
    let mut best = Place { place: (middle / unit).round() * unit, felt: 0.0 };
    for place in places {
        let felt: f64 = contacts
            .iter()
            .filter(|(point, _)| (point[axis] - place).abs() <= near)
            .map(|(_, normal)| 1.0 - normal[axis] * normal[axis])
            .sum();
        let felt = felt * (1.0 - (1.0 - BORDER) * (place - middle).abs() / half);
        if felt > best.felt {
            best = Place { place, felt };
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bounds() -> Aabb<3> {
        Aabb { min: Vector([-0.2, 0.0, -0.05]), max: Vector([0.2, 0.3, 0.05]) }
    }

    fn contact(proxy: [f64; 3], normal: [f64; 3]) -> TraceRow {
        let mut row = TraceRow::free(0.0, 0, Vector(proxy));
        (row.wanted, row.force, row.normal) = (Vector(normal), Vector(normal), Vector(normal));
        row.contact = true;
        row
    }

    fn headings(rows: &[TraceRow]) -> Vec<String> {
        let slices = felt_slices(&bounds(), rows).unwrap();
        slices.into_iter().map(|slice| slice.heading).collect()
    }

    #[test]
    fn nothing_felt_is_sliced_in_the_middle() {
        let middle = ["From the front: slice at z = 0 m", "From above: slice at y = 0.15 m"];
        assert_eq!(headings(&[]), middle);
        let mut free = contact([0.1, 0.2, 0.04], [0.0, 1.0, 0.0]);
        free.contact = false;
        assert_eq!(headings(&[free]), middle);
    }

    #[test]
    fn slices_lie_where_most_contacts_are() {
        // Three contacts on a top at z = 0.03, one elsewhere; and one on a side at y = 0.22. Of
        // places that are near enough, the one nearest the middle.
        let rows = [
            contact([0.1, 0.3, 0.030], [0.0, 1.0, 0.0]),
            contact([-0.1, 0.3, 0.034], [0.0, 1.0, 0.0]),
            contact([0.15, 0.3, 0.033], [0.0, 1.0, 0.0]),
            contact([0.0, 0.3, -0.02], [0.0, 1.0, 0.0]),
            contact([0.02, 0.22, 0.05], [0.0, 0.0, 1.0]),
        ];
        let headings = headings(&rows);
        assert_eq!(headings[0], "From the front: slice at z = 0.025 m");
        assert_eq!(headings[1], "From above: slice at y = 0.215 m");
    }

    #[test]
    fn a_face_is_not_sliced_along_itself() {
        // Many contacts on the front face, fewer on the left one: z = 0.05 grazes the first.
        let face = |i: i32| contact([0.03 * f64::from(i), 0.1, 0.05], [0.0, 0.0, 1.0]);
        let side = |i: i32| contact([-0.2, 0.1, 0.002 * f64::from(i)], [-1.0, 0.0, 0.0]);
        let rows: Vec<_> = (-5..5).map(face).chain((-1..2).map(side)).collect();
        assert_eq!(headings(&rows)[0], "From the front: slice at z = 0 m");
    }

    #[test]
    fn a_scene_felt_along_z_is_seen_from_the_side() {
        let row = |i: i32| contact([0.1, 0.2, 0.01 * f64::from(i)], [0.0, 1.0, 0.0]);
        let rows: Vec<_> = (-5..5).map(row).collect();
        assert!(headings(&rows)[0].starts_with("From the side: slice at x = 0."));
    }

    #[test]
    fn the_plane_is_drawn_whole() {
        let bounds = Aabb::<2>::centred(Vector([1.0, 2.0]));
        let slices = felt_slices(&bounds, &[]).unwrap();
        assert_eq!((slices.len(), slices[0].near), (1, f64::INFINITY));
        assert!(slices[0].heading.is_empty());
    }

    #[test]
    fn nearness_is_a_round_part_of_the_scene() {
        assert_eq!(nearness(&bounds()), 0.01);
        let plate = Aabb::<3>::centred(Vector([0.5, 0.5, 0.001]));
        assert_eq!(nearness(&plate), 0.02);
        let texts = [written(0.0215, 0.005), written(-0.1, 0.01), written(120.0, 20.0)];
        assert_eq!(texts, ["0.0215", "−0.1", "120"]);
        assert_eq!(written(-1e-18, 0.01), "0");
    }
}
