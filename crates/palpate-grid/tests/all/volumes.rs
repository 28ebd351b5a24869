// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Volumes: the same ball from every format, and what is damaged.
#[path = "../../../../fuzz/volume_bytes.rs"]
#[expect(unreachable_pub, reason = "shared with the fuzz target")]
mod volume_bytes;

use std::io::Write;
use std::path::Path;

use flate2::Compression;
use flate2::write::{GzEncoder, ZlibEncoder};
use palpate_field::Vector;
use palpate_grid::{Volume, VolumeProblem};
use palpate_mesh::Solid;
use palpate_testkit::cases;

/// Nodes along each axis, all different.
const COUNTS: [usize; 3] = [20, 24, 16];
/// The spacing [mm].
const SPACING: [f64; 3] = [1.0, 0.5, 2.0];
/// The middle of a ball [mm].
const MIDDLE: [f64; 3] = [10.0, 6.0, 15.0];

/// A ball of 4 mm, denser than what is around it: 100 less its distance in tenths of a millimetre.
fn densities() -> Vec<i16> {
    let mut samples = Vec::new();
    for z in 0..COUNTS[2] {
        for y in 0..COUNTS[1] {
            for x in 0..COUNTS[0] {
                let p = [x, y, z];
                let off: [f64; 3] =
                    std::array::from_fn(|i| p[i] as f64 * SPACING[i] - MIDDLE[i]);
                samples.push((100.0 - 10.0 * Vector(off).norm()).round() as i16);
            }
        }
    }
    samples
}

fn little() -> Vec<u8> {
    densities().into_iter().flat_map(i16::to_le_bytes).collect()
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut out = GzEncoder::new(Vec::new(), Compression::default());
    out.write_all(bytes).unwrap();
    out.finish().unwrap()
}

fn nrrd(encoding: &str) -> Vec<u8> {
    let head = format!(
        "NRRD0005\n# a ball\ntype: short\ndimension: 3\nspace: right-anterior-superior\nsizes: 20 24 16\n\
         space directions: (1,0,0) (0,0.5,0) (0,0,2)\nkinds: domain domain domain\nendian: little\n\
         encoding: {encoding}\nspace origin: (0,0,0)\n\n"
    );
    let samples = if encoding == "raw" { little() } else { gzip(&little()) };
    [head.into_bytes(), samples].concat()
}

fn meta(is_compressed: bool) -> Vec<u8> {
    let said = if is_compressed { "True" } else { "False" };
    let head = format!(
        "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = True\nCompressedData = {said}\n\
         TransformMatrix = -1 0 0 0 -1 0 0 0 1\nOffset = 0 0 0\nElementSpacing = 1 0.5 2\nDimSize = 20 24 16\n\
         ElementType = MET_SHORT\nElementDataFile = LOCAL\n"
    );
    let big: Vec<u8> = densities().into_iter().flat_map(i16::to_be_bytes).collect();
    let samples = if is_compressed {
        let mut out = ZlibEncoder::new(Vec::new(), Compression::default());
        out.write_all(&big).unwrap();
        out.finish().unwrap()
    } else {
        big
    };
    [head.into_bytes(), samples].concat()
}

fn nifti() -> Vec<u8> {
    let mut head = [0_u8; 352];
    let mut put =
        |place: usize, bytes: &[u8]| head[place..place + bytes.len()].copy_from_slice(bytes);
    put(0, &348_i32.to_le_bytes());
    for (i, count) in [3, 20, 24, 16, 1, 1, 1, 1_i16].into_iter().enumerate() {
        put(40 + 2 * i, &count.to_le_bytes());
    }
    put(70, &4_i16.to_le_bytes());
    for (i, side) in [1.0, 1.0, 0.5, 2.0_f32].into_iter().enumerate() {
        put(76 + 4 * i, &side.to_le_bytes());
    }
    put(108, &352_f32.to_le_bytes());
    put(112, &1_f32.to_le_bytes());
    put(123, &[2]);
    put(252, &1_i16.to_le_bytes());
    put(344, b"n+1\0");
    [head.to_vec(), little()].concat()
}

