// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The exact motion of a mass on a spring and a damper under a force that is linear in time.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

/// Terms of the power series. The last is below `1 / 21! < 2e-20` of the first where
/// [`Oscillator::longest`] is kept, so the series is the function up to rounding.
const TERMS: u32 = 22;

/// `z'' + σ z' + ω² z = a + j t`, from `z(0) = 0` and `z'(0) = v`.
///
/// With the impulse response `S`, `S'' + σ S' + ω² S = 0`, `S(0) = 0`, `S'(0) = 1`, its
/// integral `P = ∫ S` (step response) and `Q = ∫ P` (ramp response), the solution is
///
/// ```text
/// z  = v S  + a P + j Q
/// z' = v S' + a S + j P
/// ```
///
/// `S` is `e^(−σt/2) sin(νt)/ν`, `t e^(−σt/2)` or `e^(−σt/2) sinh(νt)/ν` with `ν² = |ω² −
/// σ²/4|`, and `Q` divides by `ω²` twice: near critical damping and without a spring these
/// forms cancel completely. Their common power series does not, and needs no cases:
///
/// ```text
/// S = Σ sₙ tⁿ,   s₀ = 0,   s₁ = 1,   sₙ₊₂ = −(σ sₙ₊₁ + ω² sₙ / (n + 1)) / (n + 2)
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Oscillator {
    /// σ, damping per mass [1/s].
    pub(crate) decay: f64,
    /// ω², stiffness per mass [1/s²].
    pub(crate) spring: f64,
}

/// The responses at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Response {
    /// `S'`.
    slope: f64,
    /// `S` [s].
    blow: f64,
    /// `P` [s²].
    step: f64,
    /// `Q` [s³].
    ramp: f64,
}

/// Initial velocity, and force per mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Drive {
    /// `v`, the velocity at the start [m/s].
    pub(crate) velocity: f64,
    /// `a`, force per mass at the start [m/s²].
    pub(crate) push: f64,
    /// `j`, the rate of change of force per mass [m/s³].
    pub(crate) growth: f64,
}

impl Oscillator {
    /// `σ + ω`, a bound on the rates of the motion [1/s].
    pub(crate) fn fastest(&self) -> f64 {
        self.decay + self.spring.sqrt()
    }

    /// The longest time for which [`response`](Self::response) is exact [s].
    ///
    /// Within this time the acceleration is zero at most once (its zeros are half a period
    /// apart), and quadrature with [`Nodes`] is exact too.
    pub(crate) fn longest(&self) -> f64 {
        1.0 / self.fastest()
    }

    /// The responses after `time` [s].
    ///
    /// Real-time: a fixed number of operations, no system mathematics.
    #[inline(never)]
    pub(crate) fn response(&self, time: f64) -> Response {
        let (decay, spring) = (self.decay * time, self.spring * time * time);
        // The terms sₙ tⁿ⁻¹ and sₙ₊₁ tⁿ.
        let (mut term, mut next) = (0.0, 1.0);
        let (mut slope, mut blow, mut step, mut ramp) = (0.0, 0.0, 0.0, 0.0);
        for n in 0..TERMS {
            let n = f64::from(n);
            slope += n * term;
            blow += term;
            step += term / (n + 1.0);
            ramp += term / ((n + 1.0) * (n + 2.0));
            let after = -(decay * next + spring * term / (n + 1.0)) / (n + 2.0);
            (term, next) = (next, after);
        }
        Response {
            slope,
            blow: blow * time,
            step: step * time * time,
            ramp: ramp * time * time * time,
        }
    }
}

impl Response {
    /// The displacement of the mass [m].
    pub(crate) fn way(&self, drive: &Drive) -> f64 {
        drive.velocity * self.blow + drive.push * self.step + drive.growth * self.ramp
    }

    /// The velocity of the mass [m/s].
    pub(crate) fn velocity(&self, drive: &Drive) -> f64 {
        drive.velocity * self.slope + drive.push * self.blow + drive.growth * self.step
    }
}

/// Abscissae in (0, 1) and weights of the quadrature of Gauss and Legendre with 8 nodes, exact
/// for polynomials of degree 15 (Abramowitz and Stegun 1964, table 25.4).
const GAUSS: [(f64, f64); 8] = [
    (0.019_855_071_751_231_884, 0.050_614_268_145_188_13),
    (0.101_666_761_293_186_63, 0.111_190_517_226_687_24),
    (0.237_233_795_041_835_5, 0.156_853_322_938_943_64),
    (0.408_282_678_752_175_1, 0.181_341_891_689_181),
    (0.591_717_321_247_825, 0.181_341_891_689_181),
    (0.762_766_204_958_164_5, 0.156_853_322_938_943_64),
    (0.898_333_238_706_813_4, 0.111_190_517_226_687_24),
    (0.980_144_928_248_768_1, 0.050_614_268_145_188_13),
];

