// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Shapes as plain data, and their formulas written a second time.
//!
//! [`Tree::shape`] builds a shape as a user would. [`Tree::distance`] evaluates the definitions
//! of the operators directly, in any number; the fields of `palpate-field` must agree with it.

use palpate_field::kernel::{Argument, NamedKernel};
use palpate_field::operator::{Child, Copies, Operator, Profile};
use palpate_field::scalar::{Circular, Cubic, Exponential, Quadratic, Quartic, Root, Scalar};
use palpate_field::{Node, Pose, Shape, ShapeError, Vector};

use crate::kernels::{Dimension, IntoShape, Space, Visit};

/// A primitive by its name in the catalogue.
#[derive(Clone, Debug, PartialEq)]
pub struct Leaf {
    /// Its name.
    pub name: &'static str,
    /// One argument for each parameter.
    pub arguments: Vec<Argument>,
}

/// A shape as plain data.
#[derive(Clone, Debug, PartialEq)]
pub enum Tree<const D: usize> {
    /// A primitive.
    Leaf(Leaf),
    /// `min`.
    Union(Vec<Self>),
    /// `max`.
    Intersection(Vec<Self>),
    /// The first without the others.
    Difference(Box<Self>, Vec<Self>),
    /// Points in an odd number of shapes.
    SymmetricDifference(Vec<Self>),
    /// A boolean with its creases filled or cut off by a width [m].
    Smooth(Boolean, Vec<Self>, Profile, f64),
    /// Grown by a distance [m].
    Offset(Box<Self>, f64),
    /// An operator of the catalogue with its argument.
    Operated(Box<Self>, Operator, Argument),
    /// Mirrored along an axis.
    Mirrored(Box<Self>, usize),
    /// Repeated along the axes.
    Repeated(Box<Self>, [Copies; D]),
    /// Bent by a rate [rad/m].
    Bent(Box<Self>, f64),
    /// In space: twisted by a rate [rad/m].
    Twisted(Box<Self>, f64),
    /// Displaced by another field, by at most a height [m].
    Displaced(Box<Self>, Box<Self>, f64),
    /// A morph: part of the way to another shape.
    Morphed(Box<Self>, Box<Self>, f64),
    /// Moved.
    Placed(Box<Self>, Pose<D>),
    /// Scaled by one factor.
    Scaled(Box<Self>, f64),
    /// Scaled by one factor an axis.
    Stretched(Box<Self>, [f64; D]),
    /// In space: a profile made solid.
    Solid(Box<Tree<2>>, Sweep),
}

/// Which smooth boolean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Boolean {
    /// Points in at least one.
    Union,
    /// Points in all.
    Intersection,
    /// The first without the others.
    Difference,
}

/// How a profile becomes a solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sweep {
    /// Extruded to a height [m].
    Extruded(f64),
    /// Turned about y.
    Revolved,
}

/// Operators that only one dimension has.
pub trait Solid<const D: usize>: Dimension<D> {
    /// Builds a solid from its profile.
    ///
    /// # Errors
    ///
    /// As the operator.
    fn solid(profile: &Tree<2>, sweep: Sweep) -> Result<Shape<D>, ShapeError>;

    /// Twists a shape.
    ///
    /// # Errors
    ///
    /// As the operator.
    fn twisted(shape: Shape<D>, rate: f64) -> Result<Shape<D>, ShapeError>;

    /// The formula of a solid.
    fn solid_distance<S: Scalar>(profile: &Tree<2>, sweep: Sweep, p: Vector<S, D>) -> S;
}

impl Solid<2> for Space {
    fn solid(_: &Tree<2>, _: Sweep) -> Result<Shape<2>, ShapeError> {
        Err(ShapeError::Unsuitable { operator: "solid", needs: "space".into() })
    }

    fn twisted(_: Shape<2>, _: f64) -> Result<Shape<2>, ShapeError> {
        Err(ShapeError::Unsuitable { operator: "twist", needs: "space".into() })
    }

    fn solid_distance<S: Scalar>(_: &Tree<2>, _: Sweep, _: Vector<S, 2>) -> S {
        unreachable!("no plane tree with a solid can be built")
    }
}