fn npy(is_fortran: bool) -> Vec<u8> {
    let order = if is_fortran { "True" } else { "False" };
    let mut head =
        format!("{{'descr': '<i2', 'fortran_order': {order}, 'shape': (20, 24, 16), }}");
    head.push('\n');
    let samples = densities();
    let samples: Vec<u8> = if is_fortran {
        little()
    } else {
        let at = |x: usize, y: usize, z: usize| samples[x + 20 * (y + 24 * z)];
        let all =
            (0..20).flat_map(|x| (0..24).flat_map(move |y| (0..16).map(move |z| (x, y, z))));
        all.flat_map(|(x, y, z)| at(x, y, z).to_le_bytes()).collect()
    };
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    file.extend((head.len() as u16).to_le_bytes());
    file.extend(head.into_bytes());
    file.extend(samples);
    file
}

fn files() -> Vec<(&'static str, Vec<u8>)> {
    vec![
        ("ball.nrrd", nrrd("raw")),
        ("packed.nrrd", nrrd("gzip")),
        ("ball.mha", meta(false)),
        ("packed.mha", meta(true)),
        ("ball.nii", nifti()),
        ("ball.nii.gz", gzip(&nifti())),
    ]
}

#[test]
fn every_format_gives_the_same_ball() {
    let expected: Vec<f32> = densities().into_iter().map(f32::from).collect();
    for (name, bytes) in files() {
        let volume = Volume::from_bytes(&bytes, Path::new(name)).unwrap();
        assert_eq!((volume.counts(), volume.range()[1]), (COUNTS, 90.0), "{name}");
        assert_eq!(volume.samples(), expected, "{name}");
        let last = volume.node([19, 23, 15]) - Vector([0.019, 0.0115, 0.03]);
        assert!(last.norm() < 1e-9, "{name}: {last:?}");
        let mesh = volume.surface(60.0).unwrap();
        assert!(mesh.report().is_watertight(), "{name}");
        assert!(mesh.report().enclosed.unwrap() > 0.0, "{name}");
        for vertex in mesh.vertices() {
            let off = (*vertex - Vector(MIDDLE) * 1e-3).norm() - 4e-3;
            assert!(off.abs() < 6e-4, "{name}: {off}");
        }
    }
    for is_fortran in [true, false] {
        let volume = Volume::from_bytes(&npy(is_fortran), Path::new("ball.npy")).unwrap();
        assert_eq!(volume.samples(), expected);
    }
}

/// The same scan by formats of both conventions stood in two places.
#[test]
fn places_in_a_patient_are_the_same_in_every_format() {
    let text = |bytes: Vec<u8>, from: &str, to: &str| {
        let at = bytes.windows(from.len()).position(|part| part == from.as_bytes()).unwrap();
        [&bytes[..at], to.as_bytes(), &bytes[at + from.len()..]].concat()
    };
    let nrrd = text(nrrd("raw"), "right-anterior-superior", "left-posterior-superior");
    let meta = text(meta(false), "-1 0 0 0 -1 0 0 0 1", "1 0 0 0 1 0 0 0 1");
    for (name, bytes) in [("ball.nrrd", nrrd), ("ball.mha", meta)] {
        let volume = Volume::from_bytes(&bytes, Path::new(name)).unwrap();
        let last = volume.node([19, 23, 15]) - Vector([-0.019, -0.0115, 0.03]);
        assert!(last.norm() < 1e-9, "{name}: {last:?}");
        assert!(volume.surface(60.0).unwrap().report().enclosed.unwrap() > 0.0, "{name}");
    }
}

/// Units were compared by their beginning: three times "m" was taken for "mm", "micron" for "m".
#[test]
fn units_of_a_head_are_whole_words() {
    let of = |units: &str| {
        let bytes = nrrd("raw");
        let head = String::from_utf8_lossy(&bytes[..bytes.len() - 2 * 20 * 24 * 16]);
        let head = head.replace("kinds:", &format!("space units: {units}\nkinds:"));
        let bytes = [head.into_bytes(), little()].concat();
        let volume = Volume::from_bytes(&bytes, Path::new("ball.nrrd"));
        volume.map(|volume| volume.steps()[0].norm()).map_err(|error| error.to_string())
    };
    for (units, metres) in [
        ("\"m\" \"m\" \"m\"", 1.0),
        ("\"mm\" \"mm\" \"mm\"", 1e-3),
        ("\"micron\" \"micron\" \"micron\"", 1e-6),
        ("\"cm\" \"cm\" \"cm\"", 1e-2),
    ] {
        assert_eq!(of(units), Ok(metres), "{units}");
    }
    for units in ["\"mm\" \"m\" \"mm\"", "\"mil\" \"mil\" \"mil\""] {
        assert!(of(units).unwrap_err().contains("space units"), "{units}");
    }
}

