// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A shape as a file gives it.

use indexmap::IndexMap;
use palpate_field::Shape;
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::Value;

use crate::build;
use crate::json::{self, Document, Source};
use crate::problem::SceneError;
use crate::write::Writer;

/// A shape as a file gives it: an object that makes it, or the name of another shape.
///
/// It keeps what a [`Shape`](palpate_field::Shape) does not hold: references, descriptions, angles
/// in degrees and the order of keys. [`Scene::build`](crate::Scene::build) checks it and makes the
/// `Shape`; [`Scene::with_bodies`](crate::Scene::with_bodies) makes it of a `Shape`.
///
/// ```
/// use palpate_scene::{AnyScene, Dimension, Scene, WrittenBody, WrittenShape};
///
/// # fn main() -> Result<(), palpate_scene::SceneError> {
/// let cup = r#"{ "shell": 0.002, "of": { "ball": { "radius": 0.04 } } }"#;
/// let mut scene = Scene::new(Dimension::Three);
/// scene.shapes.insert("cup".into(), WrittenShape::from_json(cup)?);
/// scene.bodies.push(WrittenBody::new("my cup", WrittenShape::reference("cup")));
/// let AnyScene::Spatial(built) = scene.build()? else { unreachable!("dimension is 3") };
/// assert_eq!(built.whole.distance([0.0, 0.0, 0.0]), 0.039);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(transparent)]
pub struct WrittenShape(Value);

impl WrittenShape {
    /// The shape called `name`.
    pub fn reference(name: impl Into<String>) -> Self {
        Self(Value::String(name.into()))
    }

    /// Takes a JSON text, as it stands in a scene file.
    ///
    /// # Errors
    ///
    /// If the text is no JSON, repeats a key or has a number beyond the range of `f64`. Whether it
    /// makes a shape is checked by [`Scene::build`](crate::Scene::build).
    pub fn from_json(text: &str) -> Result<Self, SceneError> {
        Document::parse(&Source::of(text))?.into_value().map(Self::new)
    }

    /// A shape made in code, as a file holds it: the same node, and the same bits of every
    /// distance, when it is read. What the shape holds more than once is written as often.
    ///
    /// # Errors
    ///
    /// If the shape holds what files cannot say (a kernel, field or closure of a user), or more
    /// than a million nodes.
    ///
    /// ```
    /// use palpate_field::Shape;
    /// use palpate_scene::WrittenShape;
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let cup = Shape::cylinder(0.04, 0.09)? - Shape::cylinder(0.037, 0.08)?;
    /// let written = WrittenShape::of(&cup)?;
    /// assert_eq!(WrittenShape::from_json(&written.to_json())?.build::<3>()?, cup);
    /// # Ok(())
    /// # }
    /// ```
    pub fn of<const D: usize>(shape: &Shape<D>) -> Result<Self, SceneError> {
        Ok(Writer::new(IndexMap::new()).shape(shape)?)
    }

    /// Makes the shape, which must not refer to another by name.
    ///
    /// # Errors
    ///
    /// What is wrong, with its path; [`ShapeError`](palpate_field::ShapeError)s as they say.
    pub fn build<const D: usize>(&self) -> Result<Shape<D>, SceneError> {
        Ok(build::alone(self)?)
    }

    /// The JSON text, as it stands in a scene file.
    #[must_use]
    pub fn to_json(&self) -> String {
        json::write(&self.0)
    }

    /// Takes a JSON value.
    pub(crate) fn new(mut json: Value) -> Self {
        merge_spellings(&mut json);
        Self(json)
    }

    /// The JSON value.
    pub(crate) fn json(&self) -> &Value {
        &self.0
    }
}

impl<'de> Deserialize<'de> for WrittenShape {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Value::deserialize(deserializer).map(Self::new)
    }
}

/// Makes integers of whole numbers, so that `1` and `1.0` are equal. A negative zero and numbers
/// from 2⁵³ stay as they are.
fn merge_spellings(json: &mut Value) {
    match json {
        Value::Number(number) => {
            let Some(x) = number.as_f64().filter(|_| number.is_f64()) else { return };
            let is_negative_zero = x == 0.0 && x.is_sign_negative();
            if x.fract() == 0.0 && x.abs() < 9_007_199_254_740_992.0 && !is_negative_zero {
                *number = (x as i64).into();
            }
        }
        Value::Array(elements) => elements.iter_mut().for_each(merge_spellings),
        Value::Object(entries) => entries.values_mut().for_each(merge_spellings),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spellings_of_a_number_are_equal() {
        let shape = |text: &str| WrittenShape::from_json(text).unwrap();
        assert_eq!(shape("[1.0, -2e0, 1e15]"), shape("[1, -2, 1000000000000000]"));
        assert_ne!(shape("-0"), shape("0"));
        assert_eq!(shape("1e300").json().as_f64(), Some(1e300));
    }
}
