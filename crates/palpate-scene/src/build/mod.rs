// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Builds a scene: from the data of a file to shapes that can be evaluated.

mod builder;
mod motion;
mod object;
mod operator;
mod primitive;

use std::any::Any;
use std::collections::HashMap;
use std::collections::hash_map::Entry;

use palpate_field::{Point, Pose, Shape};

use palpate_haptics::{Guide, Material, ToolOptions};
use palpate_safety::{Acceptance, WorkspaceMap};
use palpate_vibration::Actuator;

use crate::mesh_file::BuiltMesh;
use crate::names::shortened;
use crate::pose::{Turning, Turns, vector};
use crate::problem::{Problem, Problems};
use crate::scene::{Dimension, Scene, WrittenBody};
use crate::shape::WrittenShape;
use crate::view::WrittenView;
use builder::{Builder, Space};
pub use motion::{BuiltMotion, MotionJump, MotionSpeed};
pub(crate) use object::MOST;

/// The most bodies of a scene: each has a shape, a material and a place among those that a hand
/// touches, which take a hundred times as much memory as its text.
const MOST_BODIES: usize = 100_000;

/// A built scene, in its dimension.
#[derive(Clone, Debug)]
pub enum AnyScene {
    /// A scene in the plane.
    Planar(BuiltScene<2>),
    /// A scene in space.
    Spatial(BuiltScene<3>),
}

/// A built scene: its bodies, tool, guides, motions and views.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct BuiltScene<const D: usize> {
    /// The bodies, in the order of the scene.
    pub bodies: Vec<BuiltBody<D>>,
    /// The union of the bodies in the world.
    pub whole: Shape<D>,
    /// The tool, if the scene has one.
    pub tool: Option<BuiltTool<D>>,
    /// The guides of the hand in free space.
    pub guides: Vec<Guide>,
    /// The motions of its bodies, in the order of the scene.
    pub motions: Vec<BuiltMotion<D>>,
    /// The pictures worth making of it.
    pub views: Vec<WrittenView>,
    /// The map from the device's space to the world; `None` if the scene gives none.
    pub workspace: Option<WorkspaceMap>,
    /// The mesh files that its shapes are made of, and what was found in each.
    pub meshes: Vec<BuiltMesh>,
}

/// The tool of a built scene.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct BuiltTool<const D: usize> {
    /// The radius of each contact point, or the offset added to the shape [m].
    pub radius: f64,
    /// The contact points in the tool's own coordinates [m]; empty for one at the origin.
    pub points: Vec<Point<3>>,
    /// The shape in the tool's own coordinates, instead of points.
    pub shape: Option<Shape<D>>,
    /// The coupling of a tool with a shape, and the largest force on the hand, which the scene may
    /// leave to the device.
    pub options: ToolOptions,
    /// The largest power of bodies that move on the hand, if the scene says so [W].
    pub drive_power: Option<f64>,
    /// What a device renders of materials, if the scene says so.
    pub acceptance: Option<Acceptance>,
    /// What shakes each contact point, if the scene says so.
    pub actuator: Option<Actuator>,
}

impl<const D: usize> BuiltTool<D> {
    /// One contact point at the origin, of this radius [m].
    #[must_use]
    pub fn of_radius(radius: f64) -> Self {
        Self {
            radius,
            points: Vec::new(),
            shape: None,
            options: ToolOptions::default(),
            drive_power: None,
            acceptance: None,
            actuator: None,
        }
    }
}

/// A body of a built scene.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct BuiltBody<const D: usize> {
    /// Its name.
    pub name: String,
    /// Its shape in the world.
    pub shape: Shape<D>,
    /// Its shape in its own coordinates.
    pub shape_in_body: Shape<D>,
    /// Its pose.
    pub world_from_body: Pose<D>,
    /// Its material.
    pub material: Material,
}

