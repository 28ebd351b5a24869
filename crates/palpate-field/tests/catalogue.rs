// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The catalogue: every primitive gives back what it was made from.

use palpate_field::ShapeError;
use palpate_field::kernel::{Argument, CappedTorus, Primitive, Segment, TriangularPrism};
use palpate_testkit::kernels::{Dimension, Space, Visit};
use palpate_testkit::{arbitrary as draw, cases};

/// The arguments that a kernel gives back, by its accessors.
struct Arguments;

impl<const D: usize> Visit<D> for Arguments {
    type Output = Vec<Argument>;

    fn visit<K: Primitive<D>>(self, kernel: K) -> Vec<Argument> {
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
