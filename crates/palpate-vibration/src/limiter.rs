// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A peak limiter with look-ahead.

#![deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)]

/// How far the limiter looks ahead [s]: the gain falls over this time, which is as long as the
/// attack of a tone, so that the fall is not heard as a click.
const LOOK_AHEAD: f64 = 0.002;

/// The time constant with which the gain comes back [s]: longer than a turn of the lowest frequency
/// that is played, so that the gain does not follow the wave.
const RELEASE: f64 = 0.1;

/// The gain from which on it is 1 again: nobody feels the 0.01 dB that are left.
const RELEASED: f64 = 0.999;

/// What a limiter did.
///
/// ```
/// use palpate_vibration::Limiting;
///
/// let half = Limiting { ticks: 12, least_gain: 0.5 };
/// assert!((half.largest_reduction_db() - 6.02).abs() < 0.001);
/// assert_eq!(Limiting::default().largest_reduction_db(), 0.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limiting {
    /// The ticks in which a sample was made smaller.
    pub ticks: u64,
    /// The least gain, in (0, 1].
    pub least_gain: f64,
}

impl Default for Limiting {
    fn default() -> Self {
        Self { ticks: 0, least_gain: 1.0 }
    }
}

impl Limiting {
    /// The largest reduction of a sample [dB].
    #[must_use]
    pub fn largest_reduction_db(&self) -> f64 {
        // Written so that a gain of 1 gives zero, not its negative.
        20.0 * libm::log10(1.0 / self.least_gain)
    }

    /// Both together, of two actuators or runs.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            ticks: self.ticks + other.ticks,
            least_gain: self.least_gain.min(other.least_gain),
        }
    }

    /// Counts a tick whose least gain this was.
    pub(crate) fn count(&mut self, least_gain: f64) {
        self.ticks += u64::from(least_gain < 1.0);
        self.least_gain = self.least_gain.min(least_gain);
    }
}

/// The last so many numbers.
#[derive(Clone, Debug)]
struct Window {
    numbers: Vec<f64>,
    next: usize,
}

impl Window {
    fn new(length: usize, number: f64) -> Self {
        Self { numbers: vec![number; length], next: 0 }
    }

    /// Takes in `number`, and gives back the oldest.
    fn push(&mut self, number: f64) -> f64 {
        let Some(place) = self.numbers.get_mut(self.next) else { return number };
        let oldest = std::mem::replace(place, number);
        self.next = (self.next + 1) % self.numbers.len();
        oldest
    }

    fn least(&self) -> f64 {
        self.numbers.iter().copied().fold(f64::INFINITY, f64::min)
    }

    fn mean(&self) -> f64 {
        self.numbers.iter().sum::<f64>() / self.numbers.len() as f64
    }
}

/// Keeps samples within ±1 by a gain that changes slowly.
///
/// A sample x needs a gain of at most `1 / |x|`. The needed gain comes back with a time constant of
/// 100 ms; its minimum over the look-ahead of L samples, averaged over L samples, is the gain of
/// the sample that lies L samples back. Every number in that average is at most what this sample
/// needs, so no sample exceeds 1, and the gain changes by at most `1 / (L + 1)` from one sample to
/// the next.
#[derive(Clone, Debug)]
pub(crate) struct Limiter {
    delayed: Window,
    needed: Window,
    gains: Window,
    /// The needed gain, which comes back slowly.
    released: f64,
    /// What is left of a difference of the needed gain after a sample.
    left: f64,
}

impl Limiter {
    pub(crate) fn new(sample_rate: f64) -> Self {
        let ahead = delay(sample_rate);
        Self {
            delayed: Window::new(ahead, 0.0),
            needed: Window::new(ahead + 1, 1.0),
            gains: Window::new(ahead + 1, 1.0),
            released: 1.0,
            left: libm::exp(-1.0 / (RELEASE * sample_rate)),
        }
    }

    /// The sample that came in `delay` samples ago, made smaller, and the gain by which it was.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn step(&mut self, sample: f64) -> (f64, f64) {
        // Written so that NaN becomes silence.
        let sample = if sample.abs() <= f64::MAX { sample } else { 0.0 };
        let back = 1.0 + (self.released - 1.0) * self.left;
        let back = if back > RELEASED { 1.0 } else { back };
        self.released = back.min(1.0 / sample.abs().max(1.0));
        self.needed.push(self.released);
        self.gains.push(self.needed.least());
        // Rounding of the mean must not lift a gain above what is needed.
        let gain = self.gains.mean();
        let delayed = self.delayed.push(sample);
        // Silence is not made smaller.
        let acted = if delayed == 0.0 { 1.0 } else { gain };
        ((delayed * gain).clamp(-1.0, 1.0), acted)
    }
}

/// The samples by which a limiter at `sample_rate` [Hz] delays.
pub(crate) fn delay(sample_rate: f64) -> usize {
    libm::ceil(LOOK_AHEAD * sample_rate).max(1.0) as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate_testkit::cases::each as cases;

    #[test]
    fn what_is_small_passes_unchanged_and_delayed() {
        let mut limiter = Limiter::new(8000.0);
        assert_eq!(delay(8000.0), 16);
        let out: Vec<_> = (0..100).map(|i| limiter.step(f64::from(i) * 0.01)).collect();
        for (i, (sample, gain)) in out.into_iter().enumerate() {
            assert!((sample - (i as f64 - 16.0).max(0.0) * 0.01).abs() < 1e-15);
            assert!((gain - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn nothing_exceeds_one_and_the_gain_never_jumps() {
        cases(100, |u| {
            let mut limiter = Limiter::new(8000.0);
            let mut last = 1.0;
            for _ in 0..500 {
                let sample = u.int_in_range(-300..=300).map(|i: i32| f64::from(i) * 0.01)?;
                let mut copy = limiter.clone();
                let (limited, _) = limiter.step(sample);
                // The bound holds before the clamp, which is for rounding alone.
                let gain = limiter.gains.mean();
                let unclamped = copy.delayed.push(0.0) * gain;
                assert!(unclamped.abs() <= 1.0 + 1e-15 && limited.abs() <= 1.0);
                assert!((gain - last).abs() <= 1.0 / 17.0 + 1e-15);
                last = gain;
            }
            Ok(())
        });
    }

    #[test]
    fn a_sine_of_amplitude_three_becomes_one_of_amplitude_one() {
        let mut limiter = Limiter::new(8000.0);
        let sine = |i: usize| (std::f64::consts::TAU * 200.0 * i as f64 / 8000.0).sin();
        let out: Vec<_> = (0..8000).map(|i| limiter.step(3.0 * sine(i)).0).collect();
        // Between two crests, 2.5 ms apart, the gain comes back by up to 1 − exp(−1/40) of 2/3: a
        // sine is kept to 2 %.
        for (i, sample) in out.iter().enumerate().skip(4000) {
            let expected = sine(i - 16);
            assert!((sample - expected).abs() < 0.02, "{i}: {sample} {expected}");
        }
    }

    #[test]
    fn numbers_that_are_none_are_silent() {
        let mut limiter = Limiter::new(8000.0);
        for sample in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            limiter.step(sample);
        }
        assert!((0..50).all(|_| limiter.step(0.0) == (0.0, 1.0)));
    }
}
