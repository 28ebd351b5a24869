// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Elements that agree on the inside, and pieces whose inside is within.

use std::cell::OnceCell;

use palpate_field::{Aabb, Point, Vector};

use super::crossing::PiecesThatCross;
use super::rims::{Side, by_rim, pieces, sides};
use crate::report::signed_volume;
use crate::solid::across;
use crate::solid::boxes::Boxes;
use crate::solid::winding::{Groups, share};
use crate::tree::{BallTree, FAN};

/// Turns elements so that the two at each rim of two agree on the inside. A piece keeps the direction that
/// most of its elements have.
///
/// Returns how many elements were turned, and of how many pieces no directions agree: they are one-sided, as
/// a Möbius strip.
pub(super) fn agree<const N: usize>(elements: &mut [[u32; N]]) -> (usize, usize) {
    let sides = sides(elements);
    // Of each element the neighbours at rims of two, and whether they agree now.
    let mut neighbours = vec![[(u32::MAX, false); N]; elements.len()];
    for at_rim in by_rim(&sides) {
        if let [a, b] = at_rim {
            let agree = a.is_forward != b.is_forward;
            let mut join = |a: &Side, b: &Side| {
                neighbours[a.element as usize][a.number as usize] = (b.element, agree);
            };
            join(a, b);
            join(b, a);
        }
    }
    // Whether each element is to be turned.
    let mut turns: Vec<Option<bool>> = vec![None; elements.len()];
    let (mut turned, mut one_sided) = (0, 0);
    let mut piece = Vec::new();
    for first in 0..elements.len() {
        if turns[first].is_some() {
            continue;
        }
        turns[first] = Some(false);
        piece.clear();
        piece.push(first);
        let (mut next, mut is_one_sided) = (0, false);
        while next < piece.len() {
            let element = piece[next];
            next += 1;
            for (neighbour, agree) in neighbours[element] {
                if neighbour == u32::MAX {
                    continue;
                }
                let neighbour = neighbour as usize;
                // Where both agree, both are turned or neither.
                let wanted = turns[element].map(|is_turned| is_turned == agree);
                if turns[neighbour].is_none() {
                    turns[neighbour] = wanted;
                    piece.push(neighbour);
                } else {
                    is_one_sided |= turns[neighbour] != wanted;
                }
            }
        }
        one_sided += usize::from(is_one_sided);
        let count = piece.iter().filter(|element| turns[**element] == Some(true)).count();
        // Of a tie, the first element stays.
        let is_other = 2 * count > piece.len();
        turned += if is_other { piece.len() - count } else { count };
        for &element in &piece {
            if turns[element] == Some(!is_other) {
                turn(&mut elements[element]);
            }
        }
    }
    (turned, one_sided)
}

fn turn<const N: usize>(element: &mut [u32; N]) {
    element.swap(0, 1);
}

/// So many elements of a piece tell whether it lies in another.
const SAMPLES: usize = 3;

/// How far behind an element a sample is, as a share of its size: elements may lie on those of another piece, where the
/// winding number tells nothing.
const BEHIND: f64 = 1e-6;

/// Of a piece of more elements the winding number is summed by groups.
const MANY: usize = 64;

/// A piece, and how it lies to the others.
#[derive(Debug)]
struct Piece<const N: usize, const D: usize> {
    elements: Vec<usize>,
    bounds: Aabb<D>,
    /// What it encloses [m³], in the plane [m²]: negative if its normals point inwards.
    volume: f64,
    /// Points within it.
    samples: [Point<D>; SAMPLES],
    /// Made when first asked for.
    winding: OnceCell<Groups<N, D>>,
}

/// How the pieces of a mesh lie to each other.
#[derive(Debug, Default)]
pub(in crate::solid) struct Pieces {
    /// Of each element, the number of its piece.
    pub(in crate::solid) of_element: Vec<usize>,
    /// Which pieces are cavities: their normals point inwards.
    pub(in crate::solid) is_cavity: Vec<bool>,
    /// How many pieces lie right inside a piece with the same orientation.
    pub(in crate::solid) nested: usize,
    /// How many pieces were inside out.
    pub(in crate::solid) turned: usize,
}

