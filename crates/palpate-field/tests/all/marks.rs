// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Marks of parameters: each measures its parameter, and lengths end on the surface.

use std::collections::BTreeSet;

use palpate_field::catalogue::Entry;
use palpate_field::kernel::{Argument, Mark, MarkKind, ParameterKind};
use palpate_field::{ShapeError, Vector};
use palpate_testkit::kernels::{Dimension, Space};
use palpate_testkit::{arbitrary as draw, cases};

/// Lengths between places of which neither is on the surface.
const WITHIN: &[(&str, &str)] = &[
    ("arc", "ring_radius"),
    ("circle_wave", "ring_radius"),
    ("horseshoe", "ring_radius"),
    ("capped_torus", "ring_radius"),
    ("torus", "ring_radius"),
    ("power_torus", "ring_radius"),
    ("link", "ring_radius"),
    ("cut_hollow_sphere", "radius"),
    ("cut_hollow_sphere", "cut_height"),
    ("moon", "distance"),
    ("death_star", "distance"),
    ("uneven_capsule", "height"),
    ("round_cone", "height"),
    // The corners before they are rounded.
    ("rhombus_prism", "size[0]"),
    ("rhombus_prism", "size[2]"),
    // The tips of hyperbolas are at the other semi-axis.
    ("hyperbola", "radii[0]"),
];

/// What the arguments say of a mark: the number that it measures, or its position.
fn argument<'a, const D: usize>(
    entry: &Entry<D>,
    arguments: &'a [Argument],
    mark: &Mark<D>,
) -> (ParameterKind, &'a Argument) {
    let named = entry.parameters.iter().position(|p| p.name == mark.parameter);
    let place = named.unwrap_or_else(|| panic!("{}: {}", entry.name, mark.parameter));
    (entry.parameters[place].kind, &arguments[place])
}

/// The number at the mark's index.
fn number<const D: usize>(mark: &Mark<D>, argument: &Argument) -> f64 {
    match (argument, &mark.index[..]) {
        (Argument::Number(number), []) => *number,
        (Argument::Vector(vector), [i]) => vector[*i],
        other => panic!("{other:?}"),
    }
}

/// The position at the mark's index.
fn position<'a, const D: usize>(mark: &Mark<D>, argument: &'a Argument) -> &'a [f64] {
    match (argument, &mark.index[..]) {
        (Argument::Vector(vector), []) => vector,
        (Argument::Points(points), [i]) => &points[*i],
        (Argument::Rings(rings), [i, j]) => &rings[*i][*j],
        other => panic!("{other:?}"),
    }
}

/// The angle through which the tangent of a line turns.
fn turn<const D: usize>(points: &[Vector<f64, D>]) -> f64 {
    let steps: Vec<_> = points.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let angle = |pair: &[Vector<f64, D>]| {
        (pair[0].dot(pair[1]) / (pair[0].norm() * pair[1].norm())).min(1.0).acos()
    };
    steps.windows(2).map(angle).sum()
}

fn measures<const D: usize>(
    entry: &Entry<D>,
    arguments: &[Argument],
    mark: &Mark<D>,
) -> Result<(), String> {
    let (kind, argument) = argument(entry, arguments, mark);
    let (found, expected) = match mark.kind {
        MarkKind::Length => (mark.length(), number(mark, argument).abs()),
        MarkKind::Position => {
            let same = mark.points[0].0[..] == *position(mark, argument);
            return if same { Ok(()) } else { Err(format!("{mark:?}")) };
        }
        MarkKind::Angle => {
            // As many tangents as pairs of points: the last of the arc's parts has no successor.
            let parts = (mark.points.len() - 1) as f64;
            (turn(&mark.points) * parts / (parts - 1.0), number(mark, argument))
        }
        MarkKind::Direction => {
            let Argument::Vector(given) = argument else { panic!("{argument:?}") };
            let given = Vector::<f64, D>(std::array::from_fn(|k| given[k])).normalized();
            let drawn = (mark.points[1] - mark.points[0]).normalized();
            let same = given.zip(drawn).is_some_and(|(a, b)| (a - b).norm() < 1e-12);
            return if same { Ok(()) } else { Err(format!("{mark:?}")) };
        }
        _ => panic!("{kind:?}"),
    };
    // Arcs take the arc cosine of numbers next to one, which halves the digits.
    let tolerance = if mark.kind == MarkKind::Angle { 1e-6 } else { 1e-12 };
    let size = mark.points.iter().fold(expected, |size, p| size.max(p.norm()));
    let is_same = (found - expected).abs() <= tolerance * size.max(1.0);
    if is_same { Ok(()) } else { Err(format!("{found}, not {expected}: {mark:?}")) }
}

