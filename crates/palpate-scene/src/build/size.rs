// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How large shapes grow once references are followed.

use crate::problem::Problem;
use crate::problems::Problems;

/// The deepest nesting of operators in a scene, through references: twice what
/// the shapes allow, since translations and unions within unions disappear when
/// they are built.
pub(crate) const DEEPEST: usize = 2 * palpate_field::MAX_DEPTH;

/// The most nodes of a scene once every reference is followed, each counted
/// again in everything that holds it; points of polygons count as nodes. Building as many takes
/// seconds; without a limit, twenty lines of references could take years.
pub(crate) const MOST: usize = 1_000_000;

/// The size of a built shape.
#[derive(Clone, Copy, Debug)]
pub(super) struct Size {
    /// Its nodes once every reference is followed.
    pub(super) nodes: usize,
    /// How deep its operators are nested.
    pub(super) depth: usize,
}

impl Size {
    /// The size of an operator on shapes of these sizes.
    pub(super) fn over(operands: &[Self]) -> Self {
        Self {
            nodes: operands.iter().fold(1, |sum, size| sum.saturating_add(size.nodes)),
            depth: operands.iter().map(|size| size.depth).max().unwrap_or(0) + 1,
        }
    }
}

impl Size {
    /// The size of a repetition, which may ask its shape for the copies to both sides
    /// along each axis.
    pub(super) fn repeated(self, dimensions: u32) -> Self {
        let copies = 3_usize.pow(dimensions);
        Self { nodes: self.nodes.saturating_mul(copies), depth: self.depth + 2 }
    }
}

/// The nodes that were built, of at most [`MOST`], and the limits that were passed. Each is told
/// of once: what is too large makes all that holds it too large.
#[derive(Debug, Default)]
pub(super) struct Allowance {
    spent: usize,
    is_spent_told: bool,
    is_depth_told: bool,
}

impl Allowance {
    /// Takes the nodes of a shape that is about to be built at `level`.
    pub(super) fn take(&mut self, size: Size, level: usize) -> Result<(), Problems> {
        self.check_depth(level + size.depth)?;
        self.spent = self.spent.saturating_add(size.nodes);
        let is_told = &mut self.is_spent_told;
        refused_once(self.spent > MOST, is_told, || {
            format!(
                "with all references followed the scene has more than {MOST} nodes, the most allowed"
            )
        })
    }

    /// Refuses what is nested too deeply.
    pub(super) fn check_depth(&mut self, depth: usize) -> Result<(), Problems> {
        refused_once(depth > DEEPEST, &mut self.is_depth_told, || {
            format!("shapes are nested more than {DEEPEST} deep, references followed")
        })
    }
}

/// An error if `is_wrong`, which is told unless it was.
fn refused_once(
    is_wrong: bool,
    is_told: &mut bool,
    message: impl FnOnce() -> String,
) -> Result<(), Problems> {
    match (is_wrong, std::mem::replace(is_told, *is_told || is_wrong)) {
        (false, _) => Ok(()),
        (true, true) => Err(Problems::told()),
        (true, false) => Err(Problem::new(message()).into()),
    }
}
