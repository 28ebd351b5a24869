// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What programs write into glTF beside plain triangles: boxes of 1 × 2 × 3 in many guises.

use palpate_mesh::{Format, TriangleMesh, read};

use crate::samples::gltf::{BOX, CORNERS, Document, TRIANGLES, base64, glb_of};

fn mesh(bytes: &[u8]) -> TriangleMesh {
    read(bytes, Format::Glb).unwrap()
}

fn refusal(bytes: &[u8]) -> String {
    let said = read(bytes, Format::Glb).unwrap_err().to_string();
    for word in ["expected", "invalid", "Unsupported", "serde", "Error", "line 1 column"] {
        assert!(!said.contains(word), "{said}");
    }
    said
}

/// The corners of the box around a mesh, and its volume.
fn extent(bytes: &[u8]) -> ([f64; 3], [f64; 3], f64) {
    let mesh = mesh(bytes);
    let bounds = mesh.bounds();
    (bounds.min.0, bounds.max.0, mesh.report().enclosed.unwrap())
}

/// The mesh of the box with morph targets and weights, shown by one node.
fn morphed(document: &Document, targets: &[usize], weights: &str, node: &str) -> Vec<u8> {
    let targets: Vec<_> =
        targets.iter().map(|target| format!(r#"{{"POSITION":{target}}}"#)).collect();
    let targets = targets.join(",");
    document.glb(&format!(
        r#""nodes":[{{"mesh":0{node}}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1,"targets":[{targets}]}}]{weights}}}]"#
    ))
}

#[test]
fn morph_targets_move_vertices_by_their_weights() {
    let mut document = Document::of_box();
    let along_x = document.floats("VEC3", &[[1.0, 0.0, 0.0]; 8]);
    let along_y = document.floats("VEC3", &[[0.0, 4.0, 0.0]; 8]);
    for (weights, node, start) in [
        ("", "", [0.0, 0.0, 0.0]),
        (r#","weights":[0.5,0]"#, "", [0.5, 0.0, 0.0]),
        (r#","weights":[-1.5,0.25]"#, "", [-1.5, 1.0, 0.0]),
        // Those of a node take the place of those of its mesh.
        (r#","weights":[0.5,0]"#, r#","weights":[0,2]"#, [0.0, 8.0, 0.0]),
        ("", r#","weights":[2]"#, [2.0, 0.0, 0.0]),
    ] {
        let bytes = morphed(&document, &[along_x, along_y], weights, node);
        let end = [start[0] + 1.0, start[1] + 2.0, start[2] + 3.0];
        assert_eq!(extent(&bytes), (start, end, 6.0), "{weights} {node}");
    }
    let more = morphed(&document, &[along_x], r#","weights":[0,1]"#, "");
    assert!(refusal(&more).contains("has 1 morph targets, and its mesh or node 2 weights"));
    let short = document.floats("VEC3", &[[1.0, 0.0, 0.0]; 7]);
    let short = morphed(&document, &[short], r#","weights":[1]"#, "");
    assert!(refusal(&short).contains("a morph target moves 7 vertices of 8"));
}

#[test]
fn sparse_accessors_replace_some_items() {
    // The four corners at the top move, of which the base is zero as it has no view.
    let mut document = Document::of_box();
    let indices = document.view(&[4, 5, 6, 7], "");
    let moves = [[0.0_f32, 0.0, 2.0]; 4];
    let moves: Vec<u8> = moves.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
    let values = document.view(&moves, "");
    let sparse = |count: usize, base: &str| {
        format!(
            r#"{{{base}"componentType":5126,"count":8,"type":"VEC3","sparse":{{"count":{count},"indices":{{"bufferView":{indices},"componentType":5121}},"values":{{"bufferView":{values}}}}}}}"#
        )
    };
    let target = document.accessor(sparse(4, ""));
    let bytes = morphed(&document, &[target], r#","weights":[0.5]"#, "");
    assert_eq!(extent(&bytes), ([0.0; 3], [1.0, 2.0, 4.0], 8.0));
    // Over a base: positions of the box themselves, of which four become (0, 0, 2).
    let positions = document.accessor(sparse(4, r#""bufferView":0,"#));
    let bytes = document.glb(&format!(
        r#""nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":{positions}}},"indices":1}}]}}]"#
    ));
    assert_eq!(mesh(&bytes).vertices()[4].0, [0.0, 0.0, 2.0]);
    assert_eq!(mesh(&bytes).vertices()[2].0, [1.0, 2.0, 0.0]);
    // A target that moves nothing has neither view nor sparse part.
    let nothing = r#"{"componentType":5126,"count":8,"type":"VEC3"}"#;
    let nothing = document.accessor(nothing.to_owned());
    let bytes = morphed(&document, &[nothing], r#","weights":[1]"#, "");
    assert_eq!(extent(&bytes), ([0.0; 3], [1.0, 2.0, 3.0], 6.0));
    let beyond = document.accessor(sparse(4, "").replace(r#""count":8"#, r#""count":6"#));
    let beyond = document.glb(&format!(
        r#""nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":{beyond}}}}}]}}]"#
    ));
    assert!(refusal(&beyond).contains("names item 6, and there are 6"));
}

/// The box at the instances of these attributes.
fn instanced(document: &Document, attributes: &str, node: &str) -> Vec<u8> {
    document.glb(&format!(
        r#""extensionsUsed":["EXT_mesh_gpu_instancing"],"nodes":[{{"mesh":0{node},"extensions":{{"EXT_mesh_gpu_instancing":{{"attributes":{{{attributes}}}}}}}}}],"meshes":[{BOX}]"#
    ))
}

#[test]
fn instances_are_placed_within_their_node() {
    let mut document = Document::of_box();
    let places: [[f32; 3]; 8] = std::array::from_fn(|i| [5.0 * i as f32, 0.0, 0.0]);
    let translation = document.floats("VEC3", &places);
    // A quarter turn about z, as bytes that are normalized; its length is near 1.
    let view = document.view(&[0, 0, 90, 90, 0, 0, 0, 127], "");
    let rotation = document.accessor(format!(
        r#"{{"bufferView":{view},"componentType":5120,"normalized":true,"count":2,"type":"VEC4"}}"#
    ));
    let scale = document.floats("VEC3", &[[2.0, 1.0, 1.0], [-1.0, 1.0, 1.0]]);
    let two = document.floats("VEC3", &[[0.0; 3], [10.0, 0.0, 0.0]]);

    let bytes = instanced(&document, &format!(r#""TRANSLATION":{translation}"#), "");
    assert_eq!(extent(&bytes), ([0.0; 3], [36.0, 2.0, 3.0], 48.0));
    assert_eq!(mesh(&bytes).elements().len(), 96);
    // The node doubles what its instances are.
    let doubled = r#","scale":[2,2,2],"translation":[0,0,1]"#;
    let bytes = instanced(&document, &format!(r#""TRANSLATION":{translation}"#), doubled);
    assert_eq!(extent(&bytes), ([0.0, 0.0, 1.0], [72.0, 4.0, 7.0], 384.0));
    let (min, max, volume) =
        extent(&instanced(&document, &format!(r#""ROTATION":{rotation}"#), ""));
    let near = |a: [f64; 3], b: [f64; 3]| (0..3).all(|i| (a[i] - b[i]).abs() < 1e-14);
    assert!(near(min, [-2.0, 0.0, 0.0]) && near(max, [1.0, 2.0, 3.0]), "{min:?} {max:?}");
    assert!((volume - 12.0).abs() < 1e-13, "{volume}");
    // The second is mirrored, and keeps a positive volume.
    let bytes = instanced(&document, &format!(r#""SCALE":{scale}"#), "");
    assert_eq!(extent(&bytes), ([-1.0, 0.0, 0.0], [2.0, 2.0, 3.0], 18.0));
    let all = format!(r#""TRANSLATION":{two},"ROTATION":{rotation},"SCALE":{scale}"#);
    let (min, max, _) = extent(&instanced(&document, &all, ""));
    assert!(near(min, [-2.0, 0.0, 0.0]) && near(max, [10.0, 2.0, 3.0]), "{min:?} {max:?}");
    // An attribute of another kind counts instances too.
    let ids = document.add("SCALAR", 5121, 3, &[0, 1, 2]);
    let bytes = instanced(&document, &format!(r#""_ID":{ids}"#), "");
    assert_eq!(mesh(&bytes).elements().len(), 36);

    let uneven = format!(r#""TRANSLATION":{two},"_ID":{ids}"#);
    assert!(refusal(&instanced(&document, &uneven, "")).contains("have 2 and 3 items"));
    assert!(refusal(&instanced(&document, "", "")).contains("has no attributes"));
}

#[test]
fn quantized_positions_are_scaled_by_their_node() {
    // Unsigned shorts, normalized, 8 bytes apart: a part of the box's edges.
    let mut document = Document::of_box();
    let shorts = |p: [f32; 3], edges: [f32; 3]| -> Vec<u8> {
        let short = |i: usize| (p[i] / edges[i] * 65535.0) as u16;
        [short(0), short(1), short(2), 7].map(u16::to_le_bytes).concat()
    };
    let bytes: Vec<u8> = CORNERS.iter().flat_map(|p| shorts(*p, [1.0, 2.0, 3.0])).collect();
    let view = document.view(&bytes, r#","byteStride":8"#);
    let shorts = document.accessor(format!(
        r#"{{"bufferView":{view},"componentType":5123,"normalized":true,"count":8,"type":"VEC3"}}"#
    ));
    // Signed bytes that are not normalized, and bytes that move them along z.
    let whole: Vec<u8> =
        CORNERS.iter().flat_map(|p| [p[0] as u8, p[1] as u8, p[2] as u8, 0]).collect();
    let view = document.view(&whole, r#","byteStride":4"#);
    let bytes = document.accessor(format!(
        r#"{{"bufferView":{view},"componentType":5120,"count":8,"type":"VEC3"}}"#
    ));
    let view = document.view(&[0, 0, 0xfe, 0].repeat(8), r#","byteStride":4"#);
    let moves = document.accessor(format!(
        r#"{{"bufferView":{view},"componentType":5120,"count":8,"type":"VEC3"}}"#
    ));
    let rest = |positions: usize, node: &str, mesh: &str, primitive: &str| {
        format!(
            r#""extensionsRequired":["KHR_mesh_quantization"],"nodes":[{{"mesh":0{node}}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":{positions}}},"indices":1{primitive}}}]{mesh}}}]"#
        )
    };
    let node = r#","scale":[1,2,3],"translation":[10,0,0]"#;
    let file = document.glb(&rest(shorts, node, "", ""));
    assert_eq!(extent(&file), ([10.0, 0.0, 0.0], [11.0, 2.0, 3.0], 6.0));
    let target = format!(r#","targets":[{{"POSITION":{moves}}}]"#);
    let node = r#","scale":[0.5,0.5,0.5]"#;
    let file = document.glb(&rest(bytes, node, r#","weights":[0.5]"#, &target));
    assert_eq!(extent(&file), ([0.0, 0.0, -0.5], [0.5, 1.0, 1.0], 0.75));
}

#[test]
fn extensions_that_only_paint_are_no_obstacle() {
    let document = Document::of_box();
    let requiring = |name: &str| {
        document.glb(&format!(
            r#""extensionsRequired":["{name}"],"nodes":[{{"mesh":0}}],"meshes":[{BOX}]"#
        ))
    };
    for name in [
        "KHR_materials_unlit",
        "KHR_materials_pbrSpecularGlossiness",
        "KHR_texture_transform",
        "KHR_texture_basisu",
        "EXT_texture_webp",
        "KHR_lights_punctual",
        "KHR_xmp_json_ld",
        "MSFT_texture_dds",
        "MSFT_packing_normalRoughnessMetallic",
        "ACME_materials_shine",
        "KHR_animation_pointer",
        "EXT_structural_metadata",
    ] {
        assert_eq!(extent(&requiring(name)), ([0.0; 3], [1.0, 2.0, 3.0], 6.0), "{name}");
    }
    assert_eq!(
        refusal(&requiring("KHR_draco_mesh_compression")),
        "it needs the glTF extension KHR_draco_mesh_compression, which is not read: unpack it, for \
         example with `gltf-transform copy in.glb out.glb`"
    );
    for name in ["EXT_meshopt_compression", "KHR_meshopt_compression"] {
        let said = refusal(&requiring(name));
        assert!(said.contains(name) && said.contains("`gltfpack -noq -i in.glb"), "{said}");
    }
    let said = refusal(&requiring("ACME_terrain"));
    assert!(said.contains("ACME_terrain, which is not read: export without it"), "{said}");
    // What is painted may be of any form: textures without sources, animations of anything.
    let painted = r#""materials":[{"extensions":{"ACME_x":[1,{}]}},7],"textures":[{}],"images":[{}],"animations":[{"channels":[{"target":{"path":"pointer"}}]}],"#;
    let bytes = document.glb(&format!(r#"{painted}"nodes":[{{"mesh":0}}],"meshes":[{BOX}]"#));
    assert_eq!(mesh(&bytes).elements().len(), 12);
}

#[test]
fn data_that_only_an_extension_holds_are_refused_by_its_name() {
    // Neither is required, and neither has other data.
    let mut document = Document::of_box();
    let bare = r#"{"componentType":5126,"count":8,"type":"VEC3"}"#;
    let bare = document.accessor(bare.to_owned());
    let draco = document.glb(&format!(
        r#""nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":{bare}}},"extensions":{{"KHR_draco_mesh_compression":{{"bufferView":0}}}}}}]}}]"#
    ));
    assert!(refusal(&draco).contains("KHR_draco_mesh_compression"));
    let json = document.json(&format!(r#""nodes":[{{"mesh":0}}],"meshes":[{BOX}]"#), "");
    let json = json
        .replacen(
            r#"{"buffer":0,"#,
            r#"{"extensions":{"EXT_meshopt_compression":{"buffer":0}},"buffer":1,"#,
            1,
        )
        .replace(r#""buffers":["#, r#""buffers":[{"byteLength":264},"#);
    let meshopt = glb_of(&[(b"JSON", json.as_bytes()), (b"BIN\0", &document.data)]);
    assert!(refusal(&meshopt).contains("EXT_meshopt_compression"));
}

#[test]
fn strips_fans_and_indices_of_every_type_are_read() {
    let corners = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 3.0, 0.0], [2.0, 3.0, 0.0]];
    let (strip, fan) = ([0_u32, 1, 2, 3], [0_u32, 1, 3, 2]);
    let list = [0_u32, 1, 2, 2, 1, 3];
    for (mode, indices) in [(5, &strip[..]), (6, &fan), (4, &list)] {
        for (code, size) in [(5121, 1), (5123, 2), (5125, 4)] {
            let mut document = Document::default();
            document.floats("VEC3", &corners);
            let bytes: Vec<u8> =
                indices.iter().flat_map(|i| i.to_le_bytes()[..size].to_vec()).collect();
            document.add("SCALAR", code, indices.len(), &bytes);
            let mesh = mesh(&document.glb(&format!(
                r#""nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1,"mode":{mode}}}]}}]"#
            )));
            assert_eq!(mesh.elements().len(), 2, "{mode} {code}");
            for element in 0..2 {
                let [a, b, c] = mesh.corners(element);
                assert_eq!((b - a).cross(c - a).0, [0.0, 0.0, 6.0], "{mode} {code}");
            }
        }
    }
    // Without indices, corners are in the order of the vertices.
    let mut document = Document::default();
    let corners: Vec<_> = TRIANGLES.iter().map(|i| CORNERS[usize::from(*i)]).collect();
    document.floats("VEC3", &corners);
    let bytes = document.glb(
        r#""nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}]"#,
    );
    assert_eq!(mesh(&bytes).welded().report().enclosed, Some(6.0));
}

#[test]
fn scenes_nodes_and_matrices_say_what_is_shown() {
    let document = Document::of_box();
    let nodes = r#""nodes":[{"mesh":0},{"mesh":0,"translation":[10,0,0]},{"children":[3]},{"mesh":0,"matrix":[-2,0,0,0,0,1,0,0,0,0,1,0,0,5,0,1]}]"#;
    for (scenes, min, max, volume) in [
        (
            r#""scene":1,"scenes":[{"nodes":[0]},{"nodes":[1]}]"#,
            [10.0, 0.0, 0.0],
            [11.0, 2.0, 3.0],
            6.0,
        ),
        (r#""scenes":[{"nodes":[0]},{"nodes":[1]}]"#, [0.0; 3], [1.0, 2.0, 3.0], 6.0),
        // A matrix that mirrors turns triangles over.
        (r#""scene":0,"scenes":[{"nodes":[2]}]"#, [-2.0, 5.0, 0.0], [0.0, 7.0, 3.0], 12.0),
        (r#""extras":{}"#, [-2.0, 0.0, 0.0], [11.0, 7.0, 3.0], 24.0),
    ] {
        let bytes = document.glb(&format!(r#"{scenes},{nodes},"meshes":[{BOX}]"#));
        assert_eq!(extent(&bytes), (min, max, volume), "{scenes}");
    }
    // A node that is not shown takes its children with it.
    let hidden = nodes.replacen(
        r#"{"children":[3]}"#,
        r#"{"children":[3],"extensions":{"KHR_node_visibility":{"visible":false}}}"#,
        1,
    );
    let bytes = document.glb(&format!(r#"{hidden},"meshes":[{BOX}]"#));
    assert_eq!(extent(&bytes).2, 12.0);
}

#[test]
fn primitives_may_share_their_vertices() {
    let document = Document::of_box();
    let primitive = r#"{"attributes":{"POSITION":0},"indices":1}"#;
    let mesh = mesh(&document.glb(&format!(
        r#""nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{primitive},{primitive}]}}]"#
    )));
    assert_eq!((mesh.vertices().len(), mesh.elements().len()), (8, 24));
}

#[test]
fn data_may_be_in_texts_and_in_several_buffers() {
    let document = Document::of_box();
    let rest = format!(r#""nodes":[{{"mesh":0}}],"meshes":[{BOX}]"#);
    let uri =
        format!(r#","uri":"data:application/octet-stream;base64,{}""#, base64(&document.data));
    let text = document.json(&rest, &uri);
    let right = ([0.0; 3], [1.0, 2.0, 3.0], 6.0);
    // As text, in whatever file; within a binary file, with chunks of other kinds around it.
    assert_eq!(extent(text.as_bytes()), right);
    assert_eq!(extent(format!("\u{feff}{text}").as_bytes()), right);
    assert_eq!(Format::of_content(text.as_bytes()), Some(Format::Glb));
    let file = glb_of(&[
        (b"JSON", document.json(&rest, "").as_bytes()),
        (b"ABCD", b"1234567"),
        (b"BIN\0", &document.data),
        (b"\0\0\0\x01", b""),
    ]);
    assert_eq!(extent(&file), right);
    // A second buffer within the text.
    let two = document
        .json(&rest, "")
        .replacen(r#"{"buffer":0,"#, r#"{"buffer":1,"#, 1)
        .replace(r#"}],"nodes""#, &format!(r#"}},{{"byteLength":1{uri}}}],"nodes""#));
    let file = glb_of(&[(b"JSON", two.as_bytes()), (b"BIN\0", &document.data)]);
    assert_eq!(extent(&file), right);
    // Elsewhere, or nowhere.
    let outside = refusal(document.json(&rest, r#","uri":"box.bin""#).as_bytes());
    assert!(outside.contains("`gltf-transform copy in.gltf out.glb`"), "{outside}");
    let nowhere = refusal(document.json(&rest, "").as_bytes());
    assert!(nowhere.contains("buffer 0 has no data in the file"), "{nowhere}");
    let wrong = refusal(document.json(&rest, r#","uri":"data:;base64,A!""#).as_bytes());
    assert!(wrong.contains("buffer 0 is no base 64 text"), "{wrong}");
    // Files of this name are read too.
    let name = format!("palpate-box-{}.gltf", std::process::id());
    let path = std::env::temp_dir().join(name);
    std::fs::write(&path, &text).unwrap();
    let found = palpate_mesh::read_file(&path);
    std::fs::remove_file(&path).unwrap();
    assert_eq!(found.unwrap().report().enclosed, Some(6.0));
}

#[test]
fn small_files_of_large_scenes_are_refused() {
    let document = Document::of_box();
    let primitives = vec![r#"{"attributes":{"POSITION":0},"indices":1}"#; 3000].join(",");
    let nodes = |count: usize| vec![r#"{"mesh":0}"#; count].join(",");
    let many = document.glb(&format!(
        r#""nodes":[{}],"meshes":[{{"primitives":[{primitives}]}}]"#,
        nodes(2000)
    ));
    let bytes = many.len();
    assert_eq!(
        refusal(&many),
        format!(
            "its nodes and instances place 72000000 triangles, and a file of {bytes} bytes may place \
             {}: export a part of the scene, or join what lies together",
            (16 * bytes).max(2_097_152)
        )
    );
    // Instances whose places are all zero take no bytes at all.
    let mut endless = Document::of_box();
    let places = r#"{"componentType":5126,"count":4000000000,"type":"VEC3"}"#;
    let places = endless.accessor(places.to_owned());
    let said = refusal(&instanced(&endless, &format!(r#""TRANSLATION":{places}"#), ""));
    assert!(said.contains("48000000000 triangles"), "{said}");
    // An assembly of a thousand boxes is no large scene.
    let screws = document.glb(&format!(r#""nodes":[{}],"meshes":[{BOX}]"#, nodes(1000)));
    assert_eq!(mesh(&screws).elements().len(), 12_000);
}

#[test]
fn what_is_wrong_is_told_in_plain_words() {
    let document = Document::of_box();
    let whole = format!(r#""nodes":[{{"mesh":0}}],"meshes":[{BOX}]"#);
    let json = document.json(&whole, "");
    let changed = |from: &str, to: &str| {
        let json = json.replacen(from, to, 1);
        refusal(&glb_of(&[(b"JSON", json.as_bytes()), (b"BIN\0", &document.data)]))
    };
    for (from, to, part) in [
        (r#""mesh":0"#, r#""mesh":"0""#, "a value there is of the wrong kind"),
        (r#""mesh":0"#, r#""mesh":-1"#, "a value there is of the wrong kind"),
        (r#""mesh":0"#, r#""mesh":0,,"#, "it is no JSON there"),
        (r#""mesh":0"#, r#""mesh":3"#, "it names mesh 3, and there are 1"),
        (r#""POSITION":0"#, r#""POSITION":9"#, "it names accessor 9, and there are 2"),
        (r#""POSITION":0"#, r#""POSITION":1"#, "accessor 1 is used as positions, of type VEC3"),
        (r#""indices":1"#, r#""indices":0"#, "accessor 0 is used as indices"),
        (r#""indices":1"#, r#""mode":9"#, "a primitive has the mode 9"),
        (r#""componentType":5126"#, r#""componentType":5130"#, "numbers of type 5130"),
        (r#""count":8"#, r#""count":9"#, "accessor 0 goes past the bytes of buffer view 0"),
        (r#""bufferView":0"#, r#""bufferView":5"#, "it names buffer view 5, and there are 2"),
        (r#""asset""#, r#""other""#, "its JSON has no `asset`"),
        (r#""version":"2.0""#, r#""version":"1.0""#, "it is glTF \"1.0\""),
        (r#"{"mesh":0}"#, r#"{"mesh":0,"rotation":[0,0,0,0]}"#, "rotation of node 0 is zero"),
        (r#"{"mesh":0}"#, r#"{"mesh":0,"skin":0}"#, "it has skins, which are not read"),
    ] {
        let said = changed(from, to);
        assert!(said.contains(part), "{said}");
    }
    // Numbers that are whole may be written as others.
    let mesh = read(
        &glb_of(&[
            (b"JSON", json.replace(r#""count":8"#, r#""count":8.0"#).as_bytes()),
            (b"BIN\0", &document.data),
        ]),
        Format::Glb,
    );
    assert_eq!(mesh.unwrap().elements().len(), 12);
    let file = document.glb(&whole);
    for end in [3, 10, 40, json.len(), file.len() - 1] {
        let said = refusal(&file[..end]);
        assert!(said.contains("cut off") || said.contains("begins neither"), "{said}");
    }
    let half = refusal(&json.as_bytes()[..json.len() / 2]);
    assert!(half.contains("the JSON ends there: it is cut off"), "{half}");
    let units: Vec<u8> = json.encode_utf16().flat_map(u16::to_le_bytes).collect();
    assert!(refusal(&units).starts_with("it is text in UTF-16LE"));
}
