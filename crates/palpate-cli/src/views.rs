// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Scenes at a time, and their views.

use palpate::plot::Slice;
use palpate::scene::{BuiltScene, ViewPlane, WrittenView};

use crate::outcome::Failure;
use crate::output;

/// The bodies where they are at a time [s]. Remarks that no body moves, if that is so.
pub(crate) fn at<const D: usize>(
    scene: &BuiltScene<D>,
    time: f64,
) -> Result<BuiltScene<D>, Failure> {
    remark_if_still(scene, time);
    scene.at(time).map_err(Failure::input)
}

/// Remarks that no body moves, if that is so at a time [s] after the start.
pub(crate) fn remark_if_still<const D: usize>(scene: &BuiltScene<D>, time: f64) {
    if time > 0.0 && scene.motions.is_empty() {
        output::remark("no body moves: --time changes nothing");
    }
}

/// The view of this name.
pub(crate) fn named<'a, const D: usize>(
    scene: &'a BuiltScene<D>,
    name: &str,
) -> Result<&'a WrittenView, Failure> {
    scene.views.iter().find(|view| view.name == name).ok_or_else(|| {
        let names: Vec<_> = scene.views.iter().map(|view| format!("{:?}", view.name)).collect();
        Failure::input(if names.is_empty() {
            format!("--view {name:?}: the scene has no views")
        } else {
            format!("--view {name:?}: the scene has the views {}", names.join(", "))
        })
    })
}

/// The plane of a view, in a scene in space.
pub(crate) fn plane(view: &WrittenView) -> Result<Slice, Failure> {
    let at = view.at.unwrap_or(0.0);
    match &view.plane {
        None | Some(ViewPlane::Xy) => Slice::xy(at),
        Some(ViewPlane::Xz) => Slice::xz(at),
        Some(ViewPlane::Yz) => Slice::yz(at),
        Some(ViewPlane::Free(plane)) => Slice::free(plane.origin, plane.right, plane.up),
    }
    .map_err(Failure::input)
}
