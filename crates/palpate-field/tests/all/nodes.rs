// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Shapes that are looked into, built again, compared and printed.

use palpate_field::kernel::{Ball, Kernel};
use palpate_field::node::Primitive;
use palpate_field::scalar::{Model, Scalar};
use palpate_field::{BLOCK, Block, Column, Node, Point, Promise, Shape, ShapeError, Vector};
use palpate_testkit::arbitrary::{self as draw, Turn};
use palpate_testkit::cases;
use palpate_testkit::kernels::Space;
use palpate_testkit::tree::Solid;

type Outcome = Result<(), ShapeError>;

/// The shape built again from its nodes, its primitives from their names and arguments.
fn rebuilt<const D: usize>(shape: &Shape<D>) -> Result<Shape<D>, ShapeError> {
    let all = |of: &[Shape<D>]| of.iter().map(rebuilt).collect::<Result<Vec<_>, _>>();
    Shape::from_node(match shape.node() {
        Node::Primitive(primitive) => {
            let arguments = primitive.arguments().to_vec();
            Node::Primitive(Primitive::new(primitive.name(), arguments)?)
        }
        Node::Union(of) => Node::Union(all(of)?),
        Node::Intersection(of) => Node::Intersection(all(of)?),
        Node::Difference(of) => Node::Difference(all(of)?),
        Node::SymmetricDifference(of) => Node::SymmetricDifference(all(of)?),
        Node::Smooth { boolean, profile, width, of } => {
            let (boolean, profile, width) = (*boolean, *profile, *width);
            Node::Smooth { boolean, profile, width, of: all(of)? }
        }
        Node::Displaced { of, by, height } => {
            Node::Displaced { of: rebuilt(of)?, by: rebuilt(by)?, height: *height }
        }
        Node::Morphed { from, into, progress } => {
            Node::Morphed { from: rebuilt(from)?, into: rebuilt(into)?, progress: *progress }
        }
        Node::Placed { pose, of } => Node::Placed { pose: *pose, of: rebuilt(of)? },
        Node::Scaled { factor, of } => Node::Scaled { factor: *factor, of: rebuilt(of)? },
        Node::Stretched { factors, of } => {
            Node::Stretched { factors: *factors, of: rebuilt(of)? }
        }
        Node::Offset { distance, of } => Node::Offset { distance: *distance, of: rebuilt(of)? },
        Node::Operated { operator, argument, of } => {
            let argument = argument.clone();
            Node::Operated { operator: *operator, argument, of: rebuilt(of)? }
        }
        Node::Mirrored { axis, of } => Node::Mirrored { axis: *axis, of: rebuilt(of)? },
        Node::Repeated { copies, of } => Node::Repeated { copies: *copies, of: rebuilt(of)? },
        Node::Bent { rate, of } => Node::Bent { rate: *rate, of: rebuilt(of)? },
        Node::Twisted { rate, of } => Node::Twisted { rate: *rate, of: rebuilt(of)? },
        Node::Extruded { height, of } => Node::Extruded { height: *height, of: rebuilt(of)? },
        Node::Revolved { of } => Node::Revolved { of: rebuilt(of)? },
        other => other.clone(),
    })
}

/// All that a shape says at a point and in a cell about it, as text: numbers are written
/// so that other bits are other text.
fn answers<const D: usize>(shape: &Shape<D>, p: Point<D>) -> String {
    let mut cells = Block::<Model, D, BLOCK>::zero();
    cells.set(0, Vector(Model::cell(p.0, [0.1; D])));
    let mut bounds = Column::<Model, BLOCK>::zero();
    shape.block_distances(&cells, 1, &mut bounds);
    let single = Vector(p.0.map(|x| x as f32));
    format!(
        "{:?} {:?} {:?}",
        shape.distance_gradient(p),
        shape.distance_gradient_f32(single),
        bounds.get(0),
    )
}

