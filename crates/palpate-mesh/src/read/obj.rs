// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! OBJ.
//!
//! Only vertices and faces matter here; all objects and groups share their vertices.
//! Lines of other kinds are passed over.

use palpate_field::{LARGEST_LENGTH, Point, Vector};

use super::text::{check_encoding, lines, quoted, without_mark};
use super::{Format, ReadProblem, cut_off, of_polygons};
use crate::mesh::TriangleMesh;

pub(super) fn read(bytes: &[u8]) -> Result<TriangleMesh, ReadProblem> {
    check_encoding(bytes)?;
    let text = String::from_utf8_lossy(without_mark(bytes));
    let mut found = Found::default();
    let mut lines = (1..).zip(lines(&text));
    while let Some((number, first)) = lines.next() {
        let line = Line { text: &text, number };
        if first.ends_with('\\') {
            let mut whole = first.to_owned();
            // A backslash at the end joins a line to the next.
            while whole.ends_with('\\') {
                whole.pop();
                whole.push(' ');
                whole.push_str(lines.next().map_or("", |(_, next)| next));
            }
            found.add(line, &whole)?;
        } else {
            found.add(line, first)?;
        }
    }
    let vertices = found.vertices.len();
    if let Some((line, vertex)) = found.last.filter(|(_, vertex)| *vertex > vertices) {
        return Err(
            line.wrong(&format!("a face names vertex {vertex}, and there are {vertices}"))
        );
    }
    of_polygons(found.vertices, &found.sizes, &found.corners, Format::Obj)
}

/// `true` if the first lines of a file that are no comments have a vertex.
pub(super) fn is_likely(bytes: &[u8]) -> bool {
    /// Objects, groups and materials may come before the first vertex.
    const SOON: usize = 20;
    /// Comments may come before those [bytes].
    const HEAD: usize = 1 << 16;
    let head = String::from_utf8_lossy(without_mark(&bytes[..bytes.len().min(HEAD)]));
    let lines = lines(&head).map(str::trim);
    let lines = lines.filter(|line| !line.is_empty() && !line.starts_with('#'));
    let is_vertex = |line: &str| {
        let mut words = line.split_whitespace();
        words.next() == Some("v")
            && words.filter(|word| word.parse::<f64>().is_ok()).count() >= 3
    };
    lines.take(SOON).any(is_vertex)
}

/// The vertices and faces of the lines so far.
#[derive(Default)]
struct Found<'a> {
    vertices: Vec<Point<3>>,
    /// How many corners each face has.
    sizes: Vec<u32>,
    /// The corners of all faces, counted from 0.
    corners: Vec<u32>,
    /// The last vertex that a face names, counted from 1, and the line of that face.
    /// The vertex may come after the face.
    last: Option<(Line<'a>, usize)>,
}

impl<'a> Found<'a> {
    fn add(&mut self, line: Line<'a>, text: &str) -> Result<(), ReadProblem> {
        let mut words = text.split('#').next().unwrap_or_default().split_whitespace();
        match words.next() {
            Some("v") => self.vertices.push(line.vertex(words)?),
            Some("f") => self.add_face(line, words)?,
            _ => {}
        }
        Ok(())
    }

    fn add_face<'w>(
        &mut self,
        line: Line<'a>,
        words: impl Iterator<Item = &'w str>,
    ) -> Result<(), ReadProblem> {
        let mut corners = 0;
        for word in words {
            let corner = word.split('/').next().unwrap_or_default();
            let vertex = line.corner(corner, self.vertices.len())?;
            if self.last.is_none_or(|(_, last)| last < vertex) {
                self.last = Some((line, vertex));
            }
            let Ok(index) = u32::try_from(vertex - 1) else {
                let rule = "at most 4294967296 vertices can be named";
                return Err(line.wrong(&format!("{rule}, got {vertex}")));
            };
            self.corners.push(index);
            corners += 1;
        }
        if corners < 3 {
            return Err(line.wrong(&format!("a face has 3 corners or more, got {corners}")));
        }
        self.sizes.push(corners);
        Ok(())
    }
}

/// A line of a file.
#[derive(Clone, Copy)]
struct Line<'a> {
    text: &'a str,
    number: usize,
}

impl Line<'_> {
    /// The vertex of this line. Of what comes after the coordinates, one number is a weight,
    /// by which they are divided, and three are a colour, which is passed over.
    fn vertex<'w>(self, words: impl Iterator<Item = &'w str>) -> Result<Point<3>, ReadProblem> {
        let words: Vec<_> = words.collect();
        let mut place = [0.0; 3];
        for (coordinate, word) in place.iter_mut().zip(&words) {
            *coordinate = self.coordinate(word)?;
        }
        if words.len() < 3 {
            let count = words.len();
            return Err(self.wrong(&format!("a vertex has 3 coordinates, got {count}")));
        }
        let &[_, _, _, weight] = &words[..] else { return Ok(Vector(place)) };
        let divided = weight.parse().map(|weight: f64| place.map(|x| x / weight));
        match divided {
            Ok(place) if place.iter().all(|x| x.abs() <= LARGEST_LENGTH) => Ok(Vector(place)),
            _ => {
                let rule = "the weight of a vertex is a finite number other than 0";
                Err(self.wrong(&format!("{rule}, got {}", quoted(weight))))
            }
        }
    }

    fn coordinate(self, word: &str) -> Result<f64, ReadProblem> {
        let number = word.parse().ok().filter(|x: &f64| x.abs() <= LARGEST_LENGTH);
        number.ok_or_else(|| {
            let rule = "a coordinate is a finite number of at most 1e15 in size";
            self.wrong(&format!("{rule}, got {}", quoted(word)))
        })
    }

    /// The vertex of a corner, counted from 1, where `vertices` come before the face.
    fn corner(self, corner: &str, vertices: usize) -> Result<usize, ReadProblem> {
        let index = corner.parse::<i64>().ok().filter(|index| *index != 0);
        let Some(index) = index else {
            let rule = "a corner is the number of a vertex, counted from 1";
            return Err(self.wrong(&format!("{rule}, got {}", quoted(corner))));
        };
        let counted =
            if index > 0 { Some(index) } else { index.checked_add(vertices as i64 + 1) };
        let counted = counted.and_then(|counted| usize::try_from(counted).ok());
        counted.filter(|counted| *counted > 0).ok_or_else(|| {
            let problem = format!("a face names vertex {index}, and {vertices} are before it");
            self.wrong(&problem)
        })
    }

    /// The complaint about this line.
    fn wrong(self, problem: &str) -> ReadProblem {
        let cut = cut_off(self.text, self.number);
        Format::Obj.malformed(format_args!("line {}: {problem}{cut}", self.number))
    }
}
