// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Files of every format: one tetrahedron in all of them, real meshes, and files that are
//! cut off, altered or made of noise.

#[expect(unreachable_pub, reason = "shared with the fuzz target")]
#[path = "../../../../fuzz/mesh_bytes.rs"]
mod mesh_bytes;

use palpate_field::Vector;
use palpate_mesh::{Format, MeshError, ReadProblem, TriangleMesh, read, read_file};
use palpate_testkit::cases;

use crate::samples::{all, glb, of_nodes};

/// The corners of a mesh's triangles, whatever its vertices are called.
fn corners(mesh: &TriangleMesh) -> Vec<[[f64; 3]; 3]> {
    (0..mesh.elements().len()).map(|i| mesh.corners(i).map(|p| p.0)).collect()
}

#[test]
fn one_tetrahedron_is_the_same_in_every_format() {
    let samples = all();
    let first = read(&samples[0].1, samples[0].0).unwrap();
    assert_eq!(first.report().enclosed, Some(1.0));
    for (format, bytes) in samples {
        let mesh = read(&bytes, format).unwrap();
        assert_eq!(corners(&mesh), corners(&first), "{format:?}");
        assert!(mesh.report().is_watertight());
        assert_eq!(mesh.report().vertices, 4);
    }
}

#[test]
fn formats_are_known_by_their_content() {
    for (format, bytes) in all() {
        assert_eq!(Format::of_content(&bytes), Some(format));
    }
    for other in ["", "{ \"palpate\": 1 }", "x_m,y_m\n0,1\n", "solid ground\n", "v\n"] {
        assert_eq!(Format::of_content(other.as_bytes()), None, "{other}");
    }
}

#[test]
fn objects_groups_textures_and_signs_of_obj_are_understood() {
    let text = "# a comment\nmtllib none.mtl\no one\nv 0 0 0 1 0 0\nv 1 0 0\n\
                v 1 1 0 # another\nv 0 1 0\nvt 0 0\nvn 0 0 1\ng a\nusemtl red\n\
                f 1/1/1 2//1 3/1\\\n 4\nv 0 0 5\nv 7 7 7\no two\nf -6 -5 -2\nl 1 2\n";
    let mesh = read(text.as_bytes(), Format::Obj).unwrap();
    assert_eq!(mesh.elements().len(), 3);
    assert_eq!(mesh.corners(2).map(|p| p.0), [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.0, 5.0]]);
    let report = mesh.report();
    assert_eq!((report.vertices, report.unreferenced), (6, 1));
}

#[test]
fn a_text_file_may_hold_several_solids_without_names() {
    let facet = |z: i32| {
        format!(
            "solid\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 {z}\n   vertex 1 0 {z}\n   \
             vertex 0 1 {z}\n  endloop\n endfacet\nendsolid\n"
        )
    };
    let mesh = read((facet(0) + &facet(1)).as_bytes(), Format::Stl).unwrap();
    assert_eq!((mesh.elements().len(), mesh.vertices().len()), (2, 6));
}

#[test]
fn nodes_of_glb_move_turn_and_mirror_what_they_show() {
    // Within the first node, which doubles, a second moves; a third mirrors.
    let nodes = r#"{"scale":[2,2,2],"children":[1]},{"translation":[1,0,0],"mesh":0},
                   {"scale":[-1,1,1],"mesh":0}"#;
    let mesh = read(&of_nodes(nodes, "0,2"), Format::Glb).unwrap();
    assert_eq!(mesh.elements().len(), 8);
    assert_eq!(mesh.vertices()[1], Vector([4.0, 0.0, 0.0]));
    assert_eq!(mesh.vertices()[5], Vector([-1.0, 0.0, 0.0]));
    // Doubled, eight times the volume; mirrored, turned over so that it is positive too.
    assert_eq!(mesh.report().enclosed, Some(9.0));
}

