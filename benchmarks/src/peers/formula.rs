// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The formula of a shape, for fidget: the same kernels and operators, evaluated
//! with [`Expression`]s.

use std::error::Error;

use fidget::context::Tree;
use palpate::field::kernel::{
    Argument, Ball, Capsule, Cuboid, Cylinder, NamedKernel, RegularPolygon, RegularStar,
    RoundedCuboid, Torus,
};
use palpate::field::operator::{Boolean, Profile};
use palpate::field::scalar::{Blend, Cubic, Quadratic, Scalar};
use palpate::field::{Node, Shape, Vector};

use super::expression::Expression;

/// The formula of a shape.
pub(crate) fn formula<const D: usize>(shape: &Shape<D>) -> Result<Tree, Box<dyn Error>>
where
    Dimensions: Space<D>,
{
    let axes = Expression::axes();
    Ok(distance(shape, Vector(std::array::from_fn(|i| axes[i])))?.tree())
}

type Point<const D: usize> = Vector<Expression, D>;

/// A dimension with its primitives.
pub(crate) trait Space<const D: usize> {
    fn primitive(
        name: &str,
        arguments: &[Argument],
        p: Point<D>,
    ) -> Result<Expression, Box<dyn Error>>;
}

/// The two dimensions.
pub(crate) struct Dimensions;

fn of<K: NamedKernel<D>, const D: usize>(
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
}

fn distance<const D: usize>(shape: &Shape<D>, p: Point<D>) -> Result<Expression, Box<dyn Error>>
where
    Dimensions: Space<D>,
{
    let fold = |of: &[Shape<D>], combine: &dyn Fn(Expression, Expression) -> Expression| {
        let mut result: Option<Expression> = None;
        for shape in of {
            let next = distance(shape, p)?;
            result = Some(match result {
                None => next,
                Some(so_far) => combine(so_far, next),
            });
        }
        result.ok_or_else(|| Box::<dyn Error>::from("an operator has no shapes"))
    };
    match shape.node() {
        Node::Primitive(primitive) => {
            Dimensions::primitive(primitive.name(), primitive.arguments(), p)
        }
        Node::Union(of) => fold(of, &|a, b| a.min(b)),
        Node::Difference(of) => {
            let (first, rest) = of.split_first().ok_or("an operator has no shapes")?;
            let without = fold(rest, &|a, b| a.min(b))?;
            Ok(distance(first, p)?.max(-without))
        }
        Node::Smooth { boolean: Boolean::Union, profile, width, of } => match profile {
            Profile::Cubic => {
                let unit = width * Cubic::UNIT_OVER_WIDTH;
                fold(of, &|a, b| a.smooth_min::<Cubic>(b, unit))
            }
            Profile::Quadratic => {
                let unit = width * Quadratic::UNIT_OVER_WIDTH;
                fold(of, &|a, b| a.smooth_min::<Quadratic>(b, unit))
            }
            _ => Err("a profile that is not recorded".into()),
        },
        Node::Placed { pose, of } => {
            let placement = palpate::field::field::Placement::new(*pose);
            distance(of, placement.to_body(p))
        }
        other => Err(format!("fidget is not given {other:?}").into()),
    }
}