/// Turns pieces that are inside out, with all that lie within them: those with a negative volume that lie
/// within no other. A piece that crosses another does not lie within it.
pub(super) fn outwards<const N: usize, const D: usize>(
    vertices: &[Point<D>],
    elements: &mut [[u32; N]],
) -> Pieces {
    let (of_element, count) = pieces(vertices, elements);
    let corners = |element: &[u32; N]| element.map(|index| vertices[index as usize]);
    let mut members = vec![Vec::new(); count];
    for (element, piece) in of_element.iter().enumerate() {
        members[*piece].push(element);
    }
    let all: Vec<Piece<N, D>> = members
        .into_iter()
        .map(|members| Piece::of(members, |element| corners(&elements[element])))
        .collect();
    let mut meet = PiecesThatCross::default();
    if count > 1 && all.iter().any(|piece| piece.volume < 0.0) {
        meet = PiecesThatCross::of(vertices, elements, &of_element);
    }
    let around = around(&all, &meet, |element| corners(&elements[element]));
    let is_turned = |i: usize| all[*around[i].last().unwrap_or(&i)].volume < 0.0;
    let is_cavity: Vec<bool> =
        (0..count).map(|i| (all[i].volume < 0.0) != is_turned(i)).collect();
    let is_alike =
        |i: &usize| around[*i].first().is_some_and(|k| is_cavity[*k] == is_cavity[*i]);
    let nested = (0..count).filter(is_alike).count();
    let mut turned = 0;
    for i in (0..count).filter(|i| is_turned(*i)) {
        all[i].elements.iter().for_each(|element| turn(&mut elements[*element]));
        turned += 1;
    }
    Pieces { of_element, is_cavity, nested, turned }
}

/// The pieces around each, the smallest first: those that do not cross it and hold most of its samples.
fn around<const N: usize, const D: usize>(
    all: &[Piece<N, D>],
    meet: &PiecesThatCross,
    corners: impl Fn(usize) -> [Point<D>; N],
) -> Vec<Vec<usize>> {
    let size = |i: usize| all[i].volume.abs();
    // A tree of the pieces' boxes, whose diagonals are its elements.
    let ends: Vec<Point<D>> =
        all.iter().flat_map(|piece| [piece.bounds.min, piece.bounds.max]).collect();
    let lines: Vec<[u32; 2]> = (0..all.len() as u32).map(|i| [2 * i, 2 * i + 1]).collect();
    let order = BallTree::new(&ends, &lines).order().to_vec();
    let line = |i: &u32| lines[*i as usize].map(|end| ends[end as usize]);
    let boxes = Boxes::new(&order.iter().map(line).collect::<Vec<_>>());
    (0..all.len())
        .map(|i| {
            let mut holders = Vec::new();
            for p in all[i].samples {
                boxes.overlapping(&Aabb { min: p, max: p }, |group| {
                    for k in order.iter().skip(group * FAN).take(FAN).map(|k| *k as usize) {
                        if k != i
                            && size(k) > size(i)
                            && lies_in(&all[i].bounds, &all[k].bounds)
                            && !meet.cross(i, k)
                            && all[k].goes_around(p, &corners)
                        {
                            holders.push(k);
                        }
                    }
                });
            }
            holders.sort_unstable();
            let mut around: Vec<usize> = holders
                .chunk_by(|a, b| a == b)
                .filter(|same| 2 * same.len() > SAMPLES)
                .map(|same| same[0])
                .collect();
            around.sort_by(|a, b| size(*a).total_cmp(&size(*b)));
            around
        })
        .collect()
}

impl<const N: usize, const D: usize> Piece<N, D> {
    fn of(elements: Vec<usize>, corners: impl Fn(usize) -> [Point<D>; N]) -> Self {
        let all = || elements.iter().map(|element| corners(*element));
        let first = corners(elements[0])[0];
        let bounds = Aabb::around(all().flatten()).unwrap_or(Aabb { min: first, max: first });
        let centre = bounds.centre();
        let volume = all().map(|corners| signed_volume(&corners, centre)).sum();
        let samples = samples(&elements, volume, &corners);
        Self { elements, bounds, volume, samples, winding: OnceCell::new() }
    }

    /// Whether its winding number about a point is not 0.
    fn goes_around(&self, p: Point<D>, corners: impl Fn(usize) -> [Point<D>; N]) -> bool {
        if self.elements.len() <= MANY {
            let number: f64 =
                self.elements.iter().map(|element| share(&corners(*element), p)).sum();
            return number.abs() > 0.5;
        }
        let own = || self.elements.iter().map(|element| corners(*element)).collect::<Vec<_>>();
        self.winding.get_or_init(|| Groups::new(&own())).goes_around(p)
    }
}

/// Points right behind the middles of a few of these elements, within what they enclose: its normals lead out if
/// `volume` is positive.
fn samples<const N: usize, const D: usize>(
    elements: &[usize],
    volume: f64,
    corners: impl Fn(usize) -> [Point<D>; N],
) -> [Point<D>; SAMPLES] {
    std::array::from_fn(|i| {
        let corners = corners(elements[i * (elements.len() - 1) / (SAMPLES - 1)]);
        let out = across(&corners);
        let size = if N == 3 { out.norm().sqrt() } else { out.norm() };
        let behind = out.normalized().unwrap_or(Vector::ZERO) * (BEHIND * size);
        middle(&corners) - behind * volume.signum()
    })
}

/// Whether a box lies within another.
fn lies_in<const D: usize>(inner: &Aabb<D>, outer: &Aabb<D>) -> bool {
    outer.contains(inner.min) && outer.contains(inner.max)
}

fn middle<const N: usize, const D: usize>(corners: &[Point<D>; N]) -> Point<D> {
    corners.iter().fold(Vector::ZERO, |sum, corner| sum + *corner * (1.0 / N as f64))
}
