// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Local searches on the questions that the proven ones answer: how often they miss, how far they are
//! off, and what they cost.

use std::error::Error;
use std::fmt::Write;
use std::time::Instant;

use palpate_field::Shape;
use palpate_local::{
    ElementMethod, LocalSweep, PairMethod, SampledSweep, SpaceTimeGoldenSection, halton_starts,
};
use palpate_query::{
    ElementSweep, ElementWorkspace, Limits, Moving, PairWorkspace, Placed, SweepSettings,
    SweepWorkspace, minimum, separation, sweep, sweep_element,
};

use super::inputs::{
    BUDGET, DEPTH, Draws, bodies, moving_triangle, overlapping, past, triangle,
};

/// The edges of triangles [m].
const SIZES: [f64; 3] = [0.05, 0.3, 1.0];

/// Triangles of each size and body.
const TRIANGLES: u64 = 40;

/// Poses of each pair.
const POSES: u64 = 15;

/// The edges of triangles that move [m], and motions of each body and edge.
const MOVING: [f64; 2] = [0.3, 0.02];
const MOTIONS: u64 = 40;

/// Motions of each two bodies.
const FLIGHTS: u64 = 6;

/// Starts of a search between two bodies.
const STARTS: u32 = 40;

/// Steps of time.
const SAMPLES: u32 = 60;

/// What is farther off than this share of the size of the question is missed.
const MISSED: f64 = 0.01;

/// What a method did with the questions of a table.
#[derive(Default)]
pub(crate) struct Row {
    name: String,
    asked: usize,
    missed: usize,
    /// Of what was not missed.
    errors: Vec<f64>,
    evaluations: u64,
    nanoseconds: u128,
}

impl Row {
    fn new(name: impl Into<String>) -> Self {
        Self { name: name.into(), ..Self::default() }
    }

    /// Times `search` and counts what it asked.
    fn run<T>(&mut self, search: impl FnOnce() -> (T, u32)) -> T {
        let (found, cost) = timed(search);
        self.pay(cost);
        found
    }

    fn pay(&mut self, (evaluations, nanoseconds): Cost) {
        self.evaluations += u64::from(evaluations);
        self.nanoseconds += nanoseconds;
    }

    /// One question was answered with this error, or missed.
    fn answered(&mut self, error: Option<f64>) {
        self.asked += 1;
        match error {
            Some(error) => self.errors.push(error.max(0.0)),
            None => self.missed += 1,
        }
    }

    /// The row without its time: the same on every machine.
    fn text(&self) -> String {
        let mut errors = self.errors.clone();
        errors.sort_by(f64::total_cmp);
        let [median, worst] = [errors.get(errors.len() / 2), errors.last()]
            .map(|error| error.map_or_else(|| "–".to_owned(), |error| written(*error)));
        let share = 100.0 * self.missed as f64 / self.asked as f64;
        let evaluations = self.evaluations / self.asked as u64;
        format!("| {} | {share:.1} % | {median} | {worst} | {evaluations} |", self.name)
    }
}

/// Evaluations, and the time [ns].
type Cost = (u32, u128);

/// What a search finds, and what it costs.
fn timed<T>(search: impl FnOnce() -> (T, u32)) -> (T, Cost) {
    let start = Instant::now();
    let (found, evaluations) = search();
    (found, (evaluations, start.elapsed().as_nanos()))
}

/// Two digits, and zero for what rounding may make.
fn written(error: f64) -> String {
    /// Smaller than any error that counts, larger than any rounding [m].
    const NOTHING: f64 = 1e-9;
    if error < NOTHING { "0".to_owned() } else { format!("{error:.1e}") }
}

/// The rows of a question, ours first.
pub(crate) struct Table {
    title: &'static str,
    /// What the errors are.
    errors: &'static str,
    rows: Vec<Row>,
}

impl Table {
    /// The lines of the table but for their times: the same on every machine.
    pub(crate) fn lines(&self) -> impl Iterator<Item = String> {
        self.rows.iter().map(Row::text)
    }

