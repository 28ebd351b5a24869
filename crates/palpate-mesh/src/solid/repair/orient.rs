// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Faces turned outwards; doubled faces and sheets.

use std::cell::OnceCell;
use std::collections::HashMap;

use palpate_field::{Aabb, Point, Vector};

use super::super::across;
use super::super::faces::Boxes;
use super::super::winding::{Groups, share};
use super::crossing::PiecesThatCross;
use super::has_same_direction;
use super::rims::{Side, by_rim, pieces, root, sides};
use crate::report::signed_volume;
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

/// What a patch of doubled elements is, by the other elements at its border.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Patch {
    /// An even number at each rim of its border: a wall between two volumes.
    Wall,
    /// None at all, and it is not closed: a sheet with two sides.
    Free,
    /// Else: a surface that is there twice.
    Surface,
}

/// The doubled elements.
pub(super) struct Doubled {
    /// The elements with the same vertices.
    pub(super) groups: Vec<Vec<usize>>,
    /// Whether all elements are doubled.
    pub(super) are_all: bool,
    /// Of each group, the first group of its patch, and of that, what the patch is.
    first: Vec<usize>,
    patches: Vec<Patch>,
}

impl Doubled {
    pub(super) fn of<const N: usize>(elements: &[[u32; N]]) -> Self {
        let mut copies: HashMap<[u32; N], Vec<usize>> = HashMap::new();
        for (i, element) in elements.iter().enumerate() {
            let mut key = *element;
            key.sort_unstable();
            copies.entry(key).or_default().push(i);
        }
        let mut groups: Vec<_> = copies.into_values().filter(|same| same.len() > 1).collect();
        groups.sort_unstable();
        let mut of_element = vec![None; elements.len()];
        for (group, same) in groups.iter().enumerate() {
            same.iter().for_each(|element| of_element[*element] = Some(group));
        }
        let mut first: Vec<usize> = (0..groups.len()).collect();
        // Of each rim of a group: the group, how many others it has, and whether it is the only group there.
        let mut rims = Vec::new();
        for at_rim in by_rim(&sides(elements)) {
            let all = at_rim.iter().map(|side| of_element[side.element as usize]);
            let mut here: Vec<usize> = all.flatten().collect();
            let others = at_rim.len() - here.len();
            here.sort_unstable();
            here.dedup();
            let Some(group) = here.first() else { continue };
            for other in &here[1..] {
                let [a, b] = [*group, *other].map(|group| root(&mut first, group));
                first[a.max(b)] = a.min(b);
            }
            rims.push((*group, others, here.len() == 1));
        }
        let first: Vec<usize> = (0..groups.len()).map(|i| root(&mut first, i)).collect();
        let mut borders = vec![Border::default(); groups.len()];
        for (group, others, is_alone) in rims {
            let border = &mut borders[first[group]];
            border.is_odd |= !others.is_multiple_of(2);
            border.has_others |= others > 0;
            border.is_open |= others == 0 && is_alone;
        }
        let patches = borders.iter().map(Border::patch).collect();
        let are_all = of_element.iter().all(Option::is_some);
        Self { groups, are_all, first, patches }
    }

    /// What the patch of a group is.
    pub(super) fn patch_of(&self, group: usize) -> Patch {
        self.patches[self.first[group]]
    }
}

/// The border of a patch.
#[derive(Clone, Copy, Debug, Default)]
struct Border {
    /// Whether a rim has an odd number of other elements.
    is_odd: bool,
    /// Whether a rim has other elements.
    has_others: bool,
    /// Whether a rim has nothing but one group.
    is_open: bool,
}

impl Border {
    fn patch(&self) -> Patch {
        match self {
            Self { is_odd: false, has_others: true, .. } => Patch::Wall,
            Self { has_others: false, is_open: true, .. } => Patch::Free,
            _ => Patch::Surface,
        }
    }
}

/// What has caps larger than this share of its faces is a sheet.
const SHEET: f64 = 0.9;

/// Of each element of a closed mesh, whether it is of a membrane: a sheet within the solid of all that are none, or a
/// face and the cap that mirrors it; `None` if the whole is a sheet. `caps` tells of each element the opening that it closes.
///
/// A sheet that lies elsewhere stays, and what closes it: it may be all there is of a wing.
pub(super) fn membranes<const N: usize, const D: usize>(
    vertices: &[Point<D>],
    elements: &[[u32; N]],
    caps: &[Option<usize>],
) -> Option<Vec<bool>> {
    let corners = |element: &[u32; N]| element.map(|index| vertices[index as usize]);
    let (of_element, count) = pieces(vertices, elements);
    // Of each piece, the area of its faces and of its caps [m²], twice; in the plane the lengths [m].
    let mut areas = vec![[0.0; 2]; count];
    for ((element, piece), cap) in elements.iter().zip(&of_element).zip(caps) {
        areas[*piece][usize::from(cap.is_some())] += across(&corners(element)).norm();
    }
    let is_sheet = |[own, caps]: &[f64; 2]| *caps > SHEET * own;
    if is_sheet(&areas.iter().fold([0.0; 2], |[a, b], [c, d]| [a + c, b + d])) {
        return None;
    }
    let mut is_membrane: Vec<bool> = areas.iter().map(is_sheet).collect();
    if is_membrane.contains(&true) {
        let with_pieces = || elements.iter().zip(&of_element).zip(caps);
        let rest: Vec<_> = with_pieces()
            .filter(|((_, piece), _)| !is_membrane[**piece])
            .map(|((element, _), _)| corners(element))
            .collect();
        let rest = Groups::new(&rest);
        for ((element, piece), cap) in with_pieces() {
            if is_membrane[*piece] && cap.is_none() {
                let middle = corners(element)
                    .iter()
                    .fold(Vector::ZERO, |sum, corner| sum + *corner * (1.0 / N as f64));
                is_membrane[*piece] = rest.goes_around(middle);
            }
        }
    }
    let is_mirrored = mirrored(elements);
    let with_pieces = of_element.iter().zip(is_mirrored);
    Some(with_pieces.map(|(piece, is_mirrored)| is_mirrored || is_membrane[*piece]).collect())
}

/// Of each element, whether another with the same vertices faces it, as a cap the one face that it closes: between
/// the two is nothing.
fn mirrored<const N: usize>(elements: &[[u32; N]]) -> Vec<bool> {
    // Of each set of vertices, those elements that pass them in either direction and have found none that faces them.
    let mut waiting: HashMap<[u32; N], [Vec<usize>; 2]> = HashMap::new();
    let mut is_mirrored = vec![false; elements.len()];
    for (i, element) in elements.iter().enumerate() {
        let mut key = *element;
        key.sort_unstable();
        let way = usize::from(has_same_direction(element, key));
        let waiting = waiting.entry(key).or_default();
        if let Some(other) = waiting[1 - way].pop() {
            (is_mirrored[i], is_mirrored[other]) = (true, true);
        } else {
            waiting[way].push(i);
        }
    }
    is_mirrored
}