impl Solid<3> for Space {
    fn solid(profile: &Tree<2>, sweep: Sweep) -> Result<Shape<3>, ShapeError> {
        let profile = profile.shape()?;
        match sweep {
            Sweep::Extruded(height) => profile.extruded(height),
            Sweep::Revolved => profile.revolved(),
        }
    }

    fn twisted(shape: Shape<3>, rate: f64) -> Result<Shape<3>, ShapeError> {
        shape.twisted(rate)
    }

    fn solid_distance<S: Scalar>(profile: &Tree<2>, sweep: Sweep, p: Vector<S, 3>) -> S {
        let [x, y, z] = p.0;
        match sweep {
            Sweep::Extruded(height) => {
                let zero = S::constant(0.0);
                let side = profile.distance(Vector([x, z]));
                let cap = y.abs() - S::constant(0.5 * height);
                S::norm([side.max(zero), cap.max(zero)]) + side.max(cap).min(zero)
            }
            Sweep::Revolved => {
                profile.distance(Vector([(x.squared() + z.squared()).sqrt(), y]))
            }
        }
    }
}

struct At<S, const D: usize>(Vector<S, D>);

impl<S: Scalar, const D: usize> Visit<D> for At<S, D> {
    type Output = S;

    fn visit<K: NamedKernel<D>>(self, kernel: K) -> S {
        kernel.distance(self.0)
    }
}

