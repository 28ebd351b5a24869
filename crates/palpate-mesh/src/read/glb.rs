// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Binary glTF 2.0, with gltf.
//!
//! That crate parses and validates the description of the scene. What the description
//! says of the data behind it is checked here, as its readers trust it.

use gltf::accessor::{DataType, Dimensions};
use gltf::mesh::Mode;
use gltf::{Accessor, Document, Gltf, Node, Primitive, Semantic, buffer};
use palpate_field::{Point, Vector};

use super::Format;
use super::ReadProblem;
use crate::mesh::TriangleMesh;

/// Bytes before the first chunk, and before what it holds.
const HEADER: u32 = 12;
const JSON: u32 = 20;

/// Nodes may show one mesh in many places, so that a small file is a large scene: the most
/// vertices and the most corners of triangles that are placed.
const MOST_PLACED: usize = 1 << 25;

/// An affine map: three rows of four.
type Affine = [[f64; 4]; 3];

pub(super) fn read(bytes: &[u8]) -> Result<TriangleMesh, ReadProblem> {
    let length = bytes.get(8..12).and_then(|length| length.first_chunk::<4>());
    let length = length.map_or(0, |length| u32::from_le_bytes(*length));
    if !bytes.starts_with(b"glTF") || length < HEADER {
        return Err(malformed("it does not begin as binary glTF does"));
    }
    if length as usize > bytes.len() {
        let found = bytes.len();
        return Err(malformed(format_args!(
            "byte 8: the file should have {length} bytes, and ends at byte {found}: it is cut off"
        )));
    }
    let Gltf { document, blob } =
        Gltf::from_slice_without_validation(bytes).map_err(malformed_json)?;
    let document = validated(document)?;
    let mut scene = Scene { blob: blob.unwrap_or_default(), ..Scene::default() };
    scene.place_all(&document)?;
    Ok(TriangleMesh::new(scene.vertices, scene.triangles)?)
}

/// The document, if it agrees with itself. The validation of gltf 1.4 itself takes for
/// granted that primitives name accessors that exist.
fn validated(document: Document) -> Result<Document, ReadProblem> {
    let json = document.into_json();
    let primitives = json.meshes.iter().flat_map(|mesh| &mesh.primitives);
    for accessor in primitives.flat_map(|primitive| primitive.attributes.values()) {
        let (accessor, count) = (accessor.value(), json.accessors.len());
        if accessor >= count {
            let problem = format!("a mesh names accessor {accessor}, and there are {count}");
            return Err(malformed_json(problem));
        }
    }
    Document::from_json(json).map_err(malformed_json)
}

/// What is wrong with the description of the scene.
fn malformed_json(problem: impl std::fmt::Display) -> ReadProblem {
    malformed(format_args!("in the JSON from byte {JSON} on: {problem}"))
}

fn malformed(problem: impl std::fmt::Display) -> ReadProblem {
    Format::Glb.malformed(problem)
}

/// What was placed so far.
#[derive(Default)]
struct Scene {
    blob: Vec<u8>,
    vertices: Vec<Point<3>>,
    triangles: Vec<[u32; 3]>,
    /// How many primitives, those that are left out too.
    primitives: usize,
}

impl Scene {
    /// Places the nodes of the default scene, or of the first, or all that are in no other.
    fn place_all(&mut self, document: &Document) -> Result<(), ReadProblem> {
        let identity =
            std::array::from_fn(|i| std::array::from_fn(|k| f64::from(u8::from(i == k))));
        let scene = document.default_scene().or_else(|| document.scenes().next());
        let mut open: Vec<(Node<'_>, Affine)> = match scene {
            Some(scene) => scene.nodes().map(|node| (node, identity)).collect(),
            None => {
                let mut is_child = vec![false; document.nodes().len()];
                for child in document.nodes().flat_map(|node| node.children()) {
                    is_child[child.index()] = true;
                }
                let roots = document.nodes().filter(|node| !is_child[node.index()]);
                roots.map(|node| (node, identity)).collect()
            }
        };
        open.reverse();
        let mut is_placed = vec![false; document.nodes().len()];
        while let Some((node, world_from_parent)) = open.pop() {
            let index = node.index();
            if std::mem::replace(&mut is_placed[index], true) {
                return Err(malformed(format_args!("node {index} is in two places")));
            }
            let world_from_node = product(&world_from_parent, &affine(&node));
            if let Some(mesh) = node.mesh() {
                if node.skin().is_some() {
                    let advice = "export the mesh as it stands";
                    return Err(ReadProblem::Unsupported { what: "skins", advice });
                }
                for primitive in mesh.primitives() {
                    self.place(&primitive, &world_from_node)?;
                }
            }
            let first = open.len();
            open.extend(node.children().map(|child| (child, world_from_node)));
            open[first..].reverse();
        }
        Ok(())
    }

