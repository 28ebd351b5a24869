// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The one declaration of each primitive.

use crate::error::{ShapeError, Unit};
use crate::kernel::{Kernel, Mark};
use crate::vector::Vector;

/// The kind of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterKind {
    /// A positive length [m].
    Length,
    /// A length of zero or more [m].
    LengthOrZero,
    /// A coordinate or signed offset [m].
    Coordinate,
    /// An angle [rad]; scene files may give degrees, with a key that ends in `_degrees`.
    Angle,
    /// A whole number.
    Count,
    /// A position or size, one number a dimension [m].
    Vector,
    /// A direction of any length, one number a dimension.
    Direction,
    /// Several positions [m].
    Points,
    /// Several closed polygons, each a list of positions [m].
    Rings,
}

impl ParameterKind {
    /// The unit of its numbers.
    #[must_use]
    pub const fn unit(self) -> Unit {
        match self {
            Self::Angle => Unit::Radian,
            Self::Count | Self::Direction => Unit::One,
            _ => Unit::Metre,
        }
    }
}

/// A number or list that a primitive is made from.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// Its name, as in scene files (where angles add `_degrees`).
    pub name: &'static str,
    /// Its kind.
    pub kind: ParameterKind,
    /// Its meaning, in a few words.
    pub about: &'static str,
}

/// A value for a [`Parameter`].
#[derive(Clone, Debug, PartialEq)]
pub enum Argument {
    /// For a length [m] or an angle [rad].
    Number(f64),
    /// For a count.
    Count(u32),
    /// For a vector.
    Vector(Vec<f64>),
    /// For points.
    Points(Vec<Vec<f64>>),
    /// For rings.
    Rings(Vec<Vec<Vec<f64>>>),
}

/// A kernel with a name, which can be made from arguments.
///
/// Implemented by the `primitive!` declaration beside each kernel.
pub trait NamedKernel<const D: usize>: Kernel<D> + Sized {
    /// The name in scene files.
    const NAME: &'static str;
    /// The primitive described in one sentence.
    const ABOUT: &'static str;
    /// Where its origin is and which way it points, in phrases between semicolons and commas.
    const ORIGIN: &'static str;
    /// The parameters, in the order of `new`.
    const PARAMETERS: &'static [Parameter];

    /// Makes the primitive from one argument for each parameter, in their order.
    ///
    /// # Errors
    ///
    /// If an argument is of the wrong kind or breaks the parameter's rule.
    fn from_arguments(arguments: &[Argument]) -> Result<Self, ShapeError>;

    /// The arguments of the primitive, in the order of the parameters, with the bits given to
    /// [`from_arguments`](Self::from_arguments).
    fn arguments(&self) -> Vec<Argument>;

    /// Where its parameters can be seen: one mark for each that is a length, an angle, a position
    /// or a direction, or several where it has several numbers. A mark of length zero is there too.
    fn marks(&self) -> Vec<Mark<D>>;

    /// An example of about 1 m, asymmetric where possible, for tests and pictures.
    ///
    /// # Errors
    ///
    /// None in practice.
    fn example() -> Result<Self, ShapeError>;
}

/// A parameter's value that becomes an [`Argument`].
pub(crate) trait ToArgument {
    fn to_argument(&self) -> Argument;
}

impl ToArgument for f64 {
    fn to_argument(&self) -> Argument {
        Argument::Number(*self)
    }
}

impl ToArgument for u32 {
    fn to_argument(&self) -> Argument {
        Argument::Count(*self)
    }
}

impl<const D: usize> ToArgument for Vector<f64, D> {
    fn to_argument(&self) -> Argument {
        Argument::Vector(self.0.to_vec())
    }
}

impl<const D: usize> ToArgument for &[Vector<f64, D>] {
    fn to_argument(&self) -> Argument {
        Argument::Points(self.iter().map(|point| point.0.to_vec()).collect())
    }
}

impl<const D: usize> ToArgument for &[Vec<Vector<f64, D>>] {
    fn to_argument(&self) -> Argument {
        let ring = |ring: &Vec<Vector<f64, D>>| ring.iter().map(|p| p.0.to_vec()).collect();
        Argument::Rings(self.iter().map(ring).collect())
    }
}

/// A constructor's value that is taken from an [`Argument`].
pub(crate) trait FromArgument: Sized {
    fn from_argument(parameter: &Parameter, argument: &Argument) -> Result<Self, ShapeError>;
}

fn wrong_kind(parameter: &Parameter, expected: &'static str) -> ShapeError {
    ShapeError::Unsuitable { operator: parameter.name, needs: expected.into() }
}

