// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! NRRD: ITK's place, turned to the right, the front and the top; what says no place of a patient is refused.

use palpate_grid::Volume;

use super::{Places, assert_places, assert_refused, read, samples};

const HEAD: &str = "NRRD0005\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: 4 5 6\n\
     space directions: (0,1,0) (-2,0,0) (0,0,3)\nendian: little\nencoding: raw\nspace origin: (10,20,30)\n\n";

const TURNED: &str = "space directions: (0,1,0) (-2,0,0) (0,0,3)\n";
const SPACE: &str = "space: left-posterior-superior\n";
const ORIGIN: &str = "space origin: (10,20,30)\n";

/// ITK gives (10, 20, 30) and (6, 21, 39), to the left, the back and the top.
const PLACES: Places = [[-10.0, -20.0, 30.0], [-6.0, -21.0, 39.0]];

/// The file with a part of its head replaced.
fn with(from: &str, to: &str) -> Result<Volume, String> {
    assert!(HEAD.contains(from), "{from}");
    read("a.nrrd", &[HEAD.replace(from, to).into_bytes(), samples()].concat())
}

/// The file with lines more.
fn and(lines: &str) -> Result<Volume, String> {
    with("encoding", &format!("{lines}\nencoding"))
}

/// The file without a frame, directions and an origin, and with these lines in their place.
fn plain(lines: &str) -> Result<Volume, String> {
    let head =
        HEAD.replace(SPACE, "").replace(ORIGIN, "").replace(TURNED, &format!("{lines}\n"));
    read("a.nrrd", &[head.into_bytes(), samples()].concat())
}

#[test]
fn frames_of_a_patient_are_turned_to_the_right_the_front_and_the_top() {
    let to = |signs: [f64; 3]| {
        [[10.0, 20.0, 30.0], [6.0, 21.0, 39.0]].map(|p| [0, 1, 2].map(|i| signs[i] * p[i]))
    };
    for (spaces, places) in [
        (["left-posterior-superior", "LPS", "Left-Posterior-Superior"], PLACES),
        (["right-anterior-superior", "RAS", "ras"], to([1.0; 3])),
        (["left-anterior-superior", "LAS", "las"], to([-1.0, 1.0, 1.0])),
    ] {
        for space in spaces {
            assert_places(space, with("left-posterior-superior", space), places);
        }
    }
    // No patient: the numbers of the file.
    let places = to([1.0; 3]);
    assert_places(
        "3D-right-handed",
        with("left-posterior-superior", "3D-right-handed"),
        places,
    );
    assert_places("a dimension", with(SPACE, "space dimension: 3\n"), places);
    for (space, why) in [
        ("3D-left-handed", "which of its axes is mirrored"),
        ("scanner-xyz", "how the patient lies"),
        ("left-posterior-superior-time", "not known"),
        ("left-handed", "not known"),
    ] {
        let volume = with("left-posterior-superior", space);
        assert_refused(space, volume, &[space, why, "write the place in"]);
    }
    for kind in ["space dimension: 2", "space dimension: 4"] {
        assert_refused(kind, with(SPACE, &format!("{kind}\n")), &["space dimension", "3 axes"]);
    }
}

/// ITK gives the first sample half a step from the least coordinate, unless it is of a node.
#[test]
fn an_axis_begins_at_its_least_coordinate() {
    let cells = [[10.5, 21.0, 31.5], [11.5, 25.0, 40.5]];
    let nodes = [[10.0, 20.0, 30.0], [11.0, 24.0, 39.0]];
    for (lines, places) in [
        ("spacings: 1 2 3", [[0.0; 3], [1.0, 4.0, 9.0]]),
        ("spacings: 1 -2 3", [[0.0; 3], [1.0, -4.0, 9.0]]),
        ("spacings: 1 2 3\nthicknesses: 4 4 4", [[0.0; 3], [1.0, 4.0, 9.0]]),
        ("spacings: 1 2 3\naxis mins: 10 20 30", cells),
        ("spacings: 1 2 3\naxismins: 10 20 30\ncenterings: cell cell ???", cells),
        ("spacings: 1 2 3\naxis mins: 10 20 30\ncenters: node Node NODE", nodes),
        ("spacings: 1 2 3\naxis mins: 10 20 30\naxis maxs: 14 30 48", cells),
        (
            "spacings: 1 2 3\naxis mins: 10 20 30\naxismaxs: 13 28 45\ncenters: node node node",
            nodes,
        ),
    ] {
        assert_places(lines, plain(lines), places);
    }
    let mins = "spacings: 1 2 3\naxis mins: 10 20 30";
    for (lines, words) in [
        (format!("{mins}\naxis maxs: 14 30 50"), ["axis maxs", "axis 3 ends at 50"]),
        (format!("{mins}\ncenters: left cell cell"), ["centerings", "cell or node"]),
        (format!("{mins}\ncenters: cell"), ["centerings", "each of the 3 axes"]),
        ("spacings: 1 2 3\naxis maxs: 14 30 48".to_owned(), ["axis maxs", "axis mins"]),
        ("axis mins: 10 20 30\naxis maxs: 14 30 48".to_owned(), ["lacks", "spacings"]),
        ("spacings: 1 nan 3".to_owned(), ["spacings", "3 finite numbers"]),
        (format!("{mins}\nspace origin: (1,2,3)"), ["space origin", "axis mins"]),
        (format!("{mins}\n{TURNED}").trim_end().to_owned(), ["space directions", "spacings"]),
        (format!("axis mins: 1 2 3\n{TURNED}").trim_end().to_owned(), ["axis mins", "turned"]),
    ] {
        assert_refused(&lines, plain(&lines), &words);
    }
}