#[test]
fn a_node_in_two_places_is_refused() {
    for nodes in [r#"{"children":[1]},{"children":[0]}"#, r#"{"children":[1,1]},{"mesh":0}"#] {
        let wrong = read(&of_nodes(nodes, "0"), Format::Glb).unwrap_err().to_string();
        assert!(wrong.contains("in two places"), "{wrong}");
    }
}

#[test]
fn real_meshes_are_what_they_are() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../testdata/meshes");
    let load = |name: &str| read_file(format!("{folder}/{name}.ply")).unwrap();
    let counts = |mesh: &TriangleMesh| (mesh.vertices().len(), mesh.elements().len());

    // File, vertices, triangles, what it encloses, summed up in fractions.
    for (name, vertices, elements, enclosed) in [
        ("nut", 523, 1046, 32_171.322_236_985_983),
        ("bunny", 1839, 3674, 194.288_371_256_762_2),
        ("ant", 486, 912, 482.143_627_889_193_4),
    ] {
        let mesh = load(name);
        assert_eq!(counts(&mesh), (vertices, elements));
        let report = mesh.report();
        assert!(report.is_watertight() && report.degenerate == 0, "{name}: {report:?}");
        assert_eq!((report.unreferenced, report.coincident, report.duplicates), (0, 0, 0));
        let off = report.enclosed.unwrap() - enclosed;
        assert!(off.abs() < 1e-9 * enclosed.abs(), "{name}: {report:?}");
    }
    let airplane = load("airplane");
    assert_eq!(counts(&airplane), (1335, 2452));
    let report = airplane.report();
    assert_eq!((report.boundary, report.non_manifold, report.inconsistent), (223, 1, 0));
    assert_eq!(report.enclosed, None);
}

#[test]
fn files_that_are_cut_off_are_errors_or_meshes() {
    for (format, bytes) in all() {
        for length in 0..bytes.len() {
            // Some formats end where a shorter file would.
            mesh_bytes::check(&bytes[..length], format);
        }
    }
}

#[test]
fn files_that_were_altered_are_errors_or_meshes() {
    let samples = all();
    cases::check(20000, |u| {
        let (format, mut bytes) = samples[u.choose_index(samples.len())?].clone();
        for _ in 0..u.int_in_range(1..=4)? {
            let place = u.choose_index(bytes.len())?;
            match u.int_in_range(0..=3)? {
                0 => bytes[place] = u.arbitrary()?,
                1 => bytes[place] ^= 1 << u.int_in_range(0..=7)?,
                2 => drop(bytes.drain(place..bytes.len().min(place + 8))),
                // A large count, or a number that is negative.
                _ => {
                    for byte in bytes.iter_mut().skip(place).take(4) {
                        *byte = if byte.is_ascii_digit() { b'9' } else { 0xff };
                    }
                }
            }
            if bytes.is_empty() {
                break;
            }
        }
        mesh_bytes::check(&bytes, format);
        Ok(Ok(()))
    });
}

#[test]
fn noise_is_an_error() {
    cases::check(2000, |u| {
        let count = u.int_in_range(0..=400)?;
        let mut bytes = vec![0; count];
        u.fill_buffer(&mut bytes)?;
        for format in [Format::Obj, Format::Stl, Format::Ply, Format::Glb] {
            if mesh_bytes::check(&bytes, format).is_some() {
                return Ok(Err(format!("{bytes:?} is a mesh in {format:?}")));
            }
        }
        Ok(Ok(()))
    });
}

/// A binary STL may start as a text does. Cut off, it was read as one, and the complaint quoted
/// all of it. Found by fuzzing.
#[test]
fn a_complaint_does_not_quote_a_whole_file() {
    let mut stl = b"solid\nfacet".to_vec();
    stl.resize(100_000, 0xe5);
    let wrong = read(&stl, Format::Stl).unwrap_err().to_string();
    assert!(wrong.starts_with("it is no good STL: ") && wrong.len() < 300, "{wrong}");
    assert!(wrong.ends_with("…\"; export it again"), "{wrong}");
}