impl<const D: usize> Tree<D>
where
    Space: Solid<D>,
{
    /// The primitive `name`.
    #[must_use]
    pub fn leaf(name: &'static str, arguments: Vec<Argument>) -> Self {
        Self::Leaf(Leaf { name, arguments })
    }

    /// Builds the shape, as a user would.
    ///
    /// # Errors
    ///
    /// As the operators and primitives.
    pub fn shape(&self) -> Result<Shape<D>, ShapeError> {
        let all = |trees: &[Self]| trees.iter().map(Self::shape).collect::<Result<Vec<_>, _>>();
        match self {
            Self::Leaf(leaf) => Space::with_kernel(leaf.name, &leaf.arguments, IntoShape),
            Self::Union(trees) => Shape::union(all(trees)?),
            Self::Intersection(trees) => Shape::intersection(all(trees)?),
            Self::Difference(first, others) => first.shape()?.difference(all(others)?),
            Self::SymmetricDifference(trees) => Shape::symmetric_difference(all(trees)?),
            Self::Smooth(boolean, trees, profile, width) => {
                let mut shapes = all(trees)?;
                match boolean {
                    Boolean::Union => Shape::smooth_union(shapes, *profile, *width),
                    Boolean::Intersection => {
                        Shape::smooth_intersection(shapes, *profile, *width)
                    }
                    Boolean::Difference => {
                        let first = shapes.remove(0);
                        first.smooth_difference(shapes, *profile, *width)
                    }
                }
            }
            Self::Offset(tree, distance) => tree.shape()?.offset(*distance),
            Self::Operated(tree, operator, argument) => Shape::from_node(Node::Operated {
                operator: *operator,
                argument: argument.clone(),
                of: tree.shape()?,
            }),
            Self::Mirrored(tree, axis) => tree.shape()?.mirrored(*axis),
            Self::Repeated(tree, copies) => tree.shape()?.repeated(*copies),
            Self::Bent(tree, rate) => tree.shape()?.bent(*rate),
            Self::Twisted(tree, rate) => Space::twisted(tree.shape()?, *rate),
            Self::Displaced(tree, by, height) => tree.shape()?.displaced(by.shape()?, *height),
            Self::Morphed(tree, into, progress) => {
                tree.shape()?.morphed(into.shape()?, *progress)
            }
            Self::Placed(tree, pose) => tree.shape()?.placed(pose),
            Self::Scaled(tree, factor) => tree.shape()?.scaled(*factor),
            Self::Stretched(tree, factors) => tree.shape()?.stretched(*factors),
            Self::Solid(profile, sweep) => Space::solid(profile, *sweep),
        }
    }

    /// The number of nested operators, with the leaf.
    #[must_use]
    pub fn depth(&self) -> usize {
        let deepest = |trees: &[Self]| trees.iter().map(Self::depth).max().unwrap_or(0);
        1 + match self {
            Self::Leaf(_) => 0,
            Self::Union(trees)
            | Self::Intersection(trees)
            | Self::SymmetricDifference(trees)
            | Self::Smooth(_, trees, ..) => deepest(trees),
            Self::Difference(first, others) => first.depth().max(deepest(others)),
            Self::Offset(tree, _)
            | Self::Operated(tree, ..)
            | Self::Mirrored(tree, _)
            | Self::Repeated(tree, _)
            | Self::Bent(tree, _)
            | Self::Twisted(tree, _)
            | Self::Placed(tree, _)
            | Self::Scaled(tree, _)
            | Self::Stretched(tree, _) => tree.depth(),
            Self::Displaced(a, b, _) | Self::Morphed(a, b, _) => a.depth().max(b.depth()),
            Self::Solid(profile, _) => profile.depth(),
        }
    }

    /// The formula at `p`, by the definitions of the operators.
    ///
    /// Operators that grow a child use the distance to the child's box as a guard. The
    /// definitions have no such guard, so the box comes from the child's promise.
    ///
    /// # Panics
    ///
    /// If the tree cannot be built.
    pub fn distance<S: Scalar>(&self, p: Vector<S, D>) -> S {
        let number = S::constant;
        match self {
            Self::Leaf(leaf) => Space::with_kernel(leaf.name, &leaf.arguments, At(p))
                .unwrap_or_else(|error| panic!("{self:?}: {error}")),
            Self::Union(trees) => fold(trees, p, S::min),
            Self::Intersection(trees) => fold(trees, p, S::max),
            Self::Difference(first, others) => {
                let first = first.distance(p);
                if others.is_empty() { first } else { first.max(-fold(others, p, S::min)) }
            }
            Self::SymmetricDifference(trees) => fold(trees, p, |a, b| a.min(b).max(-a.max(b))),
            Self::Smooth(boolean, trees, profile, width) => {
                let mut values = trees.iter().map(|tree| match boolean {
                    Boolean::Union => tree.guarded(p),
                    Boolean::Intersection | Boolean::Difference => tree.distance(p),
                });
                let first = values.next().unwrap_or_else(|| panic!("{self:?} is empty"));
                values.fold(first, |a, b| match boolean {
                    Boolean::Union => smooth_min(*profile, a, b, *width),
                    Boolean::Intersection => -smooth_min(*profile, -a, -b, *width),
                    Boolean::Difference => -smooth_min(*profile, -a, b, *width),
                })
            }
            Self::Offset(tree, distance) => {
                let child = if *distance > 0.0 { tree.guarded(p) } else { tree.distance(p) };
                child - number(*distance)
            }
            Self::Operated(tree, operator, argument) => {
                let child =
                    Child { value: &|p| tree.distance(p), guarded: &|p| tree.guarded(p) };
                operator.definition(&child, argument, p)
            }
            Self::Mirrored(tree, axis) => {
                let mut q = p;
                q[*axis] = q[*axis].abs();
                tree.distance(q)
            }
            Self::Repeated(tree, copies) => repeated(tree, copies, p),
            Self::Bent(tree, rate) => turned(tree, *rate, [0, 1], 0, p),
            Self::Twisted(tree, rate) => turned(tree, *rate, [2, 0], 1, p),
            Self::Displaced(tree, by, height) => {
                tree.guarded(p) - by.distance(p).clamp(-height, *height)
            }
            Self::Morphed(tree, into, progress) => {
                tree.distance(p).scale(1.0 - progress) + into.distance(p).scale(*progress)
            }
            Self::Placed(tree, pose) => placed(tree, pose, p),
            Self::Scaled(tree, factor) => {
                let s = number(*factor);
                tree.distance(Vector(p.0.map(|x| x / s))).scale(*factor)
            }
            Self::Stretched(tree, factors) => {
                let q = Vector(std::array::from_fn(|i| p.0[i] / number(factors[i])));
                let smallest = factors.iter().fold(f64::INFINITY, |m, f| f64::min(m, *f));
                tree.distance(q).scale(smallest)
            }
            Self::Solid(profile, sweep) => Space::solid_distance(profile, *sweep, p),
        }
    }

    /// As [`distance`](Self::distance), but at least the distance to the box where the promise
    /// says that the value may be less.
    fn guarded<S: Scalar>(&self, p: Vector<S, D>) -> S {
        let child = self.distance(p);
        let shape = self.shape().unwrap_or_else(|error| panic!("{self:?}: {error}"));
        let promise = shape.promise();
        match promise.bounds {
            Some(bounds) if !promise.above_bounds => {
                let centre = bounds.aabb.centre();
                let half = bounds.aabb.half_extents();
                child.max(S::orthant(std::array::from_fn::<S, D, _>(|i| {
                    (p.0[i] - S::constant(centre[i])).abs() - S::constant(half[i])
                })))
            }
            _ => child,
        }
    }
}

