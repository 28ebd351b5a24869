// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Local searches of the literature: they follow a gradient from a start, and stop where it
//! leads no farther.
//!
//! They find an upper bound of the minimum, and cannot tell whether another point is deeper.
//! This crate is for comparison with
//! [`minimum`](palpate_query::minimum) and [`separation`](palpate_query::separation), which prove their
//! answers and do not depend on them.
//!
//! | method | of | source |
//! |---|---|---|
//! | [`NaiveDescent`] | field and element | memoir 2.4 and 3.2, as printed |
//! | [`ProjectedGradient`] | field and element | memoir 3.2; Macklin et al. 2020 |
//! | [`FrankWolfe`] | field and element | Macklin et al. 2020 |
//! | [`GoldenSection`] | field and element | Macklin et al. 2020 (edges); Pelletier-Guénette et al. 2025 (triangles; the spatial part of their space-time search) |
//! | [`MacklinDescent`] | field and element | Macklin et al. 2020, as `PhysX` 5 ships it |
//! | [`AlternatingProjection`] | two fields | memoir 3.3, after Liu et al. 2024 |
//! | [`MinimaxProximal`] | two fields | the bundle method with two planes |
//! | [`SumDescent`], [`halton_starts`] | two fields | `MuJoCo` |
//! | [`SpaceTimeGoldenSection`] | field and element or mesh, in motion | Pelletier-Guénette et al. 2025 |
//! | [`SampledSweep`] | mesh and field, or two fields, in motion | any of the above, at equal steps of time |
//!
//! Constants are those of the documents, or of the programs that use their methods. [`NaiveDescent`],
//! [`MacklinDescent`] and [`SumDescent`] are as published. Of the others, what is wrong in the documents
//! is mended: steps are not constant along a unit gradient, the best point is returned and not the last
//! one, and it is the projected step that says when to stop.
//!
//! [`GradientSampler`] finds directions of gradients in the ways of the memoir's section 2.3,
//! for comparison with [`Shape::distance_gradient`].
//!
//! ```
//! use palpate_field::{Shape, Vector, kernel::Ball};
//! use palpate_local::ElementMethod;
//! use palpate_query::{Element, Limits, ElementWorkspace, minimum};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! // A ball over the left end, and a smaller one that the segment cuts.
//! let balls = Shape::union([
//!     Shape::from_kernel(Ball::new(0.2)?).translated(Vector([-1.0, 0.0]))?,
//!     Shape::from_kernel(Ball::new(0.1)?).translated(Vector([0.25, -0.3]))?,
//! ])?;
//! let segment = Element::new([Vector([-1.0, 0.25]), Vector([1.0, -0.75])])?;
//! let method: ElementMethod = "projected_gradient".parse()?;
//! let found = method.descend(&balls, &segment);
//! let certified = minimum(&balls, &segment, &Limits::new(1e-4), &mut ElementWorkspace::new())?;
//! assert!(found.value > 0.02 && certified.upper < -0.032);
//! assert!(found.to_string().starts_with(&format!("{} m at ", found.value)));
//! # Ok(())
//! # }
//! ```

#[macro_use]
mod named;

mod alternating_projection;
mod descent;
mod gradient;
mod instances;
mod naive;
mod projected_gradient;
mod sweep;
mod weights;

use palpate_field::{Point, Shape};
use palpate_query::{Element, Placed, QueryError};

pub use alternating_projection::AlternatingProjection;
pub use alternating_projection::{MinimaxProximal, SumDescent};
pub use descent::Descent;
pub use gradient::{
    FoundDirection, GradientMethod, GradientSampler, adaptive_offset, angle_between,
    central_differences, closest_vector, dichotomy,
};
#[doc(hidden)]
pub use instances::instances;
pub use naive::NaiveDescent;
pub use projected_gradient::{FrankWolfe, GoldenSection};
pub use projected_gradient::{MacklinDescent, ProjectedGradient};
pub use sweep::{LocalSweep, LocalTouch, SampledSweep, SpaceTimeGoldenSection};
pub use weights::halton_starts;
pub use weights::{Weights, WeightsError};