/// The sum of a packed file was not compared, and what follows the samples was dropped.
#[test]
fn packed_samples_are_as_long_as_is_said_and_as_their_sum_says() {
    let of = |bytes: &[u8], name: &str| {
        Volume::from_bytes(bytes, Path::new(name)).map_err(|error| error.to_string())
    };
    let good = nrrd("gzip");
    let mut bad = good.clone();
    let last = bad.len() - 5;
    bad[last] ^= 1;
    assert!(of(&good, "a.nrrd").is_ok());
    assert!(of(&bad, "a.nrrd").unwrap_err().contains("checksum"), "{:?}", of(&bad, "a.nrrd"));
    assert!(of(&good[..good.len() - 6], "a.nrrd").is_err());
    for kind in ["raw", "gzip"] {
        let bytes = nrrd(kind);
        let at = bytes.windows(8).position(|part| part == b"20 24 16").unwrap();
        let fewer = [&bytes[..at], b"20 24 15", &bytes[at + 8..]].concat();
        assert!(of(&fewer, "a.nrrd").unwrap_err().contains("and more follow"), "{kind}");
    }
}

/// Of NIfTI no sum was compared: one bit of a packed file made 16 times the faces, and what followed was dropped.
#[test]
fn a_packed_scan_that_is_damaged_or_goes_on_is_refused() {
    let of = |bytes: &[u8]| {
        Volume::from_bytes(bytes, Path::new("a.nii.gz")).map_err(|error| error.to_string())
    };
    let good = gzip(&nifti());
    let whole = of(&good).unwrap();
    for place in (20..good.len()).step_by(7) {
        let mut bad = good.clone();
        bad[place] ^= 4;
        // The last byte that is packed has bits without meaning.
        let is_same = of(&bad).is_ok_and(|volume| volume.samples() == whole.samples());
        assert!(is_same || of(&bad).is_err(), "byte {place}");
    }
    for left in [1, 8, 9] {
        assert!(of(&good[..good.len() - left]).is_err(), "{left}");
    }
    let more = gzip(&[nifti(), vec![0; 40]].concat());
    assert!(of(&more).is_err());
}

/// In a head of lines that end in CR and LF, two LF among the samples were taken for its end.
#[test]
fn a_head_ends_at_its_first_blank_line() {
    let bytes = nrrd("raw");
    let samples = bytes.len() - 2 * 20 * 24 * 16;
    let head = String::from_utf8_lossy(&bytes[..samples]).replace('\n', "\r\n");
    let mut windows = [head.into_bytes(), little()].concat();
    let start = windows.len() - 2 * 20 * 24 * 16;
    windows[start..start + 2].copy_from_slice(b"\n\n");
    let volume = Volume::from_bytes(&windows, Path::new("a.nrrd")).unwrap();
    assert_eq!(volume.counts(), COUNTS);
    assert_eq!(volume.samples()[0], 2570.0);
}

/// A mark hid the first key, and a head in UTF-16 was told to lack what it has.
#[test]
fn heads_are_utf_8_with_or_without_a_mark() {
    for (name, bytes) in [("a.nrrd", nrrd("raw")), ("a.mha", meta(false))] {
        let marked = [b"\xef\xbb\xbf", &bytes[..]].concat();
        let volume = Volume::from_bytes(&marked, Path::new(name)).unwrap();
        assert_eq!(
            volume.samples(),
            Volume::from_bytes(&bytes, Path::new(name)).unwrap().samples()
        );
        for mark in [&b"\xff\xfe"[..], b""] {
            let units = bytes[..40].iter().flat_map(|byte| [*byte, 0]);
            let units: Vec<u8> = mark.iter().copied().chain(units).collect();
            let error = Volume::from_bytes(&units, Path::new(name)).unwrap_err().to_string();
            assert!(error.starts_with("its head is text in UTF-16LE"), "{error}");
        }
    }
}

