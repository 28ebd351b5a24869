// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The catalogue: every primitive gives back what it was made from.

use palpate_field::catalogue::{ALIASES, Entry};
use palpate_field::kernel::{
    Argument, CappedTorus, Cuboid, NamedKernel, Polygon, RegularStar, Segment, Simplex,
    TriangularPrism,
};
use palpate_field::{Node, Shape, ShapeError, Vector};
use palpate_testkit::kernels::{Dimension, IntoShape, Space, Visit};
use palpate_testkit::{arbitrary as draw, cases};

/// The arguments that a kernel gives back, by its accessors.
struct Arguments;

impl<const D: usize> Visit<D> for Arguments {
    type Output = Vec<Argument>;

    fn visit<K: NamedKernel<D>>(self, kernel: K) -> Vec<Argument> {
        kernel.arguments()
    }
}

/// All numbers of arguments, in their order, to the bit.
fn bits(arguments: &[Argument]) -> Vec<u64> {
    let number = |x: &f64| x.to_bits();
    arguments
        .iter()
        .flat_map(|argument| match argument {
            Argument::Number(x) => vec![number(x)],
            Argument::Count(count) => vec![u64::from(*count)],
            Argument::Vector(vector) => vector.iter().map(number).collect(),
            Argument::Points(points) => points.iter().flatten().map(number).collect(),
            Argument::Rings(rings) => rings.iter().flatten().flatten().map(number).collect(),
        })
        .collect()
}

/// Draws arguments for each primitive in turn and asks `given` what came back.
fn primitives_give_back<const D: usize>(
    given: impl Fn(&'static str, &[Argument]) -> Result<Vec<Argument>, ShapeError>,
) where
    Space: Dimension<D>,
{
    let catalogue = <Space as Dimension<D>>::CATALOGUE;
    let mut which = 0;
    cases::check(4 * catalogue.len() as u64, |u| {
        let entry = &catalogue[which % catalogue.len()];
        which += 1;
        let drawn = draw::arguments::<D>(u, entry.name, entry.parameters)?;
        let Some(arguments) = drawn else {
            return Ok(Err(format!("no arguments found for {}", entry.name)));
        };
        let back = given(entry.name, &arguments);
        let same = back
            .as_ref()
            .is_ok_and(|back| *back == arguments && bits(back) == bits(&arguments));
        Ok(if same { Ok(()) } else { Err(format!("{}: {arguments:?}, {back:?}", entry.name)) })
    });
}

#[test]
fn every_kernel_gives_back_its_arguments_to_the_bit() {
    primitives_give_back::<2>(|name, a| {
        <Space as Dimension<2>>::with_kernel(name, a, Arguments)
    });
    primitives_give_back::<3>(|name, a| {
        <Space as Dimension<3>>::with_kernel(name, a, Arguments)
    });
}

/// The arguments that the node of a shape gives back.
fn arguments_of_node<const D: usize>(
    name: &'static str,
    arguments: &[Argument],
) -> Result<Vec<Argument>, ShapeError>
where
    Space: Dimension<D>,
{
    let shape = <Space as Dimension<D>>::with_kernel(name, arguments, IntoShape)?;
    let Node::Primitive(primitive) = shape.node() else { panic!("{name} is opaque") };
    assert_eq!((primitive.name(), &shape), (name, &Shape::from_node(shape.node().clone())?));
    Ok(primitive.arguments().to_vec())
}

#[test]
fn the_node_of_every_kernel_has_its_arguments_to_the_bit() {
    primitives_give_back::<2>(arguments_of_node::<2>);
    primitives_give_back::<3>(arguments_of_node::<3>);
}

#[test]
fn constructors_make_the_shapes_of_kernels() -> Result<(), ShapeError> {
    let of = |kernel: Cuboid<3>| Shape::from_kernel(kernel);
    assert_eq!(Shape::cuboid([0.1, 0.2, 0.3])?, of(Cuboid::new(Vector([0.1, 0.2, 0.3]))?));
    let star = Shape::regular_star(5, 0.3, 0.1)?;
    assert_eq!(star, Shape::from_kernel(RegularStar::new(5, 0.3, 0.1)?));
    let corners = [[0.0, 0.0], [0.4, 0.0], [0.0, 0.3]];
    let triangle = Simplex::new(corners.map(Vector).to_vec())?;
    assert_eq!(Shape::triangle(corners)?, Shape::from_kernel(triangle));
    let polygon = Polygon::new(vec![corners.map(Vector).to_vec()])?;
    assert_eq!(Shape::polygon([corners])?, Shape::from_kernel(polygon));
    let half_plane = Shape::half_space([0.0, 2.0], 0.1)?;
    assert_eq!(half_plane.to_string(), "half_space([0.0, 2.0], 0.1)");
    assert_eq!(Shape::sphere(0.3)?, Shape::<3>::ball(0.3)?);
    assert!(Shape::torus(0.1, 0.2).is_err());
    Ok(())
}

#[test]
fn aliases_name_primitives_that_are_there() {
    for alias in ALIASES {
        let (found, taken) = match alias.dimension {
            2 => (Entry::<2>::find(alias.name).map(|e| e.name), named::<2>(alias.name)),
            _ => (Entry::<3>::find(alias.name).map(|e| e.name), named::<3>(alias.name)),
        };
        assert_eq!(found, Some(alias.of), "{alias:?}");
        assert!(!taken, "{alias:?} hides a primitive");
    }
}

fn named<const D: usize>(name: &str) -> bool {
    Entry::<D>::all().iter().any(|entry| entry.name == name)
}

#[test]
fn accessors_have_the_names_of_parameters() -> Result<(), ShapeError> {
    let torus = CappedTorus::new(0.7, 0.1, 1.1)?;
    assert_eq!((torus.ring_radius(), torus.radius(), torus.angle()), (0.7, 0.1, 1.1));
    let prism = TriangularPrism::new(0.3, 0.1)?;
    assert_eq!((prism.side(), prism.height()), (0.3, 0.1));
    let [from, to] = [[0.1, 0.2], [0.7, 0.3]];
    let segment = Segment::new(from.into(), to.into(), 0.1)?;
    assert_eq!((segment.from().0, segment.to().0, segment.radius()), (from, to, 0.1));
    Ok(())
}