/// Builds a shape that refers to no other.
pub(crate) fn alone<const D: usize>(written: &WrittenShape) -> Result<Shape<D>, Problems> {
    let dimension = if D == 2 { Dimension::Two } else { Dimension::Three };
    let scene = Scene::new(dimension);
    let mut builder = Builder::new(&scene);
    let shape: Box<dyn Any> = match dimension {
        Dimension::Two => Box::new(builder.shape::<2>(written)?),
        Dimension::Three => Box::new(builder.shape::<3>(written)?),
    };
    let shape = shape.downcast().map_err(|_| Problem::new("shapes are in 2D or 3D"))?;
    Ok(*shape)
}

/// Checks and builds a scene.
pub(crate) fn world(scene: &Scene) -> Result<AnyScene, Problems> {
    match scene.dimension() {
        Dimension::Two => built(scene).map(AnyScene::Planar),
        Dimension::Three => built(scene).map(AnyScene::Spatial),
    }
}

fn built<const D: usize>(scene: &Scene) -> Result<BuiltScene<D>, Problems>
where
    for<'a> Builder<'a>: Space<'a, D>,
    Turns: Turning<D>,
{
    let mut builder = Builder::new(scene);
    let mut wrong = Problems::default();
    wrong.kept(builder.named_shapes::<D>().map_err(|problems| problems.under("shapes")));
    let names = names(scene.bodies.iter().map(|body| body.name.as_str()));
    wrong.kept(names.map_err(|problems| problems.under("bodies")));
    let bodies = bodies(scene, &mut builder).map_err(|problems| problems.under("bodies"));
    let bodies = wrong.kept(bodies);
    let tool = tool(scene, &mut builder).map_err(|problems| problems.under("tool"));
    let tool = wrong.kept(tool);
    let guides = wrong.kept(guides(scene).map_err(|problems| problems.under("guides")));
    let motions = motion::motions(scene, bodies.as_deref());
    let motions = wrong.kept(motions.map_err(|problems| problems.under("motions")));
    wrong.kept(check_views(scene, D).map_err(|problems| problems.under("views")));
    let workspace = workspace(scene).map_err(|problems| problems.under("tool"));
    let workspace = wrong.kept(workspace);
    let (Some(bodies), Some(tool), Some(guides), Some(motions), Some(workspace), false) =
        (bodies, tool, guides, motions, workspace, wrong.is_failed())
    else {
        return Err(wrong);
    };
    let whole = Shape::union(bodies.iter().map(|body| body.shape.clone()))
        .map_err(|error| Problem::of_shape(error).under("bodies"))?;
    let views = scene.views.clone();
    let meshes = builder.meshes;
    Ok(BuiltScene { bodies, whole, tool, guides, motions, views, workspace, meshes })
}

fn bodies<'a, const D: usize>(
    scene: &'a Scene,
    builder: &mut Builder<'a>,
) -> Result<Vec<BuiltBody<D>>, Problems>
where
    Builder<'a>: Space<'a, D>,
    Turns: Turning<D>,
{
    if scene.bodies.is_empty() {
        return Err(Problem::about("must have at least 1 body, got 0").into());
    }
    let count = scene.bodies.len();
    if count > MOST_BODIES {
        let message = format!("must have at most {MOST_BODIES} bodies, got {count}");
        return Err(Problem::about(message).into());
    }
    let mut wrong = Problems::default();
    let mut bodies = Vec::with_capacity(scene.bodies.len());
    for (i, written) in scene.bodies.iter().enumerate() {
        let body = body(written, builder).map_err(|problems| problems.at(i));
        bodies.extend(wrong.kept(body));
    }
    wrong.end(Ok(bodies))
}

fn body<'a, const D: usize>(
    body: &'a WrittenBody,
    builder: &mut Builder<'a>,
) -> Result<BuiltBody<D>, Problems>
where
    Builder<'a>: Space<'a, D>,
    Turns: Turning<D>,
{
    let mut wrong = Problems::default();
    let shape = builder.shape(&body.shape).map_err(|problems| problems.under("shape"));
    let shape: Option<Shape<D>> = wrong.kept(shape);
    let pose = body.pose.as_ref().map(|pose| pose.built()).transpose();
    let pose: Option<Option<Pose<D>>> =
        wrong.kept(pose.map_err(|problems| problems.under("pose")));
    let material = body.material.as_ref().map_or_else(
        || Ok(Material::default()),
        |written| {
            let material = written.known()?;
            crate::material::check(&material, D).map(|()| material)
        },
    );
    let material = wrong.kept(material.map_err(|problems| problems.under("material")));
    let (Some(shape_in_body), Some(pose), Some(material)) = (shape, pose, material) else {
        return Err(wrong);
    };
    let shape = match &pose {
        Some(pose) => shape_in_body.clone().placed(pose).map_err(Problem::of_shape)?,
        None => shape_in_body.clone(),
    };
    let world_from_body = pose.unwrap_or_else(Pose::identity);
    let name = body.name.clone();
    Ok(BuiltBody { name, shape, shape_in_body, world_from_body, material })
}