/// The smooth minimum of a profile by its width.
fn smooth_min<S: Scalar>(profile: Profile, a: S, b: S, width: f64) -> S {
    match profile {
        Profile::Quadratic => a.smooth_min::<Quadratic>(b, 4.0 * width),
        Profile::Cubic => a.smooth_min::<Cubic>(b, 6.0 * width),
        Profile::Quartic => a.smooth_min::<Quartic>(b, 16.0 / 3.0 * width),
        Profile::Circular => a.smooth_min::<Circular>(b, CIRCLE * width),
        Profile::Root => a.smooth_min::<Root>(b, 2.0 * width),
        Profile::Exponential => a.smooth_min::<Exponential>(b, width),
        Profile::CircularGeometrical => {
            let (zero, radius) = (S::constant(0.0), S::constant(CIRCLE * width));
            radius.max(a.min(b)) - S::norm([(radius - a).max(zero), (radius - b).max(zero)])
        }
    }
}

/// The radius of a fillet in a right angle, over the depth of its fill in the corner.
const CIRCLE: f64 = 2.0 + std::f64::consts::SQRT_2;

fn fold<S: Scalar, const D: usize>(
    trees: &[Tree<D>],
    p: Vector<S, D>,
    operation: impl Fn(S, S) -> S,
) -> S
where
    Space: Solid<D>,
{
    let values = trees.iter().map(|tree| tree.distance(p));
    values.reduce(operation).unwrap_or_else(|| panic!("an operator over nothing"))
}

/// The nearest copy: that of the point's tile, and of the tiles beside it along axes in which
/// the child is not symmetric or wider than its tile. The distance to the boxes of all other
/// copies is an upper limit.
fn repeated<S: Scalar, const D: usize>(
    tree: &Tree<D>,
    copies: &[Copies; D],
    p: Vector<S, D>,
) -> S
where
    Space: Solid<D>,
{
    let shape = tree.shape().unwrap_or_else(|error| panic!("{tree:?}: {error}"));
    let promise = shape.promise();
    let aabb = promise.bounds.unwrap_or_else(|| panic!("no bounds")).aabb;
    let rows: [(f64, f64, f64); D] = copies.map(|copies| match copies {
        Copies::One => (1.0, 0.0, 0.0),
        Copies::Between { spacing, first, last } => (spacing, first.into(), last.into()),
        Copies::Endless { spacing } => (spacing, -1e6, 1e6),
    });
    let middle = |i: usize| 0.5 * (aabb.min[i] + aabb.max[i]);
    let centre: [f64; D] =
        std::array::from_fn(|i| if promise.symmetric[i] { 0.0 } else { middle(i) });
    let wide: [bool; D] = std::array::from_fn(|i| {
        let (spacing, first, last) = rows[i];
        first < last && !(promise.symmetric[i] && aabb.max[i] <= 0.5 * spacing)
    });
    let place: [S; D] = std::array::from_fn(|i| {
        let (spacing, first, last) = rows[i];
        (p.0[i] - S::constant(centre[i])).nearest_multiple(spacing, first, last)
    });
    let any_wide = wide.contains(&true);
    let mut nearest: Option<S> = None;
    for code in 0..3_usize.pow(D as u32) {
        let step = |i: usize| [0.0, -1.0, 1.0][code / 3_usize.pow(i as u32) % 3];
        if (0..D).any(|i| !wide[i] && step(i) != 0.0) {
            continue;
        }
        let q = Vector(std::array::from_fn(|i| {
            let (spacing, first, last) = rows[i];
            let copy = place[i] + S::constant(step(i) * spacing);
            p.0[i] - copy.clamp(first * spacing, last * spacing)
        }));
        let value = if any_wide { tree.guarded(q) } else { tree.distance(q) };
        nearest = Some(nearest.map_or(value, |least| least.min(value)));
    }
    let mut result = nearest.unwrap_or_else(|| panic!("no copies"));
    let far = S::constant(1e15);
    for i in (0..D).filter(|i| wide[*i]) {
        let gaps: [S; D] = std::array::from_fn(|k| {
            let (spacing, first, last) = rows[k];
            if k == i {
                let half = 0.5 * (aabb.max[k] - aabb.min[k]);
                let inside = p.0[k] - place[k] - S::constant(centre[k]);
                let gap = S::constant(2.0 * spacing - half);
                let lowest = S::constant((first + 0.5) * spacing);
                let highest = S::constant((last - 0.5) * spacing);
                let above = S::select_less(place[k], highest, gap - inside, far);
                let below = S::select_less(lowest, place[k], gap + inside, far);
                above.min(below).max(S::constant(0.0))
            } else {
                let (low, high) = (aabb.min[k] + first * spacing, aabb.max[k] + last * spacing);
                let outside = (p.0[k] - S::constant(0.5 * (low + high))).abs();
                (outside - S::constant(0.5 * (high - low))).max(S::constant(0.0))
            }
        });
        result = result.min(S::norm(gaps));
    }
    result
}

