// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Distributions of durations and lateness.

use hdrhistogram::Histogram;

/// The longest time that is resolved [ns]: ten seconds. Longer times count as this.
const LONGEST_NS: u64 = 10_000_000_000;

/// Decimal digits of a quantile: more than a shared machine reproduces.
const DIGITS: u8 = 3;

/// A distribution of times.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Distribution {
    /// The number of measured times.
    pub count: u64,
    /// The mean [s].
    pub mean: f64,
    /// The median: half of the times are at most this [s].
    pub p50: f64,
    /// 99 % of the times are at most this [s].
    pub p99: f64,
    /// 99.9 % of the times are at most this [s].
    pub p999: f64,
    /// The largest time [s].
    pub max: f64,
    /// A histogram: times up to 1, 2, 4, 8 … µs, up to the longest.
    pub buckets: Vec<Bucket>,
}

/// A bar of a histogram: how many times lie above the bucket before and up to a bound.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Bucket {
    /// The largest time of the bucket [s].
    pub up_to: f64,
    /// The number of times in the bucket.
    pub count: u64,
}

fn seconds(ns: f64) -> f64 {
    ns / 1e9
}

/// Collects times in preallocated memory.
#[derive(Clone, Debug)]
pub(crate) struct Times(Histogram<u64>);

impl Times {
    pub(crate) fn new() -> Self {
        let histogram = Histogram::new_with_bounds(1, LONGEST_NS, DIGITS);
        Self(histogram.expect("the bounds are constants that the histogram accepts"))
    }

    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub(crate) fn record(&mut self, ns: u64) {
        self.0.saturating_record(ns);
    }

    /// The distribution of the collected times; `None` if there are none.
    pub(crate) fn distribution(&self) -> Option<Distribution> {
        let times = &self.0;
        if times.is_empty() {
            return None;
        }
        let mut buckets = Vec::new();
        let mut counted = 0;
        let mut up_to_ns = 1000;
        while counted < times.len() {
            let below = times.count_between(0, up_to_ns);
            buckets.push(Bucket {
                up_to: seconds(up_to_ns as f64),
                count: below.saturating_sub(counted),
            });
            counted = counted.max(below);
            up_to_ns *= 2;
        }
        let quantile = |part| seconds(times.value_at_quantile(part) as f64);
        Some(Distribution {
            count: times.len(),
            mean: seconds(times.mean()),
            p50: quantile(0.5),
            p99: quantile(0.99),
            p999: quantile(0.999),
            max: seconds(times.max() as f64),
            buckets,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_times() {
        let mut times = Times::new();
        assert_eq!(times.distribution(), None);
        (1..=1000).for_each(|ns| times.record(ns));
        let d = times.distribution().unwrap();
        assert_eq!((d.count, d.p50, d.p99, d.max), (1000, 500e-9, 990e-9, 1e-6));
        assert_eq!(d.buckets, [Bucket { up_to: 1e-6, count: 1000 }]);
    }

    #[test]
    fn every_time_is_in_one_bucket() {
        let mut times = Times::new();
        for ns in [0, 999, 1500, 3000, 1_000_000_000, u64::MAX] {
            times.record(ns);
        }
        let d = times.distribution().unwrap();
        assert_eq!(d.buckets.iter().map(|b| b.count).sum::<u64>(), 6);
        assert_eq!(d.buckets[0].count, 2);
        assert_eq!(d.buckets[1].count, 1);
    }
}
