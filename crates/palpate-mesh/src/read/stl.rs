// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! STL.
//!
//! A file is binary if it holds the triangles that its count says, whatever its header says:
//! headers of binary files may begin as texts do. No text does so: the letters in place of
//! the count would stand for more triangles than a file of the largest size holds.
//! Normals are not used, and may be anything.

use palpate_field::{LARGEST_LENGTH, Point, Vector};

use super::text::{Lines, check_encoding, lines, quoted, without_mark};
use super::{Format, ReadProblem};
use crate::mesh::TriangleMesh;

/// Bytes of a binary header, of the count behind it, and of a triangle.
const HEADER: usize = 80;
const COUNT: usize = 4;
const TRIANGLE: usize = 50;

/// Where the corners of a triangle begin, behind its normal, and the bytes of a coordinate.
const CORNERS: usize = 12;
const COORDINATE: usize = 4;

pub(super) fn read(bytes: &[u8]) -> Result<TriangleMesh, ReadProblem> {
    let vertices = if is_binary(bytes) {
        check_rest(bytes)?;
        of_binary(bytes)
    } else {
        check_encoding(bytes)?;
        if !is_text(bytes) {
            return Err(cut_off_or_neither(bytes));
        }
        Words::new(&String::from_utf8_lossy(without_mark(bytes))).vertices()?
    };
    let corners = (0..vertices.len() as u32).collect::<Vec<_>>();
    let (triangles, _) = corners.as_chunks::<3>();
    Ok(TriangleMesh::new(vertices, triangles.to_vec())?.welded())
}

/// `true` if a file has the length of a binary one, or begins as a text does and goes on with a
/// facet.
pub(super) fn is_likely(bytes: &[u8]) -> bool {
    /// The facets of a text begin within so many words: comments and a name have fewer.
    const SOON: usize = 100;
    let words = without_mark(bytes).split(u8::is_ascii_whitespace);
    let mut words = words.filter(|word| !word.is_empty()).take(SOON);
    is_text(bytes) && words.any(|word| word.eq_ignore_ascii_case(b"facet"))
        || bytes.len() > HEADER + COUNT && Some(bytes.len()) == binary_length(bytes)
}

fn is_binary(bytes: &[u8]) -> bool {
    binary_length(bytes).is_some_and(|length| length <= bytes.len())
}

/// `true` if one of the first lines begins with `solid`, and none of them has a zero, which
/// headers of binary files have.
fn is_text(bytes: &[u8]) -> bool {
    /// Comments and blank lines may come before the solid [bytes].
    const SOON: usize = 2000;
    let head = without_mark(&bytes[..bytes.len().min(SOON)]);
    let is_solid = |line: &[u8]| {
        let mut words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        words.next().is_some_and(|word| word.eq_ignore_ascii_case(b"solid"))
    };
    !head.contains(&0) && head.split(|byte| matches!(byte, b'\n' | b'\r')).any(is_solid)
}

/// The length of a binary file with the count of triangles that `bytes` would give.
fn binary_length(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(HEADER..)?.first_chunk::<COUNT>()?;
    let triangles = u32::from_le_bytes(*count) as usize;
    Some(triangles.saturating_mul(TRIANGLE).saturating_add(HEADER + COUNT))
}

/// Refuses a binary file with whole triangles beyond those that are counted. Other bytes, and
/// zeros, are no triangles.
fn check_rest(bytes: &[u8]) -> Result<(), ReadProblem> {
    let length = binary_length(bytes).unwrap_or(bytes.len());
    let rest = bytes.get(length..).unwrap_or_default();
    if rest.len().is_multiple_of(TRIANGLE) && rest.iter().any(|byte| *byte != 0) {
        let triangles = (length - HEADER - COUNT) / TRIANGLE;
        let more = rest.len() / TRIANGLE;
        return Err(Format::Stl.malformed(format_args!(
            "byte {HEADER}: {triangles} triangles are counted, and {more} more follow"
        )));
    }
    Ok(())
}

/// The complaint about what is no text and no whole binary file.
fn cut_off_or_neither(bytes: &[u8]) -> ReadProblem {
    let found = bytes.len();
    let Some(length) = binary_length(bytes) else {
        return Format::Stl.malformed(format_args!(
            "it ends at byte {found}: a binary file has {} bytes before its triangles, and a text begins with `solid`",
            HEADER + COUNT
        ));
    };
    let triangles = (length - HEADER - COUNT) / TRIANGLE;
    Format::Stl.malformed(format_args!(
        "byte {HEADER}: {triangles} triangles are counted, which take {length} bytes, and the \
         file ends at byte {found}: it is cut off"
    ))
}

/// The corners of a binary file, three for each triangle.
fn of_binary(bytes: &[u8]) -> Vec<Point<3>> {
    let length = binary_length(bytes).unwrap_or(bytes.len());
    let (triangles, _) = bytes[HEADER + COUNT..length].as_chunks::<TRIANGLE>();
    let corners = |triangle: &[u8; TRIANGLE]| {
        std::array::from_fn::<_, 3, _>(|corner| {
            Vector(std::array::from_fn(|axis| {
                let start = CORNERS + COORDINATE * (3 * corner + axis);
                let bytes = std::array::from_fn(|i| triangle[start + i]);
                f64::from(f32::from_le_bytes(bytes))
            }))
        })
    };
    triangles.iter().flat_map(corners).collect()
}