    /// The table with the times of all methods over that of the first.
    pub(crate) fn with_times(&self) -> String {
        let Self { title, errors, .. } = self;
        let mut text = format!(
            "| {title} | missed | {errors}: median | worst | evaluations | time over palpate |\n\
             |---|---|---|---|---|---|\n"
        );
        let ours = self.rows[0].nanoseconds as f64;
        for (row, line) in self.rows.iter().zip(self.lines()) {
            let _ = writeln!(text, "{line} {:.2} |", row.nanoseconds as f64 / ours);
        }
        text
    }
}

/// All tables.
pub(crate) fn all() -> Result<[Table; 4], Box<dyn Error>> {
    Ok([depths()?, pairs()?, times()?, flights()?])
}

/// The least value of a field over a triangle.
fn depths() -> Result<Table, Box<dyn Error>> {
    let mut ours = Row::new("`minimum` (palpate)");
    let mut rows: Vec<Row> =
        ElementMethod::ALL.iter().map(|m| Row::new(format!("`{m}`"))).collect();
    let mut workspace = ElementWorkspace::new();
    for body in &bodies()? {
        for (k, size) in SIZES.into_iter().enumerate() {
            for case in 0..TRIANGLES {
                let draws = Draws::of(k as u64, case);
                let element = triangle(body, &draws, size)?;
                let limits = Limits::new(0.01 * MISSED * size);
                let proven = ours.run(|| {
                    let found = minimum(body, &element, &limits, &mut workspace);
                    let evaluations = found.as_ref().map_or(0, |found| found.evaluations);
                    (found, evaluations)
                })?;
                let width = proven.upper - proven.lower;
                ours.answered((width <= limits.tolerance).then_some(width / size));
                for (row, method) in rows.iter_mut().zip(ElementMethod::ALL) {
                    let value = row.run(|| {
                        let found = method.descend(body, &element);
                        (found.value, found.evaluations)
                    });
                    let error = (value - proven.upper) / size;
                    row.answered((error <= MISSED).then_some(error));
                }
            }
        }
    }
    rows.insert(0, ours);
    Ok(Table { title: "least value over a triangle", errors: "error over its size", rows })
}

/// Each two of the bodies.
fn couples([smooth, edged, thin]: &[Shape<3>; 3]) -> [[&Shape<3>; 2]; 3] {
    [[smooth, edged], [edged, thin], [thin, smooth]]
}

/// The separation of two bodies that overlap by a millimetre.
fn pairs() -> Result<Table, Box<dyn Error>> {
    let mut ours = Row::new("`separation` (palpate)");
    let mut rows: Vec<Row> =
        PairMethod::ALL.iter().map(|m| Row::new(format!("`{m}`, {STARTS} starts"))).collect();
    let mut workspace = PairWorkspace::new();
    for (k, [a, b]) in couples(&bodies()?).into_iter().enumerate() {
        for case in 0..POSES {
            let draws = Draws::of(10 + k as u64, case);
            let b = Placed::new(b, overlapping([a, b], &draws, &mut workspace)?);
            let limits = Limits::new(0.1 * MISSED * DEPTH).with_budget(BUDGET);
            let proven = ours.run(|| {
                let found = separation(a, b, &limits, &mut workspace);
                let evaluations = found.as_ref().map_or(0, |found| found.evaluations);
                (found, evaluations)
            })?;
            let width = proven.upper - proven.lower;
            ours.answered((width <= limits.tolerance).then_some(width / DEPTH));
            for (row, method) in rows.iter_mut().zip(PairMethod::ALL) {
                let least = row.run(|| {
                    let (mut least, mut evaluations) = (f64::INFINITY, 0);
                    for start in halton_starts(a, b, STARTS) {
                        // Starts are finite.
                        let Ok(found) = method.descend(a, b, start, limits.tolerance) else {
                            continue;
                        };
                        evaluations += found.evaluations;
                        least = found.value.min(least);
                    }
                    (least, evaluations)
                });
                let error = (2.0 * least - proven.upper).abs() / DEPTH;
                row.answered((least <= 0.0).then_some(error));
            }
        }
    }
    rows.insert(0, ours);
    Ok(Table { title: "bodies that overlap by 1 mm", errors: "error over the depth", rows })
}

