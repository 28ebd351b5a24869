// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The first touch of a segment or a triangle that moves, and a field.

use super::elements::{ElementSweep, Whole};
use super::first_touch::FirstTouch;
use super::motion::Motion;
use super::moving::Moving;
use super::part::Part;
use super::settings::SweepSettings;
use crate::element::Element;
use crate::error::QueryError;

/// When an element that moves touches a field first, which may move too: the first time at which the
/// field is at most `settings.gap` anywhere on the element. In the contact, the field is body `a`.
///
/// Each part of the element advances through time on its own, by points that are lifted off it as
/// in [`minimum`](crate::minimum). So no motion is too fast and no body too thin.
///
/// ```
/// use palpate_field::{Pose, Screw, Shape, Vector};
/// use palpate_query::{Element, ElementSweep, SweepSettings, sweep_element};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// // It falls by 4 m on a ball, which it meets with its middle at a height of 1 m.
/// let ball = Shape::<3>::ball(1.0)?;
/// let corners = [[0.3, 0.0, 0.0], [-0.2, 0.0, 0.2], [-0.1, 0.0, -0.2]].map(Vector);
/// let [from, to] = [3.0, -1.0].map(|y| Pose::translation([0.0, y, 0.0]));
/// let falls = Screw::new(from, to, 0)?;
/// let settings = SweepSettings::of_size(1.0);
/// let triangle = Element::new(corners)?;
/// let touch = sweep_element(&ball, &triangle, falls, &settings, &mut ElementSweep::new())?;
/// assert!(touch.lower <= 0.5 && touch.upper > 0.5 - 1e-6 && touch.upper <= touch.lower + 1e-4);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
///
/// If a pose is NaN or out of range, or a setting is not positive.
pub fn sweep_element<'a, const N: usize, const D: usize>(
    field: impl Into<Moving<'a, D>>,
    element: &Element<N, D>,
    motion: impl Into<Motion<D>>,
    settings: &SweepSettings,
    workspace: &mut ElementSweep<N, D>,
) -> Result<FirstTouch<D>, QueryError> {
    let part = Part::whole(element, 0, 0.0);
    let whole = Whole { part, mesh: None, corners: &element.vertices };
    workspace.run(field.into(), &whole, motion.into(), settings)
}