fn nodes_rebuild_shapes<const D: usize>(count: u64)
where
    Space: Solid<D> + Turn<D>,
{
    cases::on_trees(count, 6, |u, _, shape: &Shape<D>| {
        let again = match rebuilt(shape) {
            Ok(again) => again,
            Err(error) => return Ok(Err(error.to_string())),
        };
        let same = again == *shape
            && again.to_string() == shape.to_string()
            && again.depth() == shape.depth()
            && format!("{:?}", again.promise()) == format!("{:?}", shape.promise());
        if !same {
            return Ok(Err(format!("{shape}\n  {again}")));
        }
        for _ in 0..8 {
            let p = draw::point(u, shape)?;
            let (before, after) = (answers(shape, p), answers(&again, p));
            if before != after {
                return Ok(Err(format!("{before}, rebuilt {after} at {p:?}: {shape}")));
            }
        }
        Ok(Ok(()))
    });
}

#[test]
fn shapes_of_the_plane_built_again_from_their_nodes_have_the_same_bits() {
    nodes_rebuild_shapes::<2>(600);
}

#[test]
fn shapes_in_space_built_again_from_their_nodes_have_the_same_bits() {
    nodes_rebuild_shapes::<3>(600);
}

#[test]
fn a_thousand_holes_are_one_difference() -> Outcome {
    let hole = Shape::circle(0.01)?;
    let mut plate = Shape::rectangle([1.0, 1.0])?;
    let mut holes = Vec::new();
    for i in 0..1000_u32 {
        let place = [0.03 * f64::from(i % 32) - 0.48, 0.03 * f64::from(i / 32) - 0.48];
        let hole = hole.clone().translated(place)?;
        plate = &plate - &hole;
        holes.push(hole);
    }
    assert_eq!(plate.depth(), 3);
    let at_once = Shape::rectangle([1.0, 1.0])?.difference(holes.clone())?;
    assert_eq!(plate, at_once);
    for p in [[0.01, 0.02], [0.48, -0.47], [0.7, 0.1], [-0.2, 0.33]] {
        let nearest = holes.iter().map(|hole| hole.distance(p)).fold(f64::INFINITY, f64::min);
        let sheet = Shape::rectangle([1.0, 1.0])?.distance(p);
        assert_eq!(plate.distance(p).to_bits(), sheet.max(-nearest).to_bits());
        assert_eq!(answers(&plate, p.into()), answers(&at_once, p.into()));
    }
    Ok(())
}

#[test]
fn nested_booleans_are_flat() -> Outcome {
    let shapes: Vec<_> = (1..=4_i32)
        .map(|i| Shape::circle(0.2)?.translated([0.1 * f64::from(i), 0.0]))
        .collect::<Result<_, _>>()?;
    let [a, b, c, d] = [0, 1, 2, 3].map(|i| &shapes[i]);
    let all = || shapes.clone();
    assert_eq!((a | b) | (c | d), Shape::union(all())?);
    assert_eq!((a & b) & (c & d), Shape::intersection(all())?);
    assert_eq!((a ^ b) ^ (c ^ d), Shape::symmetric_difference(all())?);
    assert_eq!(((a - b) - c) - d, a - (b | (c | d)));
    assert_ne!(a - (b - c), (a - b) - c);
    assert_eq!(&Shape::union([a.clone()])?, a);
    Ok(())
}

#[test]
fn motions_are_one_motion() -> Outcome {
    let bar = Shape::rectangle([0.4, 0.1])?;
    let there = bar.clone().translated([0.25, 0.5])?.translated([1.0, 0.0])?;
    assert_eq!(there, bar.clone().translated([1.25, 0.5])?);
    assert_eq!(there.translated([-1.25, -0.5])?, bar);
    Ok(())
}

