// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Bodies whose values do not tell how far away they are.

use std::io::{self, Write};

use palpate::field::Quality;
use palpate::scene::BuiltScene;

use crate::output::shown;

/// A report names at most so many.
const MOST: usize = 4;

/// Which bodies have fields that are no distances outside of them, but bounds.
pub(crate) struct BoundFields(Vec<bool>);

impl BoundFields {
    pub(crate) fn of<const D: usize>(scene: &BuiltScene<D>) -> Self {
        let is_bound = |outside: Quality| outside != Quality::Exact;
        let bodies = scene.bodies.iter();
        Self(bodies.map(|body| is_bound(body.shape_in_body.promise().outside)).collect())
    }

    /// Names the bodies of `pairs` whose fields are bounds, and says that these may be farther apart than
    /// their separations.
    pub(crate) fn say(
        &self,
        out: &mut impl Write,
        names: &[&str],
        pairs: impl Iterator<Item = [usize; 2]>,
    ) -> io::Result<()> {
        let mut bodies: Vec<usize> = pairs.flatten().filter(|&body| self.0[body]).collect();
        bodies.sort_unstable();
        bodies.dedup();
        if bodies.is_empty() {
            return Ok(());
        }
        let mut said: Vec<_> = bodies.iter().take(MOST).map(|&i| shown(names[i])).collect();
        if bodies.len() > MOST {
            said.push(format!("{} more", bodies.len() - MOST).into());
        }
        writeln!(
            out,
            "Bodies whose fields are bounds outside: {}. Their separations from others are lower bounds \
             of distances.",
            said.join(", ")
        )
    }
}
