// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Remarks on bodies without any point, such as a small ball minus a large one.

use palpate::scene::{BuiltScene, is_empty};

use crate::output;

/// Warns of each body that is proven to be empty.
pub(crate) fn warn<const D: usize>(scene: &BuiltScene<D>) {
    let empty = scene.bodies.iter().filter(|body| is_empty(&body.shape_in_body) == Some(true));
    warn_of(empty.map(|body| &body.name));
}

/// Warns of bodies that are proven to be empty, by their names.
pub(crate) fn warn_of<'a>(names: impl IntoIterator<Item = &'a String>) {
    for name in names {
        output::remark(format_args!(
            "warning: body {name:?} is empty: no point is in it, which is proven"
        ));
    }
}
