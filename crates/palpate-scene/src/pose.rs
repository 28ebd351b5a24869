// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Poses and rotations, as they are written.

use std::fmt;

use palpate_field::{Pose, Rotation, ShapeError, Unit, Vector};
#[cfg(test)]
use schemars::JsonSchema;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, MapAccess, Visitor};
use serde::{Deserialize, Serialize, Serializer};

pub(crate) use crate::attitude::Attitude;
use crate::problem::{Problem, Problems};
#[cfg(test)]
use crate::schema::{TurnSchema, VectorSchema};

/// A rotation and then a translation, as a file gives them.
///
/// ```
/// use palpate_scene::WrittenPose;
///
/// # fn main() -> Result<(), serde_json::Error> {
/// let text = r#"{ "translation": [0, 0.045, 0], "rotate_degrees": { "axis": [0, 1, 0], "angle": 30 } }"#;
/// let pose: WrittenPose = serde_json::from_str(text)?;
/// assert_eq!(pose.translation, Some(vec![0.0, 0.045, 0.0]));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "PoseFile", into = "PoseFile")]
#[non_exhaustive]
pub struct WrittenPose {
    /// A note for readers of the file.
    pub description: Option<String>,
    /// The translation, applied second [m]; none if left out.
    pub translation: Option<Vec<f64>>,
    /// The rotation, applied first; none if left out.
    pub rotation: Option<WrittenRotation>,
}

/// A rotation, as a file gives it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum WrittenRotation {
    /// In the plane: an angle from x towards y [°].
    Degrees(f64),
    /// In space: an angle about an axis, counter-clockwise seen from its tip.
    AxisAngle(AxisAngle),
    /// In space: a quaternion `[x, y, z, w]` of any length but zero.
    Quaternion([f64; 4]),
    /// The rows of a matrix, orthonormal within 1e-6. Rows that are so to rounding, as those of a
    /// [`Rotation`], keep their bits.
    Rows(Vec<Vec<f64>>),
}

/// A rotation about an axis.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(JsonSchema))]
#[serde(deny_unknown_fields, expecting = "an object")]
pub struct AxisAngle {
    /// A note for readers of the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
    /// The direction of the axis, of any length but zero.
    pub axis: [f64; 3],
    /// The angle [°].
    pub angle: f64,
}

impl AxisAngle {
    /// A turn by `angle` [°] about `axis`.
    #[must_use]
    pub fn new(axis: [f64; 3], angle: f64) -> Self {
        Self { description: None, axis, angle }
    }
}

/// A rotation and then a translation.
#[derive(Serialize, Deserialize)]
#[cfg_attr(test, derive(JsonSchema))]
#[serde(deny_unknown_fields, expecting = "an object")]
#[cfg_attr(test, schemars(rename = "Pose"))]
#[cfg_attr(test, schemars(extend("not" = { "required": ["rotate_degrees", "rotation"] })))]
struct PoseFile {
    /// A note for readers of the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    description: Option<String>,
    /// The translation, applied second [m].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(with = "Option<VectorSchema>"))]
    translation: Option<Vec<f64>>,
    /// The rotation, applied first: degrees in the plane, axis and angle in
    /// space.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    rotate_degrees: Option<Turn>,
    /// The rotation, applied first: the rows of a matrix, or in space a quaternion
    /// `[x, y, z, w]`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    rotation: Option<Attitude>,
}

#[cfg(test)]
impl JsonSchema for WrittenPose {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        PoseFile::schema_name()
    }

    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        PoseFile::json_schema(generator)
    }
}

/// What `rotate_degrees` takes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Turn {
    Degrees(f64),
    AxisAngle(AxisAngle),
}

#[cfg(test)]
impl JsonSchema for Turn {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        TurnSchema::schema_name()
    }

    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        TurnSchema::json_schema(generator)
    }
}

impl Serialize for Turn {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Degrees(angle) => angle.serialize(serializer),
            Self::AxisAngle(turn) => turn.serialize(serializer),
        }
    }
}

impl<'de> Deserialize<'de> for Turn {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(TurnVisitor)
    }
}

struct TurnVisitor;

