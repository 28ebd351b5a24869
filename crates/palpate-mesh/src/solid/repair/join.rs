// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Corners that are equal up to rounding are joined.
//!
//! A program that computes a corner anew for each face gives it a few roundings beside its copies. Then no edge of
//! one face is an edge of the next. Corners are joined where that closes edges: only corners at open edges are
//! candidates, and of those that are joined only the ones stay joined at which an edge is closed.

use std::collections::{HashMap, HashSet};

use palpate_field::Point;

use super::rims::{by_rim, sides};
use crate::mesh::SINGLE_ROUNDING;

/// Corners are joined within so many roundings of the largest coordinate.
const ROUNDINGS: f64 = 16.0;

/// They are joined also within this share of the shortest edge.
const SHARE: f64 = 1e-6;

/// Edges of at most this share of the largest coordinate are between copies of one corner.
const NO_EDGE: f64 = 1e-9;

/// Cracks of at least this share of the shortest edge are looked for.
const CRACK: f64 = 1e-6;

/// Significant digits of a text that was rounded: fewer are numbers as somebody chose them, and more are
/// those of double precision.
const DIGITS: std::ops::RangeInclusive<usize> = 6..=9;

/// Half a unit in the last place of 1, in double precision.
const DOUBLE: f64 = 0.5 * f64::EPSILON;

/// How far apart corners may be that are joined.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Within {
    /// As far as the rounding of the coordinates explains.
    Rounding,
    /// This far [m].
    Length(f64),
}

/// What was joined.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Joined {
    /// How many corners.
    pub(crate) corners: usize,
    /// How far the farthest was moved [m].
    pub(crate) farthest: f64,
    /// How far apart corners were that were joined at most, and corners from edges that they lie on [m].
    pub(crate) tolerance: f64,
}

/// Joins corners of open edges that are at most `within` apart, where that closes edges. The vertices that are left
/// without an element stay.
pub(crate) fn join<const N: usize, const D: usize>(
    vertices: &[Point<D>],
    elements: &mut [[u32; N]],
    within: Within,
    rounding: f64,
) -> Joined {
    let open = open_rims(elements);
    if open.is_empty() {
        return Joined::default();
    }
    let tolerance = match within {
        Within::Rounding => usual_tolerance(vertices, elements, rounding),
        Within::Length(length) => length,
    };
    let mut joined = Joined { tolerance, ..Joined::default() };
    if tolerance == 0.0 {
        return joined;
    }
    let mut ends: Vec<u32> = open.iter().flatten().copied().collect();
    ends.sort_unstable();
    ends.dedup();
    let leaders = leaders(vertices, &ends, tolerance);
    let renamed = |index: u32| leaders.get(&index).copied().unwrap_or(index);
    let renamed_rim = |rim: &[u32; 2]| {
        let [from, to] = rim.map(renamed);
        [from.min(to), from.max(to)]
    };
    let mut counts: HashMap<[u32; 2], usize> = HashMap::new();
    for rim in &open {
        *counts.entry(renamed_rim(rim)).or_default() += 1;
    }
    // An edge that has shrunk to a corner is closed too.
    let is_closed =
        |rim: &[u32; 2]| counts[rim].is_multiple_of(2) || N == 3 && rim[0] == rim[1];
    let at_closed: HashSet<u32> =
        open.iter().map(renamed_rim).filter(is_closed).flatten().collect();
    let mut is_moved = HashMap::new();
    for index in elements.iter_mut().flatten() {
        let leader = renamed(*index);
        if leader != *index && at_closed.contains(&leader) {
            let far = (vertices[leader as usize] - vertices[*index as usize]).norm();
            is_moved.insert(*index, far);
            *index = leader;
        }
    }
    joined.corners = is_moved.len();
    joined.farthest = is_moved.into_values().fold(0.0, f64::max);
    joined
}

/// The rims at which an odd number of elements meet: open edges, and in the plane the ends of chains.
fn open_rims<const N: usize>(elements: &[[u32; N]]) -> Vec<[u32; 2]> {
    let sides = sides(elements);
    let open = by_rim(&sides).filter(|at_rim| !at_rim.len().is_multiple_of(2));
    open.map(|at_rim| at_rim[0].rim).collect()
}

