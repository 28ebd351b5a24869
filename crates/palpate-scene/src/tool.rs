// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The tool of a scene, as a file gives it.

use palpate_field::LARGEST_LENGTH;
use palpate_haptics::{Probe, ToolOptions};
use palpate_safety::Acceptance;
use palpate_vibration::{ACTUATORS, Actuator, actuator_named};
#[cfg(test)]
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::names::unknown as unknown_name;
use crate::pose::WrittenPose;
use crate::problem::{Problem, Problems, at_least, positive_if};
#[cfg(test)]
use crate::schema::{ActuatorSchema, VectorSchema};
use crate::shape::WrittenShape;

/// The tool that touches a scene: the tip of a stylus, fingers, or a shape in the hand.
///
/// Each contact point is felt on its own, as a ball of the tool's radius. A tool
/// with a shape is felt as a whole, with force and torque.
///
/// ```
/// use palpate_scene::WrittenTool;
///
/// # fn main() -> Result<(), serde_json::Error> {
/// let fingers: WrittenTool = serde_json::from_str(
///     r#"{ "radius": 0.008, "points": [[-0.02, 0, 0], [0, 0, 0], [0.02, 0, 0]] }"#,
/// )?;
/// assert_eq!(fingers.points.len(), 3);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(JsonSchema))]
#[serde(deny_unknown_fields, default, expecting = "an object")]
#[cfg_attr(test, schemars(rename = "Tool"))]
#[non_exhaustive]
pub struct WrittenTool {
    /// A note for readers of the file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
    /// The radius of each contact point [m]; if left out, 0 with `points` or a `shape`, else that of
    /// a hand without a tool, 2 mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(range(min = 0.0)))]
    pub radius: Option<f64>,
    /// The contact points in the tool's own coordinates [m]; one at its origin
    /// if left out.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(test, schemars(with = "Vec<VectorSchema>"))]
    pub points: Vec<Vec<f64>>,
    /// The shape of the tool in its own coordinates, instead of points.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shape: Option<WrittenShape>,
    /// The virtual coupling between the hand and the tool.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coupling: Option<WrittenCoupling>,
    /// The map from the device's space to the world.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub workspace: Option<WrittenWorkspace>,
    /// The greatest force on the hand [N]; the device's own limit if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(extend("exclusiveMinimum" = 0)))]
    pub max_force: Option<f64>,
    /// The largest power of bodies that move on the hand [W]; 1 W if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(extend("exclusiveMinimum" = 0)))]
    pub drive_power: Option<f64>,
    /// What a device renders of materials; `device` if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub acceptance: Option<WrittenAcceptance>,
    /// What shakes each contact point, by its name in `palpate devices --actuators`; an actuator
    /// that plays every frequency if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(with = "ActuatorSchema"))]
    pub actuator: Option<String>,
}

/// What a device renders of materials, as
/// [`Acceptance`](palpate_safety::Acceptance) says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(JsonSchema))]
#[serde(rename_all = "snake_case")]
#[cfg_attr(test, schemars(rename = "Acceptance", inline))]
pub enum WrittenAcceptance {
    /// What needs no passivity controller in any hand.
    Passive,
    /// As stiff as the device renders well at its rate, and as damped as that leaves room for.
    Device,
    /// As it is.
    AsIs,
}

impl From<WrittenAcceptance> for Acceptance {
    fn from(written: WrittenAcceptance) -> Self {
        match written {
            WrittenAcceptance::Passive => Self::Passive,
            WrittenAcceptance::Device => Self::Device,
            WrittenAcceptance::AsIs => Self::AsIs,
        }
    }
}

/// A virtual coupling: the spring and damper between the hand and a tool with a
/// shape (Colgate, Stanley and Brown 1995). The engine derives missing values from the device.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(JsonSchema))]
#[serde(deny_unknown_fields, default, expecting = "an object")]
#[cfg_attr(test, schemars(rename = "Coupling"))]
#[non_exhaustive]
pub struct WrittenCoupling {
    /// A note for readers of the file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
    /// Force for each metre apart [N/m].
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(extend("exclusiveMinimum" = 0)))]
    pub stiffness: Option<f64>,
    /// Force for each metre per second [N·s/m].
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(range(min = 0.0)))]
    pub damping: Option<f64>,
    /// Torque for each radian apart [N·m/rad].
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(extend("exclusiveMinimum" = 0)))]
    pub angular_stiffness: Option<f64>,
    /// Torque for each radian per second [N·m·s/rad].
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(range(min = 0.0)))]
    pub angular_damping: Option<f64>,
}