fn all_measure<const D: usize>()
where
    Space: Dimension<D>,
{
    let catalogue = <Space as Dimension<D>>::CATALOGUE;
    let mut which = 0;
    cases::check(4 * catalogue.len() as u64, |u| {
        let entry = &catalogue[which % catalogue.len()];
        which += 1;
        let Some(arguments) = draw::arguments::<D>(u, entry.name, entry.parameters)? else {
            return Ok(Err(format!("no arguments found for {}", entry.name)));
        };
        let measured = entry.marks(&arguments).map_err(|error| error.to_string());
        let measured = measured
            .and_then(|marks| marks.iter().try_for_each(|m| measures(entry, &arguments, m)));
        Ok(measured.map_err(|problem| format!("{} {arguments:?}: {problem}", entry.name)))
    });
}

#[test]
fn every_mark_measures_its_parameter() {
    all_measure::<2>();
    all_measure::<3>();
}

/// Names of all marks that arguments call for.
fn expected_names<const D: usize>(
    entry: &Entry<D>,
    arguments: &[Argument],
) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    for (parameter, argument) in entry.parameters.iter().zip(arguments) {
        let name = parameter.name;
        let is_position = ["from", "to", "control"].contains(&name);
        match argument {
            Argument::Count(_) => {}
            Argument::Vector(_)
                if is_position || parameter.kind == ParameterKind::Direction =>
            {
                names.insert(name.to_owned());
            }
            Argument::Number(_) => {
                names.insert(name.to_owned());
            }
            Argument::Vector(vector) => {
                names.extend((0..vector.len()).map(|i| format!("{name}[{i}]")));
            }
            Argument::Points(points) => {
                names.extend((0..points.len()).map(|i| format!("{name}[{i}]")));
            }
            Argument::Rings(rings) => {
                names.extend(rings.iter().enumerate().flat_map(|(i, ring)| {
                    (0..ring.len()).map(move |j| format!("{name}[{i}][{j}]"))
                }))
            }
        }
    }
    names
}

fn all_are_marked<const D: usize>() -> Result<(), ShapeError> {
    for entry in Entry::<D>::all() {
        let arguments = entry.example_arguments()?;
        let marks = entry.marks(&arguments)?;
        let found: BTreeSet<_> = marks.iter().map(Mark::name).collect();
        assert_eq!(found, expected_names(entry, &arguments), "{}", entry.name);
        assert_eq!(found.len(), marks.len(), "{}", entry.name);
    }
    Ok(())
}

#[test]
fn every_parameter_but_counts_is_marked_once() -> Result<(), ShapeError> {
    all_are_marked::<2>()?;
    all_are_marked::<3>()
}

/// The lengths that end on the surface though [`WITHIN`] names them, or do not.
fn misplaced<const D: usize>() -> Result<Vec<String>, ShapeError> {
    let mut wrong = Vec::new();
    for entry in Entry::<D>::all() {
        let shape = entry.example()?;
        let marks = entry.marks(&entry.example_arguments()?)?;
        for mark in marks.iter().filter(|mark| mark.kind == MarkKind::Length) {
            let distances: Vec<f64> = mark.points.iter().map(|p| shape.distance(*p)).collect();
            let is_within = WITHIN.contains(&(entry.name, &mark.name()));
            if distances.iter().any(|distance| distance.abs() < 1e-12) == is_within {
                wrong.push(format!("{}: {mark:?} {distances:?}", entry.name));
            }
        }
    }
    Ok(wrong)
}

#[test]
fn lengths_end_on_the_surface() -> Result<(), ShapeError> {
    assert_eq!([misplaced::<2>()?, misplaced::<3>()?].concat(), Vec::<String>::new());
    Ok(())
}
