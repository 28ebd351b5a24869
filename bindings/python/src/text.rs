// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Shapes as expressions of Python that make them again.

use palpate::field::kernel::{Argument, Parameter};
use palpate::field::node::Boolean;
use palpate::field::operator::Copies;
use palpate::field::{Node, Pose, Rotation, Shape};
use palpate::grid::{Grid, GridOptions, Resolution};
use palpate::mesh::Solid;

use crate::function::Function;
use crate::grid::MOST_NODES;

/// The expression that makes a shape.
pub(crate) fn of<const D: usize>(shape: &Shape<D>) -> String {
    match shape.node() {
        Node::Primitive(primitive) => {
            let named = |(parameter, value): (&'static Parameter, &Argument)| {
                // The one name that is a word of Python.
                let end = if parameter.name == "from" { "_" } else { "" };
                format!("{}{end}={}", parameter.name, value)
            };
            let mut given: Vec<String> = primitive.named().map(named).collect();
            if D == 2 && is_of_both(primitive.name()) {
                given.push("dimension=2".to_owned());
            }
            format!("{}({})", primitive.name(), given.join(", "))
        }
        Node::Union(of) => call("union", of, &[]),
        Node::Intersection(of) => call("intersection", of, &[]),
        Node::Difference(of) => call("difference", of, &[]),
        Node::SymmetricDifference(of) => call("symmetric_difference", of, &[]),
        Node::Smooth { boolean, profile, width, of } => {
            let name = match boolean {
                Boolean::Union => "smooth_union",
                Boolean::Intersection => "smooth_intersection",
                Boolean::Difference => "smooth_difference",
            };
            call(
                name,
                of,
                &[format!("width={width:?}"), format!("profile='{}'", profile.name())],
            )
        }
        Node::Displaced { of, by, height } => {
            format!("{}.displaced({}, height={height:?})", self::of(of), self::of(by))
        }
        Node::Morphed { from, into, progress } => {
            format!("{}.morphed({}, progress={progress:?})", self::of(from), self::of(into))
        }
        Node::Placed { pose, of } => format!("{}{}", self::of(of), moved(pose)),
        Node::Scaled { factor, of } => format!("{}.scaled({factor:?})", self::of(of)),
        Node::Stretched { factors, of } => format!("{}.stretched({factors:?})", self::of(of)),
        Node::Offset { distance, of } => format!("{}.offset({distance:?})", self::of(of)),
        Node::Operated { operator, argument, of } => {
            format!("{}.{}({argument})", self::of(of), operator.method)
        }
        Node::Mirrored { axis, of } => format!("{}.mirrored('{}')", self::of(of), AXES[*axis]),
        Node::Repeated { copies, of } => format!("{}.repeated({})", self::of(of), rows(copies)),
        Node::Bent { rate, of } => format!("{}.bent(radians={rate:?})", self::of(of)),
        Node::Twisted { rate, of } => format!("{}.twisted(radians={rate:?})", self::of(of)),
        Node::Extruded { height, of } => format!("{}.extruded({height:?})", self::of(of)),
        Node::Revolved { of } => format!("{}.revolved()", self::of(of)),
        Node::Opaque(opaque) => {
            match (opaque.custom::<Solid<D, D>>(), opaque.custom::<Grid<D>>()) {
                (Some(solid), _) => format!("<solid of {} faces>", solid.elements().len()),
                (None, Some(grid)) => baked(grid),
                (None, None) => match opaque.custom::<Function<D>>() {
                    Some(function) => format!("<function {}>", function.name()),
                    None => format!("<{}>", opaque.type_name()),
                },
            }
        }
        other => format!("<{other:?}>"),
    }
}

const AXES: [&str; 3] = ["x", "y", "z"];

/// Whether the constructor of a primitive makes one of both dimensions, and nothing but a number says which.
fn is_of_both(name: &str) -> bool {
    use palpate::field::catalogue::Entry;
    use palpate::field::kernel::ParameterKind::{Direction, Points, Rings, Vector};
    Entry::<3>::all().iter().find(|entry| entry.name == name).is_some_and(|entry| {
        let says = |kind| matches!(kind, Vector | Direction | Points | Rings);
        !entry.parameters.iter().any(|parameter| says(parameter.kind))
    }) && Entry::<2>::all().iter().any(|entry| entry.name == name)
}

fn call<const D: usize>(name: &str, of: &[Shape<D>], numbers: &[String]) -> String {
    let given: Vec<String> = of.iter().map(self::of).chain(numbers.iter().cloned()).collect();
    format!("{name}({})", given.join(", "))
}

/// A grid as the method that makes it.
fn baked<const D: usize>(grid: &Grid<D>) -> String {
    let Some((of, options)) = grid.source() else {
        return format!("<grid with cells of {} m>", grid.lattice().cell);
    };
    let mut own = GridOptions::with_resolution(options.resolution);
    own.most_nodes = MOST_NODES;
    let mut given = vec![match options.resolution {
        Resolution::Tolerance(tolerance) => format!("tolerance={tolerance:?}"),
        Resolution::Cell(cell) => format!("cell={cell:?}"),
    }];
    if options.kernel != own.kernel {
        given.push(format!("kernel='{}'", options.kernel.name()));
    }
    if options.store != own.store {
        given.push(format!("store='{}'", options.store.name()));
    }
    if let Some(band) = options.band {
        given.push(format!("band={band:?}"));
    }
    if options.most_nodes != own.most_nodes {
        given.push(format!("most_nodes={}", options.most_nodes));
    }
    format!("{}.baked({})", self::of(of), given.join(", "))
}

/// A motion as the methods that make it.
fn moved<const D: usize>(pose: &Pose<D>) -> String {
    let Pose { rotation, translation } = pose;
    let turned = *rotation != Rotation::identity();
    let is_moved = !turned || translation.0.iter().any(|x| *x != 0.0);
    let rows = rotation.matrix();
    let turn = if turned { format!(".rotated(matrix={rows:?})") } else { String::new() };
    let way =
        if is_moved { format!(".translated({:?})", translation.0) } else { String::new() };
    turn + &way
}

fn rows<const D: usize>(copies: &[Copies; D]) -> String {
    let rows = copies.iter().zip(AXES).filter_map(|(copies, axis)| match copies {
        Copies::One => None,
        Copies::Endless { spacing } => Some(format!("{axis}={spacing:?}")),
        Copies::Between { spacing, first, last } => {
            Some(format!("{axis}={{'spacing': {spacing:?}, 'first': {first}, 'last': {last}}}"))
        }
    });
    rows.collect::<Vec<_>>().join(", ")
}