/// The first touch of a triangle that moves.
fn times() -> Result<Table, Box<dyn Error>> {
    let space_time = SpaceTimeGoldenSection::default();
    let mut ours = Row::new("`sweep_element` (palpate)");
    let mut parts = Row::new("`golden_section`, parts of 0.1 m");
    let mut whole = Row::new("`golden_section`");
    let mut rows: Vec<Row> = ElementMethod::ALL
        .iter()
        .map(|m| Row::new(format!("`{m}`, {SAMPLES} samples")))
        .collect();
    let settings = SweepSettings::of_size(1.0);
    let mut workspace = ElementSweep::new();
    for body in &bodies()? {
        let cases = MOVING.into_iter().zip(20..).flat_map(|(size, table)| {
            (0..MOTIONS).map(move |case| (size, Draws::of(table, case)))
        });
        for (size, draws) in cases {
            let (element, screw) = moving_triangle(&draws, size)?;
            let (proven, cost) = timed(|| {
                let found = sweep_element(body, &element, screw, &settings, &mut workspace);
                let evaluations = found.as_ref().map_or(0, |found| found.evaluations);
                (found, evaluations)
            });
            let proven = proven?;
            if proven.touches() == Some(false) {
                continue;
            }
            ours.pay(cost);
            let width = proven.upper - proven.lower;
            ours.answered((width <= settings.time_tolerance).then_some(width));
            let answered = |row: &mut Row, search: &dyn Fn() -> Option<LocalSweep<3>>| {
                let found = row.run(|| {
                    let found = search();
                    (found, found.map_or(0, |found| found.evaluations))
                });
                let touch = found.and_then(|found| found.touch);
                row.answered(touch.map(|touch| touch.time - proven.upper));
            };
            let gap = settings.gap;
            for (row, method) in
                [(&mut whole, space_time), (&mut parts, space_time.with_longest(0.1))]
            {
                answered(row, &|| method.first_touch(body, &element, screw, gap).ok());
            }
            let alone =
                palpate_mesh::TriangleMesh::new(element.vertices().to_vec(), vec![[0, 1, 2]])?;
            let sampled = SampledSweep::new(SAMPLES, gap);
            for (row, method) in rows.iter_mut().zip(ElementMethod::ALL) {
                answered(row, &|| sampled.of_mesh(body, &alone, screw, *method).ok());
            }
        }
    }
    rows.splice(0..0, [ours, whole, parts]);
    Ok(Table {
        title: "first touch of a triangle in motion",
        errors: "late, of a motion of 1",
        rows,
    })
}

/// The first touch of two bodies of which one moves.
fn flights() -> Result<Table, Box<dyn Error>> {
    let mut ours = Row::new("`sweep` (palpate)");
    let mut rows: Vec<Row> =
        PairMethod::ALL.iter().map(|m| Row::new(format!("`{m}`, {SAMPLES} samples"))).collect();
    let settings = SweepSettings { gap: 1e-5, ..SweepSettings::of_size(1.0) };
    let mut workspace = SweepWorkspace::new();
    for (k, [a, b]) in couples(&bodies()?).into_iter().enumerate() {
        for case in 0..FLIGHTS {
            let screw = Draws::of(30 + k as u64, case).take(past)?;
            let moving = Moving::new(b, screw);
            let (proven, cost) = timed(|| {
                let found = sweep(a, moving, &settings, &mut workspace);
                let evaluations = found.as_ref().map_or(0, |found| found.evaluations);
                (found, evaluations)
            });
            let proven = proven?;
            if proven.touches() == Some(false) {
                continue;
            }
            ours.pay(cost);
            let width = proven.upper - proven.lower;
            ours.answered((width <= settings.time_tolerance).then_some(width));
            let sampled = SampledSweep::new(SAMPLES, settings.gap);
            for (row, method) in rows.iter_mut().zip(PairMethod::ALL) {
                let found = row.run(|| {
                    let found = sampled.of_pair(a, moving, *method).ok();
                    (found, found.map_or(0, |found| found.evaluations))
                });
                let touch = found.and_then(|found| found.touch);
                row.answered(touch.map(|touch| touch.time - proven.upper));
            }
        }
    }
    rows.insert(0, ours);
    Ok(Table {
        title: "first touch of two bodies in motion",
        errors: "late, of a motion of 1",
        rows,
    })
}
