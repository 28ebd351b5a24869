// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Rows and the table of both programs' answers.

use super::exchange::Found;
use super::ours::Ours;
use super::poses::{KNOWN, Known};
use super::samples::Comparison;
use crate::fields::Rows;
use crate::rounds::median;

/// A pair at a depth.
#[derive(Debug, PartialEq)]
pub(super) struct Case {
    /// The pair and the depth, as keys begin.
    pub(super) key: String,
    pub(super) poses: usize,
    /// Poses that were replaced since their depth did not get known.
    pub(super) replaced: u32,
    /// Poses whose overlap MuJoCo's own fields confirm at the witness.
    pub(super) confirmed: usize,
    /// What MuJoCo's own fields say of the depth at the witness: errors as of a summary.
    pub(super) at_witness: [f64; 2],
    pub(super) theirs: Summary,
    pub(super) ours: Summary,
    /// What it takes us to prove the overlap alone, median [ns].
    pub(super) overlap_ns: f64,
}

/// The answers of one program.
#[derive(Debug, PartialEq)]
pub(super) struct Summary {
    pub(super) missed: usize,
    /// Errors of the depths that were found, as shares of it: median and largest.
    pub(super) errors: [f64; 2],
    /// Median [ns].
    pub(super) ns: f64,
}

impl Summary {
    fn new(missed: usize, errors: Vec<f64>, times: &[f64]) -> Self {
        Self { missed, errors: middle_and_worst(errors), ns: median(times.to_vec()) }
    }
}

/// The median and the largest of errors; not numbers if there are none.
fn middle_and_worst(errors: Vec<f64>) -> [f64; 2] {
    let worst = errors.iter().copied().fold(f64::NAN, f64::max);
    [median(errors), worst]
}

impl Case {
    pub(super) fn new(key: String, known: &[Known], theirs: &Found, ours: Ours) -> Self {
        // At a point, the larger value of two distances is half the separation of the bodies if
        // the point is the best; it is what MuJoCo puts into `contact.dist`.
        let error = |known: &Known, distance: f64| (-2.0 * distance / known.depth - 1.0).abs();
        let found = known.iter().zip(&theirs.distances);
        let errors: Vec<_> =
            found.filter_map(|(known, distance)| Some(error(known, (*distance)?))).collect();
        let at_witness = known.iter().zip(&theirs.at_witnesses);
        let at_witness = at_witness.map(|(known, value)| error(known, *value)).collect();
        let missed = known.len() - errors.len();
        let confirmed = theirs.at_witnesses.iter().filter(|value| **value < 0.0).count();
        Self {
            key,
            poses: known.len(),
            replaced: known.iter().map(|known| known.replaced).sum(),
            confirmed,
            at_witness: middle_and_worst(at_witness),
            theirs: Summary::new(missed, errors, &theirs.times),
            ours: Summary::new(ours.missed, ours.errors, &ours.separation_times),
            overlap_ns: median(ours.overlap_times),
        }
    }

    /// Adds the rows of the case.
    pub(super) fn add_to(&self, rows: &mut Rows) {
        let mut add = |stat: &str, number: f64| {
            rows.insert(format!("{}.{stat}", self.key), number);
        };
        add("poses", self.poses as f64);
        add("replaced", f64::from(self.replaced));
        add("confirmed", self.confirmed as f64);
        add("error.mujoco_at_witness.p50", self.at_witness[0]);
        add("error.mujoco_at_witness.max", self.at_witness[1]);
        add("overlap.ours.p50_ns", self.overlap_ns);
        for (program, summary) in [("mujoco", &self.theirs), ("ours", &self.ours)] {
            add(&format!("missed.{program}"), summary.missed as f64);
            add(&format!("error.{program}.p50"), summary.errors[0]);
            add(&format!("error.{program}.max"), summary.errors[1]);
            add(&format!("depth.{program}.p50_ns"), summary.ns);
        }
    }
}

