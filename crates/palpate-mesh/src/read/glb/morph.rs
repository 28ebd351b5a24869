// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The vertices and triangles of a mesh, with its morph targets at their weights
//! (glTF 2.0, section 3.7.2.2).

use std::collections::{HashMap, HashSet};

use super::data::Data;
use super::document::{Attributes, Mesh, Primitive, Whole};
use super::limits::Count;
use super::{extensions, malformed};
use crate::read::ReadProblem;

/// How corners make triangles: one after the other, in a strip or in a fan.
const TRIANGLES: usize = 4;
const STRIP: usize = 5;
const FAN: usize = 6;

/// A mesh before a node places it.
#[derive(Default)]
pub(super) struct Model {
    pub(super) vertices: Vec<[f64; 3]>,
    pub(super) triangles: Vec<[u32; 3]>,
}

/// What the vertices of a primitive follow from: primitives that agree in it share them.
type Morphed<'a> = (Whole, &'a [Attributes]);

/// A primitive that has triangles.
struct Part<'a> {
    primitive: &'a Primitive,
    mode: usize,
    positions: Whole,
}

/// The primitives of a mesh that have triangles; points and lines are left out.
fn parts<'a>(mesh: &'a Mesh) -> impl Iterator<Item = Result<Part<'a>, ReadProblem>> {
    mesh.primitives.iter().filter_map(|primitive| {
        let mode = primitive.mode.map_or(TRIANGLES, Whole::get);
        let positions = primitive.attributes.position?;
        match mode {
            TRIANGLES | STRIP | FAN => Some(Ok(Part { primitive, mode, positions })),
            0..TRIANGLES => None,
            _ => Some(Err(malformed(format_args!("a primitive has the mode {mode}, above 6")))),
        }
    })
}

/// How much a mesh holds.
pub(super) fn count(mesh: &Mesh, data: &Data<'_>) -> Result<Count, ReadProblem> {
    let mut count = Count { primitives: mesh.primitives.len(), ..Count::default() };
    let mut known = HashSet::new();
    for part in parts(mesh) {
        let Part { primitive, mode, positions } = part?;
        let vertices = data.accessor(positions)?.count.get();
        let corners = match primitive.indices {
            None => vertices,
            Some(indices) => data.accessor(indices)?.count.get(),
        };
        count.triangles = count.triangles.saturating_add(match mode {
            TRIANGLES => corners / 3,
            _ => corners.saturating_sub(2),
        });
        let morphed: Morphed<'_> = (positions, &primitive.targets);
        if known.insert(morphed) {
            count.vertices = count.vertices.saturating_add(vertices);
        }
    }
    Ok(count)
}

/// A mesh at these weights.
pub(super) fn model(
    mesh: &Mesh,
    weights: &[f64],
    data: &Data<'_>,
) -> Result<Model, ReadProblem> {
    let mut model = Model::default();
    // Where the vertices of primitives begin, and how many they are.
    let mut known: HashMap<Morphed<'_>, (usize, usize)> = HashMap::new();
    for part in parts(mesh) {
        let part = part?;
        let morphed: Morphed<'_> = (part.positions, &part.primitive.targets);
        let (first, count) = match known.get(&morphed) {
            Some(range) => *range,
            None => {
                let positions = part.vertices(weights, data)?;
                let range = (model.vertices.len(), positions.len());
                model.vertices.extend(positions);
                known.insert(morphed, range);
                range
            }
        };
        let corners = match part.primitive.indices {
            None => (0..count as u32).collect(),
            Some(indices) if data.is_filled(indices)? => data.indices(indices)?,
            Some(indices) => return Err(empty(part.primitive, indices)),
        };
        if let Some(corner) = corners.iter().find(|corner| **corner as usize >= count) {
            return Err(malformed(format_args!(
                "a triangle names vertex {corner} of {count}, counted from 0"
            )));
        }
        let moved = |triangle: [u32; 3]| triangle.map(|corner| corner + first as u32);
        model.triangles.extend(triangles(part.mode, &corners).into_iter().map(moved));
    }
    Ok(model)
}

impl Part<'_> {
    /// The positions with the displacements of all targets, each times its weight.
    fn vertices(&self, weights: &[f64], data: &Data<'_>) -> Result<Vec<[f64; 3]>, ReadProblem> {
        let (index, targets) = (self.positions, &self.primitive.targets);
        if !data.is_filled(index)? {
            return Err(empty(self.primitive, index));
        }
        let beyond = weights.get(targets.len()..).unwrap_or_default();
        if beyond.iter().any(|weight| *weight != 0.0) {
            return Err(malformed(format_args!(
                "a primitive has {} morph targets, and its mesh or node {} weights",
                targets.len(),
                weights.len()
            )));
        }
        let mut positions = data.items(index, "positions")?;
        for (target, weight) in targets.iter().zip(weights) {
            let Some(target) = target.position.filter(|_| *weight != 0.0) else { continue };
            let (count, found) = (positions.len(), data.accessor(target)?.count.get());
            if found != count {
                return Err(malformed(format_args!(
                    "a morph target moves {found} vertices of {count}"
                )));
            }
            let moves = data.items::<3>(target, "displacements of a morph target")?;
            for (position, by) in positions.iter_mut().zip(moves) {
                *position = std::array::from_fn(|axis| position[axis] + weight * by[axis]);
            }
        }
        Ok(positions)
    }
}

/// The complaint that an accessor of a primitive has no numbers.
fn empty(primitive: &Primitive, accessor: Whole) -> ReadProblem {
    if primitive.is_draco() {
        extensions::draco()
    } else {
        malformed(format_args!("accessor {accessor} has no data"))
    }
}

/// The triangles of corners.
fn triangles(mode: usize, corners: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        STRIP => {
            let turned = |(i, t): (usize, &[u32; 3])| match i % 2 {
                0 => *t,
                _ => [t[1], t[0], t[2]],
            };
            corners.array_windows().enumerate().map(turned).collect()
        }
        FAN => corners
            .get(1..)
            .unwrap_or_default()
            .array_windows()
            .map(|&[b, c]| [corners[0], b, c])
            .collect(),
        _ => corners.as_chunks::<3>().0.to_vec(),
    }
}