/// The field turned in a plane by a rate along an axis. It is evaluated in the box that the
/// turned shape sweeps; outside, the distance to this box is added.
fn turned<S: Scalar, const D: usize>(
    tree: &Tree<D>,
    rate: f64,
    [u, v]: [usize; 2],
    along: usize,
    p: Vector<S, D>,
) -> S
where
    Space: Solid<D>,
{
    let shape = tree.shape().unwrap_or_else(|error| panic!("{tree:?}: {error}"));
    let mut room = shape.promise().bounds.unwrap_or_else(|| panic!("no bounds")).aabb;
    let farthest = |i: usize| f64::max(room.min[i].abs(), room.max[i].abs());
    let radius = farthest(u).hypot(farthest(v)) * (1.0 + 4.0 * f64::EPSILON);
    for i in [u, v] {
        (room.min[i], room.max[i]) = (-radius, radius);
    }
    let inside = Vector(std::array::from_fn(|i| p.0[i].clamp(room.min[i], room.max[i])));
    let outside = S::norm(std::array::from_fn::<S, D, _>(|i| p.0[i] - inside.0[i]));
    let angle = inside.0[along].scale(-rate);
    let mut q = inside;
    q.0[u] = angle.cos() * inside.0[u] - angle.sin() * inside.0[v];
    q.0[v] = angle.sin() * inside.0[u] + angle.cos() * inside.0[v];
    tree.distance(q) + outside
}

/// `f(Rᵀ(p − t))`; motions of a moved leaf are one motion, composed in doubles.
fn placed<S: Scalar, const D: usize>(tree: &Tree<D>, pose: &Pose<D>, p: Vector<S, D>) -> S
where
    Space: Solid<D>,
{
    let (mut tree, mut pose) = (tree, *pose);
    if let Some((leaf, motion)) = moved_leaf(tree) {
        (tree, pose) = (leaf, pose * motion);
    }
    let q = p - Vector::of(&pose.translation.0);
    let rows = pose.rotation.matrix();
    tree.distance(Vector(std::array::from_fn(|i| {
        let column: [f64; D] = std::array::from_fn(|k| rows[k][i]);
        q.dot_constant(&column)
    })))
}

fn moved_leaf<const D: usize>(tree: &Tree<D>) -> Option<(&Tree<D>, Pose<D>)> {
    match tree {
        Tree::Leaf(_) => Some((tree, Pose::identity())),
        Tree::Placed(inner, pose) => {
            moved_leaf(inner).map(|(leaf, motion)| (leaf, *pose * motion))
        }
        _ => None,
    }
}