    /// Places the triangles of a primitive; points and lines are left out.
    fn place(
        &mut self,
        primitive: &Primitive<'_>,
        world_from_node: &Affine,
    ) -> Result<(), ReadProblem> {
        self.primitives += 1;
        if self.primitives > MOST_PLACED {
            let problem = format!("its nodes place more than {MOST_PLACED} primitives");
            return Err(malformed(problem));
        }
        let mode = primitive.mode();
        if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
            return Ok(());
        }
        let Some(positions) = primitive.get(&Semantic::Positions) else { return Ok(()) };
        if positions.data_type() != DataType::F32 || positions.dimensions() != Dimensions::Vec3
        {
            return Err(malformed("positions are not three 32-bit floats each"));
        }
        let first = self.vertices.len();
        let count = positions.count();
        let named = primitive.indices().map_or(count, |indices| indices.count());
        let corners = self.triangles.len().saturating_mul(3).saturating_add(named);
        if first.saturating_add(count).max(corners) > MOST_PLACED {
            let problem = format!("its nodes place more than {MOST_PLACED} vertices");
            return Err(malformed(problem));
        }
        for bytes in items(&positions, &self.blob)? {
            let coordinate = |k: usize| f64::from(f32::from_le_bytes(chunk(bytes, 4 * k)));
            let p = [coordinate(0), coordinate(1), coordinate(2)];
            self.vertices.push(Vector(
                world_from_node
                    .map(|[x, y, z, offset]| x * p[0] + y * p[1] + z * p[2] + offset),
            ));
        }
        let corners = match primitive.indices() {
            None => (0..count as u32).collect(),
            Some(indices) => self.indices(&indices)?,
        };
        // A node that mirrors turns its triangles over.
        let is_mirrored = determinant(world_from_node) < 0.0;
        for [a, b, c] in triangles(mode, &corners) {
            let [a, b, c] = if is_mirrored { [a, c, b] } else { [a, b, c] };
            let mut triangle = [a, b, c];
            for corner in &mut triangle {
                if *corner as usize >= count {
                    let problem =
                        format!("a triangle names vertex {corner} of {count}, counted from 0");
                    return Err(malformed(problem));
                }
                *corner += first as u32;
            }
            self.triangles.push(triangle);
        }
        Ok(())
    }

    fn indices(&self, accessor: &Accessor<'_>) -> Result<Vec<u32>, ReadProblem> {
        let items = items(accessor, &self.blob)?;
        Ok(match (accessor.data_type(), accessor.dimensions()) {
            (DataType::U8, Dimensions::Scalar) => {
                items.map(|item| u32::from(item[0])).collect()
            }
            (DataType::U16, Dimensions::Scalar) => {
                items.map(|item| u32::from(u16::from_le_bytes(chunk(item, 0)))).collect()
            }
            (DataType::U32, Dimensions::Scalar) => {
                items.map(|item| u32::from_le_bytes(chunk(item, 0))).collect()
            }
            _ => return Err(malformed("indices are not unsigned integers")),
        })
    }
}

/// The bytes of each item of an accessor, all within the file.
fn items<'a>(
    accessor: &Accessor<'_>,
    blob: &'a [u8],
) -> Result<impl Iterator<Item = &'a [u8]> + use<'a>, ReadProblem> {
    if accessor.sparse().is_some() {
        let advice = "export without them";
        return Err(ReadProblem::Unsupported { what: "sparse accessors", advice });
    }
    let view = accessor.view().ok_or_else(|| malformed("an accessor has no data"))?;
    if matches!(view.buffer().source(), buffer::Source::Uri(_)) {
        let advice = "export everything into one .glb";
        return Err(ReadProblem::Unsupported { what: "buffers outside the file", advice });
    }
    let (size, count) = (accessor.size(), accessor.count());
    let stride = view.stride().unwrap_or(size).max(1);
    let end = view.offset().checked_add(view.length());
    let within = end.and_then(|end| blob.get(view.offset()..end)).and_then(|data| {
        let last = count.saturating_sub(1).checked_mul(stride)?;
        let length = if count == 0 { 0 } else { last.checked_add(size)? };
        data.get(accessor.offset()..)?.get(..length)
    });
    let data = within.ok_or_else(|| {
        let (index, bytes) = (accessor.index(), blob.len());
        malformed(format_args!("accessor {index} goes past the {bytes} bytes of data"))
    })?;
    Ok((0..count).map(move |i| &data[i * stride..i * stride + size]))
}

/// `N` bytes from `start` on, which the size of an item holds.
fn chunk<const N: usize>(bytes: &[u8], start: usize) -> [u8; N] {
    let mut chunk = [0; N];
    chunk.copy_from_slice(&bytes[start..start + N]);
    chunk
}

/// The corners of triangles, one after the other, in a strip or in a fan.
fn triangles(mode: Mode, corners: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        Mode::TriangleStrip => {
            let turned = |(i, t): (usize, &[u32; 3])| match i % 2 {
                0 => *t,
                _ => [t[1], t[0], t[2]],
            };
            corners.array_windows().enumerate().map(turned).collect()
        }
        Mode::TriangleFan => corners
            .get(1..)
            .unwrap_or_default()
            .array_windows()
            .map(|&[b, c]| [corners[0], b, c])
            .collect(),
        _ => corners.as_chunks::<3>().0.to_vec(),
    }
}

fn affine(node: &Node<'_>) -> Affine {
    // Columns of four, of which the last row is that of an affine map.
    let columns = node.transform().matrix();
    std::array::from_fn(|i| std::array::from_fn(|k| f64::from(columns[k][i])))
}

/// The map that applies `b` first.
fn product(a: &Affine, b: &Affine) -> Affine {
    a.map(|row| {
        std::array::from_fn(|k| {
            let moved: f64 = (0..3).map(|j| row[j] * b[j][k]).sum();
            if k == 3 { moved + row[3] } else { moved }
        })
    })
}

fn determinant(m: &Affine) -> f64 {
    let minor = |i: usize, j: usize| m[1][i] * m[2][j] - m[1][j] * m[2][i];
    m[0][0] * minor(1, 2) + m[0][1] * minor(2, 0) + m[0][2] * minor(0, 1)
}