/// What lies before the samples was not looked at, and the samples were read from the wrong place.
#[test]
fn what_a_head_says_of_other_places_is_refused() {
    let of = |name: &str, bytes: Vec<u8>, from: &str, to: &str| {
        let at = bytes.windows(from.len()).position(|part| part == from.as_bytes()).unwrap();
        let bytes = [&bytes[..at], to.as_bytes(), &bytes[at + from.len()..]].concat();
        Volume::from_bytes(&bytes, Path::new(name)).unwrap_err().to_string()
    };
    let error = of("a.nrrd", nrrd("raw"), "kinds:", "byte skip: 2\nkinds:");
    assert!(error.contains("byte skip \"2\" is not read"), "{error}");
    let error = of("a.mha", meta(false), "Offset", "HeaderSize = 2\nOffset");
    assert!(error.contains("HeaderSize 2 is not read"), "{error}");
    let error = of("a.mha", meta(false), "BinaryData = True", "BinaryData = False");
    assert!(error.contains("its samples are text"), "{error}");
}

/// The first node was at the origin whatever `axis mins` said, and unknown spaces were taken for a right-handed one.
#[test]
fn a_head_says_where_its_first_node_is() {
    let of = |from: &str, to: &str| {
        let bytes = nrrd("raw");
        let head = String::from_utf8_lossy(&bytes[..bytes.len() - 2 * 20 * 24 * 16]);
        let bytes = [head.replace(from, to).into_bytes(), little()].concat();
        let volume = Volume::from_bytes(&bytes, Path::new("ball.nrrd"));
        volume.map(|volume| volume.node([0; 3])).map_err(|error| error.to_string())
    };
    let mins = "axis mins: 10 20 30";
    let origin = "space origin: (0,0,0)";
    for (centers, millimetres) in [
        ("", [10.5, 20.25, 31.0]),
        ("\ncenters: cell cell cell", [10.5, 20.25, 31.0]),
        ("\ncenters: node node cell", [10.0, 20.0, 31.0]),
    ] {
        let at = of(origin, &format!("{mins}{centers}")).unwrap();
        assert!((at - Vector(millimetres) * 1e-3).norm() < 1e-15, "{centers}: {at:?}");
    }
    assert!(of(origin, &format!("{mins}\n{origin}")).unwrap_err().contains("`axis mins`"));
    let space = "right-anterior-superior";
    assert!(of(space, "3D-left-handed").unwrap_err().contains("space \"3D-left-handed\""));
    let kinds = "domain domain domain";
    assert!(of(kinds, "vector domain domain").unwrap_err().contains("kinds"));
    assert!(of(origin, &format!("{origin}\n{origin}")).unwrap_err().contains("twice"));
}

/// The lattice of the surface lay along the axes of space: nodes of a volume that does not were passed over.
#[test]
fn no_sample_of_a_turned_volume_is_passed_over() {
    let turn = |v: [f64; 3]| {
        let ([x, y, z], [c, s]) = (v, [0.8, 0.6]);
        Vector([c * x - s * y, s * x + c * y, z])
    };
    let steps = [[1.0, 0.0, 0.0], [0.0, 0.3, 0.0], [0.0, 0.0, 2.0]].map(turn);
    let mut samples = vec![0.0; 9 * 9 * 9];
    let bright: Vec<usize> = (0..8).map(|i| 91 + 70 * i).collect();
    for node in &bright {
        samples[*node] = 1.0;
    }
    let volume = Volume::new([9; 3], Vector([5.0, 0.0, 0.0]), steps, samples).unwrap();
    let mesh = volume.surface(0.9).unwrap();
    let found = Solid::from_mesh(&mesh).unwrap().0;
    let shape: palpate_field::Shape<3> = found.into();
    for node in bright {
        assert!(shape.distance(volume.node([node % 9, node / 9 % 9, node / 81])) < 0.0);
    }
    let mirrored = [steps[0], steps[1], steps[2] * -1.0];
    let samples = volume.samples().to_vec();
    let mirrored = Volume::new([9; 3], volume.origin(), mirrored, samples).unwrap();
    let enclosed = |mesh: palpate_mesh::TriangleMesh| mesh.report().enclosed.unwrap();
    let [one, other] = [mesh, mirrored.surface(0.9).unwrap()].map(enclosed);
    assert!(one > 0.0 && (one - other).abs() < 1e-12, "{one} {other}");
}