#[test]
fn axes_that_are_not_of_space_are_refused() {
    for kinds in ["domain domain domain", "space space space", "none ??? Domain"] {
        assert_places(kinds, and(&format!("kinds: {kinds}")), PLACES);
    }
    for kinds in ["vector domain domain", "domain domain list", "RGB-color domain domain"] {
        assert_refused(kinds, and(&format!("kinds: {kinds}")), &["kinds", kinds, "of space"]);
    }
    assert_refused("4", with("dimension: 3", "dimension: 4"), &["dimension \"4\"", "3 axes"]);
    let none = with("(0,1,0) (-2,0,0)", "none (0,1,0)");
    assert_refused("none", none, &["space directions", "3 vectors"]);
    // It is about the components of vectors, which are refused.
    assert_places("a frame", and("measurement frame: (0,1,0) (1,0,0) (0,0,1)"), PLACES);
}

/// Fields that are none of the format were passed over, as were lines without a field.
#[test]
fn a_head_is_read_as_the_format_says() {
    for (what, volume) in [
        ("a pair", and("space origin:=(1,1,1)\na:=b: c\ncontent: a:=b\n# space: RAS")),
        ("no units", and("space units: \"\" \"\" \"\"")),
        ("capitals", with("type: short", "TYPE: Signed Short Int").and(with("raw", "RAW"))),
        ("spaces", with("(10,20,30)", "( 10, 20 , 30 )")),
    ] {
        assert_places(what, volume, PLACES);
    }
    for (lines, words) in [
        ("spce: RAS", ["\"spce\"", "no field"]),
        ("content:x", ["\"content:x\"", "no `field: value`"]),
        ("axismins: 1 2 3\naxis mins: 1 2 3", ["axis mins", "twice"]),
        ("line skip: 1", ["line skip", "not read"]),
        ("byteskip: -1", ["byte skip", "not read"]),
        ("space units: \"mm\" \"mm\" \"cm\"", ["space units", "the same for all axes"]),
    ] {
        assert_refused(lines, and(lines), &words);
    }
    assert_refused("no order", with("endian: little\n", ""), &["`endian`", "little or big"]);
    for encoding in ["ascii", "hex", "bz2"] {
        let volume = with("raw", encoding);
        assert_refused(encoding, volume, &["encoding", encoding, "raw or gzip"]);
    }
    let origin = with("(10,20,30)", "(nan,nan,nan)");
    assert_refused("no origin", origin, &["space origin", "finite"]);
    let long: Vec<u8> = (0..120_i64).flat_map(i64::to_le_bytes).collect();
    for kind in ["longlong", "long long int", "int64", "uint64", "unsigned long long"] {
        let head = HEAD.replace("short", kind);
        assert_places(kind, read("a.nrrd", &[head.as_bytes(), &long].concat()), PLACES);
    }
}

#[test]
fn samples_in_another_file_are_found_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.raw"), samples()).unwrap();
    let open = |file: &str| {
        let path = folder.path().join("a.nhdr");
        std::fs::write(&path, HEAD.replace("\n\n", &format!("\ndata file: {file}\n"))).unwrap();
        Volume::open(path).map_err(|error| error.to_string())
    };
    for file in ["a.raw", "./a.raw"] {
        assert_places(file, open(file), PLACES);
    }
    assert_refused("a missing file", open("gone.raw"), &["\"gone.raw\""]);
    for list in ["LIST\na.raw\nb.raw", "LIST 2\na.raw", "a%02d.raw 0 5 1"] {
        assert_refused(list, open(list), &["data file", "several files", "into one file"]);
        assert_eq!(Volume::files(folder.path().join("a.nhdr")).unwrap().len(), 1);
    }
}