/// A local search for the least value of a field over an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ElementMethod {
    /// [`NaiveDescent`].
    Naive,
    /// [`ProjectedGradient`].
    ProjectedGradient,
    /// [`FrankWolfe`].
    FrankWolfe,
    /// [`GoldenSection`].
    GoldenSection,
    /// [`MacklinDescent`].
    Macklin,
}

named!(ElementMethod:
    Naive = "naive",
    ProjectedGradient = "projected_gradient",
    FrankWolfe = "frank_wolfe",
    GoldenSection = "golden_section",
    Macklin = "macklin"
);

impl ElementMethod {
    /// The search with its default constants.
    #[must_use]
    #[inline(never)]
    pub fn descend<const N: usize, const D: usize>(
        self,
        shape: &Shape<D>,
        element: &Element<N, D>,
    ) -> Descent<D> {
        self.search(shape, element, None)
    }

    /// The same search from another point of the element than its usual start.
    #[must_use]
    #[inline(never)]
    pub fn descend_from<const N: usize, const D: usize>(
        self,
        shape: &Shape<D>,
        element: &Element<N, D>,
        start: &Weights<N>,
    ) -> Descent<D> {
        self.search(shape, element, Some(start))
    }

    fn search<const N: usize, const D: usize>(
        self,
        shape: &Shape<D>,
        element: &Element<N, D>,
        start: Option<&Weights<N>>,
    ) -> Descent<D> {
        match self {
            Self::Naive => NaiveDescent::default().search(shape, element, start),
            Self::ProjectedGradient => {
                ProjectedGradient::default().search(shape, element, start)
            }
            Self::FrankWolfe => FrankWolfe::default().search(shape, element, start),
            Self::GoldenSection => GoldenSection::default().search(shape, element, start),
            Self::Macklin => MacklinDescent::default().search(shape, element, start),
        }
    }
}

/// A local search for a point in two bodies, or between them.
///
/// What is made small is `max(g_a, g_b)` with `g` as in
/// [`separation`](palpate_query::separation), which is twice its least value; [`SumDescent`] makes a sum
/// of both small.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PairMethod {
    /// [`AlternatingProjection`].
    AlternatingProjection,
    /// [`MinimaxProximal`].
    MinimaxProximal,
    /// [`SumDescent`].
    SumDescent,
}

named!(PairMethod:
    AlternatingProjection = "alternating_projection",
    MinimaxProximal = "minimax_proximal",
    SumDescent = "sum_descent"
);

impl PairMethod {
    /// The search from `start` [m], with its default constants, until a step is shorter
    /// than `tolerance` [m].
    ///
    /// # Errors
    ///
    /// If a coordinate is not finite or beyond 1e15 m, a pose is not finite, or the
    /// tolerance is negative.
    pub fn descend<'a, const D: usize>(
        self,
        a: impl Into<Placed<'a, D>>,
        b: impl Into<Placed<'a, D>>,
        start: Point<D>,
        tolerance: f64,
    ) -> Result<Descent<D>, QueryError> {
        match self {
            Self::AlternatingProjection => {
                AlternatingProjection::default().descend(a, b, start, tolerance)
            }
            Self::MinimaxProximal => MinimaxProximal::default().descend(a, b, start, tolerance),
            Self::SumDescent => SumDescent::default().descend(a, b, start, tolerance),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_as_they_are_written() {
        for method in ElementMethod::ALL {
            assert_eq!(method.to_string().parse(), Ok(*method));
        }
        for method in PairMethod::ALL {
            assert_eq!(method.to_string().parse(), Ok(*method));
        }
        let error = "newton".parse::<PairMethod>().unwrap_err();
        assert_eq!(
            error.to_string(),
            "there is no method \"newton\"; there are alternating_projection, minimax_proximal, sum_descent"
        );
    }
}
