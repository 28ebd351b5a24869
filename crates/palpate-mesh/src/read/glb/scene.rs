// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The triangles of a scene, where nodes and their instances put them.

use palpate_field::Point;

use super::affine::{Affine, Parts};
use super::data::{Data, found};
use super::document::{Instancing, Mesh, Node, Whole};
use super::limits::{Count, Limits};
use super::malformed;
use super::morph::{self, Model};
use crate::mesh::TriangleMesh;
use crate::read::ReadProblem;

/// What is placed of a document.
pub(super) struct Scene<'a> {
    data: &'a Data<'a>,
    vertices: Vec<Point<3>>,
    triangles: Vec<[u32; 3]>,
}

/// A mesh at a node.
struct Placement<'a> {
    mesh: &'a Mesh,
    /// The number of the mesh.
    index: Whole,
    node: &'a Node,
    world_from_node: Affine,
}

impl<'a> Scene<'a> {
    pub(super) fn new(data: &'a Data<'a>) -> Self {
        Self { data, vertices: Vec::new(), triangles: Vec::new() }
    }

    /// Places the nodes of the default scene, or of the first, or all that are in no other.
    /// What is too much is refused before it takes memory.
    pub(super) fn place_all(&mut self, limits: &Limits) -> Result<(), ReadProblem> {
        let placements = self.placements()?;
        limits.check(self.count(&placements)?)?;
        for placement in placements {
            self.place(&placement)?;
        }
        Ok(())
    }

    pub(super) fn mesh(self) -> Result<TriangleMesh, ReadProblem> {
        Ok(TriangleMesh::new(self.vertices, self.triangles)?)
    }

    fn roots(&self) -> Result<Vec<Whole>, ReadProblem> {
        let document = self.data.document;
        if let Some(index) = document.scene {
            return Ok(found(&document.scenes, index, "scene")?.nodes.clone());
        }
        if let Some(scene) = document.scenes.first() {
            return Ok(scene.nodes.clone());
        }
        let mut is_child = vec![false; document.nodes.len()];
        for child in document.nodes.iter().flat_map(|node| &node.children) {
            found(&document.nodes, *child, "node")?;
            is_child[child.get()] = true;
        }
        let all = (0..document.nodes.len()).filter(|node| !is_child[*node]);
        // Each number is that of a node in memory, and so is a whole number of 32 bits.
        Ok(all.filter_map(|node| Whole::try_from(node as f64).ok()).collect())
    }

    /// The meshes of all nodes that are shown, parents first.
    fn placements(&self) -> Result<Vec<Placement<'a>>, ReadProblem> {
        let document = self.data.document;
        let mut placements = Vec::new();
        let mut is_placed = vec![false; document.nodes.len()];
        let mut open: Vec<_> =
            self.roots()?.into_iter().rev().map(|root| (root, Affine::IDENTITY)).collect();
        while let Some((index, world_from_parent)) = open.pop() {
            let node = found(&document.nodes, index, "node")?;
            if std::mem::replace(&mut is_placed[index.get()], true) {
                return Err(malformed(format_args!("node {index} is in two places")));
            }
            let visibility = node.extensions.as_ref().and_then(|all| all.visibility.as_ref());
            if visibility.is_some_and(|visibility| !visibility.visible) {
                continue;
            }
            let world_from_node = world_from_parent.after(&affine(node, index)?);
            if let Some(index) = node.mesh {
                if node.skin.is_some() {
                    let advice = "export the mesh as it stands";
                    return Err(ReadProblem::Unsupported { what: "skins", advice });
                }
                let mesh = found(&document.meshes, index, "mesh")?;
                placements.push(Placement { mesh, index, node, world_from_node });
            }
            open.extend(node.children.iter().rev().map(|child| (*child, world_from_node)));
        }
        Ok(placements)
    }

    /// How much the placements hold.
    fn count(&self, placements: &[Placement<'_>]) -> Result<Count, ReadProblem> {
        let mut known = vec![None; self.data.document.meshes.len()];
        let mut total = Count::default();
        for placement in placements {
            let index = placement.index.get();
            let count = match known[index] {
                Some(count) => count,
                None => *known[index].insert(morph::count(placement.mesh, self.data)?),
            };
            let places: usize = match placement.instancing() {
                None => 1,
                Some(instancing) => places(instancing, self.data)?,
            };
            // A mesh is read even if no instance shows it.
            let places = places.max(1);
            total = total.plus(count, places);
        }
        Ok(total)
    }

    fn place(&mut self, placement: &Placement<'_>) -> Result<(), ReadProblem> {
        let Placement { mesh, node, world_from_node, .. } = placement;
        // The weights of a node take the place of those of its mesh.
        let weights = if node.weights.is_empty() { &mesh.weights } else { &node.weights };
        let model = morph::model(mesh, weights, self.data)?;
        let Some(instancing) = placement.instancing() else {
            self.append(&model, world_from_node);
            return Ok(());
        };
        // An empty mesh may be in more places than can be counted one by one.
        if !model.triangles.is_empty() {
            for node_from_instance in instances(instancing, self.data)? {
                self.append(&model, &world_from_node.after(&node_from_instance));
            }
        }
        Ok(())
    }

    fn append(&mut self, model: &Model, world_from_model: &Affine) {
        let first = self.vertices.len() as u32;
        self.vertices.extend(model.vertices.iter().map(|p| world_from_model.apply(*p)));
        // A map that mirrors turns triangles over.
        let is_mirrored = world_from_model.is_mirrored();
        self.triangles.extend(model.triangles.iter().map(|&[a, b, c]| {
            let triangle = if is_mirrored { [a, c, b] } else { [a, b, c] };
            triangle.map(|corner| corner + first)
        }));
    }
}

