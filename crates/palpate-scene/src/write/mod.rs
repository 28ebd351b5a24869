// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Scenes of shapes that were made in code.

mod rotation;
mod shape;

use palpate_field::{Pose, Shape, Vector};
use palpate_haptics::Material;

use crate::material::WrittenMaterial;
use crate::pose::WrittenPose;
use crate::problem::{Problem, SceneError};
use crate::scene::{Dimension, Scene, WrittenBody};
pub(crate) use shape::Writer;

/// A shape made in code as a body of a scene: with its name, and where and of what it is.
///
/// ```
/// use palpate_field::{Pose, Shape};
/// use palpate_haptics::Material;
/// use palpate_scene::{Dimension, Scene, SceneBody};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let cup = Shape::cylinder(0.04, 0.09)? - Shape::cylinder(0.037, 0.08)?;
/// let cup = SceneBody::new("cup", cup)
///     .at(Pose::translation([0.0, 0.045, 0.0]))
///     .made_of(Material::wood());
/// let scene = Scene::new(Dimension::Three).with_bodies([cup])?;
/// assert_eq!(Scene::from_json(&scene.to_json())?, scene);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct SceneBody<const D: usize> {
    /// The name, unlike that of any other body.
    pub name: String,
    /// The shape, in the body's own coordinates.
    pub shape: Shape<D>,
    /// Where the body is; at the origin if `None`.
    pub world_from_body: Option<Pose<D>>,
    /// What the body feels like; the default material if `None`.
    pub material: Option<Material>,
}

impl<const D: usize> SceneBody<D> {
    /// A body of the default material at the origin.
    pub fn new(name: impl Into<String>, shape: Shape<D>) -> Self {
        Self { name: name.into(), shape, world_from_body: None, material: None }
    }

    /// The body at `world_from_body`.
    #[must_use]
    pub fn at(self, world_from_body: Pose<D>) -> Self {
        Self { world_from_body: Some(world_from_body), ..self }
    }

    /// The body with a material.
    #[must_use]
    pub fn made_of(self, material: Material) -> Self {
        Self { material: Some(material), ..self }
    }
}

impl Scene {
    /// The scene with further bodies, whose shapes were made in code.
    ///
    /// Written as a file and read again, a body has the same shape: the same
    /// [`node`](Shape::node), and the same bits of every distance. Angles and rotations are
    /// written in degrees or as a quaternion if those keep the bits, else in radians or as the
    /// rows of a matrix. A shape that is there more than once, in one body or in several, is
    /// written once, as one of [`shapes`](Self::shapes) that the others refer to: shapes are the
    /// same if they are clones of each other.
    ///
    /// # Errors
    ///
    /// If the bodies have another dimension than the scene, or if a shape holds what files cannot
    /// say (a kernel, field or closure of a user). The error has the path to the place, and the
    /// name of the Rust type.
    ///
    /// Names, poses and materials are checked by [`build`](Self::build), which also refuses a
    /// scene of more than a million nodes, or of more than 128 nested operators, with references
    /// followed.
    ///
    /// ```
    /// use palpate_field::{Promise, Shape};
    /// use palpate_scene::{Dimension, Scene, SceneBody};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let pin = Shape::cylinder(0.002, 0.03)?;
    /// let left = SceneBody::new("left", pin.clone().translated([-0.01, 0.0, 0.0])?);
    /// let right = SceneBody::new("right", pin.translated([0.01, 0.0, 0.0])?);
    /// let scene = Scene::new(Dimension::Three).with_bodies([left, right])?;
    /// assert_eq!(scene.shapes.keys().collect::<Vec<_>>(), ["shared_1"]);
    ///
    /// let floor = Shape::from_fn(Promise::lipschitz(None, 1.0), |p| p.0[1]);
    /// let floor = SceneBody::new("floor", Shape::cuboid([1.0, 0.1, 1.0])? | floor);
    /// let error = Scene::new(Dimension::Three).with_bodies([floor]).unwrap_err();
    /// assert_eq!(error.first().path, "bodies[0].shape.union[1]");
    /// # Ok(())
    /// # }
    /// ```
    pub fn with_bodies<const D: usize>(
        self,
        bodies: impl IntoIterator<Item = SceneBody<D>>,
    ) -> Result<Self, SceneError> {
        self.with_all(&bodies.into_iter().collect::<Vec<_>>())
    }

    #[inline(never)]
    pub(crate) fn with_all<const D: usize>(
        mut self,
        bodies: &[SceneBody<D>],
    ) -> Result<Self, SceneError> {
        if self.dimension().count() != D {
            let message = format!("the scene is {}, its bodies are {D}D", self.dimension());
            return Err(Problem::new(message).under("bodies").into());
        }
        let mut writer = Writer::new(std::mem::take(&mut self.shapes));
        bodies.iter().for_each(|body| writer.count(&body.shape));
        for body in bodies {
            let place = self.bodies.len();
            let written = written(&mut writer, body)
                .map_err(|problem| problem.at(place).under("bodies"))?;
            self.bodies.push(written);
        }
        self.shapes = writer.finish();
        Ok(self)
    }

    /// A scene with one body, called `name`, at the origin.
    ///
    /// # Errors
    ///
    /// As [`with_bodies`](Self::with_bodies).
    ///
    /// ```
    /// use palpate_field::Shape;
    /// use palpate_scene::Scene;
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let scene = Scene::of_shape("coin", &Shape::circle(0.01)?)?;
    /// let text = r#""bodies": [{ "name": "coin", "shape": { "ball": { "radius": 0.01 } } }]"#;
    /// assert!(scene.to_json().contains(text));
    /// # Ok(())
    /// # }
    /// ```
    pub fn of_shape<const D: usize>(
        name: impl Into<String>,
        shape: &Shape<D>,
    ) -> Result<Self, SceneError> {
        let dimension = if D == 2 { Dimension::Two } else { Dimension::Three };
        Self::new(dimension).with_bodies([SceneBody::new(name, shape.clone())])
    }
}

fn written<const D: usize>(
    writer: &mut Writer,
    body: &SceneBody<D>,
) -> Result<WrittenBody, Problem> {
    let shape = writer.shape(&body.shape).map_err(|problem| problem.under("shape"))?;
    Ok(WrittenBody {
        pose: body.world_from_body.as_ref().map(pose),
        material: body.material.clone().map(WrittenMaterial::from),
        ..WrittenBody::new(&body.name, shape)
    })
}

fn pose<const D: usize>(pose: &Pose<D>) -> WrittenPose {
    WrittenPose {
        translation: translation(pose.translation),
        rotation: rotation::written(&pose.rotation),
        description: None,
    }
}

/// The numbers of a translation; `None` for none.
fn translation<const D: usize>(translation: Vector<f64, D>) -> Option<Vec<f64>> {
    let moves = translation.0.iter().any(|x| x.to_bits() != 0);
    moves.then(|| translation.0.to_vec())
}
