// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What is written is read again.

use palpate_field::Shape;
use palpate_mesh::{ContourOptions, Format, TriangleMesh, read};

#[test]
fn what_is_written_is_read_again() {
    let shape = Shape::torus(0.3, 0.1).unwrap();
    let mesh = TriangleMesh::of_shape(&shape, &ContourOptions::with_cell(0.023)).unwrap();
    for (format, is_double) in
        [(Format::Obj, true), (Format::Ply, true), (Format::Stl, false), (Format::Glb, false)]
    {
        let mut bytes = Vec::new();
        mesh.write(format, &mut bytes).unwrap();
        assert!(format == Format::Stl || Format::of_content(&bytes) == Some(format));
        let again = read(&bytes, format).unwrap();
        assert!(again.report().is_watertight(), "{format:?}");
        assert_eq!(again.elements().len(), mesh.elements().len());
        for face in 0..mesh.elements().len() {
            for (a, b) in mesh.corners(face).into_iter().zip(again.corners(face)) {
                assert!((a - b).norm() <= if is_double { 0.0 } else { 1e-7 }, "{format:?}");
            }
        }
    }
}