#[test]
fn samples_beside_a_head_are_read_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = meta(false);
    let head = String::from_utf8_lossy(&bytes);
    let head =
        head.split("ElementDataFile").next().unwrap().replace("MSB = True", "MSB = False");
    let write = |name: &str| {
        let path = folder.path().join("ball.mhd");
        std::fs::write(&path, format!("{head}ElementDataFile = {name}\n")).unwrap();
        Volume::open(path)
    };
    std::fs::write(folder.path().join("ball.raw"), little()).unwrap();
    assert_eq!(write("ball.raw").unwrap().counts(), COUNTS);
    for name in ["../ball.raw", "/etc/passwd", "a/ball.raw", ".."] {
        let error = write(name).unwrap_err();
        assert!(matches!(error.problem, VolumeProblem::Elsewhere { .. }), "{error}");
    }
}

#[test]
fn a_ball_that_the_volume_cuts_off_is_closed() {
    let bytes = nrrd("raw");
    let volume = Volume::from_bytes(&bytes, Path::new("ball.nrrd")).unwrap();
    let mut samples = volume.samples().to_vec();
    samples[..20 * 24].fill(100.0);
    let cut = Volume::new(volume.counts(), volume.origin(), volume.steps(), samples).unwrap();
    assert!(cut.surface(60.0).unwrap().report().is_watertight());
}

#[test]
fn what_is_damaged_is_refused() {
    for (name, good) in files().into_iter().chain([("ball.npy", npy(true))]) {
        cases::check(200, |u| {
            let mut bad = good.clone();
            if u.ratio(1, 2)? {
                bad.truncate(u.int_in_range(0..=good.len() - 1)?);
            }
            for _ in 0..u.int_in_range(0..=3)? {
                let most = bad.len().min(400);
                if most > 0 {
                    let at = u.int_in_range(0..=most - 1)?;
                    bad[at] = u.arbitrary()?;
                }
            }
            // Either an error or a volume: never a panic, nor memory for what is not there.
            volume_bytes::check(&bad, name);
            if let Ok(volume) = Volume::from_bytes(&bad, Path::new(name)) {
                assert!(volume.samples().len() <= 1 << 22);
            }
            Ok(Ok(()))
        });
    }
    let said = |bytes: &[u8], name: &str| {
        Volume::from_bytes(bytes, Path::new(name)).unwrap_err().to_string()
    };
    assert!(said(b"", "scan.dcm").contains("dcm2niix"));
    assert!(said(&nrrd("bzip2"), "a.nrrd").contains("encoding \"bzip2\" is not read"));
    let head = nrrd("raw");
    let head = String::from_utf8_lossy(&head[..head.len() - little().len()]);
    for (sizes, expected) in
        [("200 240 160", "bytes, it has"), ("2000 2400 1600", "268435456 at most")]
    {
        let text = head.replace("sizes: 20 24 16", &format!("sizes: {sizes}"));
        assert!(said(text.as_bytes(), "a.nrrd").contains(expected), "{sizes}");
    }
    let sheared = nrrd("raw");
    let sheared = [&sheared[..], &[]].concat();
    let place = sheared.windows(9).position(|w| w == b"(0,0.5,0)").unwrap();
    let mut bytes = sheared.clone();
    bytes[place..place + 9].copy_from_slice(b"(1,0.5,0)");
    assert!(said(&bytes, "a.nrrd").contains("sheared"));
    let volume = Volume::from_bytes(&nrrd("raw"), Path::new("a.nrrd")).unwrap();
    assert!(volume.surface(101.0).unwrap_err().to_string().contains("no surface lies at 101"));
}
