// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! OBJ, with tobj.
//!
//! Only vertices and faces matter here. They alone are passed on, without texture and
//! normal indices, so that all objects share their vertices and nothing else can be wrong.
//! Each vertex is passed on once more as a point, since tobj drops those without a face.

use std::fmt::Write;

use palpate_field::Vector;

use super::ReadProblem;
use super::{Format, of_polygons};
use crate::mesh::TriangleMesh;

pub(super) fn read(bytes: &[u8]) -> Result<TriangleMesh, ReadProblem> {
    let options = tobj::LoadOptions::default();
    let no_material = |_: &std::path::Path| Err(tobj::LoadError::GenericFailure);
    let essence = essence(bytes);
    let (models, _) = tobj::load_obj_buf(&mut essence.as_bytes(), &options, no_material)
        .map_err(|error| Format::Obj.malformed(error))?;
    let Some(model) = models.into_iter().next() else {
        return Err(crate::MeshError::Empty { vertices: 0 }.into());
    };
    let (coordinates, _) = model.mesh.positions.as_chunks::<3>();
    let vertices = coordinates.iter().map(|&point| Vector(point)).collect();
    // The points come last. tobj leaves arities out if all faces are triangles.
    let sizes = &model.mesh.face_arities;
    let faces = sizes.iter().position(|&size| size == 1).unwrap_or(sizes.len());
    of_polygons(vertices, &sizes[..faces], &model.mesh.indices, Format::Obj)
}

/// `true` if the first lines of a file that are no comments have a vertex.
pub(super) fn is_likely(bytes: &[u8]) -> bool {
    /// Objects, groups and materials may come before the first vertex.
    const SOON: usize = 20;
    let lines = bytes.split(|byte| *byte == b'\n').filter_map(|line| str::from_utf8(line).ok());
    let lines = lines.map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'));
    let is_vertex = |line: &str| {
        let mut words = line.split_whitespace();
        words.next() == Some("v")
            && words.filter(|word| word.parse::<f64>().is_ok()).count() >= 3
    };
    lines.take(SOON).any(is_vertex)
}

/// The positions and faces of a file.
fn essence(bytes: &[u8]) -> String {
    let text = String::from_utf8_lossy(bytes).replace("\\\r\n", " ").replace("\\\n", " ");
    let mut essence = String::with_capacity(text.len());
    let mut vertices = 0_usize;
    for line in text.lines() {
        let mut words = line.split('#').next().unwrap_or_default().split_whitespace();
        match words.next() {
            Some("v") => {
                vertices += 1;
                // Of what comes after the coordinates, one number is a weight and three
                // are a colour.
                let numbers: Vec<_> = words.collect();
                let kept = if numbers.len() == 4 { 4 } else { numbers.len().min(3) };
                essence.push_str("v ");
                essence.push_str(&numbers[..kept].join(" "));
                essence.push('\n');
            }
            Some("f") => {
                essence.push('f');
                for word in words {
                    essence.push(' ');
                    essence.push_str(word.split('/').next().unwrap_or_default());
                }
                essence.push('\n');
            }
            _ => {}
        }
    }
    for i in 1..=vertices {
        // Writing to a string does not fail.
        let _ = writeln!(essence, "f {i}");
    }
    essence
}
