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
    /// The faces that are left, without caps.
    pub own: usize,
    /// Vertices equal to another, merged with it.
    pub welded: usize,
    /// Vertices joined with another a rounding away, where that closed edges.
    pub joined: usize,
    /// How far vertices were moved that were joined, and edges that were parted beside a corner, at most [m].
    pub moved: f64,
    /// What would close cracks that are left.
    pub cracks: Option<Cracks>,
    /// Faces with a vertex twice, dropped.
    pub degenerate: usize,
    /// Faces with the vertices of another, dropped.
    pub duplicates: usize,
    /// Faces whose inside was not that of their neighbours, turned.
    pub turned: usize,
    /// Faces on an edge of which corners of others lie, parted there.
    pub parted: usize,
    /// Pieces that are not orientable, as a Möbius strip.
    pub one_sided: usize,
    /// Pieces that were inside out, turned.
    pub inside_out: usize,
    /// Pieces that lie inside another piece and have the same orientation: their faces are inside the solid.
    pub nested: usize,
    /// Faces with the solid on both sides, or on neither, dropped: of sheets within the solid, and of pieces that
    /// nothing crosses or touches.
    pub inner: usize,
    /// Openings, closed by flat caps.
    pub openings: Vec<Opening<D>>,
    /// Faces without area, whose normal is unknown.
    pub flat: usize,
    /// Edges of more than two faces.
    pub crowded_rims: usize,
    /// Pairs of faces that cross each other.
    pub crossings: usize,
    /// Pairs of faces that touch without a common corner, or lie on each other.
    pub touching: usize,
    /// Whether more pairs cross or touch than were counted: the search stops after a million.
    pub are_more: bool,
    /// Where the first faces that cross are [m]; if none do, the first that touch.
    pub crossing_at: Option<Point<D>>,
}

/// Cracks between faces whose corners are farther apart than roundings.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Cracks {
    /// How wide the widest is [m].
    pub width: f64,
    /// Corners joined within this length close nearly all of them [m].
    pub join_within: f64,
}

impl<const D: usize> Findings<D> {
    /// The same with lengths and places in other units.
    #[must_use]
    pub fn scaled(mut self, factor: f64) -> Self {
        for opening in &mut self.openings {
            *opening = Opening {
                place: opening.place * factor,
                size: opening.size * factor,
                doubtful: opening.doubtful * factor,
                ..*opening
            };
        }
        self.crossing_at = self.crossing_at.map(|at| at * factor);
        self.moved *= factor;
        self.cracks = self.cracks.map(|Cracks { width, join_within }| Cracks {
            width: width * factor,
            join_within: join_within * factor,
        });
        self
    }

    /// Whether the mesh was a solid as it came: closed, each face's inside that of its neighbours, and no faces
    /// that cross.
    #[must_use]
    pub fn is_clean(&self) -> bool {
        let flaws = [
            self.joined,
            self.degenerate,
            self.duplicates,
            self.turned,
            self.parted,
            self.one_sided,
            self.inside_out,
            self.nested,
            self.inner,
            self.openings.len(),
            self.flat,
            self.crowded_rims,
            self.crossings,
            self.touching,
        ];
        flaws.iter().all(|count| *count == 0)
    }
}

impl<const D: usize> fmt::Display for Findings<D> {
    /// What was found, separated by semicolons; nothing if nothing was.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut found = Vec::new();
        let mut say = |count: usize, one: &str, many: &str| {
            if count > 0 {
                found.push(format!("{count} {}", if count == 1 { one } else { many }));
            }
        };
        say(
            self.welded,
            "vertex equal to another was merged",
            "vertices equal to others were merged",
        );
        let moved = metres(self.moved);
        say(
            self.joined,
            &format!("vertex {moved} m beside another was joined with it"),
            &format!("vertices up to {moved} m beside others were joined with them"),
        );
        say(
            self.degenerate,
            "face with a vertex twice was dropped",
            "faces with a vertex twice were dropped",
        );
        say(self.duplicates, "doubled face was dropped", "doubled faces were dropped");
        say(
            self.turned,
            "face faced the wrong way and was turned",
            "faces faced the wrong way and were turned",
        );
        say(
            self.parted,
            "face had corners of others on an edge and was parted there",
            "faces had corners of others on an edge and were parted there",
        );
        say(
            self.inside_out,
            "piece was inside out and was turned",
            "pieces were inside out and were turned",
        );
        say(self.one_sided, "piece is not orientable", "pieces are not orientable");
        say(self.nested, "piece lies within the solid", "pieces lie within the solid");
        say(
            self.inner,
            "face with the solid on both sides, or on neither, was dropped",
            "faces with the solid on both sides, or on neither, were dropped",
        );
        say(self.flat, "face has no area", "faces have no area");
        say(
            self.crowded_rims,
            "edge has more than two faces",
            "edges have more than two faces",
        );
        let crossed_at =
            self.crossing_at.map(|at| format!(", first at ({})", place_in_words(at)));
        let crossed_at = crossed_at.unwrap_or_default();
        say(
            self.crossings,
            &format!("pair of faces crosses{crossed_at}"),
            &format!("pairs of faces cross{crossed_at}"),
        );
        say(
            self.touching,
            "pair of faces touches without a common corner",
            "pairs of faces touch without a common corner",
        );
        if self.are_more {
            found.push("after these no more pairs were sought".to_owned());
        }
        let largest = self.openings.iter().max_by(|a, b| a.size.total_cmp(&b.size));
        if let Some(Opening { size, place, doubtful, .. }) = largest {
            let (count, at) = (self.openings.len(), place_in_words(*place));
            let [size, doubtful] = [size, doubtful].map(|length| metres(*length));
            found.push(if count == 1 {
                format!("1 opening, {size} m across at ({at}), was closed by a flat cap: within {doubtful} m of it the sign is a guess")
            } else {
                format!("{count} openings, the largest {size} m across at ({at}), were closed by flat caps: within {doubtful} m of the largest the sign is a guess")
            });
        }
        if let Some(cracks) = self.cracks {
            found.push(cracks.to_string());
        }
        f.write_str(&found.join("; "))
    }
}

impl fmt::Display for Cracks {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [width, within] = [self.width, self.join_within].map(metres);
        write!(
            f,
            "its faces are parted by cracks up to {width} m wide: joining corners within {within} m closes them \
             (--weld-within, \"weld_within\" in a scene)"
        )
    }
}

fn place_in_words<const D: usize>(place: Point<D>) -> String {
    place.0.map(metres).join(", ")
}

/// A length, to the micrometre if it is at least a millimetre.
fn metres(length: f64) -> String {
    let is_small = length.abs() < 1e-3 && length.abs() > 0.0;
    if is_small { format!("{length:.3e}") } else { format!("{length:.6}") }
}
