// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A tetrahedron of volume 1 in every format.

use palpate_mesh::Format;

pub(crate) mod gltf;

const VERTICES: [[f32; 3]; 4] =
    [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]];
const FACES: [[u16; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];

/// All of them.
pub(crate) fn all() -> Vec<(Format, Vec<u8>)> {
    let positions = r#"{"componentType":5126,"count":4,"type":"VEC3","bufferView":0,
                       "min":[0,0,0],"max":[1,2,3]}"#;
    vec![
        (Format::Obj, obj().into_bytes()),
        (Format::Stl, stl_text().into_bytes()),
        (Format::Stl, stl_binary(b"made by a program")),
        (Format::Stl, stl_binary(b"solid in name alone")),
        (Format::Ply, ply_text().into_bytes()),
        (Format::Ply, ply_binary("little", |x| x.to_le_bytes(), |i| i.to_le_bytes())),
        (Format::Ply, ply_binary("big", |x| x.to_be_bytes(), |i| i.to_be_bytes())),
        (Format::Glb, glb(positions, r#"{"mesh":0}"#, "0")),
    ]
}

/// The GLB with other nodes, of which `roots` are in its scene.
pub(crate) fn of_nodes(nodes: &str, roots: &str) -> Vec<u8> {
    let positions = r#"{"componentType":5126,"count":4,"type":"VEC3","bufferView":0,
                       "min":[0,0,0],"max":[1,2,3]}"#;
    glb(positions, nodes, roots)
}

fn obj() -> String {
    let vertices = VERTICES.map(|[x, y, z]| format!("v {x} {y} {z}\n"));
    let faces = FACES.map(|face| {
        let [a, b, c] = face.map(|i| i + 1);
        format!("f {a} {b} {c}\n")
    });
    vertices.concat() + &faces.concat()
}

fn stl_text() -> String {
    let facets = FACES.map(|face| {
        let [a, b, c] = face.map(|i| {
            let [x, y, z] = VERTICES[usize::from(i)];
            format!("   vertex {x} {y} {z}\n")
        });
        format!(" facet normal 0 0 0\n  outer loop\n{a}{b}{c}  endloop\n endfacet\n")
    });
    format!("solid tetrahedron\n{}endsolid tetrahedron\n", facets.concat())
}

fn stl_binary(header: &[u8]) -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes[..header.len()].copy_from_slice(header);
    bytes.extend(4_u32.to_le_bytes());
    for face in FACES {
        bytes.extend([0; 12]);
        for x in face.iter().flat_map(|i| VERTICES[usize::from(*i)]) {
            bytes.extend(x.to_le_bytes());
        }
        bytes.extend([0; 2]);
    }
    bytes
}

fn ply_header(format: &str) -> String {
    format!(
        "ply\nformat {format} 1.0\ncomment of tests\nelement vertex 4\nproperty float x\n\
         property float y\nproperty float z\nelement face 4\n\
         property list uchar ushort vertex_indices\nend_header\n"
    )
}

fn ply_text() -> String {
    let vertices = VERTICES.map(|[x, y, z]| format!("{x} {y} {z}\n"));
    let faces = FACES.map(|[a, b, c]| format!("3 {a} {b} {c}\n"));
    ply_header("ascii") + &vertices.concat() + &faces.concat()
}

fn ply_binary(order: &str, float: fn(f32) -> [u8; 4], index: fn(u16) -> [u8; 2]) -> Vec<u8> {
    let mut bytes = ply_header(&format!("binary_{order}_endian")).into_bytes();
    bytes.extend(VERTICES.as_flattened().iter().flat_map(|x| float(*x)));
    for face in FACES {
        bytes.push(3);
        bytes.extend(face.iter().flat_map(|i| index(*i)));
    }
    bytes
}

/// A GLB with these positions and nodes, of which `roots` are in its scene.
pub(crate) fn glb(positions: &str, nodes: &str, roots: &str) -> Vec<u8> {
    let mut json = format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[{roots}]}}],
        "nodes":[{nodes}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
        "accessors":[{positions},{{"componentType":5123,"count":12,"type":"SCALAR","bufferView":1}}],
        "bufferViews":[{{"buffer":0,"byteLength":48}},{{"buffer":0,"byteOffset":48,"byteLength":24}}],
        "buffers":[{{"byteLength":72}}]}}"#
    )
    .into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut data: Vec<u8> =
        VERTICES.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
    data.extend(FACES.as_flattened().iter().flat_map(|i| i.to_le_bytes()));
    let length = 12 + 8 + json.len() + 8 + data.len();
    let mut bytes = b"glTF".to_vec();
    bytes.extend(2_u32.to_le_bytes());
    bytes.extend((length as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", &json), (b"BIN\0", &data)] {
        bytes.extend((chunk.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(chunk);
    }
    bytes
}
