// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Pictures worth making of a scene.

use std::fmt;

use palpate_field::{LARGEST_LENGTH, Vector};
#[cfg(test)]
use schemars::JsonSchema;
use serde::de::value::{MapAccessDeserializer, StrDeserializer};
use serde::de::{Deserializer, Error, IntoDeserializer, MapAccess, Visitor};
use serde::{Deserialize, Serialize, Serializer};

use crate::problem::{Problem, Problems, positive_if};

/// A picture of a scene: a window on a plane through it.
///
/// What is left out is chosen so that the scene fills the picture.
///
/// ```
/// use palpate_scene::{WrittenView, ViewPlane};
///
/// # fn main() -> Result<(), serde_json::Error> {
/// let view: WrittenView = serde_json::from_str(r#"{ "name": "top", "plane": "xz", "at": 0.02 }"#)?;
/// assert_eq!(view.plane, Some(ViewPlane::Xz));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(JsonSchema))]
#[serde(deny_unknown_fields, expecting = "an object")]
#[non_exhaustive]
pub struct WrittenView {
    /// The name, unlike that of any other view.
    #[cfg_attr(test, schemars(length(min = 1)))]
    pub name: String,
    /// A note for readers of the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
    /// The plane, in space alone; `"xy"` if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(schema_with = "crate::schema::plane"))]
    pub plane: Option<ViewPlane>,
    /// The third coordinate of a plane along two axes [m]; 0 if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at: Option<f64>,
    /// The middle of the window, in coordinates of the plane [m].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub center: Option<[f64; 2]>,
    /// The width of the window [m].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(extend("exclusiveMinimum" = 0)))]
    pub width: Option<f64>,
    /// The height of the window [m].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(extend("exclusiveMinimum" = 0)))]
    pub height: Option<f64>,
    /// The distance from isoline to isoline [m].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(extend("exclusiveMinimum" = 0)))]
    pub spacing: Option<f64>,
}

impl WrittenView {
    /// A view whose plane and window are chosen so that the scene fills the picture.
    #[must_use]
    pub fn new(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            description: None,
            plane: None,
            at: None,
            center: None,
            width: None,
            height: None,
            spacing: None,
        }
    }
}

/// A plane through space.
#[derive(Clone, Debug, PartialEq)]
pub enum ViewPlane {
    /// Seen from the front: x to the right, y up.
    Xy,
    /// Seen from above: x to the right, z down the page.
    Xz,
    /// Seen from the side.
    Yz,
    /// Any plane.
    Free(FreePlane),
}

/// A plane by a point and two directions, made square to each other by turning
/// the second.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(JsonSchema))]
#[serde(deny_unknown_fields, expecting = "an object")]
#[cfg_attr(test, schemars(inline))]
pub struct FreePlane {
    /// A note for readers of the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
    /// The point of the plane that has coordinates 0, 0 [m].
    pub origin: [f64; 3],
    /// The direction to the right, of any length but zero.
    pub right: [f64; 3],
    /// The direction up, of any length but zero and not along `right`.
    pub up: [f64; 3],
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum AxisPlane {
    Xy,
    Xz,
    Yz,
}

impl Serialize for ViewPlane {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Xy => AxisPlane::Xy.serialize(serializer),
            Self::Xz => AxisPlane::Xz.serialize(serializer),
            Self::Yz => AxisPlane::Yz.serialize(serializer),
            Self::Free(plane) => plane.serialize(serializer),
        }
    }
}

impl<'de> Deserialize<'de> for ViewPlane {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(PlaneVisitor)
    }
}

struct PlaneVisitor;

impl<'de> Visitor<'de> for PlaneVisitor {
    type Value = ViewPlane;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("\"xy\", \"xz\", \"yz\", or an object with `origin`, `right` and `up`")
    }

    fn visit_str<E: Error>(self, name: &str) -> Result<ViewPlane, E> {
        let name: StrDeserializer<'_, E> = name.into_deserializer();
        AxisPlane::deserialize(name).map(|plane| match plane {
            AxisPlane::Xy => ViewPlane::Xy,
            AxisPlane::Xz => ViewPlane::Xz,
            AxisPlane::Yz => ViewPlane::Yz,
        })
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<ViewPlane, A::Error> {
        FreePlane::deserialize(MapAccessDeserializer::new(map)).map(ViewPlane::Free)
    }
}

impl WrittenView {
    /// Checks the numbers, in a scene of `dimension`.
    pub(crate) fn check(&self, dimension: usize) -> Result<(), Problems> {
        let center = self.center.as_ref().map_or(Ok(()), |center| {
            crate::pose::position(center, 2).map_err(|problem| problem.under("center"))
        });
        let numbers = [
            positive_if("width", self.width, "m"),
            positive_if("height", self.height, "m"),
            positive_if("spacing", self.spacing, "m"),
            center,
        ];
        let planes =
            if dimension == 2 { self.check_no_plane() } else { self.check_plane_in_space() };
        Problems::all([Problems::all(numbers), planes])
    }

    /// A scene in the plane has one plane.
    fn check_no_plane(&self) -> Result<(), Problems> {
        let keys = [("plane", self.plane.is_some()), ("at", self.at.is_some())];
        Problems::all(keys.map(|(key, is_there)| match is_there {
            true => Err(Problem::new("a scene in 2D has one plane").under(key)),
            false => Ok(()),
        }))
    }

    fn check_plane_in_space(&self) -> Result<(), Problems> {
        // Written so that NaN is refused.
        let is_accepted = |at: &f64| at.abs() <= LARGEST_LENGTH;
        let at = match (&self.plane, self.at) {
            (Some(ViewPlane::Free(_)), Some(_)) => {
                Err(Problem::new("goes with a plane along two axes; move `origin`"))
            }
            (_, Some(at)) if !is_accepted(&at) => {
                let message = format!("must be finite and at most 1e15 in size, got {at} m");
                Err(Problem::about(message))
            }
            _ => Ok(()),
        };
        let plane = match &self.plane {
            Some(ViewPlane::Free(plane)) => plane.check(),
            _ => Ok(()),
        };
        Problems::all([
            at.map_err(|problem| problem.under("at").into()),
            plane.map_err(|problems| problems.under("plane")),
        ])
    }
}

/// How far from parallel the directions of a plane must be: the sine of their
/// angle. Less would lose most digits of the second direction.
const LEAST_SINE: f64 = 1e-6;

impl FreePlane {
    fn check(&self) -> Result<(), Problems> {
        let origin = crate::pose::position(&self.origin, 3).map_err(|p| p.under("origin"));
        let directions = [("right", &self.right), ("up", &self.up)].map(|(key, direction)| {
            crate::pose::direction(direction, 3).map_err(|problem| problem.under(key))
        });
        Problems::all(directions.into_iter().chain([origin]))?;
        let unit = |v: [f64; 3]| Vector(v).normalized().unwrap_or(Vector::ZERO);
        let (right, up) = (unit(self.right), unit(self.up));
        let across = up - right * right.dot(up);
        if across.norm() >= LEAST_SINE {
            return Ok(());
        }
        Err(Problem::about("must not be along `right`").under("up").into())
    }
}