/// The map from the device's space to the world, if the tool has one.
fn workspace<const D: usize>(scene: &Scene) -> Result<Option<WorkspaceMap>, Problems>
where
    Turns: Turning<D>,
{
    let workspace = scene.tool.as_ref().and_then(|tool| tool.workspace.as_ref());
    let Some(workspace) = workspace else { return Ok(None) };
    let pose = workspace.pose.as_ref().map(|pose| pose.built::<D>()).transpose();
    let pose = pose.map_err(|problems| problems.under("pose"));
    let scale = crate::problem::positive("scale", workspace.scale, "");
    let made = Problems::both(pose, scale).and_then(|(pose, ())| {
        let map = WorkspaceMap::new(
            pose.map_or_else(Pose::identity, |pose| pose.in_space()),
            workspace.scale,
        );
        map.map_err(|error| Problem::new(error.to_string()).into())
    });
    made.map(Some).map_err(|problems| problems.under("workspace"))
}

fn tool<'a, const D: usize>(
    scene: &'a Scene,
    builder: &mut Builder<'a>,
) -> Result<Option<BuiltTool<D>>, Problems>
where
    Builder<'a>: Space<'a, D>,
    Turns: Turning<D>,
{
    let Some(tool) = &scene.tool else { return Ok(None) };
    let shape = tool.shape.as_ref().map(|written| builder.shape(written)).transpose();
    let shape = shape.map_err(|problems| problems.under("shape"));
    let (shape, ()) = Problems::both(shape, tool.check(D))?;
    let points = tool.points.iter().map(|point| Ok(vector::<D>(point)?.in_space()));
    Ok(Some(BuiltTool {
        radius: tool.probe_radius(),
        points: points.collect::<Result<_, Problem>>()?,
        shape,
        options: tool.options(),
        drive_power: tool.drive_power,
        acceptance: tool.acceptance.map(Into::into),
        actuator: tool.actuator()?,
    }))
}

fn guides(scene: &Scene) -> Result<Vec<Guide>, Problems> {
    let dimension = scene.dimension();
    let mut wrong = Problems::default();
    let mut guides = Vec::with_capacity(scene.guides.len());
    for (i, guide) in scene.guides.iter().enumerate() {
        let made = guide
            .check(dimension.count())
            .and_then(|()| guide.built(dimension).map_err(Into::into));
        guides.extend(wrong.kept(made.map_err(|problems| problems.at(i))));
    }
    wrong.end(Ok(guides))
}

fn check_views(scene: &Scene, dimension: usize) -> Result<(), Problems> {
    let names = names(scene.views.iter().map(|view| view.name.as_str()));
    let views = scene.views.iter().enumerate();
    let views = views.map(|(i, view)| view.check(dimension).map_err(|problems| problems.at(i)));
    Problems::all(views.chain([names]))
}

/// Checks that no name is empty or there twice.
fn names<'a>(names: impl Iterator<Item = &'a str>) -> Result<(), Problems> {
    let mut seen = HashMap::new();
    let checked = names.enumerate().map(|(i, name)| {
        if name.is_empty() {
            return Err(Problem::about("must not be empty").under("name").at(i));
        }
        match seen.entry(name) {
            Entry::Vacant(place) => {
                place.insert(i);
                Ok(())
            }
            Entry::Occupied(first) => {
                let (name, first) = (shortened(name), first.get());
                let message =
                    format!("must be unique, but {name:?} is also the name at [{first}]");
                Err(Problem::about(message).under("name").at(i))
            }
        }
    });
    Problems::all(checked)
}
