// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! STL, OBJ and PLY as programs write them: a box of 1 × 2 × 3 in many guises.

use palpate_mesh::{Format, TriangleMesh, read};

use crate::samples::gltf::{CORNERS, TRIANGLES};

/// A text STL of the box, all of whose facets have this normal.
fn stl(normal: &str) -> String {
    let facet = |triangle: &[u16; 3]| {
        let corner = |i: u16| {
            let [x, y, z] = CORNERS[usize::from(i)];
            format!("   vertex {x} {y} {z}\n")
        };
        let corners = triangle.map(corner).concat();
        format!(" facet normal {normal}\n  outer loop\n{corners}  endloop\n endfacet\n")
    };
    let (triangles, _) = TRIANGLES.as_chunks::<3>();
    let facets: String = triangles.iter().map(facet).collect();
    format!("solid cube\n{facets}endsolid cube\n")
}

fn stl_binary(head: &[u8]) -> Vec<u8> {
    let mut bytes = head.to_vec();
    bytes.resize(80, 0);
    bytes.extend(12_u32.to_le_bytes());
    let (triangles, _) = TRIANGLES.as_chunks::<3>();
    for triangle in triangles {
        // Normals that are no numbers.
        bytes.extend([0xff; 12]);
        let corners = triangle.map(|i| CORNERS[usize::from(i)]);
        bytes.extend(corners.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
        bytes.extend([7; 2]);
    }
    bytes
}

fn obj() -> String {
    let vertices = CORNERS.map(|[x, y, z]| format!("v {x} {y} {z}\n")).concat();
    let (triangles, _) = TRIANGLES.as_chunks::<3>();
    let face = |[a, b, c]: &[u16; 3]| format!("f {} {} {}\n", a + 1, b + 1, c + 1);
    vertices + &triangles.iter().map(face).collect::<String>()
}

fn ply() -> String {
    let vertices = CORNERS.map(|[x, y, z]| format!("{x} {y} {z}\n")).concat();
    let (triangles, _) = TRIANGLES.as_chunks::<3>();
    let face = |[a, b, c]: &[u16; 3]| format!("3 {a} {b} {c}\n");
    let faces: String = triangles.iter().map(face).collect();
    format!(
        "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\n\
         property float z\nelement face 12\nproperty list uchar int vertex_indices\nend_header\n\
         {vertices}{faces}"
    )
}

fn is_the_box(mesh: &TriangleMesh) -> bool {
    let report = mesh.report();
    let bounds = mesh.bounds();
    let box_of = (bounds.min.0, bounds.max.0);
    box_of == ([0.0; 3], [1.0, 2.0, 3.0])
        && (report.vertices, report.enclosed) == (8, Some(6.0))
}

fn check(bytes: &[u8], format: Format) {
    let mesh = read(bytes, format).unwrap_or_else(|problem| {
        panic!("{problem}: {}", String::from_utf8_lossy(&bytes[..bytes.len().min(200)]))
    });
    assert!(is_the_box(&mesh), "{}", String::from_utf8_lossy(bytes));
}

fn refusal(bytes: &[u8], format: Format) -> String {
    let said = read(bytes, format).unwrap_err().to_string();
    for word in
        ["expected", "invalid", "Unsupported", "Error", "Invalid", "Couldn't", "String:"]
    {
        assert!(!said.contains(word), "{said}");
    }
    said
}

#[test]
fn texts_of_stl_are_read_as_programs_write_them() {
    let plain = stl("0 0 1");
    for normal in ["NaN NaN NaN", "nan inf -inf", "-1.#IND 0 0", "-nan(ind) 0 0", "0 0", ""] {
        check(stl(normal).as_bytes(), Format::Stl);
    }
    for (from, to) in [
        ("endsolid", "end solid"),
        ("endloop", "end loop"),
        ("endfacet", "end facet"),
        ("endfacet", "End\n  Facet"),
        ("solid cube", "solid cube of steel, 2 x 3"),
        ("solid cube", "solid"),
        ("solid cube\n", "# a comment\n; another\n\n\nsolid cube\n"),
        ("solid cube\n", "written by a program\nsolid cube\n"),
        ("solid cube\n", "   \n\tsolid cube\n"),
        (" facet", "# facet\n // facet\n facet"),
        ("vertex 1 2 3", "vertex 1. +2e+0 3.0E0"),
        ("vertex 0 0 0", "vertex -0 .0e-3 +0."),
        ("\n", "\r\n"),
        ("\n", "\r"),
        ("\n", "\n\n"),
        ("   vertex", " vertex"),
        ("outer loop\n", "outer loop "),
    ] {
        // The end has the name too.
        let times = if from.starts_with("solid") { 1 } else { usize::MAX };
        check(plain.replacen(from, to, times).as_bytes(), Format::Stl);
    }
    check(plain.to_ascii_uppercase().as_bytes(), Format::Stl);
    check(format!("\u{feff}{plain}").as_bytes(), Format::Stl);
    // A name in another encoding.
    let named = plain.replace("solid cube", "solid c\u{e9}").into_bytes();
    let latin: Vec<u8> = named.into_iter().filter(|byte| *byte != 0xc3).collect();
    check(&latin, Format::Stl);
    // The box in two solids, the first of which may lack its end.
    let middle = plain.match_indices(" facet").nth(5).unwrap().0;
    for between in ["endsolid a\nsolid b\n", "end solid\n\nsolid\n", "solid b\n"] {
        let two = format!("{}{between}{}", &plain[..middle], &plain[middle..]);
        check(two.as_bytes(), Format::Stl);
    }
    // A facet without area has a normal that is no number.
    let flat = " facet normal NaN NaN NaN\n outer loop\n vertex 0 0 0\n vertex 1 2 3\n vertex 0 0 0\n endloop\n endfacet\n";
    let with_flat = format!("{}{flat}{}", &plain[..middle], &plain[middle..]);
    let mesh = read(with_flat.as_bytes(), Format::Stl).unwrap();
    assert_eq!((mesh.elements().len(), mesh.report().degenerate), (13, 1));
    assert!(Format::of_content(plain.replace('\n', "\r").as_bytes()) == Some(Format::Stl));
}

#[test]
fn texts_of_stl_that_are_wrong_are_told_by_line() {
    let plain = stl("0 0 1");
    for (from, to, part) in [
        ("vertex 1 2 0", "vertex 1 2,5 0", "line 5: a coordinate is a finite number"),
        ("vertex 0 0 0", "vertex nan 0 0", "line 4: a coordinate is a finite number"),
        ("vertex 0 0 0", "vertex 1e30 0 0", "line 4: a coordinate is a finite number"),
        ("  endloop", "vertex 1 1 1\n  endloop", "line 7: `endloop` should stand there"),
        ("outer loop\n", "", "line 3: `outer loop` should stand there, got \"vertex\""),
        (" facet normal", " face normal", "line 2: `facet` or `endsolid` should stand there"),
        ("endsolid cube\n", "", "the file ends without `endsolid`: it is cut off"),
        ("endsolid cube\n", "endsolid\n facet", "line 87: `solid` should stand there"),
    ] {
        let said = refusal(plain.replacen(from, to, 1).as_bytes(), Format::Stl);
        assert!(said.contains(part), "{said}");
    }
    let cut = refusal(&plain.as_bytes()[..700], Format::Stl);
    assert!(cut.contains("line ") && cut.contains("of a facet: it is cut off"), "{cut}");
}

#[test]
fn binary_stl_is_known_by_its_count() {
    let solid = stl_binary(b"solid made by a program");
    for bytes in
        [stl_binary(b""), solid.clone(), stl_binary(b"\xff\xfe"), stl_binary(b"s\0o\0")]
    {
        check(&bytes, Format::Stl);
        // Bytes that follow are no triangles.
        for rest in [&[1; 2][..], &[b'x'; 49], &[9; 120], &[0; 50]] {
            check(&[&bytes[..], rest].concat(), Format::Stl);
        }
        let more = refusal(&[&bytes[..], &bytes[84..134]].concat(), Format::Stl);
        assert!(more.contains("12 triangles are counted, and 1 more follow"), "{more}");
    }
    let cut = refusal(&solid[..600], Format::Stl);
    assert!(cut.contains("12 triangles are counted, which take 684 bytes"), "{cut}");
}

#[test]
fn texts_may_have_any_line_ends_and_a_mark() {
    for (text, format) in
        [(obj(), Format::Obj), (ply(), Format::Ply), (stl("0 0 1"), Format::Stl)]
    {
        for end in ["\n", "\r\n", "\r"] {
            let text = text.replace('\n', end);
            check(text.as_bytes(), format);
            check(format!("\u{feff}{text}").as_bytes(), format);
            assert_eq!(Format::of_content(text.as_bytes()), Some(format), "{end:?}");
        }
    }
}

#[test]
fn texts_in_utf_16_are_refused_for_that() {
    for (text, format) in
        [(obj(), Format::Obj), (ply(), Format::Ply), (stl("0 0 1"), Format::Stl)]
    {
        for mark in ["", "\u{feff}"] {
            let units: Vec<u16> = format!("{mark}{text}").encode_utf16().collect();
            let little: Vec<u8> = units.iter().flat_map(|unit| unit.to_le_bytes()).collect();
            let big: Vec<u8> = units.iter().flat_map(|unit| unit.to_be_bytes()).collect();
            for (bytes, encoding) in [(little, "UTF-16LE"), (big, "UTF-16BE")] {
                assert_eq!(
                    refusal(&bytes, format),
                    format!(
                        "it is text in {encoding}: save it as UTF-8, for example with \
                         `iconv -f {encoding} -t UTF-8`"
                    )
                );
            }
        }
    }
}

#[test]
fn weights_of_obj_divide() {
    let weighted = obj().replace("v 1 2 3\n", "v 2 4 6 2\n");
    check(weighted.as_bytes(), Format::Obj);
    for weight in ["0", "x", "nan"] {
        let wrong = obj().replace("v 1 2 3\n", &format!("v 2 4 6 {weight}\n"));
        let said = refusal(wrong.as_bytes(), Format::Obj);
        assert!(said.contains("line 7: the weight of a vertex"), "{said}");
    }
}

#[test]
fn a_binary_ply_may_have_a_head_of_other_line_ends() {
    let text = ply().replace("ascii", "binary_little_endian");
    let head = text.split_inclusive("end_header\n").next().unwrap();
    let mut rows: Vec<u8> =
        CORNERS.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
    let (triangles, _) = TRIANGLES.as_chunks::<3>();
    for triangle in triangles {
        rows.push(3);
        rows.extend(triangle.iter().flat_map(|i| u32::from(*i).to_le_bytes()));
    }
    for end in ["\n", "\r\n", "\r"] {
        check(&[head.replace('\n', end).as_bytes(), &rows].concat(), Format::Ply);
    }
    // A coordinate that is no number, of the seventh vertex.
    let nan = f32::NAN.to_le_bytes();
    rows[72..76].copy_from_slice(&nan);
    let said = refusal(&[head.as_bytes(), &rows].concat(), Format::Ply);
    assert!(said.contains("vertex 6 must be finite"), "{said}");
}

#[test]
fn what_is_wrong_with_ply_is_told_in_plain_words() {
    for (from, to, part) in [
        (
            "1 2 3\n",
            "1 nan 3\n",
            "line 16: \"1 nan 3\" is not a row of \"vertex\": float x, float y, float z",
        ),
        (
            "1 2 3\n",
            "1 x 3\n",
            "line 16: \"1 x 3\" is not a row of \"vertex\": float x, float y, float z",
        ),
        ("1 2 3\n", "1 2\n", "line 16: \"1 2\" is not a row of \"vertex\""),
        ("3 0 2 1\n", "3 0 2.5 1\n", "is not a row of \"face\": list uchar int vertex_indices"),
        ("3 0 2 1\n", "3 0 -2 1\n", "face 0 names vertex -2"),
        ("3 0 2 1\n", "3 0 8 1\n", "face 0 names vertex 8, and there are 8"),
        ("uchar int vertex", "uchar float vertex", "is a list of floating-point numbers"),
        ("list uchar int", "int", "of its faces is a number, and no list"),
        ("vertex_indices", "corners", "its faces have no property \"vertex_indices\""),
        ("property float z\n", "", "its vertices have no property \"z\""),
        ("float z", "list uchar float z", "of its vertices is a list, and no number"),
        (
            "format ascii 1.0",
            "format text 1.0",
            "line 2: \"format text 1.0\" is not a line of its head",
        ),
        (
            "element vertex 8",
            "element vertex many",
            "line 3: \"element vertex many\" is not a line",
        ),
        ("end_header\n", "", "is not a line of its head"),
    ] {
        let said = refusal(ply().replacen(from, to, 1).as_bytes(), Format::Ply);
        assert!(said.contains(part), "{said}");
    }
}
