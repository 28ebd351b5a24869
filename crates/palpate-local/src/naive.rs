// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The memoir's descent, and how it oscillates.

use palpate_field::{LARGEST_LENGTH, Shape, Vector};
use palpate_query::Element;

use crate::alternating_projection::nearest;
use crate::descent::Step;
use crate::{Descent, GradientMethod, GradientSampler, Weights};

/// Steps down the gradient from the centroid of the element, with a length that follows the
/// value, and after each step to the nearest point of the element:
///
/// ```text
/// P ← P − α·max(f(P), µ)·∇f(P)/‖∇f(P)‖
/// ```
///
/// The factor f(P) makes long steps far away; µ keeps the steps from vanishing at the surface,
/// and so from ever vanishing: where α·µ is longer than the way to the minimum, the point goes to
/// and fro across it ([`Descent::oscillation`]). Without µ, the steps add up to the distance of the
/// surface, where the descent ends. The other methods of this crate mend both.
///
/// An upper bound of the minimum, without a proof. On a disc of 1 m, three steps from 3 m away
/// with α = ½ and µ = ½ m are 1 m, ½ m and ¼ m long:
///
/// ```
/// use palpate_field::{Shape, Vector};
/// use palpate_local::{GradientMethod, NaiveDescent, Weights};
/// use palpate_query::Element;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let disc = Shape::<2>::ball(1.0)?;
/// let element = Element::new([Vector([0.0, 0.0]), Vector([0.0, 4.0])])?;
/// let descent = NaiveDescent::default()
///     .with_alpha(0.5)
///     .with_mu(0.5)
///     .with_steps(3)
///     .with_gradient(GradientMethod::Exact);
/// let found = descent.descend_from(&disc, &element, &Weights::new([0.25, 0.75])?);
/// assert_eq!(found.path, [3.0, 2.0, 1.5, 1.25].map(|y| Vector([0.0, y])));
/// // A value and a gradient in dual numbers for each step, and the first value.
/// assert_eq!((found.value, found.evaluations), (0.25, 10));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct NaiveDescent {
    /// The memoir's α, its "learning rate"; 0.1, as in its program.
    pub alpha: f64,
    /// The memoir's µ [m]; a tenth of the longest edge if `None`. Its program has 100 pixels in
    /// a window of 1920.
    pub mu: Option<f64>,
    /// Steps at most; 64, as in the memoir.
    pub steps: u32,
    /// How gradients are found. `None` is the memoir's [`GradientMethod::Dichotomy`] in the plane,
    /// and [`GradientMethod::Differences`] in space, where there is no dichotomy. Offsets are
    /// [`GradientSampler::OFFSET_SHARE`] of the longest edge.
    pub gradient: Option<GradientMethod>,
}

impl Default for NaiveDescent {
    fn default() -> Self {
        Self { alpha: 0.1, mu: None, steps: 64, gradient: None }
    }
}

impl NaiveDescent {
    /// How many evaluations the memoir counts for a gradient: "une dizaine". Its dichotomy takes
    /// 12.
    pub const MEMOIR_EVALUATIONS: u32 = 10;

    /// The default µ, as a share of the longest edge.
    const MU_SHARE: f64 = 0.1;

    /// The same method with another α. One that is not positive and finite takes no step.
    #[must_use]
    pub const fn with_alpha(self, alpha: f64) -> Self {
        Self { alpha, ..self }
    }

    /// The same method with another µ [m].
    #[must_use]
    pub const fn with_mu(self, mu: f64) -> Self {
        Self { mu: Some(mu), ..self }
    }

    /// The same method with another number of steps at most.
    #[must_use]
    pub const fn with_steps(self, steps: u32) -> Self {
        Self { steps, ..self }
    }

    /// The same method with gradients found in another way. Where one finds no direction, the
    /// descent ends.
    #[must_use]
    pub const fn with_gradient(self, gradient: GradientMethod) -> Self {
        Self { gradient: Some(gradient), ..self }
    }

    /// The µ for an element [m].
    #[must_use]
    pub fn mu_for<const N: usize, const D: usize>(&self, element: &Element<N, D>) -> f64 {
        self.mu.unwrap_or_else(|| Self::MU_SHARE * element.longest_edge())
    }

