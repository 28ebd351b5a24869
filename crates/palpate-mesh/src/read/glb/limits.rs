// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How much a file may unfold to. Nodes and instances may show one mesh in many places, so
//! that a small file is a large scene.

use crate::read::ReadProblem;

/// What every file may place of each kind: an assembly of 2000 screws of 1000 triangles has
/// fewer. With a tenth, such assemblies are refused; with ten times as many, a file of a few
/// kilobytes takes gigabytes.
const LEAST: usize = 1 << 21;

/// What a file may place for each of its bytes. A triangle takes 6 bytes or more where it is
/// described, so that each may be shown a hundred times.
const EACH_BYTE: usize = 16;

/// The most that any file may place, for the memory that it takes: 2^25 corners of triangles
/// and as many vertices.
const MOST_VERTICES: usize = 1 << 25;
const MOST_TRIANGLES: usize = MOST_VERTICES / 3;

/// The most that a file may place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Limits {
    bytes: usize,
    most: Count,
}

/// How much is placed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Count {
    pub(super) triangles: usize,
    pub(super) vertices: usize,
    /// Parts of meshes with a material each.
    pub(super) primitives: usize,
}

impl Count {
    /// This and another, in so many places.
    pub(super) fn plus(self, other: Self, places: usize) -> Self {
        let sum = |a: usize, b: usize| a.saturating_add(b.saturating_mul(places));
        Self {
            triangles: sum(self.triangles, other.triangles),
            vertices: sum(self.vertices, other.vertices),
            primitives: sum(self.primitives, other.primitives),
        }
    }
}

impl Limits {
    /// Those of a file of so many bytes.
    pub(super) fn of(bytes: usize) -> Self {
        let most = bytes.saturating_mul(EACH_BYTE).max(LEAST);
        let most = Count {
            triangles: most.min(MOST_TRIANGLES),
            vertices: most.min(MOST_VERTICES),
            primitives: most.min(MOST_VERTICES),
        };
        Self { bytes, most }
    }

    /// Refuses what is above them.
    pub(super) fn check(&self, count: Count) -> Result<(), ReadProblem> {
        for (what, placed, most) in [
            ("triangles", count.triangles, self.most.triangles),
            ("vertices", count.vertices, self.most.vertices),
            ("primitives", count.primitives, self.most.primitives),
        ] {
            if placed > most {
                return Err(ReadProblem::Unfolds { what, placed, bytes: self.bytes, most });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_follow_the_size_of_the_file() {
        let triangles = |bytes| Limits::of(bytes).most.triangles;
        assert_eq!(triangles(0), 2_097_152);
        assert_eq!(triangles(178_400), 2_854_400);
        assert_eq!(triangles(usize::MAX), 11_184_810);
        let count = Count { triangles: 3, vertices: 4, primitives: 1 };
        assert_eq!(count.plus(count, 9), Count { triangles: 30, vertices: 40, primitives: 10 });
        assert_eq!(count.plus(count, usize::MAX).triangles, usize::MAX);
    }
}
