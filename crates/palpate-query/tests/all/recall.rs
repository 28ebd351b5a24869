// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Poses at which separations are known (`testdata/recall`): nothing is missed, nothing is
//! found where nothing is, and separations are within their bounds.

use std::num::NonZero;
use std::thread;

use palpate_field::ShapeError;
use palpate_query::{
    Certified, Limits, Nearest, PairWorkspace, Placed, QueryError, Stop, overlap, separation,
};
use palpate_testkit::kernels::Space;
use palpate_testkit::recall::{GAPS, Pair, Row, Turned, in_space, in_the_plane, rows};

/// The share of searches that may spend the budget of default limits.
const SPENT: f64 = 0.001;

/// Of so many rows, the truth of one is proven anew.
const ROWS_A_PROOF: usize = 100;

const SEPARATION: &str = "separation";
const SIGN: &str = "overlap";
const BUILT: &str = "overlap of the built motion";

/// What was asked of rows, and what is wrong with the answers.
#[derive(Default)]
pub(crate) struct Report {
    pub(crate) rows: usize,
    pub(crate) wrong: Vec<String>,
    pub(crate) signs_spent: Vec<String>,
    pub(crate) separations_spent: Vec<String>,
}

impl Report {
    fn add(&mut self, other: Self) {
        self.rows += other.rows;
        self.wrong.extend(other.wrong);
        self.signs_spent.extend(other.signs_spent);
        self.separations_spent.extend(other.separations_spent);
    }
}

/// What `ask` reports of each row, on all cores.
pub(crate) fn on_rows<const D: usize>(
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
            whole.add(thread.join().expect("no panic"));
        }
    });
    whole
}

/// Asks for a row whether the bodies overlap, and for their separation.
fn answers<const D: usize>(
    pair: &Pair<D>,
    row: &Row<D>,
    workspace: &mut PairWorkspace<D>,
) -> Result<Report, ShapeError>
where
    Space: Turned<D>,
{
    let limits = Limits::new(1e-4);
    let [a, b] = &pair.bodies;
    let there = Placed::new(b, row.pose()?);
    let built = b.clone().placed(&row.pose()?)?;
    let mut report = Report { rows: 1, ..Report::default() };
    let mut ask = |what: &str, answer: Result<Certified<Nearest<D>>, QueryError>| {
        let complaint = format!("{what} of {row}: {answer:?}");
        let Ok(answer) = answer else { return report.wrong.push(complaint) };
        let is_spent = answer.stop.is_early();
        // The box of a built motion is larger, and so are some separations less.
        let is_less = what == BUILT;
        let is_right = answer.is_hit() == Some(row.truth.upper < 0.0);
        // All gaps are larger than the tolerance: the sign must be known.
        let has_sign = is_right || answer.is_hit().is_none() && (is_spent || is_less);
        let is_above = is_less || row.truth.lower <= answer.upper;
        let is_within = is_above && answer.lower <= row.truth.upper;
        let is_narrow =
            answer.stop != Stop::Converged || answer.upper - answer.lower <= limits.tolerance;
        if !(has_sign && is_within && is_narrow) {
            report.wrong.push(complaint);
        } else if is_spent && what == SEPARATION {
            report.separations_spent.push(complaint);
        } else if is_spent {
            report.signs_spent.push(complaint);
        }
    };
    ask(SEPARATION, separation(a, there, &limits, workspace));
    ask(SIGN, overlap(a, there, &limits, workspace));
    ask(BUILT, overlap(a, &built, &limits, workspace));
    Ok(report)
}

fn replay<const D: usize>(pairs: &[Pair<D>]) -> Report
where
    Space: Turned<D>,
{
    let rows = rows::<D>().expect("rows");
    let expected: usize = pairs.iter().map(|pair| pair.rows).sum();
    assert!(rows.len() * 100 >= expected * 99, "{} of {expected} rows", rows.len());
    for row in &rows {
        let size = row.truth.lower.abs().min(row.truth.upper.abs());
        assert!(row.truth.has_sign() && (GAPS[0]..=GAPS[1]).contains(&size), "{row}");
    }
    on_rows(pairs, &rows, answers)
}

fn assert_all_right(report: &Report) {
    let some = |what: &[String]| {
        what.iter().take(20).map(|line| format!("\n{line}")).collect::<String>()
    };
    let Report { rows, wrong, signs_spent, separations_spent } = report;
    assert!(wrong.is_empty(), "{} of {rows} rows are wrong{}", wrong.len(), some(wrong));
    for (what, spent, share) in
        [(SIGN, signs_spent, 2.0 * SPENT), (SEPARATION, separations_spent, SPENT)]
    {
        let is_few = spent.len() as f64 <= share * *rows as f64;
        assert!(is_few, "{} of {rows}, {what}, are spent{}", spent.len(), some(spent));
    }
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
    // One more, so that it is not the same of every pair.
    let some: Vec<Row<D>> =
        rows().expect("rows").into_iter().step_by(ROWS_A_PROOF + 1).collect();
    on_rows(pairs, &some, |pair, row, _| {
        let again = row.prove(pair)?;
        let is_within = row.truth.lower <= again.upper && again.lower <= row.truth.upper;
        let mut report = Report { rows: 1, ..Report::default() };
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
    assert!(report.rows >= 120);
    assert_all_right(&report);
    Ok(())
}