impl FromArgument for f64 {
    fn from_argument(parameter: &Parameter, argument: &Argument) -> Result<Self, ShapeError> {
        match argument {
            Argument::Number(number) => Ok(*number),
            _ => Err(wrong_kind(parameter, "a number")),
        }
    }
}

impl FromArgument for u32 {
    fn from_argument(parameter: &Parameter, argument: &Argument) -> Result<Self, ShapeError> {
        match argument {
            Argument::Count(count) => Ok(*count),
            _ => Err(wrong_kind(parameter, "a whole number")),
        }
    }
}

fn vector<const D: usize>(
    parameter: &Parameter,
    components: &[f64],
) -> Result<Vector<f64, D>, ShapeError> {
    let components = components.try_into().map_err(|_| ShapeError::Count {
        parameter: parameter.name.into(),
        rule: format!("{D} numbers").into(),
        count: components.len(),
    })?;
    for x in components {
        crate::error::finite(parameter.name, x, parameter.kind.unit())?;
    }
    Ok(Vector(components))
}

impl<const D: usize> FromArgument for Vector<f64, D> {
    fn from_argument(parameter: &Parameter, argument: &Argument) -> Result<Self, ShapeError> {
        match argument {
            Argument::Vector(components) => vector(parameter, components),
            _ => Err(wrong_kind(parameter, "a vector")),
        }
    }
}

impl<const D: usize> FromArgument for Vec<Vector<f64, D>> {
    fn from_argument(parameter: &Parameter, argument: &Argument) -> Result<Self, ShapeError> {
        match argument {
            Argument::Points(points) => points.iter().map(|p| vector(parameter, p)).collect(),
            _ => Err(wrong_kind(parameter, "a list of points")),
        }
    }
}

impl<const D: usize> FromArgument for Vec<Vec<Vector<f64, D>>> {
    fn from_argument(parameter: &Parameter, argument: &Argument) -> Result<Self, ShapeError> {
        match argument {
            Argument::Rings(rings) => rings
                .iter()
                .map(|ring| ring.iter().map(|p| vector(parameter, p)).collect())
                .collect(),
            _ => Err(wrong_kind(parameter, "a list of rings")),
        }
    }
}

/// Takes exactly as many arguments as there are parameters.
pub(crate) fn check_count(
    name: &'static str,
    parameters: &[Parameter],
    arguments: &[Argument],
) -> Result<(), ShapeError> {
    if parameters.len() == arguments.len() {
        return Ok(());
    }
    Err(ShapeError::Count {
        parameter: name.into(),
        rule: format!("{} arguments", parameters.len()).into(),
        count: arguments.len(),
    })
}

/// A vector of `$dimension` numbers. Written out, since documentation shows the tokens.
macro_rules! vector_type {
    (2) => { $crate::vector::Vector<f64, 2> };
    (3) => { $crate::vector::Vector<f64, 3> };
    ($dimension:tt) => { $crate::vector::Vector<f64, $dimension> };
}

/// A shape of `$dimension` dimensions. Written out, since documentation shows the tokens.
macro_rules! shape_type {
    (2) => { $crate::shape::Shape<2> };
    (3) => { $crate::shape::Shape<3> };
    ($dimension:tt) => { $crate::shape::Shape<$dimension> };
}

/// The type that a parameter's accessor returns, by its kind, in `$dimension` dimensions.
macro_rules! parameter_type {
    (Count, $dimension:tt) => { u32 };
    (Vector, $dimension:tt) => { $crate::kernel::primitive::vector_type!($dimension) };
    (Direction, $dimension:tt) => { $crate::kernel::primitive::vector_type!($dimension) };
    (Points, $dimension:tt) => { &[$crate::kernel::primitive::vector_type!($dimension)] };
    (Rings, $dimension:tt) => { &[Vec<$crate::kernel::primitive::vector_type!($dimension)>] };
    ($number:ident, $dimension:tt) => { f64 };
}

/// The unit at the end of a parameter's documentation.
macro_rules! parameter_unit {
    (Angle) => {
        " [rad]"
    };
    (Count) => {
        ""
    };
    (Direction) => {
        ""
    };
    ($length:ident) => {
        " [m]"
    };
}

/// The value of a parameter: the field of its name, or the expression of the declaration.
macro_rules! parameter_value {
    ($kernel:ident, $parameter:ident, Points) => {
        &$kernel.$parameter
    };
    ($kernel:ident, $parameter:ident, Rings) => {
        &$kernel.$parameter
    };
    ($kernel:ident, $parameter:ident, $kind:ident) => {
        $kernel.$parameter
    };
    ($kernel:ident, $parameter:ident, $kind:ident, $given:expr) => {{
        let given: fn(&Self) -> _ = $given;
        given($kernel)
    }};
}

