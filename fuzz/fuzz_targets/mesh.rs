// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Reading a mesh from any bytes, the first of which says in which format.

#![no_main]

use palpate_mesh::Format;

#[path = "../mesh_bytes.rs"]
mod mesh_bytes;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    if let [format, bytes @ ..] = data {
        let formats = [Format::Obj, Format::Stl, Format::Ply, Format::Glb];
        mesh_bytes::check(bytes, formats[*format as usize % formats.len()]);
    }
});
