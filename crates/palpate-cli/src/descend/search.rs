// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Which search over an element is asked for, and where it starts.

use palpate::field::{LARGEST_LENGTH, Shape};
use palpate::local::{Descent, ElementMethod, NaiveDescent, PairMethod, Weights};
use palpate::query::Element;

use super::method;
use crate::arguments::DescendOptions;
use crate::input;
use crate::outcome::Failure;

/// Most steps of the naive descent, whose path is kept.
const MOST_ITERATIONS: u32 = 100_000;

/// A search over an element.
#[derive(Debug)]
pub(super) struct Search<const N: usize> {
    pub(super) method: ElementMethod,
    /// The constants of [`ElementMethod::Naive`].
    pub(super) naive: NaiveDescent,
    /// Where it starts, if that is asked for.
    start: Option<Weights<N>>,
}

impl<const N: usize> Search<N> {
    pub(super) fn of<const D: usize>(options: &DescendOptions) -> Result<Self, Failure> {
        let needs = "searches between two bodies: leave out --triangle and --segment";
        let method = method::<_, PairMethod>(options, ElementMethod::ProjectedGradient, needs)?;
        if method != ElementMethod::Naive {
            refuse_naive(options)?;
        }
        Ok(Self { method, naive: naive::<D>(options)?, start: start(options)? })
    }

    pub(super) fn run<const D: usize>(
        &self,
        shape: &Shape<D>,
        element: &Element<N, D>,
    ) -> Descent<D> {
        match (self.method, &self.start) {
            (ElementMethod::Naive, None) => self.naive.descend(shape, element),
            (ElementMethod::Naive, Some(start)) => {
                self.naive.descend_from(shape, element, start)
            }
            (method, None) => method.descend(shape, element),
            (method, Some(start)) => method.descend_from(shape, element, start),
        }
    }

    /// The method in words, with its constants.
    pub(super) fn in_words<const D: usize>(&self, element: &Element<N, D>) -> String {
        if self.method != ElementMethod::Naive {
            return self.method.to_string();
        }
        let (alpha, mu) = (self.naive.alpha, self.naive.mu_for(element));
        let gradient = self.naive.gradient_in::<D>();
        format!("naive, alpha {alpha}, mu {mu} m, gradients by {gradient}")
    }
}

/// Refuses options of the naive descent for other searches.
pub(super) fn refuse_naive(options: &DescendOptions) -> Result<(), Failure> {
    let given = [
        ("--alpha", options.alpha.is_some()),
        ("--mu", options.mu.is_some()),
        ("--iterations", options.iterations.is_some()),
        ("--gradient", options.gradient.is_some()),
    ];
    match given.iter().find(|(_, is_given)| *is_given) {
        Some((name, _)) => Err(Failure::input(format!("{name} is only for --method naive"))),
        None => Ok(()),
    }
}

/// The naive descent with the constants that are asked for.
fn naive<const D: usize>(options: &DescendOptions) -> Result<NaiveDescent, Failure> {
    let mut naive = NaiveDescent::default();
    if let Some(alpha) = options.alpha {
        // Written so that NaN is refused.
        if !(alpha > 0.0 && alpha.is_finite()) {
            let problem = format!("--alpha must be positive and finite, got {alpha:?}");
            return Err(Failure::input(problem));
        }
        naive = naive.with_alpha(alpha);
    }
    if let Some(mu) = options.mu {
        if !(0.0..=LARGEST_LENGTH).contains(&mu) {
            let rule = format!("from 0 m to {LARGEST_LENGTH:e} m, got {mu:?} m");
            return Err(Failure::input(format!("--mu must be {rule}")));
        }
        naive = naive.with_mu(mu);
    }
    if let Some(iterations) = options.iterations {
        if iterations > MOST_ITERATIONS {
            let rule = format!("at most {MOST_ITERATIONS}, got {iterations}");
            return Err(Failure::input(format!("--iterations must be {rule}")));
        }
        naive = naive.with_steps(iterations);
    }
    match &options.gradient {
        Some(name) => Ok(naive.with_gradient(input::gradient::<D>(name)?)),
        None => Ok(naive),
    }
}

/// The weights of `--start`.
fn start<const N: usize>(options: &DescendOptions) -> Result<Option<Weights<N>>, Failure> {
    let [given] = options.start.as_slice() else {
        return match options.start.len() {
            0 => Ok(None),
            count => Err(Failure::input(format!(
                "a search over an element has one --start, got {count}"
            ))),
        };
    };
    let numbers = input::numbers(given).ok_or_else(|| {
        let (element, letters) =
            if N == 2 { ("segment", "u,v") } else { ("triangle", "u,v,w") };
        Failure::input(format!(
            "--start of a {element} is the barycentric weights {letters} of its corners, got {given:?}; \
             a point in metres starts a search between two bodies, without --triangle and --segment"
        ))
    })?;
    let weights = Weights::new(numbers);
    weights.map(Some).map_err(|error| Failure::input(format!("--start: {error}")))
}
