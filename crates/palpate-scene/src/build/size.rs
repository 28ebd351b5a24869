// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How large shapes grow once references are followed.

use crate::problem::Problem;

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

/// The nodes that were built, of at most [`MOST`].
#[derive(Debug)]
pub(super) struct Allowance {
    spent: usize,
}

impl Allowance {
    pub(super) fn new() -> Self {
        Self { spent: 0 }
    }

    /// Takes the nodes of a shape that is about to be built at `level`.
    pub(super) fn take(&mut self, size: Size, level: usize) -> Result<(), Problem> {
        check_depth(level + size.depth)?;
        self.spent = self.spent.saturating_add(size.nodes);
        if self.spent <= MOST {
            return Ok(());
        }
        Err(Problem::new(format!(
            "with all references followed the scene has more than {MOST} nodes, the most allowed"
        )))
    }
}

/// Refuses what is nested too deeply.
pub(super) fn check_depth(depth: usize) -> Result<(), Problem> {
    if depth <= DEEPEST {
        return Ok(());
    }
    Err(Problem::new(format!(
        "shapes are nested more than {DEEPEST} deep, references followed"
    )))
}
