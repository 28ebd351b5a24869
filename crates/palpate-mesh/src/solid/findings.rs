// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What was found and mended where a mesh became a solid.

use std::fmt;

use palpate_field::Point;

use super::repair::Opening;

/// What was found where a mesh became a [`Solid`](super::Solid), and what was done about it.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Findings<const D: usize> {
    /// The triangles or segments of the mesh.
    pub faces: usize,
    /// Vertices equal to another, merged with it.
    pub welded: usize,
    /// Faces with a vertex twice, dropped.
    pub degenerate: usize,
    /// Faces with the vertices of another, dropped.
    pub duplicates: usize,
    /// Faces whose inside was not that of their neighbours, turned.
    pub turned: usize,
    /// Pieces of which no directions agree, as of a Möbius strip.
    pub one_sided: usize,
    /// Pieces that were inside out, turned.
    pub inside_out: usize,
    /// Pieces within a piece that turns the same way, which are walls within the solid.
    pub nested: usize,
    /// Openings, closed by flat caps.
    pub openings: Vec<Opening<D>>,
    /// Edges of an odd number of faces that are left: no cap closes them.
    pub open_rims: usize,
    /// Edges of more than two faces.
    pub crowded_rims: usize,
    /// Pairs of faces that cross each other.
    pub crossings: usize,
    /// Pairs of faces that touch without a common corner, or lie on each other.
    pub touching: usize,
    /// Where the first of these are [m].
    pub crossing_at: Option<Point<D>>,
}

impl<const D: usize> Findings<D> {
    /// Whether the mesh was a solid as it came: closed, each face's inside that of its neighbours, and no faces
    /// that cross.
    #[must_use]
    pub fn is_clean(&self) -> bool {
        let flaws = [
            self.degenerate,
            self.duplicates,
            self.turned,
            self.one_sided,
            self.inside_out,
            self.nested,
            self.openings.len(),
            self.open_rims,
            self.crowded_rims,
            self.crossings,
            self.touching,
        ];
        flaws.iter().all(|count| *count == 0)
    }
}

impl<const D: usize> fmt::Display for Findings<D> {
    /// One sentence for each thing that was found, none if nothing was.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut sentences = Vec::new();
        let mut say = |count: usize, one: &str, many: &str| {
            if count > 0 {
                sentences.push(format!("{count} {}", if count == 1 { one } else { many }));
            }
        };
        say(
            self.welded,
            "vertex equal to another was merged",
            "vertices equal to others were merged",
        );
        say(
            self.degenerate,
            "face without area was dropped",
            "faces without area were dropped",
        );
        say(self.duplicates, "doubled face was dropped", "doubled faces were dropped");
        say(
            self.turned,
            "face faced the wrong way and was turned",
            "faces faced the wrong way and were turned",
        );
        say(
            self.inside_out,
            "piece was inside out and was turned",
            "pieces were inside out and were turned",
        );
        say(self.one_sided, "piece has one side alone", "pieces have one side alone");
        let largest = self.openings.iter().max_by(|a, b| a.size.total_cmp(&b.size));
        if let Some(largest) = largest {
            let (count, Opening { size, place, .. }) = (self.openings.len(), largest);
            let place = place.0.map(|x| format!("{x:.6}")).join(", ");
            sentences.push(if count == 1 {
                format!("1 opening, {size:.6} m across at ({place}), was closed by a flat cap")
            } else {
                format!("{count} openings, the largest {size:.6} m across at ({place}), were closed by flat caps")
            });
        }
        let mut say = |count: usize, one: &str, many: &str| {
            if count > 0 {
                sentences.push(format!("{count} {}", if count == 1 { one } else { many }));
            }
        };
        say(self.nested, "piece lies within the solid", "pieces lie within the solid");
        say(self.open_rims, "edge could not be closed", "edges could not be closed");
        say(
            self.crowded_rims,
            "edge has more than two faces",
            "edges have more than two faces",
        );
        say(self.crossings, "pair of faces crosses", "pairs of faces cross");
        say(
            self.touching,
            "pair of faces touches without a common corner",
            "pairs of faces touch without a common corner",
        );
        if let Some(at) = self.crossing_at
            && let Some(last) = sentences.last_mut()
        {
            let place = at.0.map(|x| format!("{x:.6}")).join(", ");
            last.push_str(&format!(", first at ({place})"));
        }
        f.write_str(&sentences.join("; "))
    }
}