/// Prints all cases as a table.
pub(super) fn print(cases: &[Case]) {
    let columns = [
        "pair and depth",
        "poses",
        "replaced",
        "confirmed",
        "MuJoCo: missed",
        "error: median, worst",
        "µs",
        "ours: missed",
        "error: median, worst",
        "overlap µs",
        "depth µs",
    ];
    println!("| {} |\n|{}", columns.join(" | "), "---|".repeat(columns.len()));
    for Case { key, poses, replaced, confirmed, theirs, ours, overlap_ns, .. } in cases {
        let errors = |summary: &Summary| {
            let [half, worst] = summary.errors.map(percent);
            format!("{half}, {worst}")
        };
        println!(
            "| `{key}` | {poses} | {replaced} | {confirmed} | {} | {} | {} | {} | {} | {} | {} |",
            theirs.missed,
            errors(theirs),
            micros(theirs.ns),
            ours.missed,
            errors(ours),
            micros(*overlap_ns),
            micros(ours.ns),
        );
    }
    println!("Errors are shares of the depth, which is known to {}.", percent(KNOWN));
}

/// Says of a plugin whether its field is that of our body, and how steep it is.
pub(super) fn describe(plugin: &str, size: f64, compared: &Comparison) -> String {
    let [least, half, most] = compared.steepness.map(|steepness| digits(steepness, ""));
    format!(
        "{plugin} of {:.0} mm: {} of its signs differ from ours; its gradient is {least} to {most} \
         long, {half} in the median, that of a distance 1",
        size * 1e3,
        percent(compared.disagree)
    )
}

/// A share with two digits.
fn percent(share: f64) -> String {
    digits(100.0 * share, " %")
}

fn micros(ns: f64) -> String {
    digits(ns / 1e3, "")
}

/// A number with two digits or more, all of those before the point.
fn digits(number: f64, unit: &str) -> String {
    if number.is_nan() {
        return "–".into();
    }
    // The decimal place of the first digit, after it is rounded.
    let rounded = format!("{number:.1e}");
    let place = rounded.split_once('e').and_then(|(_, place)| place.parse().ok()).unwrap_or(0);
    let places = usize::try_from(1 - place).unwrap_or(0);
    format!("{number:.places$}{unit}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use palpate::field::{Pose, Vector};

    fn known(depth: f64) -> Known {
        Known { pose: Pose::identity(), witness: Vector([0.0; 3]), depth, replaced: 1 }
    }

    fn case() -> Case {
        let theirs = Found {
            times: vec![4000.0, 2000.0, 3000.0],
            distances: vec![Some(-0.00045), None, Some(-0.0004)],
            at_witnesses: vec![-0.0005, -0.0005, 1e-6],
        };
        let ours = Ours {
            missed: 0,
            errors: vec![0.001, 0.002, 0.003],
            overlap_times: vec![10.0, 20.0, 30.0],
            separation_times: vec![100.0, 200.0, 300.0],
        };
        Case::new("pair.1mm".into(), &[known(0.001); 3], &theirs, ours)
    }

    #[test]
    fn a_pose_without_a_contact_is_missed() {
        let case = case();
        assert_eq!((case.poses, case.replaced, case.confirmed), (3, 3, 2));
        assert_eq!((case.theirs.missed, case.ours.missed), (1, 0));
        assert_eq!(case.theirs.ns, 3000.0);
    }

    #[test]
    fn a_contact_has_half_the_depth() {
        let [half, worst] = case().theirs.errors;
        assert!((worst - 0.2).abs() < 1e-12 && half > 0.0999, "{half} {worst}");
    }

    #[test]
    fn values_at_the_witness_are_judged_too() {
        let [half, worst] = case().at_witness;
        assert!(half.abs() < 1e-12 && (worst - 1.002).abs() < 1e-12, "{half} {worst}");
    }

    #[test]
    fn a_row_names_its_program() {
        let mut rows = Rows::new();
        case().add_to(&mut rows);
        assert_eq!(rows["pair.1mm.missed.mujoco"], 1.0);
        assert_eq!(rows["pair.1mm.missed.ours"], 0.0);
        assert_eq!(rows["pair.1mm.depth.ours.p50_ns"], 200.0);
    }

    #[test]
    fn numbers_have_two_digits() {
        let shown = [0.5, 0.021, 0.000_999, 0.00012, 0.0, f64::NAN].map(percent);
        assert_eq!(shown, ["50 %", "2.1 %", "0.10 %", "0.012 %", "0.0 %", "–"]);
        assert_eq!(micros(107_730.0), "108");
    }
}
