// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A shape as a file gives it.

use serde::{Deserialize, Deserializer, Serialize};
use serde_json::Value;

use crate::error::SceneError;
use crate::json::Document;

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
        Document::parse(text).map(|document| Self::new(document.into_value()))
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