/// The responses at quadrature nodes during a time, and at its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Nodes {
    /// The time [s].
    pub(crate) length: f64,
    /// The responses at the end.
    pub(crate) end: Response,
    /// Time, weight [s] and responses of each node.
    within: [(f64, f64, Response); 8],
}

impl Nodes {
    pub(crate) fn new(oscillator: &Oscillator, length: f64) -> Self {
        let within = GAUSS.map(|(part, weight)| {
            (part * length, weight * length, oscillator.response(part * length))
        });
        Self { length, end: oscillator.response(length), within }
    }

    /// The integral of `of(time, response)` over the time.
    pub(crate) fn integral<const N: usize>(
        &self,
        of: impl Fn(f64, &Response) -> [f64; N],
    ) -> [f64; N] {
        let mut sums = [0.0; N];
        for (time, weight, response) in &self.within {
            for (sum, value) in sums.iter_mut().zip(of(*time, response)) {
                *sum += weight * value;
            }
        }
        sums
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The closed forms of `S'`, `S`, `P`, where they do not cancel.
    fn closed(oscillator: &Oscillator, t: f64) -> [f64; 3] {
        let (sigma, spring) = (oscillator.decay, oscillator.spring);
        let half = 0.5 * sigma;
        let square = spring - half * half;
        let nu = square.abs().sqrt();
        let decay = (-half * t).exp();
        let (blow, slope) = if square > 0.0 {
            let blow = decay * (nu * t).sin() / nu;
            (blow, decay * (nu * t).cos() - half * blow)
        } else if square < 0.0 {
            let blow = decay * (nu * t).sinh() / nu;
            (blow, decay * (nu * t).cosh() - half * blow)
        } else {
            (decay * t, decay * (1.0 - half * t))
        };
        let step = if spring > 0.0 {
            (1.0 - slope - sigma * blow) / spring
        } else {
            (t - blow) / sigma
        };
        [slope, blow, step]
    }

    #[test]
    fn the_series_is_the_closed_form_in_every_regime() {
        for (decay, spring) in [(0.3, 4.0), (4.0, 4.0), (7.0, 4.0), (5.0, 0.0), (0.0, 9.0)] {
            let oscillator = Oscillator { decay, spring };
            for i in 1..=10 {
                let t = 0.1 * f64::from(i) * oscillator.longest();
                let response = oscillator.response(t);
                let [slope, blow, step] = closed(&oscillator, t);
                assert!((response.slope - slope).abs() < 1e-14, "{oscillator:?} {t}");
                assert!((response.blow - blow).abs() < 1e-14 * t, "{oscillator:?} {t}");
                // The closed form of P cancels: its error is a rounding of 1, divided by ω² or
                // σ.
                assert!((response.step - step).abs() < 1e-15, "{oscillator:?} {t}");
            }
        }
    }

    #[test]
    fn the_equation_holds() {
        // S'' = −σ S' − ω² S integrates to 1 = S' + σ S + ω² P and t = S + σ P + ω² Q.
        for (decay, spring) in [(0.0, 0.0), (11.0, 0.0), (20.0, 100.0), (1e3, 1e-9), (3.0, 1e6)]
        {
            let oscillator = Oscillator { decay, spring };
            let t = oscillator.longest().min(1.0);
            let Response { slope, blow, step, ramp } = oscillator.response(t);
            assert!((slope + decay * blow + spring * step - 1.0).abs() < 4e-16);
            assert!(((blow + decay * step + spring * ramp) / t - 1.0).abs() < 4e-16);
        }
    }

    #[test]
    fn without_spring_and_damper_it_is_the_fall() {
        let response = Oscillator { decay: 0.0, spring: 0.0 }.response(0.5);
        assert_eq!(
            response,
            Response { slope: 1.0, blow: 0.5, step: 0.125, ramp: 0.125 / 6.0 }
        );
    }

    #[test]
    fn the_quadrature_integrates_what_it_should() {
        let oscillator = Oscillator { decay: 4.0, spring: 9.0 };
        let nodes = Nodes::new(&oscillator, oscillator.longest());
        let drive = Drive { velocity: 1.0, push: -2.0, growth: 3.0 };
        // The integral of the velocity is the displacement; that of z z' is half its square.
        let [way, half_square] = nodes.integral(|_, response| {
            let velocity = response.velocity(&drive);
            [velocity, velocity * response.way(&drive)]
        });
        let exact = nodes.end.way(&drive);
        assert!((way / exact - 1.0).abs() < 1e-14);
        assert!((half_square / (0.5 * exact * exact) - 1.0).abs() < 1e-14);
        let [fifteenth] = nodes.integral(|time, _| [time.powi(15)]);
        assert!((fifteenth / (nodes.length.powi(16) / 16.0) - 1.0).abs() < 1e-14);
    }
}
