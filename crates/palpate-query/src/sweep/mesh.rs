// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The first touch of a mesh that moves, and a field.

use palpate_mesh::Mesh;

use super::elements::{ElementSweep, Whole};
use super::first_touch::FirstTouch;
use super::motion::Motion;
use super::moving::{Moving, corners};
use super::part::Part;
use super::settings::SweepSettings;
use crate::error::QueryError;

/// When a mesh that moves touches a field first, which may move too: the first time at which the
/// field is at most `settings.gap` anywhere on an element of the mesh. In the contact, the field is
/// body `a`, and the id is the index of the element.
///
/// As [`sweep_element`](crate::sweep_element), from the root of the mesh's tree on: most elements
/// are never looked at.
///
/// ```
/// use palpate_field::{Pose, Screw, Shape, Vector};
/// use palpate_mesh::Outline;
/// use palpate_query::{ElementSweep, SweepSettings, sweep_mesh};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// // A square of 2 m falls by 4 m, and its lower side meets the disc at a height of 1 m.
/// let disc = Shape::<2>::ball(1.0)?;
/// let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(Vector).to_vec();
/// let square = Outline::new(corners, vec![[0, 1], [1, 2], [2, 3], [3, 0]])?;
/// let [from, to] = [4.0, 0.0].map(|y| Pose::translation([0.0, y]));
/// let falls = Screw::new(from, to, 0)?;
/// let settings = SweepSettings::of_size(1.0);
/// let touch = sweep_mesh(&disc, &square, falls, &settings, &mut ElementSweep::new())?;
/// assert!(touch.lower <= 0.5 && touch.upper > 0.5 - 1e-6 && touch.upper <= touch.lower + 1e-4);
/// assert_eq!(touch.contact.ok_or("it touches")?.id, 0);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
///
/// If a pose is NaN or out of range, or a setting is not positive.
pub fn sweep_mesh<'a, const N: usize, const D: usize>(
    field: impl Into<Moving<'a, D>>,
    mesh: &Mesh<N, D>,
    motion: impl Into<Motion<D>>,
    settings: &SweepSettings,
    workspace: &mut ElementSweep<N, D>,
) -> Result<FirstTouch<D>, QueryError> {
    let corners: Vec<_> = corners(&mesh.bounds()).collect();
    let whole = Whole { part: Part::root(mesh), mesh: Some(mesh), corners: &corners };
    workspace.run(field.into(), &whole, motion.into(), settings)
}