/// The map from the device's space to the world: scaled, rotated, then translated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(JsonSchema))]
#[serde(deny_unknown_fields, default, expecting = "an object")]
#[cfg_attr(test, schemars(rename = "Workspace"))]
#[non_exhaustive]
pub struct WrittenWorkspace {
    /// A note for readers of the file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
    /// Metres in the world for each metre of the device; 1 if left out.
    #[cfg_attr(test, schemars(extend("exclusiveMinimum" = 0)))]
    pub scale: f64,
    /// The device's axes and origin in the world, `world_from_device`; those of
    /// the world if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pose: Option<WrittenPose>,
}

impl Default for WrittenWorkspace {
    fn default() -> Self {
        Self { description: None, scale: 1.0, pose: None }
    }
}

impl WrittenTool {
    /// Checks the numbers; the shape and the workspace are checked when they are built.
    pub(crate) fn check(&self, dimension: usize) -> Result<(), Problems> {
        let points = self.points.iter().enumerate().map(|(i, point)| {
            crate::pose::position(point, dimension).map_err(|p| p.at(i).under("points"))
        });
        let is_both = self.shape.is_some() && !self.points.is_empty();
        let both = Problem::new("a tool has either contact points or a shape").under("points");
        let radius = self.radius.unwrap_or(0.0);
        let far =
            Problem::new(format!("must be at most {LARGEST_LENGTH:e} m, got {radius:e} m"));
        let far = far.under("radius");
        let numbers = [
            at_least("radius", radius, 0.0, "m"),
            if radius > LARGEST_LENGTH { Err(far) } else { Ok(()) },
            if is_both { Err(both) } else { Ok(()) },
            positive_if("max_force", self.max_force, "N"),
            positive_if("drive_power", self.drive_power, "W"),
            self.actuator().map(drop).map_err(|problem| problem.under("actuator")),
        ];
        let coupling = self.coupling.as_ref().map_or(Ok(()), WrittenCoupling::check);
        Problems::all([
            Problems::all(numbers.into_iter().chain(points)),
            coupling.map_err(|problems| problems.under("coupling")),
        ])
    }
}

impl WrittenCoupling {
    fn check(&self) -> Result<(), Problems> {
        let at_least_zero = |key, value: Option<f64>, unit| {
            value.map_or(Ok(()), |value| at_least(key, value, 0.0, unit))
        };
        Problems::all([
            positive_if("stiffness", self.stiffness, "N/m"),
            positive_if("angular_stiffness", self.angular_stiffness, "N·m/rad"),
            at_least_zero("damping", self.damping, "N·s/m"),
            at_least_zero("angular_damping", self.angular_damping, "N·m·s/rad"),
        ])
    }
}

impl WrittenTool {
    /// The actuator of this name.
    pub(crate) fn actuator(&self) -> Result<Option<Actuator>, Problem> {
        let Some(name) = &self.actuator else { return Ok(None) };
        let known = ACTUATORS.each_ref().map(|(known, _)| *known);
        let unknown = |_| Problem::new(unknown_name("actuator", name, &known));
        actuator_named(name).map(Some).map_err(unknown)
    }

    /// The radius of each contact point [m].
    pub(crate) fn probe_radius(&self) -> f64 {
        let is_bare = self.shape.is_none() && self.points.is_empty();
        let left_out = if is_bare { Probe::default().radius() } else { 0.0 };
        self.radius.unwrap_or(left_out)
    }

    /// The options of a tool with a shape; missing keys have the values of
    /// [`ToolOptions::default`].
    #[must_use]
    pub fn options(&self) -> ToolOptions {
        let default = ToolOptions::default();
        let coupling = self.coupling.clone().unwrap_or_default();
        ToolOptions {
            stiffness: coupling.stiffness.unwrap_or(default.stiffness),
            damping: coupling.damping.unwrap_or(default.damping),
            angular_stiffness: coupling.angular_stiffness.or(default.angular_stiffness),
            angular_damping: coupling.angular_damping.unwrap_or(default.angular_damping),
            max_force: self.max_force.or(default.max_force),
            ..default
        }
    }
}
