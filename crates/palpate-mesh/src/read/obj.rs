// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! OBJ, with tobj.
//!
//! Only vertices and faces matter here. They alone are passed on, without texture and
//! normal indices, so that all objects share their vertices and nothing else can be wrong.
//! Each vertex is passed on once more as a point, since tobj drops those without a face.

use std::fmt::Write;

use palpate_field::Vector;

use super::ReadProblem;
use super::{Format, cut_off, of_polygons};
use crate::mesh::TriangleMesh;

pub(super) fn read(bytes: &[u8]) -> Result<TriangleMesh, ReadProblem> {
    let options = tobj::LoadOptions::default();
    let no_material = |_: &std::path::Path| Err(tobj::LoadError::GenericFailure);
    // The mark with which some editors begin a text would hide the first vertex.
    let text = String::from_utf8_lossy(bytes);
    let essence = essence(text.trim_start_matches('\u{feff}'))?;
    let (models, _) = tobj::load_obj_buf(&mut essence.as_bytes(), &options, no_material)
        .map_err(|error| Format::Obj.malformed(error))?;
    let Some(model) = models.into_iter().next() else {
        return Err(crate::MeshError::Empty { vertices: 0 }.into());
    };
    let (coordinates, _) = model.mesh.positions.as_chunks::<3>();
    let vertices = coordinates.iter().map(|&point| Vector(point)).collect();
    // The points come last. tobj leaves arities out if all faces are triangles.
    let sizes = &model.mesh.face_arities;
    let faces = sizes.iter().position(|&size| size == 1).unwrap_or(sizes.len());
    of_polygons(vertices, &sizes[..faces], &model.mesh.indices, Format::Obj)
}

/// `true` if the first lines of a file that are no comments have a vertex.
pub(super) fn is_likely(bytes: &[u8]) -> bool {
    /// Objects, groups and materials may come before the first vertex.
    const SOON: usize = 20;
    let lines = bytes.split(|byte| *byte == b'\n').filter_map(|line| str::from_utf8(line).ok());
    let lines = lines.map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'));
    let is_vertex = |line: &str| {
        let mut words = line.split_whitespace();
        words.next() == Some("v")
            && words.filter(|word| word.parse::<f64>().is_ok()).count() >= 3
    };
    lines.take(SOON).any(is_vertex)
}

/// The positions and faces of a file, with nothing that tobj would refuse without its line.
fn essence(text: &str) -> Result<String, ReadProblem> {
    let mut essence =
        Essence { text: String::with_capacity(text.len()), vertices: 0, last: None };
    let mut lines = text.lines().enumerate();
    while let Some((number, first)) = lines.next() {
        let mut whole = first.to_owned();
        // A backslash at the end joins a line to the next.
        while whole.ends_with('\\') {
            whole.pop();
            whole.push(' ');
            whole.push_str(lines.next().map_or("", |(_, next)| next));
        }
        let line = Line { text, number: number + 1 };
        let mut words = whole.split('#').next().unwrap_or_default().split_whitespace();
        match words.next() {
            Some("v") => essence.add_vertex(line, &words.collect::<Vec<_>>())?,
            Some("f") => essence.add_face(line, words)?,
            _ => {}
        }
    }
    essence.finished()
}

/// What is passed on of the lines so far.
struct Essence<'a> {
    text: String,
    vertices: usize,
    /// The line that names the last vertex, which may come after it.
    last: Option<(Line<'a>, usize)>,
}

impl<'a> Essence<'a> {
    fn add_vertex(&mut self, line: Line<'a>, numbers: &[&str]) -> Result<(), ReadProblem> {
        self.vertices += 1;
        line.check_vertex(numbers)?;
        // Of what comes after the coordinates, one number is a weight and three are a colour.
        let kept = if numbers.len() == 4 { 4 } else { numbers.len().min(3) };
        self.text.push_str("v ");
        self.text.push_str(&numbers[..kept].join(" "));
        self.text.push('\n');
        Ok(())
    }

    fn add_face<'w>(
        &mut self,
        line: Line<'a>,
        words: impl Iterator<Item = &'w str>,
    ) -> Result<(), ReadProblem> {
        self.text.push('f');
        let mut corners = 0;
        for word in words {
            let corner = word.split('/').next().unwrap_or_default();
            let vertex = line.corner(corner, self.vertices)?;
            if self.last.is_none_or(|(_, last)| last < vertex) {
                self.last = Some((line, vertex));
            }
            self.text.push(' ');
            self.text.push_str(corner);
            corners += 1;
        }
        if corners < 3 {
            return Err(line.wrong(&format!("a face has 3 corners or more, got {corners}")));
        }
        self.text.push('\n');
        Ok(())
    }

    /// All of it, with a point for each vertex.
    fn finished(mut self) -> Result<String, ReadProblem> {
        let vertices = self.vertices;
        if let Some((line, vertex)) = self.last.filter(|(_, vertex)| *vertex > vertices) {
            let problem = format!("a face names vertex {vertex}, and there are {vertices}");
            return Err(line.wrong(&problem));
        }
        for i in 1..=vertices {
            // Writing to a string does not fail.
            let _ = writeln!(self.text, "f {i}");
        }
        Ok(self.text)
    }
}

/// A line of a file.
#[derive(Clone, Copy)]
struct Line<'a> {
    text: &'a str,
    number: usize,
}

impl Line<'_> {
    /// Refuses what are no coordinates.
    fn check_vertex(self, numbers: &[&str]) -> Result<(), ReadProblem> {
        let is_good = |number: &&str| {
            number.parse().is_ok_and(|x: f64| x.abs() <= palpate_field::LARGEST_LENGTH)
        };
        if let Some(wrong) = numbers.iter().take(3).find(|number| !is_good(number)) {
            let rule = "a coordinate is a finite number of at most 1e15 in size";
            return Err(self.wrong(&format!("{rule}, got {wrong:?}")));
        }
        if numbers.len() < 3 {
            let count = numbers.len();
            return Err(self.wrong(&format!("a vertex has 3 coordinates, got {count}")));
        }
        Ok(())
    }

    /// The vertex of a corner, counted from 1, where `vertices` come before the face.
    fn corner(self, corner: &str, vertices: usize) -> Result<usize, ReadProblem> {
        let index = corner.parse::<i64>().ok().filter(|index| *index != 0);
        let Some(index) = index else {
            let rule = "a corner is the number of a vertex, counted from 1";
            return Err(self.wrong(&format!("{rule}, got {corner:?}")));
        };
        let counted = if index > 0 { index } else { vertices as i64 + 1 + index };
        usize::try_from(counted).ok().filter(|counted| *counted > 0).ok_or_else(|| {
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
