// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The data of a scene file.

use std::fmt;
use std::path::Path;

use indexmap::IndexMap;
#[cfg(test)]
use schemars::JsonSchema;
use serde::de::{Deserializer, Unexpected, Visitor};
use serde::{Deserialize, Serialize, Serializer};

use crate::build::{self, AnyScene};
use crate::encoding::utf8;
use crate::file::{LARGEST_FILE, read_file};
use crate::guide::WrittenGuide;
use crate::json::{self, Document, Source};
use crate::material::WrittenMaterial;
use crate::mesh_file::Resources;
use crate::motion::WrittenMotion;
use crate::pose::WrittenPose;
use crate::problem::{Problem, SceneError, SceneProblem};
use crate::shape::WrittenShape;
use crate::tool::WrittenTool;
use crate::view::WrittenView;

/// The number of dimensions of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Dimension {
    /// The plane: x to the right, y up.
    Two,
    /// Space: right-handed, y up.
    Three,
}

impl Dimension {
    /// 2 or 3.
    #[must_use]
    pub const fn count(self) -> usize {
        match self {
            Self::Two => 2,
            Self::Three => 3,
        }
    }
}

impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}D", self.count())
    }
}

/// The data of a scene file: named shapes, bodies, a tool, guides, motions and views.
///
/// Plain data: [`build`](Self::build) checks it and makes the shapes.
///
/// ```
/// use palpate_scene::{Scene, AnyScene};
///
/// # fn main() -> Result<(), palpate_scene::SceneError> {
/// let scene = Scene::from_json(
///     r#"{ "palpate": 1, "dimension": 2,
///          "bodies": [ { "name": "coin", "shape": { "ball": { "radius": 0.5 } },
///                        "pose": { "translation": [1, 0] } } ] }"#,
/// )?;
/// assert_eq!(Scene::from_json(&scene.to_json())?, scene);
/// if let AnyScene::Planar(world) = scene.build()? {
///     assert_eq!(world.whole.distance([3.0, 0.0]), 1.5);
/// }
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(JsonSchema))]
#[serde(deny_unknown_fields, expecting = "an object")]
#[non_exhaustive]
pub struct Scene {
    /// The version of the format: 1.
    palpate: Version,
    /// 2 for the plane, 3 for space.
    #[cfg_attr(test, schemars(schema_with = "crate::schema::dimension"))]
    dimension: Dimension,
    /// A note for readers of the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
    /// Shapes that have a name, which any shape may refer to.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    #[cfg_attr(test, schemars(schema_with = "crate::schema::named_shapes"))]
    pub shapes: IndexMap<String, WrittenShape>,
    /// The bodies to be touched; at least one.
    #[cfg_attr(test, schemars(length(min = 1)))]
    pub bodies: Vec<WrittenBody>,
    /// The tool that touches them: the tip of a stylus, fingers, or a shape held in the hand.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tool: Option<WrittenTool>,
    /// Guides of the hand in free space.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub guides: Vec<WrittenGuide>,
    /// Motions of bodies.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub motions: Vec<WrittenMotion>,
    /// Pictures worth making of the scene.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub views: Vec<WrittenView>,
    /// What it uses beside its text.
    #[serde(skip)]
    #[cfg_attr(test, schemars(skip))]
    pub resources: Resources,
}

/// A body: a shape with its pose in the world and its material.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(JsonSchema))]
#[serde(deny_unknown_fields, expecting = "an object")]
#[cfg_attr(test, schemars(rename = "Body"))]
#[non_exhaustive]
pub struct WrittenBody {
    /// The name, unlike that of any other body.
    #[cfg_attr(test, schemars(length(min = 1)))]
    pub name: String,
    /// A note for readers of the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
    /// The shape, in the body's own coordinates.
    pub shape: WrittenShape,
    /// Where the body is, as `world_from_body`; at the origin if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pose: Option<WrittenPose>,
    /// The material, in numbers or as the name of a preset; the default material if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(test, schemars(schema_with = "crate::schema::material"))]
    pub material: Option<WrittenMaterial>,
}

impl WrittenBody {
    /// A body of the default material at the origin.
    pub fn new(name: impl Into<String>, shape: WrittenShape) -> Self {
        Self { name: name.into(), description: None, shape, pose: None, material: None }
    }
}

impl Scene {
    /// An empty scene; [`build`](Self::build) refuses it until it has a body.
    #[must_use]
    pub fn new(dimension: Dimension) -> Self {
        Self {
            palpate: Version,
            dimension,
            description: None,
            shapes: IndexMap::new(),
            bodies: Vec::new(),
            tool: None,
            guides: Vec::new(),
            motions: Vec::new(),
            views: Vec::new(),
            resources: Resources::default(),
        }
    }

    /// Reads a scene and checks it as [`build`](Self::build) does, its unused
    /// shapes too. A byte order mark is passed over.
    ///
    /// # Errors
    ///
    /// All that is wrong, with paths, lines and columns.
    pub fn from_json(text: &str) -> Result<Self, SceneError> {
        Self::from_json_in(text, Resources::default())
    }

