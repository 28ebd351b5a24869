// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Poses at which separations are known (`testdata/recall`): nothing is missed, nothing is
//! found where nothing is, and separations are within their bounds.

use std::num::NonZero;
use std::thread;

use palpate_field::field::{EvaluateBlock, Field};
use palpate_field::scalar::Model;
use palpate_field::{BLOCK, ShapeError};
use palpate_query::{Certified, Limits, Nearest, PairWorkspace, Stop, overlap, separation};
use palpate_testkit::kernels::Space;
use palpate_testkit::recall::{GAPS, Pair, Row, Turned, in_space, in_the_plane, rows};

/// Of so many searches, one may spend its budget.
const SEARCHES_A_FAILURE: usize = 1000;

/// Of so many rows, the truth of one is proven anew.
const ROWS_A_PROOF: usize = 100;

/// What is wrong with answers, and how many searches spent their budget.
#[derive(Default)]
struct Report {
    searches: usize,
    spent: Vec<String>,
    wrong: Vec<String>,
}

impl Report {
    fn add(&mut self, other: Self) {
        self.searches += other.searches;
        self.spent.extend(other.spent);
        self.wrong.extend(other.wrong);
    }
}

/// What `ask` reports of each row, on all cores.
fn on_rows<const D: usize>(
    pairs: &[Pair<D>],
    rows: &[Row<D>],
    ask: impl Fn(&Pair<D>, &Row<D>, &mut PairWorkspace<D>) -> Result<Report, ShapeError> + Sync,
) -> Report
where
    Space: Turned<D>,
{
    let threads = thread::available_parallelism().map_or(1, NonZero::get);
    let of_thread = |first: usize| {
        let (mut report, mut workspace) = (Report::default(), PairWorkspace::new());
        for row in rows.iter().skip(first).step_by(threads) {
            let pair = pairs.iter().find(|pair| pair.name == row.pair);
            match pair.map(|pair| ask(pair, row, &mut workspace)) {
                Some(Ok(of_row)) => report.add(of_row),
                other => report.wrong.push(format!("{row}: {:?}", other.map(Result::err))),
            }
        }
        report
    };
    let mut whole = Report::default();
    thread::scope(|scope| {
        let of_thread = &of_thread;
        let threads: Vec<_> =
            (0..threads).map(|first| scope.spawn(move || of_thread(first))).collect();
        for thread in threads {
            whole.add(thread.join().unwrap());
        }
    });
    whole
}

/// Both answers for a row.
fn answers<const D: usize>(
    pair: &Pair<D>,
    row: &Row<D>,
    workspace: &mut PairWorkspace<D>,
) -> Result<Report, ShapeError>
where
    Space: Turned<D>,
    dyn Field<D>: EvaluateBlock<f64, D, BLOCK> + EvaluateBlock<Model, D, BLOCK>,
{
    let limits = Limits::default();
    let [a, b] = row.bodies(pair)?;
    let mut report = Report::default();
    let mut judge = |what: &str, answer: &Certified<Nearest<D>>, is_hit: Option<bool>| {
        report.searches += 1;
        let complaint = format!("{what} of {row}: {answer:?}");
        if answer.stop == Stop::BudgetSpent {
            report.spent.push(complaint.clone());
        }
        let is_within = answer.lower <= row.truth.upper && row.truth.lower <= answer.upper;
        let has_sign = answer.stop == Stop::BudgetSpent || is_hit == answer.is_hit();
        let is_narrow =
            answer.stop != Stop::Converged || answer.upper - answer.lower <= limits.tolerance;
        if !(is_within && has_sign && is_narrow) {
            report.wrong.push(complaint);
        }
    };
    let is_hit = Some(row.truth.upper < 0.0);
    match (overlap(&a, &b, &limits, workspace), separation(&a, &b, &limits, workspace)) {
        (Ok(sign), Ok(whole)) => {
            // All gaps are larger than the tolerance: both must know the sign.
            judge("overlap", &sign, is_hit);
            judge("separation", &whole, is_hit);
        }
        refused => report.wrong.push(format!("{row}: {refused:?}")),
    }
    Ok(report)
}

fn replay<const D: usize>(pairs: &[Pair<D>]) -> Report
where
    Space: Turned<D>,
    dyn Field<D>: EvaluateBlock<f64, D, BLOCK> + EvaluateBlock<Model, D, BLOCK>,
{
    let rows = rows::<D>().unwrap();
    let expected: usize = pairs.iter().map(|pair| pair.rows).sum();
    assert!(rows.len() * 100 >= expected * 99, "{} of {expected} rows", rows.len());
    for row in &rows {
        let size = row.truth.lower.abs().min(row.truth.upper.abs());
        assert!(row.truth.has_sign() && (GAPS[0]..=GAPS[1]).contains(&size), "{row}");
    }
    on_rows(pairs, &rows, answers)
}

fn assert_all_right(report: &Report) {
    let Report { searches, spent, wrong } = report;
    let lines = |what: &[String]| what.iter().take(20).map(|line| format!("\n{line}")).collect::<String>();
    assert!(wrong.is_empty(), "{} of {searches} are wrong{}", wrong.len(), lines(wrong));
    let allowed = searches / SEARCHES_A_FAILURE;
    assert!(spent.len() <= allowed, "{} of {searches} are spent{}", spent.len(), lines(spent));
}

#[test]
fn no_contact_in_space_is_missed_and_none_is_false() -> Result<(), ShapeError> {
    assert_all_right(&replay(&in_space()?));
    Ok(())
}

#[test]
fn no_contact_in_the_plane_is_missed_and_none_is_false() -> Result<(), ShapeError> {
    assert_all_right(&replay(&in_the_plane()?));
    Ok(())
}

/// Proves one row of many anew, by the same plain search.
fn proven_anew<const D: usize>(pairs: &[Pair<D>]) -> Report
where
    Space: Turned<D>,
{
    // A step that is prime to the number of threads.
    let some: Vec<Row<D>> = rows().unwrap().into_iter().step_by(ROWS_A_PROOF + 1).collect();
    on_rows(pairs, &some, |pair, row, _| {
        let again = row.prove(pair)?;
        let is_within = row.truth.lower <= again.upper && again.lower <= row.truth.upper;
        let mut report = Report { searches: 1, ..Report::default() };
        if !(is_within && again.has_sign()) {
            report.wrong.push(format!("{row} is {again:?} now; see `cargo xtask oracle`"));
        }
        Ok(report)
    })
}

#[test]
fn what_is_known_of_poses_is_found_again() -> Result<(), ShapeError> {
    let mut report = proven_anew(&in_space()?);
    report.add(proven_anew(&in_the_plane()?));
    assert!(report.searches >= 120);
    assert_all_right(&report);
    Ok(())
}