impl<'de> Visitor<'de> for TurnVisitor {
    type Value = Turn;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number of degrees in 2D, an object with `axis` and `angle` in 3D")
    }

    fn visit_u64<E>(self, degrees: u64) -> Result<Turn, E> {
        Ok(Turn::Degrees(degrees as f64))
    }

    fn visit_i64<E>(self, degrees: i64) -> Result<Turn, E> {
        Ok(Turn::Degrees(degrees as f64))
    }

    fn visit_f64<E>(self, degrees: f64) -> Result<Turn, E> {
        Ok(Turn::Degrees(degrees))
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Turn, A::Error> {
        AxisAngle::deserialize(MapAccessDeserializer::new(map)).map(Turn::AxisAngle)
    }
}

impl TryFrom<PoseFile> for WrittenPose {
    type Error = &'static str;

    fn try_from(file: PoseFile) -> Result<Self, Self::Error> {
        let rotation = one_rotation(file.rotate_degrees, file.rotation)?;
        Ok(Self { description: file.description, translation: file.translation, rotation })
    }
}

impl From<WrittenPose> for PoseFile {
    fn from(pose: WrittenPose) -> Self {
        let (rotate_degrees, rotation) = keys(pose.rotation);
        Self {
            description: pose.description,
            translation: pose.translation,
            rotate_degrees,
            rotation,
        }
    }
}

/// The rotation of the two keys that may give it.
pub(crate) fn one_rotation(
    rotate_degrees: Option<Turn>,
    rotation: Option<Attitude>,
) -> Result<Option<WrittenRotation>, &'static str> {
    Ok(match (rotate_degrees, rotation) {
        (None, None) => None,
        (Some(Turn::Degrees(angle)), None) => Some(WrittenRotation::Degrees(angle)),
        (Some(Turn::AxisAngle(turn)), None) => Some(WrittenRotation::AxisAngle(turn)),
        (None, Some(Attitude::Quaternion(q))) => Some(WrittenRotation::Quaternion(q)),
        (None, Some(Attitude::Rows(rows))) => Some(WrittenRotation::Rows(rows)),
        (Some(_), Some(_)) => {
            return Err("`rotate_degrees` and `rotation` say the same; give one of them");
        }
    })
}

/// The values of `rotate_degrees` and `rotation`.
pub(crate) fn keys(rotation: Option<WrittenRotation>) -> (Option<Turn>, Option<Attitude>) {
    match rotation {
        None => (None, None),
        Some(WrittenRotation::Degrees(angle)) => (Some(Turn::Degrees(angle)), None),
        Some(WrittenRotation::AxisAngle(turn)) => (Some(Turn::AxisAngle(turn)), None),
        Some(WrittenRotation::Quaternion(q)) => (None, Some(Attitude::Quaternion(q))),
        Some(WrittenRotation::Rows(rows)) => (None, Some(Attitude::Rows(rows))),
    }
}

impl WrittenRotation {
    /// The key it has in files.
    pub(crate) fn key(&self) -> &'static str {
        match self {
            Self::Degrees(_) | Self::AxisAngle(_) => "rotate_degrees",
            Self::Quaternion(_) | Self::Rows(_) => "rotation",
        }
    }
}

/// What turns a written rotation into one of `D` dimensions.
pub(crate) trait Turning<const D: usize> {
    /// The rotation; a problem seen from its own place.
    fn rotation(written: &WrittenRotation) -> Result<Rotation<D>, Problem>;
}

/// The two dimensions.
pub(crate) struct Turns;

impl Turning<2> for Turns {
    fn rotation(written: &WrittenRotation) -> Result<Rotation<2>, Problem> {
        match written {
            WrittenRotation::Degrees(angle) => {
                Rotation::from_angle(radians(*angle)?).map_err(|e| Problem::new(e.to_string()))
            }
            WrittenRotation::AxisAngle(_) => {
                Err(Problem::about("must be a number of degrees in 2D, got an object")
                    .of_dimension())
            }
            WrittenRotation::Quaternion(_) => {
                Err(Problem::new("a quaternion turns in 3D; in 2D give `rotate_degrees`")
                    .of_dimension())
            }
            WrittenRotation::Rows(rows) => of_rows(rows),
        }
    }
}

impl Turning<3> for Turns {
    fn rotation(written: &WrittenRotation) -> Result<Rotation<3>, Problem> {
        let seen = |key: Option<&str>, error: ShapeError| {
            let problem = Problem::of_shape(error);
            key.map_or(problem.clone(), |key| problem.under(key))
        };
        match written {
            WrittenRotation::Degrees(_) => Err(Problem::about(
                "must be an object with `axis` and `angle` in 3D, got a number",
            )
            .of_dimension()),
            WrittenRotation::AxisAngle(turn) => {
                let angle = radians(turn.angle).map_err(|problem| problem.under("angle"))?;
                Rotation::from_axis_angle(Vector(turn.axis), angle)
                    .map_err(|error| seen(Some("axis"), error))
            }
            WrittenRotation::Quaternion(quaternion) => {
                Rotation::from_quaternion(*quaternion).map_err(|error| seen(None, error))
            }
            WrittenRotation::Rows(rows) => of_rows(rows),
        }
    }
}

