// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What must hold for any bytes that are read as a mesh.

use palpate_mesh::{Format, TriangleMesh, read};

/// Reads `bytes` as a mesh and checks what came of it; the mesh, if it is one.
///
/// # Panics
///
/// If reading panics, an error says nothing or too much, or a mesh is none.
pub fn check(bytes: &[u8], format: Format) -> Option<TriangleMesh> {
    let mesh = match read(bytes, format) {
        Ok(mesh) => mesh,
        Err(problem) => {
            let text = problem.to_string();
            assert!((10..2_000).contains(&text.len()), "{text}");
            return None;
        }
    };
    let count = mesh.elements().len();
    for i in 0..count {
        for corner in mesh.corners(i) {
            assert!(mesh.bounds().contains(corner), "{corner:?} of {i} is out of bounds");
        }
    }
    let mut order = mesh.tree().order().to_vec();
    order.sort_unstable();
    assert!(order.iter().copied().eq(0..count as u32), "its tree has other triangles");
    let report = mesh.report();
    assert_eq!((report.elements, report.vertices), (count, mesh.vertices().len()));
    assert!(report.surface.is_finite() && report.surface >= 0.0, "{report:?}");
    assert!(report.degenerate <= count && report.duplicates < count, "{report:?}");
    Some(mesh)
}