impl<'a> Placement<'a> {
    fn instancing(&self) -> Option<&'a Instancing> {
        self.node.extensions.as_ref()?.instancing.as_ref()
    }
}

/// Where a node is in its parent.
fn affine(node: &Node, index: Whole) -> Result<Affine, ReadProblem> {
    if let Some(columns) = &node.matrix {
        return Ok(Affine::of_columns(columns));
    }
    let default = Parts::IDENTITY;
    let parts = Parts {
        translation: node.translation.as_deref().copied().unwrap_or(default.translation),
        rotation: node.rotation.as_deref().copied().unwrap_or(default.rotation),
        scale: node.scale.as_deref().copied().unwrap_or(default.scale),
    };
    let problem = || malformed(format_args!("the rotation of node {index} is zero"));
    Affine::of_parts(&parts).ok_or_else(problem)
}

/// In how many places instances put a mesh.
fn places(instancing: &Instancing, data: &Data<'_>) -> Result<usize, ReadProblem> {
    let mut counts = Vec::new();
    for accessor in instancing.attributes.values() {
        counts.push(data.accessor(*accessor)?.count.get());
    }
    let Some(first) = counts.first().copied() else {
        return Err(malformed("EXT_mesh_gpu_instancing has no attributes"));
    };
    match counts.iter().find(|count| **count != first) {
        None => Ok(first),
        Some(other) => Err(malformed(format_args!(
            "attributes of EXT_mesh_gpu_instancing have {first} and {other} items"
        ))),
    }
}

/// Where instances are in their node (`EXT_mesh_gpu_instancing`).
fn instances(instancing: &Instancing, data: &Data<'_>) -> Result<Vec<Affine>, ReadProblem> {
    let attribute = |name: &str| instancing.attributes.get(name).copied();
    let translations = attribute("TRANSLATION").map(|index| data.items(index, "TRANSLATION"));
    let rotations = attribute("ROTATION").map(|index| data.items(index, "ROTATION"));
    let scales = attribute("SCALE").map(|index| data.items(index, "SCALE"));
    let (translations, rotations, scales) =
        (translations.transpose()?, rotations.transpose()?, scales.transpose()?);
    let mut maps = Vec::new();
    for i in 0..places(instancing, data)? {
        let default = Parts::IDENTITY;
        let parts = Parts {
            translation: translations.as_ref().map_or(default.translation, |all| all[i]),
            rotation: rotations.as_ref().map_or(default.rotation, |all| all[i]),
            scale: scales.as_ref().map_or(default.scale, |all| all[i]),
        };
        let problem = || malformed(format_args!("the rotation of instance {i} is zero"));
        maps.push(Affine::of_parts(&parts).ok_or_else(problem)?);
    }
    Ok(maps)
}