/// The words of a text, whatever their case, each with its line.
struct Words<'a> {
    lines: Lines<'a>,
    /// The number of the line, counted from 1.
    line: usize,
    /// What is left of the line.
    rest: std::str::SplitAsciiWhitespace<'a>,
}

impl<'a> Words<'a> {
    fn new(text: &'a str) -> Self {
        Self { lines: lines(text), line: 0, rest: "".split_ascii_whitespace() }
    }

    /// The corners of all facets of all solids, three for each.
    fn vertices(mut self) -> Result<Vec<Point<3>>, ReadProblem> {
        let mut vertices = Vec::new();
        // What stands before the first solid is a comment.
        while let Some(word) = self.next() {
            let is_solid = word.eq_ignore_ascii_case("solid");
            self.skip_line();
            if is_solid {
                break;
            }
        }
        let mut is_open = true;
        while let Some(word) = self.next() {
            if is_open && word.eq_ignore_ascii_case("facet") {
                self.facet(&mut vertices)?;
            } else if word.eq_ignore_ascii_case("solid") {
                is_open = true;
                self.skip_line();
            } else if is_open && self.is_end(word, "solid")? {
                is_open = false;
                self.skip_line();
            } else if is_open {
                return Err(self.other_than("`facet` or `endsolid`", word));
            } else {
                return Err(self.other_than("`solid`", word));
            }
        }
        if is_open {
            return Err(self.wrong("the file ends without `endsolid`: it is cut off"));
        }
        Ok(vertices)
    }

    /// Reads what follows `facet`.
    fn facet(&mut self, vertices: &mut Vec<Point<3>>) -> Result<(), ReadProblem> {
        const LATER: [&str; 5] = ["facet", "vertex", "endloop", "endfacet", "endsolid"];
        // The normal comes first.
        loop {
            let word = self.word("`outer loop`")?;
            if word.eq_ignore_ascii_case("outer") {
                break;
            }
            if LATER.iter().any(|later| word.eq_ignore_ascii_case(later)) {
                return Err(self.other_than("`outer loop`", word));
            }
        }
        self.expect("loop")?;
        for _ in 0..3 {
            self.expect("vertex")?;
            let mut place = [0.0; 3];
            for coordinate in &mut place {
                *coordinate = self.coordinate()?;
            }
            vertices.push(Vector(place));
        }
        for part in ["loop", "facet"] {
            let end = format!("`end{part}`");
            let word = self.word(&end)?;
            if !self.is_end(word, part)? {
                return Err(self.other_than(&end, word));
            }
        }
        Ok(())
    }

    /// Whether `word` ends a part, in one word or two: `endloop` or `end loop`.
    fn is_end(&mut self, word: &str, part: &str) -> Result<bool, ReadProblem> {
        if word.eq_ignore_ascii_case("end") {
            self.expect(part)?;
            return Ok(true);
        }
        let (end, ended) = word.split_at_checked("end".len()).unwrap_or((word, ""));
        Ok(end.eq_ignore_ascii_case("end") && ended.eq_ignore_ascii_case(part))
    }

    fn expect(&mut self, expected: &str) -> Result<(), ReadProblem> {
        let quoted = format!("`{expected}`");
        let word = self.word(&quoted)?;
        if word.eq_ignore_ascii_case(expected) {
            Ok(())
        } else {
            Err(self.other_than(&quoted, word))
        }
    }

    fn coordinate(&mut self) -> Result<f64, ReadProblem> {
        let word = self.word("a coordinate")?;
        let number = word.parse().map(|x: f32| f64::from(x));
        number.ok().filter(|x| x.abs() <= LARGEST_LENGTH).ok_or_else(|| {
            let rule = "a coordinate is a finite number of at most 1e15 in size";
            self.wrong(&format!("{rule}, got {}", quoted(word)))
        })
    }

    /// The next word; `expected` says of which kind.
    fn word(&mut self, expected: &str) -> Result<&'a str, ReadProblem> {
        self.next().ok_or_else(|| {
            self.wrong(&format!("the file ends before {expected} of a facet: it is cut off"))
        })
    }

    fn next(&mut self) -> Option<&'a str> {
        loop {
            if let Some(word) = self.rest.next() {
                return Some(word);
            }
            let line = self.lines.next()?;
            self.line += 1;
            let is_comment = ["#", ";", "//"].iter().any(|mark| line.trim().starts_with(mark));
            if !is_comment {
                self.rest = line.split_ascii_whitespace();
            }
        }
    }

    /// Passes over what is left of the line: a name, which may be of several words.
    fn skip_line(&mut self) {
        self.rest = "".split_ascii_whitespace();
    }

    fn other_than(&self, expected: &str, word: &str) -> ReadProblem {
        self.wrong(&format!("{expected} should stand there, got {}", quoted(word)))
    }

    fn wrong(&self, problem: &str) -> ReadProblem {
        Format::Stl.malformed(format_args!("line {}: {problem}", self.line))
    }
}
