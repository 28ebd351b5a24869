// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Remarks on bodies that lie within others, such as a hard nodule in soft skin.

use std::fmt;

use palpate::scene::BuiltScene;

use crate::output::{self, shown};

/// Why a body cannot be felt, and what to do.
pub(crate) struct Told<'a> {
    /// The name of the body.
    pub(crate) inner: &'a str,
    /// The name of the body around it.
    pub(crate) outer: &'a str,
}

impl fmt::Display for Told<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [inner, outer] = [self.inner, self.outer].map(shown);
        write!(
            f,
            "body \"{inner}\" lies wholly within body \"{outer}\": it cannot be felt, because a hand \
             stays on the surface of \"{outer}\"; let it come out there, or give the material of \
             \"{outer}\" \"layers\", with \"pop_through\" if the hand is to reach what lies within"
        )
    }
}

/// Warns of each body that is proven to lie within another.
pub(crate) fn warn<const D: usize>(scene: &BuiltScene<D>) {
    let name = |body: usize| scene.bodies[body].name.as_str();
    for hidden in scene.hidden() {
        let told = Told { inner: name(hidden.body), outer: name(hidden.within) };
        output::remark(format_args!("warning: {told}"));
    }
}
