// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The formula of a scene, for fidget: the same kernels and operators, evaluated
//! with [`Expression`]s.

use std::error::Error;

use fidget::context::Tree;
use palpate::field::kernel::{
    Argument, Ball, Capsule, Cuboid, Cylinder, Primitive, RegularPolygon, RegularStar,
    RoundedCuboid, Torus,
};
use palpate::field::scalar::{Blend, Cubic, Quadratic, Scalar};
use palpate::field::{Pose, Rotation, Vector};
use palpate::scene::{Boolean, Form, Node, Profile, Scene, WrittenRotation};

use super::expression::Expression;
use crate::scenes::pose;

/// The formula of the first body of a scene.
pub(crate) fn formula(scene: &Scene) -> Result<Tree, Box<dyn Error>> {
    let [x, y, z] = Expression::axes();
    let shape = &scene.bodies[0].shape;
    let result = if scene.dimension() == palpate::scene::Dimension::Two {
        distance(scene, shape, Vector([x, y]))?
    } else {
        distance(scene, shape, Vector([x, y, z]))?
    };
    Ok(result.tree())
}

type Point<const D: usize> = Vector<Expression, D>;

/// A dimension with its primitives and poses.
trait Space<const D: usize> {
    fn primitive(
        name: &str,
        arguments: &[Argument],
        p: Point<D>,
    ) -> Result<Expression, Box<dyn Error>>;

    fn pose(
        translate: Option<&[f64]>,
        rotation: Option<&WrittenRotation>,
    ) -> Result<Pose<D>, Box<dyn Error>>;
}

struct Dimensions;

fn of<K: Primitive<D>, const D: usize>(
    arguments: &[Argument],
    p: Point<D>,
) -> Result<Expression, Box<dyn Error>> {
    Ok(K::from_arguments(arguments)?.distance(p))
}

impl Space<2> for Dimensions {
    fn primitive(
        name: &str,
        arguments: &[Argument],
        p: Point<2>,
    ) -> Result<Expression, Box<dyn Error>> {
        match name {
            "ball" => of::<Ball, 2>(arguments, p),
            "cuboid" => of::<Cuboid<2>, 2>(arguments, p),
            "rounded_cuboid" => of::<RoundedCuboid<2>, 2>(arguments, p),
            "regular_polygon" => of::<RegularPolygon, 2>(arguments, p),
            "regular_star" => of::<RegularStar, 2>(arguments, p),
            _ => Err(format!("fidget is not given {name}").into()),
        }
    }

    fn pose(
        translate: Option<&[f64]>,
        rotation: Option<&WrittenRotation>,
    ) -> Result<Pose<2>, Box<dyn Error>> {
        let translation = match translate {
            None => Vector::ZERO,
            Some(offset) => Vector(offset.try_into()?),
        };
        let rotation = match rotation {
            None => Rotation::identity(),
            Some(WrittenRotation::Degrees(angle)) => Rotation::from_angle(angle.to_radians())?,
            Some(_) => return Err("rotations in the plane are angles".into()),
        };
        Ok(Pose::new(rotation, translation))
    }
}

impl Space<3> for Dimensions {
    fn primitive(
        name: &str,
        arguments: &[Argument],
        p: Point<3>,
    ) -> Result<Expression, Box<dyn Error>> {
        match name {
            "ball" => of::<Ball, 3>(arguments, p),
            "cuboid" => of::<Cuboid<3>, 3>(arguments, p),
            "rounded_cuboid" => of::<RoundedCuboid<3>, 3>(arguments, p),
            "capsule" => of::<Capsule, 3>(arguments, p),
            "cylinder" => of::<Cylinder, 3>(arguments, p),
            "torus" => of::<Torus, 3>(arguments, p),
            _ => Err(format!("fidget is not given {name}").into()),
        }
    }

    fn pose(
        translate: Option<&[f64]>,
        rotation: Option<&WrittenRotation>,
    ) -> Result<Pose<3>, Box<dyn Error>> {
        pose(translate, rotation)
    }
}

fn distance<const D: usize>(
    scene: &Scene,
    node: &Node,
    p: Point<D>,
) -> Result<Expression, Box<dyn Error>>
where
    Dimensions: Space<D>,
{
    let fold = |nodes: &[Node], combine: &dyn Fn(Expression, Expression) -> Expression| {
        let mut result: Option<Expression> = None;
        for node in nodes {
            let next = distance(scene, node, p)?;
            result = Some(match result {
                None => next,
                Some(so_far) => combine(so_far, next),
            });
        }
        result.ok_or_else(|| Box::<dyn Error>::from("an operator has no shapes"))
    };
    match &node.form {
        Form::Reference(name) => {
            let node = scene.shapes.get(name).ok_or_else(|| format!("no shape {name}"))?;
            distance(scene, node, p)
        }
        Form::Primitive(primitive) => {
            let arguments: Vec<_> = primitive.arguments.values().cloned().collect();
            Dimensions::primitive(&primitive.name, &arguments, p)
        }
        Form::Union(nodes) => fold(nodes, &|a, b| a.min(b)),
        Form::Difference(nodes) => {
            let (first, rest) = nodes.split_first().ok_or("an operator has no shapes")?;
            let without = fold(rest, &|a, b| a.min(b))?;
            Ok(distance(scene, first, p)?.max(-without))
        }
        Form::Smooth { boolean: Boolean::Union, of, width, profile } => match profile {
            Some(Profile::Cubic) => {
                let unit = width * Cubic::UNIT_OVER_WIDTH;
                fold(of, &|a, b| a.smooth_min::<Cubic>(b, unit))
            }
            Some(Profile::Quadratic) | None => {
                let unit = width * Quadratic::UNIT_OVER_WIDTH;
                fold(of, &|a, b| a.smooth_min::<Quadratic>(b, unit))
            }
            Some(_) => Err("a profile that is not recorded".into()),
        },
        Form::Placed { translate, rotation, of } => {
            let pose = Dimensions::pose(translate.as_deref(), rotation.as_ref())?;
            let placement = palpate::field::field::Placement::new(pose);
            distance(scene, of, placement.to_body(p))
        }
        other => Err(format!("fidget is not given {other:?}").into()),
    }
}
