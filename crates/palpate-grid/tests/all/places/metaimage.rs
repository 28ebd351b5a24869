// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! MetaImage: every spelling that ITK knows gives ITK's place.

use std::io::Write;

use flate2::Compression;
use flate2::write::{GzEncoder, ZlibEncoder};
use palpate_grid::Volume;

use super::{Places, assert_places, assert_refused, read, samples};

/// A head whose steps are turned by a quarter and of different lengths.
const HEAD: &str = "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n\
     CompressedData = False\nTransformMatrix = 0 1 0 -1 0 0 0 0 1\nOffset = 10 20 30\nElementSpacing = 1 2 3\n\
     DimSize = 4 5 6\nElementType = MET_SHORT\nElementDataFile = LOCAL\n";

/// ITK gives (10, 20, 30) and (6, 21, 39), to the left, the back and the top.
const PLACES: Places = [[-10.0, -20.0, 30.0], [-6.0, -21.0, 39.0]];

/// The file with a part of its head replaced.
fn with(from: &str, to: &str) -> Result<Volume, String> {
    assert!(HEAD.contains(from), "{from}");
    read("a.mha", &[HEAD.replace(from, to).into_bytes(), samples()].concat())
}

/// The file with a field more.
fn and(field: &str) -> Result<Volume, String> {
    with("ElementDataFile", &format!("{field}\nElementDataFile"))
}

/// Coordinates were taken to be to the left and the back only where the orientation was three of RLAPIS. ITK never
/// reads the field for a place.
#[test]
fn the_frame_is_the_same_whatever_the_anatomical_orientation() {
    assert_places("no orientation", with("", ""), PLACES);
    for orientation in ["RAI", "LPS", "RAS", "???", "unknown", "RA"] {
        let volume = and(&format!("AnatomicalOrientation = {orientation}"));
        assert_places(orientation, volume, PLACES);
    }
    assert_places("a centre", and("CenterOfRotation = 5 6 7"), PLACES);
}

/// `Orientation` was passed over, and the volume not turned.
#[test]
fn fields_of_several_names_are_the_same_field() {
    for name in ["Orientation", "Rotation"] {
        assert_places(name, with("TransformMatrix", name), PLACES);
    }
    for name in ["Position", "Origin", "ImagePosition"] {
        assert_places(name, with("Offset", name), PLACES);
    }
    assert_places("ElementSize", with("ElementSpacing", "ElementSize"), PLACES);
    assert_places("both sizes", and("ElementSize = 4 4 4"), PLACES);
    assert_places("both origins", and("Origin = 10.0 20 30"), PLACES);
    for field in
        ["Origin = 1 1 1", "Rotation = 1 0 0 0 1 0 0 0 1", "ElementByteOrderMSB = True"]
    {
        let name = field.split(' ').next().unwrap();
        assert_refused(field, and(field), &[name, "are the same field, and differ"]);
    }
    assert_refused("twice", and("Offset = 1 1 1"), &["`Offset` twice"]);
    assert_refused("a small letter", with("Offset", "offset"), &["`offset`", "write `Offset`"]);
}

#[test]
fn lines_are_parted_as_itk_parts_them() {
    for (what, head) in [
        ("no spaces", HEAD.replace(" = ", "=")),
        ("colons", HEAD.replace(" = ", ": ")),
        ("tabs", HEAD.replace(" = ", "\t=\t")),
        ("two characters at the end", HEAD.replace('\n', "\r\n")),
        ("blank lines and comments", format!("# a scan\n\n{HEAD}")),
        ("equal signs in a value", format!("Comment = a = b: c\n{HEAD}")),
        ("no Unicode", format!("Comment = M\u{fc}ller\nFoo = bar\n{HEAD}")),
    ] {
        let latin: Vec<u8> = head.chars().map(|c| c as u8).collect();
        assert_places(what, read("a.mha", &[latin, samples()].concat()), PLACES);
    }
    assert_refused("a line", and("Offset 1 2 3"), &["\"Offset 1 2 3\"", "no `Key = value`"]);
    for offset in ["1,2,3", "1 2", "1 2 3 4", "1 2 nan"] {
        let volume = with("10 20 30", offset);
        assert_refused(offset, volume, &["Offset", offset, "3 numbers with spaces"]);
    }
}