/// The rotation with these rows.
pub(crate) fn of_rows<const D: usize>(rows: &[Vec<f64>]) -> Result<Rotation<D>, Problem> {
    let count = rows.len();
    let arrays: Vec<_> = rows.iter().filter_map(|row| row.as_slice().try_into().ok()).collect();
    let Ok(rows) = <[[f64; D]; D]>::try_from(arrays) else {
        let message = format!("rotation must have {D} rows of {D} numbers in {D}D");
        let problem = Problem::new(message);
        return Err(if count == 5 - D { problem.of_dimension() } else { problem });
    };
    Rotation::from_rows(rows).map_err(Problem::of_shape)
}

/// The largest angle accepted [°]: beyond, less than a millionth of a degree is
/// left of its remainder.
const LARGEST_ANGLE: f64 = 1e9;

fn radians(degrees: f64) -> Result<f64, Problem> {
    if degrees.abs() <= LARGEST_ANGLE {
        Ok(degrees.to_radians())
    } else {
        let message = format!("must be at most 1e9 degrees either way, got {degrees}°");
        Err(Problem::about(message))
    }
}

/// The numbers of a vector of `D` dimensions.
pub(crate) fn array<const D: usize>(numbers: &[f64]) -> Result<[f64; D], Problem> {
    numbers.try_into().map_err(|_| {
        let count = numbers.len();
        let problem = Problem::about(format!("must have {D} numbers in {D}D, got {count}"));
        if count == 5 - D { problem.of_dimension() } else { problem }
    })
}

/// The numbers of a vector of `D` dimensions, each within the range of lengths.
pub(crate) fn vector<const D: usize>(numbers: &[f64]) -> Result<Vector<f64, D>, Problem> {
    let components: [f64; D] = array(numbers)?;
    // Written so that NaN is refused.
    let accepted = |x: f64| x.abs() <= palpate_field::LARGEST_LENGTH;
    if let Some(i) = components.iter().position(|x| !accepted(*x)) {
        let quantity = palpate_field::Quantity(components[i], Unit::Metre);
        let message = format!("must be finite and at most 1e15 in size, got {quantity}");
        return Err(Problem::about(message).at(i));
    }
    Ok(Vector(components))
}

/// The pose with this translation and rotation, whose keys are as given.
pub(crate) fn pose<const D: usize>(
    translation: (&str, Option<&[f64]>),
    rotation: Option<&WrittenRotation>,
) -> Result<Pose<D>, Problems>
where
    Turns: Turning<D>,
{
    let (key, translation) = translation;
    let translation = match translation {
        Some(numbers) => vector(numbers).map_err(|problem| problem.under(key)),
        None => Ok(Vector::ZERO),
    };
    let rotation = match rotation {
        Some(written) => <Turns as Turning<D>>::rotation(written)
            .map_err(|problem| problem.under(written.key())),
        None => Ok(Rotation::identity()),
    };
    let (translation, rotation) = Problems::both(translation, rotation)?;
    Ok(Pose::new(rotation, translation))
}

impl WrittenPose {
    /// The pose in `D` dimensions.
    pub(crate) fn built<const D: usize>(&self) -> Result<Pose<D>, Problems>
    where
        Turns: Turning<D>,
    {
        pose(("translation", self.translation.as_deref()), self.rotation.as_ref())
    }
}

/// Checks a position in a scene of `dimension`.
pub(crate) fn position(numbers: &[f64], dimension: usize) -> Result<(), Problem> {
    match dimension {
        2 => vector::<2>(numbers).map(drop),
        _ => vector::<3>(numbers).map(drop),
    }
}

/// Checks a direction in a scene of `dimension`: a vector that is not zero.
pub(crate) fn direction(numbers: &[f64], dimension: usize) -> Result<(), Problem> {
    position(numbers, dimension)?;
    if numbers.iter().any(|x| x.abs() >= f64::MIN_POSITIVE) {
        return Ok(());
    }
    Err(Problem::about("must be a direction, got a vector of length 0"))
}