    /// As [`from_json`](Self::from_json); its files are in a folder, or it uses other resources too.
    ///
    /// # Errors
    ///
    /// As `from_json`.
    pub fn from_json_in(
        text: &str,
        resources: impl Into<Resources>,
    ) -> Result<Self, SceneError> {
        Self::parsed(text, &resources.into())
    }

    // Not generic, so that it is compiled once.
    fn parsed(text: &str, resources: &Resources) -> Result<Self, SceneError> {
        let source = Source::of(text);
        let with = |scene: Self| Self { resources: resources.clone(), ..scene };
        let read = Document::parse(&source)?
            .read(|scene: &Self| build::world(&with(scene.clone())).map(drop))?;
        Ok(with(read))
    }

    /// Reads a scene from the bytes of a file, as [`from_json`](Self::from_json).
    ///
    /// # Errors
    ///
    /// As `from_json`; if the bytes are not UTF-8, an error that says what they are.
    ///
    /// ```
    /// use palpate_scene::Scene;
    ///
    /// let error = Scene::from_bytes(b"{ \"palpate\": 1, \"description\": \"caf\xe9\" }").unwrap_err();
    /// assert!(error.to_string().starts_with("the file is not UTF-8: byte 35, in line 1, is 0xe9"));
    /// ```
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, SceneError> {
        Self::from_json(utf8(bytes).map_err(|error| Problem::new(error.to_string()))?)
    }

    /// As [`from_bytes`](Self::from_bytes); its files are in a folder, or it uses other resources too.
    ///
    /// # Errors
    ///
    /// As `from_bytes`.
    pub fn from_bytes_in(
        bytes: &[u8],
        resources: impl Into<Resources>,
    ) -> Result<Self, SceneError> {
        let text = utf8(bytes).map_err(|error| Problem::new(error.to_string()))?;
        Self::from_json_in(text, resources)
    }

    /// Reads a scene from the file at `path`, as [`from_bytes`](Self::from_bytes); the files of its meshes
    /// are looked for beside it.
    ///
    /// # Errors
    ///
    /// As `from_bytes`; if the file cannot be read, or has more bytes than [`LARGEST_FILE`], an error
    /// without place that names it.
    pub fn from_file(path: impl AsRef<Path>) -> Result<Self, SceneError> {
        Self::from_file_within(path, LARGEST_FILE)
    }

    /// As [`from_file`](Self::from_file), of a file that has at most `most` bytes.
    ///
    /// # Errors
    ///
    /// As `from_file`.
    pub fn from_file_within(path: impl AsRef<Path>, most: u64) -> Result<Self, SceneError> {
        let path = path.as_ref();
        let bytes =
            read_file(path, most).map_err(|error| SceneProblem::of_file(path, &error))?;
        Self::from_bytes_in(&bytes, path.parent().unwrap_or(Path::new("")))
    }

    /// The scene as a file: its keys in a fixed order, those of shapes as they were read.
    ///
    /// Reading it again gives the same scene, to the last bit of each number.
    /// Numbers that are not finite, which [`build`](Self::build) refuses, become
    /// `null`.
    #[must_use]
    pub fn to_json(&self) -> String {
        // Serialisation of plain data to a value has no way to fail.
        json::write(&serde_json::to_value(self).unwrap_or_default())
    }

    /// The number of dimensions.
    #[must_use]
    pub fn dimension(&self) -> Dimension {
        self.dimension
    }

    /// Makes the shapes and places the bodies.
    ///
    /// # Errors
    ///
    /// All that is wrong, with paths; lines are known to
    /// [`from_json`](Self::from_json) alone.
    pub fn build(&self) -> Result<AnyScene, SceneError> {
        Ok(build::world(self)?)
    }
}

/// The version of the format that this crate reads: 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Version;

#[cfg(test)]
impl JsonSchema for Version {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Version".into()
    }

    fn inline_schema() -> bool {
        true
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({ "const": 1 })
    }
}

impl Serialize for Version {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_u8(1)
    }
}

impl<'de> Deserialize<'de> for Version {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let expected = "1, the one version of the format so far";
        deserializer.deserialize_u64(OneOf(&[(1, Self)], expected))
    }
}

impl Serialize for Dimension {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_u8(match self {
            Self::Two => 2,
            Self::Three => 3,
        })
    }
}

impl<'de> Deserialize<'de> for Dimension {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_u64(OneOf(&[(2, Self::Two), (3, Self::Three)], "2 or 3"))
    }
}

/// Takes one of a few numbers, and says which.
struct OneOf<'a, T>(&'a [(u64, T)], &'static str);

impl<T: Copy> Visitor<'_> for OneOf<'_, T> {
    type Value = T;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.1)
    }

    fn visit_u64<E: serde::de::Error>(self, number: u64) -> Result<T, E> {
        let found = self.0.iter().find(|(accepted, _)| *accepted == number);
        found
            .map(|(_, value)| *value)
            .ok_or_else(|| E::invalid_value(Unexpected::Unsigned(number), &self))
    }
}