/// The type that a constructor of shapes takes for a parameter.
macro_rules! accepted_type {
    (Count, $dimension:tt) => { u32 };
    (Vector, $dimension:tt) => { impl Into<$crate::kernel::primitive::vector_type!($dimension)> };
    (Direction, $dimension:tt) => { impl Into<$crate::kernel::primitive::vector_type!($dimension)> };
    (Points, $dimension:tt) => {
        impl IntoIterator<Item: Into<$crate::kernel::primitive::vector_type!($dimension)>>
    };
    (Rings, $dimension:tt) => {
        impl IntoIterator<
            Item: IntoIterator<Item: Into<$crate::kernel::primitive::vector_type!($dimension)>>,
        >
    };
    ($number:ident, $dimension:tt) => { f64 };
}

/// The [`Argument`] of a value that a constructor of shapes took.
macro_rules! accepted {
    (Count, $dimension:tt, $value:ident) => {
        $crate::kernel::Argument::Count($value)
    };
    (Vector, $dimension:tt, $value:ident) => {
        $crate::kernel::primitive::vector_argument::<$dimension>($value)
    };
    (Direction, $dimension:tt, $value:ident) => {
        $crate::kernel::primitive::vector_argument::<$dimension>($value)
    };
    (Points, $dimension:tt, $value:ident) => {
        $crate::kernel::Argument::Points($crate::kernel::primitive::positions::<$dimension>(
            $value,
        ))
    };
    (Rings, $dimension:tt, $value:ident) => {
        $crate::kernel::Argument::Rings(
            $value
                .into_iter()
                .map($crate::kernel::primitive::positions::<$dimension>)
                .collect(),
        )
    };
    ($number:ident, $dimension:tt, $value:ident) => {
        $crate::kernel::Argument::Number($value)
    };
}

/// A vector as an argument.
pub(crate) fn vector_argument<const D: usize>(vector: impl Into<Vector<f64, D>>) -> Argument {
    vector.into().to_argument()
}

/// Positions as part of an argument.
pub(crate) fn positions<const D: usize>(
    points: impl IntoIterator<Item: Into<Vector<f64, D>>>,
) -> Vec<Vec<f64>> {
    points.into_iter().map(|point| point.into().0.to_vec()).collect()
}

