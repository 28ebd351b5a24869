// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Builds a scene: from the data of a file to shapes that can be evaluated.

mod builder;
mod motion;
mod object;
mod operator;
mod primitive;
mod size;

use std::any::Any;

use palpate_field::{Point, Pose, Shape};

use palpate_haptics::{Guide, Material, ToolOptions, WorkspaceMap};

use crate::guide::WrittenGuide;
use crate::pose::{Turning, Turns, vector};
use crate::problem::Problem;
use crate::scene::{Dimension, Scene};
use crate::shape::WrittenShape;
use crate::view::View;
use builder::{Builder, Space};
pub use motion::BuiltMotion;
pub(crate) use size::MOST;

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
    pub guides: Vec<Guide<D>>,
    /// The motions of its bodies, in the order of the scene.
    pub motions: Vec<BuiltMotion<D>>,
    /// The pictures worth making of it.
    pub views: Vec<View>,
    /// The map from the device's space to the world; `None` if the scene gives none.
    pub workspace: Option<WorkspaceMap<D>>,
}

/// The tool of a built scene.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct BuiltTool<const D: usize> {
    /// The radius of each contact point, or the offset added to the shape [m].
    pub radius: f64,
    /// The contact points in the tool's own coordinates [m]; empty for one at the origin.
    pub points: Vec<Point<D>>,
    /// The shape in the tool's own coordinates, instead of points.
    pub shape: Option<Shape<D>>,
    /// The coupling of a tool with a shape, and the largest force on the hand, which the scene may
    /// leave to the device.
    pub options: ToolOptions,
}

