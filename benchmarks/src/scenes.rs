// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The benchmark scenes, read from `scenes/`.

use std::error::Error;

use palpate::field::catalogue::Entry;
use palpate::field::kernel::Argument;
use palpate::field::{Node, Pose, Shape};
use palpate::scene::{AnyScene, Scene};

const P1: &str = include_str!("../../scenes/p1.json");
const P2: &str = include_str!("../../scenes/p2.json");
const P3: &str = include_str!("../../scenes/p3.json");
const S1: &str = include_str!("../../scenes/s1.json");
const S2: &str = include_str!("../../scenes/s2.json");
const S3: &str = include_str!("../../scenes/s3.json");
const S4: &str = include_str!("../../scenes/s4.json");
const THOUSAND: &str = include_str!("../../scenes/thousand.json");
const WRENCH: &str = include_str!("../../scenes/wrench.json");

/// A scene of `D` dimensions, and the cube that points are drawn from.
pub(crate) struct Work<const D: usize> {
    pub(crate) name: &'static str,
    pub(crate) shape: Shape<D>,
    /// Half the side of the cube about the origin [m].
    pub(crate) half: f64,
}

/// S1 to S4.
pub(crate) fn spatial() -> Result<Vec<Work<3>>, Box<dyn Error>> {
    Ok(vec![
        in_space("S1", S1, 1.1)?,
        in_space("S2", S2, 1.1)?,
        s3()?,
        in_space("S4", S4, 2.6)?,
    ])
}

/// S3.
pub(crate) fn s3() -> Result<Work<3>, Box<dyn Error>> {
    in_space("S3", S3, 1.1)
}

/// The union of a thousand placed primitives.
pub(crate) fn thousand() -> Result<Work<3>, Box<dyn Error>> {
    in_space("thousand", THOUSAND, 0.6)
}

fn in_space(name: &'static str, text: &str, half: f64) -> Result<Work<3>, Box<dyn Error>> {
    let scene = Scene::from_json(text)?;
    match scene.build()? {
        AnyScene::Spatial(world) => Ok(Work { name, shape: world.whole, half }),
        AnyScene::Planar(_) => Err(format!("{name} is not spatial").into()),
    }
}

/// The wrench.
pub(crate) fn wrench() -> Result<Work<2>, Box<dyn Error>> {
    in_the_plane("wrench", WRENCH, 0.13)
}

/// P1 to P3, what S1 to S3 are in the plane.
pub(crate) fn planar() -> Result<Vec<Work<2>>, Box<dyn Error>> {
    let scenes = [("P1", P1, 1.1), ("P2", P2, 1.1), ("P3", P3, 1.1)];
    scenes.into_iter().map(|(name, text, half)| in_the_plane(name, text, half)).collect()
}

fn in_the_plane(name: &'static str, text: &str, half: f64) -> Result<Work<2>, Box<dyn Error>> {
    let scene = Scene::from_json(text)?;
    match scene.build()? {
        AnyScene::Planar(world) => Ok(Work { name, shape: world.whole, half }),
        AnyScene::Spatial(_) => Err(format!("{name} is not planar").into()),
    }
}

/// A placed primitive, as data.
pub(crate) struct Placed {
    entry: Entry<3>,
    arguments: Vec<Argument>,
    pose: Pose<3>,
}

/// The members of a union, as data: what building starts from.
pub(crate) fn members(shape: &Shape<3>) -> Result<Vec<Placed>, Box<dyn Error>> {
    let Node::Union(of) = shape.node() else {
        return Err("the scene is not a union".into());
    };
    of.iter().map(placed).collect()
}

fn placed(shape: &Shape<3>) -> Result<Placed, Box<dyn Error>> {
    let Node::Placed { pose, of } = shape.node() else {
        return Err("a member is not placed".into());
    };
    let Node::Primitive(primitive) = of.node() else {
        return Err("a member is not a primitive".into());
    };
    let arguments = primitive.arguments().to_vec();
    Ok(Placed { entry: *primitive.entry(), arguments, pose: *pose })
}

/// Builds the union of `members`.
pub(crate) fn build(members: &[Placed]) -> Result<Shape<3>, Box<dyn Error>> {
    let mut shapes = Vec::with_capacity(members.len());
    for member in members {
        shapes.push(member.entry.build_at(&member.arguments, &member.pose)?);
    }
    Ok(Shape::union(shapes)?)
}