/// The least tolerance, of a few, that would close nearly all open rims, and what it would join: the mesh has
/// cracks, and is no sheet. `None` if there is none.
pub(crate) fn cracks<const N: usize, const D: usize>(
    vertices: &[Point<D>],
    elements: &[[u32; N]],
    rounding: f64,
) -> Option<Joined> {
    let before = open_rims(elements).len();
    let shortest = shortest_edge(vertices, elements, 0.0)?.length;
    let mut tolerance = usual_tolerance(vertices, elements, rounding).max(CRACK * shortest);
    while before > 0 && tolerance < 0.5 * shortest {
        let mut mended = elements.to_vec();
        let joined = join(vertices, &mut mended, Within::Length(tolerance), rounding);
        mended.retain(|element| (1..N).all(|i| !element[..i].contains(&element[i])));
        if open_rims(&mended).len() <= before / 10 {
            return Some(joined);
        }
        tolerance *= 4.0;
    }
    None
}

/// Of each vertex the first within the tolerance of it, if that is another one.
fn leaders<const D: usize>(
    vertices: &[Point<D>],
    ends: &[u32],
    tolerance: f64,
) -> HashMap<u32, u32> {
    let at = |index: u32| vertices[index as usize];
    let cell = |p: Point<D>| p.0.map(|x| (x / tolerance).floor());
    let key = |cell: [f64; D]| cell.map(f64::to_bits);
    let mut firsts: HashMap<[u64; D], Vec<u32>> = HashMap::new();
    let mut leaders = HashMap::new();
    for &end in ends {
        let here = cell(at(end));
        let mut nearest: Option<(f64, u32)> = None;
        for step in 0..3_usize.pow(D as u32) {
            // Zero has one sign.
            let beside = std::array::from_fn(|k| {
                here[k] + (step / 3_usize.pow(k as u32) % 3) as f64 - 1.0 + 0.0
            });
            for &first in firsts.get(&key(beside)).into_iter().flatten() {
                let apart = (at(first) - at(end)).norm();
                if apart <= tolerance && nearest.is_none_or(|(least, _)| apart < least) {
                    nearest = Some((apart, first));
                }
            }
        }
        match nearest {
            Some((_, leader)) => drop(leaders.insert(end, leader)),
            None => firsts.entry(key(here.map(|x| x + 0.0))).or_default().push(end),
        }
    }
    leaders
}

/// How far apart copies of one corner may be, by their rounding and by the shortest edge [m].
fn usual_tolerance<const N: usize, const D: usize>(
    vertices: &[Point<D>],
    elements: &[[u32; N]],
    rounding: f64,
) -> f64 {
    let largest =
        elements.iter().flatten().flat_map(|index| vertices[*index as usize].0.map(f64::abs));
    let largest = largest.fold(0.0, f64::max);
    let by_rounding = ROUNDINGS * rounding * largest;
    let least = by_rounding.max(NO_EDGE * largest);
    let shortest = shortest_edge(vertices, elements, least).map_or(0.0, |edge| edge.length);
    // Never so far that an edge would be lost.
    by_rounding.max(SHARE * shortest).min(0.25 * shortest)
}

/// An edge of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ShortEdge<const D: usize> {
    pub(crate) ends: [Point<D>; 2],
    pub(crate) length: f64,
}

/// The shortest edge that is longer than `least` [m].
pub(crate) fn shortest_edge<const N: usize, const D: usize>(
    vertices: &[Point<D>],
    elements: &[[u32; N]],
    least: f64,
) -> Option<ShortEdge<D>> {
    let edge = |element: &[u32; N], i: usize| {
        let ends = [element[i], element[(i + 1) % N]].map(|index| vertices[index as usize]);
        ShortEdge { ends, length: (ends[1] - ends[0]).norm() }
    };
    let edges = elements.iter().flat_map(|element| (0..N).map(move |i| edge(element, i)));
    let longer = edges.filter(|edge| edge.length > least);
    longer.min_by(|a, b| a.length.total_cmp(&b.length))
}

/// The rounding of coordinates, relative to the largest: that of single precision where all are such numbers, of a text
/// with few digits where all have no more, else that of double precision.
pub(crate) fn rounding_of<const D: usize>(vertices: &[Point<D>]) -> f64 {
    let coordinates = || vertices.iter().flat_map(|vertex| vertex.0);
    let is_single = coordinates().all(|x| f64::from(x as f32) == x);
    let has_digits = |digits: usize| {
        coordinates().all(|x| {
            let text = format!("{x:.*e}", digits - 1);
            if is_single {
                text.parse::<f32>().is_ok_and(|read| read == x as f32)
            } else {
                text.parse::<f64>().is_ok_and(|read| read == x)
            }
        })
    };
    let precise = if is_single { SINGLE_ROUNDING } else { DOUBLE };
    if has_digits(DIGITS.start() - 1) {
        return precise;
    }
    let of_text = DIGITS.into_iter().find(|digits| has_digits(*digits));
    of_text.map_or(precise, |digits| precise.max(0.5 * 0.1_f64.powi(digits as i32 - 1)))
}