impl<const D: usize> BuiltTool<D> {
    /// One contact point at the origin, of this radius [m].
    #[must_use]
    pub fn of_radius(radius: f64) -> Self {
        Self { radius, points: Vec::new(), shape: None, options: ToolOptions::default() }
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
pub(crate) fn alone<const D: usize>(written: &WrittenShape) -> Result<Shape<D>, Problem> {
    let dimension = if D == 2 { Dimension::Two } else { Dimension::Three };
    let scene = Scene::new(dimension);
    let mut builder = Builder::new(&scene);
    let shape: Box<dyn Any> = match dimension {
        Dimension::Two => Box::new(builder.shape::<2>(written)?),
        Dimension::Three => Box::new(builder.shape::<3>(written)?),
    };
    let shape = shape.downcast().map_err(|_| Problem::new("shapes are in 2D or 3D"));
    shape.map(|shape| *shape)
}

/// Checks and builds a scene.
pub(crate) fn world(scene: &Scene) -> Result<AnyScene, Problem> {
    match scene.dimension() {
        Dimension::Two => built(scene).map(AnyScene::Planar),
        Dimension::Three => built(scene).map(AnyScene::Spatial),
    }
}

fn built<const D: usize>(scene: &Scene) -> Result<BuiltScene<D>, Problem>
where
    for<'a> Builder<'a>: Space<'a, D>,
    Turns: Turning<D>,
{
    let mut builder = Builder::new(scene);
    builder.named_shapes::<D>().map_err(|problem| problem.under("shapes"))?;
    let bodies = bodies(scene, &mut builder).map_err(|problem| problem.under("bodies"))?;
    let whole = Shape::union(bodies.iter().map(|body| body.shape.clone()))
        .map_err(|error| Problem::of_shape(error).under("bodies"))?;
    let tool = tool(scene, &mut builder).map_err(|problem| problem.under("tool"))?;
    let guides = guides(scene).map_err(|problem| problem.under("guides"))?;
    let motions =
        motion::motions(scene, &bodies).map_err(|problem| problem.under("motions"))?;
    check_views(scene, D).map_err(|problem| problem.under("views"))?;
    let workspace = workspace(scene).map_err(|problem| problem.under("tool"))?;
    Ok(BuiltScene {
        bodies,
        whole,
        tool,
        guides,
        motions,
        views: scene.views.clone(),
        workspace,
    })
}

fn bodies<'a, const D: usize>(
    scene: &'a Scene,
    builder: &mut Builder<'a>,
) -> Result<Vec<BuiltBody<D>>, Problem>
where
    Builder<'a>: Space<'a, D>,
    Turns: Turning<D>,
{
    if scene.bodies.is_empty() {
        return Err(Problem::about("must have at least 1 body, got 0"));
    }
    unique(scene.bodies.iter().map(|body| body.name.as_str()))?;
    let mut bodies = Vec::with_capacity(scene.bodies.len());
    for (i, body) in scene.bodies.iter().enumerate() {
        let mut make = || -> Result<BuiltBody<D>, Problem> {
            let shape_in_body = builder.shape(&body.shape).map_err(|p| p.under("shape"))?;
            let (world_from_body, shape) = match &body.pose {
                Some(pose) => {
                    let pose = pose.built().map_err(|problem| problem.under("pose"))?;
                    let shape =
                        shape_in_body.clone().placed(&pose).map_err(Problem::of_shape)?;
                    (pose, shape)
                }
                None => (Pose::identity(), shape_in_body.clone()),
            };
            let material = match &body.material {
                Some(written) => written.known().map_err(|p| p.under("material"))?,
                None => Material::default(),
            };
            crate::material::check(&material, D)
                .map_err(|problem| problem.under("material"))?;
            let name = body.name.clone();
            Ok(BuiltBody { name, shape, shape_in_body, world_from_body, material })
        };
        bodies.push(make().map_err(|problem| problem.at(i))?);
    }
    Ok(bodies)
}

/// The map from the device's space to the world, if the tool has one.
fn workspace<const D: usize>(scene: &Scene) -> Result<Option<WorkspaceMap<D>>, Problem>
where
    Turns: Turning<D>,
{
    let workspace = scene.tool.as_ref().and_then(|tool| tool.workspace.as_ref());
    let Some(workspace) = workspace else { return Ok(None) };
    let pose = workspace.pose.as_ref().map(|pose| pose.built::<D>()).transpose();
    let pose = pose.map_err(|problem| problem.under("pose").under("workspace"))?;
    let map = WorkspaceMap::new(pose.unwrap_or_else(Pose::identity), workspace.scale);
    map.map(Some).map_err(|error| Problem::new(error.to_string()).under("workspace"))
}

fn tool<'a, const D: usize>(
    scene: &'a Scene,
    builder: &mut Builder<'a>,
) -> Result<Option<BuiltTool<D>>, Problem>
where
    Builder<'a>: Space<'a, D>,
    Turns: Turning<D>,
{
    let Some(tool) = &scene.tool else { return Ok(None) };
    tool.check(D)?;
    let shape = tool.shape.as_ref().map(|written| builder.shape(written)).transpose();
    Ok(Some(BuiltTool {
        radius: tool.radius,
        points: tool.points.iter().map(|point| vector(point)).collect::<Result<_, _>>()?,
        shape: shape.map_err(|problem| problem.under("shape"))?,
        options: tool.options(),
    }))
}

fn guides<const D: usize>(scene: &Scene) -> Result<Vec<Guide<D>>, Problem> {
    let guide = |(i, guide): (usize, &WrittenGuide)| {
        guide.check(D).map_err(|problem| problem.at(i))?;
        guide.built().map_err(|problem| problem.at(i))
    };
    scene.guides.iter().enumerate().map(guide).collect()
}

fn check_views(scene: &Scene, dimension: usize) -> Result<(), Problem> {
    unique(scene.views.iter().map(|view| view.name.as_str()))?;
    for (i, view) in scene.views.iter().enumerate() {
        view.check(dimension).map_err(|problem| problem.at(i))?;
    }
    Ok(())
}

/// Checks that no name is empty or there twice.
fn unique<'a>(names: impl Iterator<Item = &'a str>) -> Result<(), Problem> {
    let mut seen = std::collections::HashMap::new();
    for (i, name) in names.enumerate() {
        if name.is_empty() {
            return Err(Problem::about("must not be empty").under("name").at(i));
        }
        if let Some(first) = seen.insert(name, i) {
            let name = crate::problem::shortened(name);
            let message = format!("must be unique, but {name:?} is also the name at [{first}]");
            return Err(Problem::about(message).under("name").at(i));
        }
    }
    Ok(())
}