/// All words but `true` were false: the bytes of `1` were swapped without a word.
#[test]
fn a_boolean_is_true_by_its_first_letter() {
    let big: Vec<u8> = (0..120_i16).flat_map(i16::to_be_bytes).collect();
    for word in ["1", "T", "t", "True", "true", "TRUE"] {
        let head = HEAD.replace("MSB = False", &format!("MSB = {word}"));
        assert_places(word, read("a.mha", &[head.as_bytes(), &big].concat()), PLACES);
        let head = head.replace("BinaryDataByteOrderMSB", "ElementByteOrderMSB");
        assert_places(word, read("a.mha", &[head.as_bytes(), &big].concat()), PLACES);
        let mut packed = ZlibEncoder::new(Vec::new(), Compression::default());
        packed.write_all(&samples()).unwrap();
        let head = HEAD.replace("CompressedData = False", &format!("CompressedData = {word}"));
        let file = [head.as_bytes(), &packed.finish().unwrap()].concat();
        assert_places(word, read("a.mha", &file), PLACES);
        let mut packed = GzEncoder::new(Vec::new(), Compression::default());
        packed.write_all(&samples()).unwrap();
        let file = [head.as_bytes(), &packed.finish().unwrap()].concat();
        assert_places(word, read("a.mha", &file), PLACES);
    }
    for word in ["0", "F", "f", "False", "false"] {
        assert_places(word, with("MSB = False", &format!("MSB = {word}")), PLACES);
        let volume = with("BinaryData = True", &format!("BinaryData = {word}"));
        assert_refused(word, volume, &["its samples are text"]);
    }
    for word in ["Yes", "on", ""] {
        let volume = with("MSB = False", &format!("MSB = {word}"));
        assert_refused(
            word,
            volume,
            &["BinaryDataByteOrderMSB", word, "neither True nor False"],
        );
    }
}

#[test]
fn units_are_honoured_or_refused() {
    for unit in ["mm", "?"] {
        assert_places(unit, and(&format!("DistanceUnits = {unit}")), PLACES);
    }
    // The same place in another unit.
    for (unit, offset, spacing) in
        [("um", "10000 20000 30000", "1000 2000 3000"), ("cm", "1 2 3", "0.1 0.2 0.3")]
    {
        let head = HEAD.replace("Spacing = 1 2 3", &format!("Spacing = {spacing}"));
        let head = format!("DistanceUnits = {unit}\n{}", head.replace("10 20 30", offset));
        assert_places(unit, read("a.mha", &[head.into_bytes(), samples()].concat()), PLACES);
    }
    assert_refused("inches", and("DistanceUnits = inch"), &["DistanceUnits", "inch", "um, mm"]);
}

/// ITK turns the axis of a negative spacing around: the place is the same.
#[test]
fn a_negative_spacing_is_a_direction() {
    let places = [[-10.0, -20.0, 30.0], [-14.0, -21.0, 39.0]];
    assert_places("negative", with("Spacing = 1 2 3", "Spacing = 1 -2 3"), places);
    assert_refused("zero", with("Spacing = 1 2 3", "Spacing = 1 0 3"), &["spacing"]);
}

#[test]
fn samples_are_found_where_itk_finds_them_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let head = HEAD.replace("LOCAL", "a.raw");
    std::fs::write(folder.path().join("a.raw"), [b"skip".to_vec(), samples()].concat())
        .unwrap();
    let open = |head: &str| {
        let path = folder.path().join("a.mhd");
        std::fs::write(&path, head).unwrap();
        Volume::open(path).map_err(|error| error.to_string())
    };
    for size in ["4", "-1"] {
        let head = format!("HeaderSize = {size}\n{head}");
        assert_places(size, open(&head), PLACES);
        assert_places("./", open(&head.replace("a.raw", "./a.raw")), PLACES);
    }
    assert_refused("-2", open(&format!("HeaderSize = -2\n{head}")), &["HeaderSize -2"]);
    assert_refused(
        "a missing file",
        open(&HEAD.replace("LOCAL", "gone.raw")),
        &["\"gone.raw\""],
    );
    // A list was looked for as a file of this name, and the head was said to be missing.
    for list in ["LIST", "LIST 2D", "a%02d.raw 0 5 1"] {
        let said = ["ElementDataFile", list, "several files", "into one file"];
        assert_refused(list, open(&HEAD.replace("LOCAL", list)), &said);
        assert_eq!(Volume::files(folder.path().join("a.mhd")).unwrap().len(), 1);
    }
}

#[test]
fn what_is_not_read_of_a_head_is_refused() {
    for (from, to, word) in [
        ("NDims = 3", "NDims = 4", "NDims \"4\""),
        ("= 4 5 6", "= 4 5", "DimSize \"4 5\""),
        ("MET_SHORT", "MET_SHORT_ARRAY", "ElementType \"MET_SHORT_ARRAY\""),
        ("ElementType", "ElementNumberOfChannels = 3\nElementType", "ElementNumberOfChannels"),
        ("ElementType", "ElementToIntensityFunctionSlope = 2\nElementType", "FunctionSlope 2"),
        (
            "ElementType",
            "ElementToIntensityFunctionOffset = 5\nElementType",
            "FunctionOffset 5",
        ),
    ] {
        assert_refused(to, with(from, to), &[word, "is not read"]);
    }
    let long: Vec<u8> = (0..120_i64).flat_map(i64::to_le_bytes).collect();
    for kind in ["MET_LONG_LONG", "MET_ULONG_LONG"] {
        let head = HEAD.replace("MET_SHORT", kind);
        assert_places(kind, read("a.mha", &[head.as_bytes(), &long].concat()), PLACES);
    }
}
