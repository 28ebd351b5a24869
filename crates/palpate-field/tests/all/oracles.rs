// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Every primitive against its definition: what it contains, and its boundary
//! sampled.

use palpate_field::Quality;
use palpate_testkit::arbitrary as draw;
use palpate_testkit::cases;
use palpate_testkit::kernels::{Defined, Dimension, IntoShape, Space};
use palpate_testkit::oracle::Outside;

/// Spacing of the samples, of the size of the shape.
const SPACING: f64 = 1e-3;

/// Sets of arguments drawn for each primitive.
const ARGUMENTS: u64 = 24;

/// Points for each set.
const POINTS: usize = 16;

/// Points further away than this, in sizes, say little for many samples.
const NEAR: f64 = 4.0;

/// Compares the primitives of one dimension with their definitions.
fn agree<const D: usize>()
where
    Space: Dimension<D>,
{
    let catalogue = <Space as Dimension<D>>::CATALOGUE;
    let mut counts = vec![(0, 0); catalogue.len()];
    cases::numbered(ARGUMENTS * catalogue.len() as u64, |seed, u| {
        let which = seed % catalogue.len();
        let entry = &catalogue[which];
        let Some(arguments) = draw::arguments::<D>(u, entry.name, entry.parameters)? else {
            return Ok(Err(format!("no arguments found for {}", entry.name)));
        };
        let shape = match Space::with_kernel(entry.name, &arguments, IntoShape) {
            Ok(shape) => shape,
            Err(error) => return Ok(Err(error.to_string())),
        };
        let definition = match Space::with_kernel(entry.name, &arguments, Defined) {
            Ok(definition) => definition,
            Err(error) => return Ok(Err(error.to_string())),
        };
        let size = draw::size(&shape);
        for _ in 0..POINTS {
            let p = draw::point(u, &shape)?;
            if p.norm() > NEAR * size {
                continue;
            }
            let f = shape.distance(p);
            let oracle = definition.distance(p, SPACING * size);
            let slack = shape.promise().rounding.within(p.norm()) + 1e-12 * size;
            let complain = |what: &str| {
                Ok(Err(format!(
                    "{what}: {f:e}, {oracle:?} at {p:?} of {} {arguments:?}",
                    entry.name
                )))
            };
            counts[which].0 += 1;
            counts[which].1 += usize::from(oracle.upper - oracle.lower <= SPACING * size);
            let sampled = !(oracle.inside && definition.overlaps_itself);
            if sampled && f.abs() > oracle.upper + slack {
                return complain("farther than a sample");
            }
            if f.abs() > slack && (f < 0.0) != oracle.inside {
                return complain("on the wrong side");
            }
            let quality =
                if f < 0.0 { shape.promise().inside } else { shape.promise().outside };
            if f > 0.0 && definition.outside == Outside::Bound && quality == Quality::Exact {
                return complain("promised exact, but a bound");
            }
            if quality == Quality::Exact && f.abs() < oracle.lower - slack {
                return complain("nearer than every sample");
            }
        }
        Ok(Ok(()))
    });
    for (entry, (asked, sharp)) in catalogue.iter().zip(counts) {
        assert!(2 * sharp > asked, "{}: {sharp} of {asked} oracles are sharp", entry.name);
    }
}

#[test]
fn planar_primitives_are_what_they_are_defined_as() {
    agree::<2>();
}

#[test]
fn spatial_primitives_are_what_they_are_defined_as() {
    agree::<3>();
}