#[test]
fn shapes_print_as_what_builds_them() -> Outcome {
    let (a, b) = (Shape::circle(0.5)?, Shape::rectangle([0.2, 0.1])?);
    let print = |shape: Shape<2>| shape.to_string();
    assert_eq!(print((&a | &b) & &a), "(ball(0.5) | cuboid([0.2, 0.1])) & ball(0.5)");
    assert_eq!(print(&a - (&b & &a)), "ball(0.5) - (cuboid([0.2, 0.1]) & ball(0.5))");
    assert_eq!(print((&a ^ &b).offset(0.1)?), "(ball(0.5) ^ cuboid([0.2, 0.1])).offset(0.1)");
    let blend =
        a.clone().smooth_difference([b.clone()], palpate_field::node::Profile::Root, 0.1)?;
    assert_eq!(print(blend), "ball(0.5).smooth_difference([cuboid([0.2, 0.1])], Root, 0.1)");
    let cup = b.revolved()?;
    assert_eq!(cup.to_string(), "cuboid([0.2, 0.1]).revolved()");
    Ok(())
}

#[test]
fn numbers_in_text_read_back_to_the_same_bits() -> Outcome {
    for radius in [0.1 + 0.2, 1.0 / 3.0, 1e-15, 123_456_789.123] {
        let text = Shape::circle(radius)?.to_string();
        let number = text.trim_start_matches("ball(").trim_end_matches(')');
        assert_eq!(number.parse(), Ok(radius));
    }
    Ok(())
}

#[test]
fn debug_text_of_a_large_shape_counts_what_it_leaves_out() -> Outcome {
    let parts = (0..100_u32).map(|i| Shape::circle(0.1)?.translated([f64::from(i), 0.0]));
    let row = Shape::union(parts.collect::<Result<Vec<_>, _>>()?)?;
    let text = format!("{row:?}");
    assert!(text.ends_with(" more"), "{text}");
    assert!(text.len() < 3000, "{text}");
    assert!(row.to_string().ends_with("translated([99.0, 0.0])"));
    Ok(())
}

/// A pole without end.
#[derive(Clone, Debug)]
struct Pole;

impl Kernel<3> for Pole {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 3>) -> S {
        S::norm([p[0], p[2]]) - S::constant(0.1)
    }

    fn promise(&self) -> Promise<3> {
        Promise::exact_convex(None, 4.0, 0.1)
    }
}

#[test]
fn fields_of_users_are_opaque_and_equal_themselves() -> Outcome {
    let pole = Shape::from_kernel(Pole);
    let Node::Opaque(opaque) = pole.node() else { panic!("{pole} is not opaque") };
    assert!(opaque.type_name().ends_with("Pole"), "{}", opaque.type_name());
    assert!(pole.to_string().starts_with("opaque("), "{pole}");
    let again = Shape::from_node(pole.node().clone())?;
    assert_eq!(again, pole);
    assert_eq!(again.distance([0.3, 7.0, 0.4]), 0.4);
    assert_ne!(Shape::from_kernel(Pole), pole);
    Ok(())
}

#[test]
fn a_kernel_of_the_catalogue_is_a_primitive() -> Outcome {
    let ball: Shape<2> = Shape::from_kernel(Ball::new(0.3)?);
    assert_eq!(ball, Shape::circle(0.3)?);
    let Node::Primitive(primitive) = ball.node() else { panic!("{ball} is opaque") };
    let names: Vec<_> = primitive.named().map(|(parameter, _)| parameter.name).collect();
    assert_eq!((primitive.name(), names), ("ball", vec!["radius"]));
    Ok(())
}

#[test]
fn nodes_with_bad_parameters_are_refused() -> Outcome {
    let of = Shape::circle(0.1)?;
    assert!(Shape::from_node(Node::<2>::Union(vec![])).is_err());
    assert!(Shape::from_node(Node::<2>::Difference(vec![])).is_err());
    assert!(Shape::from_node(Node::Mirrored { axis: 2, of: of.clone() }).is_err());
    assert!(Shape::from_node(Node::Twisted { rate: 1.0, of: of.clone() }).is_err());
    assert!(Shape::from_node(Node::<2>::Extruded { height: 0.1, of: of.clone() }).is_err());
    assert!(Shape::from_node(Node::Offset { distance: f64::NAN, of }).is_err());
    assert!(Primitive::<2>::new("torus", vec![]).is_err());
    Ok(())
}