    /// How gradients are found in `D` dimensions.
    #[must_use]
    pub fn gradient_in<const D: usize>(&self) -> GradientMethod {
        let usual =
            if D == 2 { GradientMethod::Dichotomy } else { GradientMethod::Differences };
        self.gradient.unwrap_or(usual)
    }

    /// The search from a point of the element, or from its centroid.
    pub(crate) fn search<const N: usize, const D: usize>(
        &self,
        shape: &Shape<D>,
        element: &Element<N, D>,
        start: Option<&Weights<N>>,
    ) -> Descent<D> {
        let start = start.copied().unwrap_or_else(Weights::centroid);
        let descent = Descent::from_weights(shape, element, &start);
        let offset = GradientSampler::OFFSET_SHARE * element.longest_edge();
        // An element without extent is its point.
        let Ok(sampler) = GradientSampler::new(offset) else { return descent };
        let (mu, method) = (self.mu_for(element), self.gradient_in::<D>());
        let (mut p, mut value) = (descent.best, descent.value);
        descent.run(self.steps, |descent| {
            let step = self.alpha * value.max(mu);
            // Written so that NaN ends the descent; zero is for ever.
            if !(step > 0.0 && step <= LARGEST_LENGTH) {
                return Step::None;
            }
            let found = sampler.find(method, shape, p);
            descent.evaluations += found.evaluations;
            let Some(upwards) = found.direction else { return Step::None };
            p = nearest(element, p - upwards * step);
            value = shape.distance(p);
            descent.evaluations += 1;
            descent.visit(p, value);
            Step::Next
        })
    }
}

element_search!(NaiveDescent, ", from its centroid");

/// The last steps of a path that are looked at.
const LAST: usize = 8;

/// Steps do not shrink if the longest of the later half has at least this share of the longest of
/// the earlier half: a path that converges to and fro by less than 3 % a step counts as
/// oscillating.
const KEPT: f64 = 0.9;

/// Steps below so many roundings of the coordinates are rounding.
const ROUNDINGS: f64 = 64.0 * f64::EPSILON;

impl<const D: usize> Descent<D> {
    /// The peak-to-peak amplitude of the oscillation that the path ends in [m]; `None` if it ends in
    /// none.
    ///
    /// A path oscillates if of its last 8 steps at least every other one turns back, by more than
    /// a right angle, and the longest of the later four has at least 0.9 of the length of the
    /// longest of the earlier four. The amplitude is the longest of the 8.
    ///
    /// Above the centre of a disc, steps of a constant length go to and fro across its deepest
    /// point:
    ///
    /// ```
    /// use palpate_field::{Shape, Vector};
    /// use palpate_local::NaiveDescent;
    /// use palpate_query::Element;
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let disc = Shape::<2>::ball(1.0)?;
    /// let segment = Element::new([Vector([-3.0, 0.0]), Vector([3.5, 0.0])])?;
    /// let found = NaiveDescent::default().with_alpha(0.5).with_mu(0.5).descend(&disc, &segment);
    /// let amplitude = found.oscillation().ok_or("it converges")?;
    /// assert!((amplitude - 0.25).abs() < 1e-9); // α·µ
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn oscillation(&self) -> Option<f64> {
        let last = &self.path[self.path.len().checked_sub(LAST + 1)?..];
        let steps: Vec<_> = last.windows(2).map(|ends| ends[1] - ends[0]).collect();
        let turns = steps.windows(2).filter(|pair| pair[0].dot(pair[1]) < 0.0).count();
        let (earlier, later) = steps.split_at(LAST / 2);
        let [earlier, later] = [earlier, later].map(longest);
        let size = last.iter().fold(0.0_f64, |m, p| m.max(p.norm()));
        let is_kept = later >= KEPT * earlier && later > ROUNDINGS * size;
        (is_kept && 2 * turns >= steps.len() - 1).then_some(earlier.max(later))
    }
}

/// The length of the longest step [m].
fn longest<const D: usize>(steps: &[Vector<f64, D>]) -> f64 {
    steps.iter().map(|step| step.norm()).fold(0.0, f64::max)
}