#[test]
fn counts_that_no_file_holds_take_no_memory() {
    let ply = "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\n\
               property float x\nproperty float y\nproperty float z\nend_header\n";
    let wrong = read(ply.as_bytes(), Format::Ply).unwrap_err().to_string();
    assert!(wrong.contains("hold no 4000000000 rows of \"vertex\""), "{wrong}");
    let nothing = "ply\nformat ascii 1.0\nelement face 9\nend_header\n";
    assert!(matches!(
        read(nothing.as_bytes(), Format::Ply),
        Err(ReadProblem::Malformed { format: "PLY", .. })
    ));
    let mut stl = vec![0; 84];
    stl[80..].copy_from_slice(&u32::MAX.to_le_bytes());
    assert!(matches!(read(&stl, Format::Stl), Err(ReadProblem::Malformed { .. })));
    let accessor = r#"{"componentType":5126,"count":4000000000,"type":"VEC3","bufferView":0,
                      "min":[0,0,0],"max":[1,1,1]}"#;
    let wrong =
        read(&glb(accessor, r#"{"mesh":0}"#, "0"), Format::Glb).unwrap_err().to_string();
    assert!(wrong.contains("place 4000000000 vertices"), "{wrong}");
}

#[test]
fn errors_say_which_file_and_what_to_do() {
    let missing = read_file("no/such/file.stl").unwrap_err();
    assert!(missing.to_string().starts_with("no/such/file.stl: it cannot be read: "));
    let other = read_file("model.fbx").unwrap_err();
    assert_eq!(
        other.to_string(),
        "model.fbx: the ending \"fbx\" is none of .obj, .stl, .ply, .glb and .gltf: convert the file"
    );
    let empty = read(b"v 0 0 0\nv 1 0 0\n", Format::Obj).unwrap_err();
    assert!(matches!(empty, ReadProblem::Mesh(MeshError::Empty { vertices: 2 })), "{empty:?}");
    let outside = read(b"v 0 0 0\nv 1 0 0\nf 1 2 4\n", Format::Obj).unwrap_err();
    assert_eq!(
        outside.to_string(),
        "it is no good OBJ: line 3: a face names vertex 4, and there are 2; export it again"
    );
    let nan = read(b"v 0 0 0\nv 1 nan 0\nv 1 1 1\nf 1 2 3\n", Format::Obj).unwrap_err();
    assert_eq!(
        nan.to_string(),
        "it is no good OBJ: line 2: a coordinate is a finite number of at most 1e15 in size, got \
         \"nan\"; export it again"
    );
}

/// What is wrong with a file, after "it is no good FORMAT: ".
#[expect(clippy::unwrap_used, reason = "a test that cannot be set up fails")]
fn wrong(bytes: &[u8], format: Format) -> String {
    let wrong = read(bytes, format).unwrap_err().to_string();
    let wrong = wrong.strip_prefix(&format!("it is no good {}: ", format.name()));
    wrong.unwrap().strip_suffix("; export it again").unwrap().to_owned()
}

#[test]
fn errors_of_text_name_their_line() {
    for (text, expected) in [
        ("v 0 0 0\nv 1 0\n", "line 2: a vertex has 3 coordinates, got 2"),
        (
            "v 0 0 0\nv 1 0,5 0\n",
            "line 2: a coordinate is a finite number of at most 1e15 in size, got \"0,5\"",
        ),
        (
            "v 0 0 0\nf 1 0 x\n",
            "line 2: a corner is the number of a vertex, counted from 1, got \"0\"",
        ),
        ("v 0 0 0\n\nf 1 1\n", "line 3: a face has 3 corners or more, got 2"),
        ("v 0 0 0\nf 1 1 -2\n", "line 2: a face names vertex -2, and 1 are before it"),
        // Two lines that are one.
        (
            "v 0 0 0\nv 0 0 \\\n0\nv 0 x 0\n",
            "line 4: a coordinate is a finite number of at most 1e15 in size, got \"x\"",
        ),
        (
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2",
            "line 4: a face has 3 corners or more, got 2; the file ends there: it may be cut off",
        ),
    ] {
        assert_eq!(wrong(text.as_bytes(), Format::Obj), expected);
    }
    let facet = " facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 0 1 0\n  endloop\n endfacet\n";
    let two = format!(
        "solid a\n{facet}endsolid a\nsolid b\n{}endsolid b\n",
        facet.replace("1 0 0\n   v", "1 x 0\n   v")
    );
    assert_eq!(
        wrong(two.as_bytes(), Format::Stl),
        "line 14: a coordinate is a finite number of at most 1e15 in size, got \"x\""
    );
    let cut = format!("solid a\n{facet}{}", &facet[..60]);
    let said = wrong(cut.as_bytes(), Format::Stl);
    assert_eq!(said, "line 12: the file ends before a coordinate of a facet: it is cut off");
    // Capitals, and the mark of an editor, were taken for binary files that are cut off.
    let one = format!("solid a\n{facet}{facet}endsolid a\n");
    for text in [one.to_ascii_uppercase(), format!("\u{feff}{one}")] {
        let mesh = read(text.as_bytes(), Format::Stl).unwrap();
        assert_eq!(mesh.elements().len(), 2, "{text}");
    }
    let marked = "\u{feff}v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    assert_eq!(read(marked.as_bytes(), Format::Obj).unwrap().vertices().len(), 3);
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
               element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 oops\n0 1 0\n3 0 1 2\n";
    let said = wrong(ply.as_bytes(), Format::Ply);
    assert!(said.starts_with("line 11: "), "{said}");
    // The parser keeps one of two properties of a name, and drops rows that are not counted.
    let twice = ply.replace("property float y\n", "property float x\nproperty float y\n");
    let said = wrong(twice.as_bytes(), Format::Ply);
    assert_eq!(said, "line 5: a second property \"x\"");
    let more = format!("{}1 0 0\n3 2 1 0\n", ply.replace("oops", "0"));
    let said = wrong(more.as_bytes(), Format::Ply);
    assert_eq!(said, "line 14: 13 bytes follow the last row that its header counts");
    let cut = ply.replace("oops\n0 1 0\n3 0 1 2\n", "0\n");
    let said = wrong(cut.as_bytes(), Format::Ply);
    assert!(said.ends_with("; the file ends there: it is cut off"), "{said}");
}

#[test]
fn errors_of_binary_files_name_their_byte() {
    for (format, bytes) in all() {
        let is_text = std::str::from_utf8(&bytes).is_ok_and(|text| text.contains("\n"));
        if is_text && format != Format::Glb {
            continue;
        }
        let cut = &bytes[..bytes.len() - 7];
        let said = wrong(cut, format);
        assert!(said.contains("cut off"), "{format:?}: {said}");
        assert!(said.contains("byte "), "{format:?}: {said}");
    }
    let mut stl = vec![0; 84];
    stl[80] = 3;
    assert_eq!(
        wrong(&stl, Format::Stl),
        "byte 80: 3 triangles are counted, which take 234 bytes, and the file ends at byte 84: it is \
         cut off"
    );
}

/// The words of the parsers for files that are cut off helped nobody.
#[test]
fn files_that_end_in_their_head_are_told_in_words() {
    let folder = std::env::temp_dir();
    let head = b"ply\nformat binary_little_endian 1.0\nelement vertex 8\nproperty float x\nproperty fl";
    for (ending, bytes) in [("ply", &head[..]), ("stl", &[7; 60][..])] {
        let file = folder.join(format!("palpate-cut-head-{}.{ending}", std::process::id()));
        std::fs::write(&file, bytes).unwrap();
        let said = palpate_mesh::read_file(&file).unwrap_err().to_string();
        std::fs::remove_file(&file).unwrap();
        assert!(!said.contains("ParseError") && !said.contains("buffer"), "{said}");
        assert!(said.contains(ending.to_uppercase().as_str()), "{said}");
    }
}