/// Declares a kernel as a primitive: its name, what it is, where its origin is and which way it
/// points, its parameters in the order of `new`, where pictures show them, and an example.
///
/// A parameter's value is the field of its name; where there is no such field, `=> |kernel| …`
/// gives it. Each gets an accessor of its name, and [`Shape`](crate::Shape) a constructor of
/// the primitive's name.
macro_rules! primitive {
    (
        $kernel:ident $(<$argument:tt>)?, $name:ident, $dimension:tt,
        about: $about:literal,
        origin: $origin:literal,
        parameters: {
            $($parameter:ident: $kind:ident = $what:literal $(=> $given:expr)?),* $(,)?
        },
        marks: $marks:expr,
        example: ($($example:expr),* $(,)?) $(,)?
    ) => {
        primitive!(@accessors [$($argument)?] $dimension, $kernel $(<$argument>)?,
            { $($parameter: $kind = $what $(=> $given)?),* });
        primitive!(@declare $dimension, $kernel, $kernel $(<$argument>)?, $name, $about,
            $origin, $marks, { $($parameter: $kind = $what),* }, ($($example),*));
    };
    (@accessors [D] any, $kernel:ty, $parameters:tt) => {
        primitive!(@methods [const D: usize], D, $kernel, $parameters);
    };
    (@accessors [] any, $kernel:ty, $parameters:tt) => {
        // A kernel for any dimension has no vector parameters, so the dimension does not
        // matter.
        primitive!(@methods [], 0, $kernel, $parameters);
    };
    (@accessors [$($argument:tt)?] $dimension:tt, $kernel:ty, $parameters:tt) => {
        primitive!(@methods [], $dimension, $kernel, $parameters);
    };
    (
        @methods [$($generics:tt)*], $dimension:tt, $kernel:ty,
        { $($parameter:ident: $kind:ident = $what:literal $(=> $given:expr)?),* }
    ) => {
        impl<$($generics)*> $kernel {
            $(
                #[doc = concat!(
                    "The parameter `", stringify!($parameter), "`: ", $what,
                    $crate::kernel::primitive::parameter_unit!($kind), ".",
                )]
                #[must_use]
                #[inline]
                pub fn $parameter(
                    &self,
                ) -> $crate::kernel::primitive::parameter_type!($kind, $dimension) {
                    let kernel = self;
                    $crate::kernel::primitive::parameter_value!(
                        kernel, $parameter, $kind $(, $given)?
                    )
                }
            )*
        }
    };
    (@declare any, $type:ident, $kernel:ty, $($rest:tt)*) => {
        primitive!(@primitive [const D: usize], D, $kernel, $($rest)*);
        primitive!(@constructor [const D: usize], D, $type, $($rest)*);
    };
    (@declare $dimension:tt, $type:ident, $kernel:ty, $($rest:tt)*) => {
        primitive!(@primitive [], $dimension, $kernel, $($rest)*);
        primitive!(@constructor [], $dimension, $type, $($rest)*);
    };
    (
        @constructor [$($generics:tt)*], $dimension:tt, $type:ident,
        $name:ident, $about:literal, $origin:literal, $marks:expr,
        { $($parameter:ident: $kind:ident = $what:literal),* },
        $example:tt
    ) => {
        impl<$($generics)*> $crate::kernel::primitive::shape_type!($dimension) {
            #[doc = concat!(
                $about, "\n\nOrigin: ", $origin, ".\n\nThe constructor of [`kernel::", stringify!($type),
                "`](struct@", stringify!($type),
                "), which has the formula and an example. Parameters:\n\n",
            )]
            $(
                #[doc = concat!(
                    "- `", stringify!($parameter), "`: ", $what,
                    $crate::kernel::primitive::parameter_unit!($kind),
                )]
            )*
            #[doc = "\n# Errors\n\nIf a parameter breaks the rule of the kernel's `new`."]
            pub fn $name(
                $(
                    $parameter: $crate::kernel::primitive::accepted_type!($kind, $dimension)
                ),*
            ) -> Result<Self, $crate::error::ShapeError> {
                let arguments = vec![$(
                    $crate::kernel::primitive::accepted!($kind, $dimension, $parameter)
                ),*];
                let primitive =
                    $crate::node::Primitive::new(stringify!($name), arguments)?;
                Self::from_node($crate::node::Node::Primitive(primitive))
            }
        }
    };
    (
        @primitive [$($generics:tt)*], $dimension:tt, $kernel:ty,
        $name:ident, $about:literal, $origin:literal, $marks:expr,
        { $($parameter:ident: $kind:ident = $what:literal),* },
        ($($example:expr),*)
    ) => {
        impl<$($generics)*> $crate::kernel::NamedKernel<$dimension> for $kernel {
            const NAME: &'static str = stringify!($name);
            const ABOUT: &'static str = $about;
            const ORIGIN: &'static str = $origin;
            const PARAMETERS: &'static [$crate::kernel::Parameter] = &[
                $($crate::kernel::Parameter {
                    name: stringify!($parameter),
                    kind: $crate::kernel::ParameterKind::$kind,
                    about: $what,
                }),*
            ];

            fn from_arguments(
                arguments: &[$crate::kernel::Argument],
            ) -> Result<Self, $crate::error::ShapeError> {
                let name = stringify!($name);
                let parameters =
                    <Self as $crate::kernel::NamedKernel<$dimension>>::PARAMETERS;
                $crate::kernel::primitive::check_count(name, parameters, arguments)?;
                let mut pairs = parameters.iter().zip(arguments);
                let mut next = || pairs.next().ok_or($crate::error::ShapeError::Count {
                    parameter: name.into(),
                    rule: "all arguments".into(),
                    count: arguments.len(),
                });
                $(
                    let (parameter, argument) = next()?;
                    let $parameter = $crate::kernel::primitive::FromArgument::from_argument(
                        parameter, argument,
                    )?;
                )*
                Self::new($($parameter),*)
            }

            fn arguments(&self) -> Vec<$crate::kernel::Argument> {
                vec![$(
                    $crate::kernel::primitive::ToArgument::to_argument(&self.$parameter())
                ),*]
            }

            fn marks(&self) -> Vec<$crate::kernel::Mark<$dimension>> {
                let marks: fn(&Self) -> _ = $marks;
                marks(self)
            }

            fn example() -> Result<Self, $crate::error::ShapeError> {
                Self::new($($example),*)
            }
        }
    };
}

pub(crate) use {
    accepted, accepted_type, parameter_type, parameter_unit, parameter_value, primitive,
    shape_type, vector_type,
};
