// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Recordings, as files.

use palpate::field::{Point, Vector};
use palpate::servo_loop::{TraceRow, TraceWriter};
use palpate::sim::{HandPath, Interpolation};

use super::MOST_POINTS;

/// The least time between two samples of a path [s]: the step of the thread that leads the hand.
const STEP: f64 = 0.008;

/// The axes as columns name them.
const AXES: [&str; 3] = ["x", "y", "z"];

/// The answer to a replay of nothing.
pub(crate) const NOTHING: &str = "there are no rows to replay";

/// Times [s] and places [m] of a contact point.
type Places = (Vec<f64>, Vec<Point<3>>);

/// What a hand is led along.
#[derive(Clone, Debug)]
pub(crate) struct Replay {
    /// The dimension of the scenes in which it is replayed.
    pub(crate) dimension: usize,
    /// The path of each contact point.
    pub(crate) paths: Vec<HandPath>,
    /// The times [s] between which the hand is lifted.
    pub(crate) lifts: Vec<[f64; 2]>,
}

impl Replay {
    /// The places of the contact points at a time from the beginning on [m].
    pub(crate) fn places(&self, time: f64) -> Vec<Point<3>> {
        let place = |path: &HandPath| path.state_at(path.start() + time).position;
        self.paths.iter().map(place).collect()
    }

    /// The end of the lift at a time from the beginning on [s], if the hand is lifted then.
    pub(crate) fn lifted_until(&self, time: f64) -> Option<f64> {
        let start = self.paths.first()?.start();
        // Both ends are rounded alike, so that the end of a lift is past it.
        let mut lifts = self.lifts.iter().map(|lift| lift.map(|end| end - start));
        lifts.find(|[from, to]| (*from..*to).contains(&time)).map(|[_, to]| to)
    }

    pub(crate) fn is_over(&self, time: f64) -> bool {
        self.paths.iter().all(|path| time > path.duration())
    }
}

/// Rows of a scene of so many dimensions as a file.
pub(crate) fn written(rows: &[TraceRow], dimension: usize) -> Vec<u8> {
    let mut out = TraceWriter::new(Vec::new());
    if dimension == 2 {
        out = out.in_plane();
    }
    // Writing to memory has no way to fail.
    let written = rows.iter().try_for_each(|row| out.write(row));
    written.and_then(|()| out.finish()).unwrap_or_default()
}

/// The replay of rows of a scene of so many dimensions.
pub(crate) fn replay(rows: &[TraceRow], dimension: usize) -> Result<Replay, String> {
    let (mut all, mut lifts) = (Vec::new(), Vec::new());
    for row in rows {
        add(&mut all, row.point as usize, row.time_s, row.device)?;
        add_lift(&mut lifts, row.time_s, row.is_lifted);
    }
    finished(all, lifts, dimension)
}

/// Adds what a row says of the lifts; one that goes on ends at the last row.
fn add_lift(lifts: &mut Vec<(bool, [f64; 2])>, time: f64, is_lifted: bool) {
    match lifts.last_mut() {
        Some((goes_on, lift)) if *goes_on => (*goes_on, lift[1]) = (is_lifted, time),
        _ if is_lifted => lifts.push((true, [time; 2])),
        _ => {}
    }
}

/// The replay of a file in a scene of so many dimensions: `time_s`, `point` if there are several, `lifted` if it says so, and `device_x_m` … or,
/// as in the paths of `palpate feel`, `x_m` ….
pub(crate) fn read(bytes: &[u8], dimension: usize) -> Result<Replay, String> {
    let mut reader = csv::Reader::from_reader(bytes);
    let said = |error: csv::Error| error.to_string();
    let names = reader.headers().map_err(said)?.clone();
    let column = |name: &str| names.iter().position(|other| other == name);
    let needed = |name: &str| {
        column(name).ok_or_else(|| {
            format!("there is no column {name}: a trace in {dimension}D has one")
        })
    };
    let prefix = if column("device_x_m").is_some() { "device_" } else { "" };
    let mut places = Vec::new();
    for axis in &AXES[..dimension] {
        places.push(needed(&format!("{prefix}{axis}_m"))?);
    }
    if dimension == 2 && column(&format!("{prefix}z_m")).is_some() {
        return Err("the trace is of a scene in space, this one is in the plane".to_owned());
    }
    let (time, point, lifted) = (needed("time_s")?, column("point"), column("lifted"));
    let (mut all, mut lifts) = (Vec::new(), Vec::new());
    for row in reader.records() {
        let row = row.map_err(said)?;
        let line = row.position().map_or(0, csv::Position::line);
        let number = |column: usize| {
            let text = row.get(column).unwrap_or_default();
            let number = text.trim().parse::<f64>().ok().filter(|number| number.is_finite());
            let name = names.get(column).unwrap_or_default();
            let shown: String = text.chars().take(40).collect();
            number.ok_or_else(|| format!("line {line}: {name} must be a number, got {shown:?}"))
        };
        let mut place = Vector::ZERO;
        for (axis, column) in places.iter().enumerate() {
            place[axis] = number(*column)?;
        }
        let point = point.map_or(Ok(0.0), number)?;
        if point < 0.0 || point.fract() != 0.0 {
            return Err(format!("line {line}: point must be 0, 1, 2 …, got {point}"));
        }
        let at_line = |why: String| format!("line {line}: {why}");
        let time = number(time)?;
        add(&mut all, point as usize, time, place).map_err(at_line)?;
        let is_lifted = lifted.is_some_and(|column| row.get(column) == Some("true"));
        add_lift(&mut lifts, time, is_lifted);
    }
    finished(all, lifts, dimension)
}

/// Adds a place of a contact point, unless it comes too soon after the last one.
fn add(all: &mut Vec<Places>, point: usize, time: f64, place: Point<3>) -> Result<(), String> {
    if point >= MOST_POINTS {
        return Err(format!(
            "a hand has at most {MOST_POINTS} contact points, got the number {point}"
        ));
    }
    if all.len() <= point {
        all.resize_with(point + 1, Places::default);
    }
    let (times, places) = &mut all[point];
    if let Some(last) = times.last().filter(|last| time < **last) {
        return Err(format!("time_s must not go back, got {time} s after {last} s"));
    }
    if times.last().is_none_or(|last| time - last >= STEP) {
        times.push(time);
        places.push(place);
    }
    Ok(())
}

fn finished(
    all: Vec<Places>,
    lifts: Vec<(bool, [f64; 2])>,
    dimension: usize,
) -> Result<Replay, String> {
    if all.is_empty() {
        return Err(NOTHING.to_owned());
    }
    let path = |(point, (times, places)): (usize, Places)| {
        HandPath::new(times, places, Interpolation::Monotone)
            .map_err(|error| format!("contact point {point}: {error}"))
    };
    let paths = all.into_iter().enumerate().map(path).collect::<Result<_, _>>()?;
    Ok(Replay { dimension, paths, lifts: lifts.into_iter().map(|(_, lift)| lift).collect() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_read_from_traces_and_from_paths() {
        let trace = "time_s,point,device_x_m,device_y_m,proxy_x_m\n\
                     0.001,0,0.5,0.25,9\n0.002,0,7,7,9\n0.011,0,0.75,0.25,9\n";
        let paths = read(trace.as_bytes(), 2).unwrap().paths;
        assert_eq!(paths.len(), 1);
        assert!((paths[0].duration() - 0.01).abs() < 1e-15);
        assert_eq!(paths[0].state_at(0.011).position, Vector([0.75, 0.25, 0.0]));
        let path = "time_s,x_m,y_m,z_m\n0,1,2,3\n1,1,2,4\n";
        let found = read(path.as_bytes(), 3).unwrap();
        assert_eq!(found.paths[0].state_at(1.0).position, Vector([1.0, 2.0, 4.0]));
    }

    #[test]
    fn lifts_are_read_from_traces() {
        let trace = "time_s,x_m,y_m,lifted\n5,0,0,false\n5.1,0,0,true\n5.2,1,0,true\n\
                     5.3,1,0,false\n5.4,2,0,true\n5.5,2,0,true\n";
        let replay = read(trace.as_bytes(), 2).unwrap();
        assert_eq!(replay.lifts, [[5.1, 5.3], [5.4, 5.5]]);
        assert_eq!(replay.lifted_until(0.05), None);
        assert!((replay.lifted_until(0.15).unwrap() - 0.3).abs() < 1e-12);
        assert_eq!(replay.lifted_until(0.35), None);
        // The end of a lift is past it, also where the difference of times is rounded: such a replay lifted and
        // set down the hand for ever.
        for (start, end) in [(0.26, 3.063), (0.022, 0.085), (-5.0, 0.1)] {
            let replay = Replay { lifts: vec![[start + 0.01, end]], ..long(start) };
            let end = replay.lifted_until(0.02).unwrap();
            assert_eq!(replay.lifted_until(end), None);
        }
    }

    /// A recording of ten seconds.
    fn long(start: f64) -> Replay {
        let text = format!("time_s,x_m,y_m\n{start},0,0\n{},1,0\n", start + 10.0);
        read(text.as_bytes(), 2).unwrap()
    }

    #[test]
    fn what_is_no_trace_is_told_with_its_line() {
        let why = |text: &str| read(text.as_bytes(), 2).unwrap_err();
        assert_eq!(why("a,b\n1,2\n"), "there is no column x_m: a trace in 2D has one");
        assert_eq!(
            why("time_s,x_m,y_m\n0,0,0\n1,east,0\n"),
            "line 3: x_m must be a number, got \"east\""
        );
        assert_eq!(why("time_s,x_m,y_m\n"), "there are no rows to replay");
        assert_eq!(
            why("time_s,x_m,y_m,z_m\n0,0,0,0\n"),
            "the trace is of a scene in space, this one is in the plane"
        );
        assert!(why("time_s,point,x_m,y_m\n0,1e9,0,0\n").starts_with("line 2: a hand has"));
        assert!(why("time_s,x_m,y_m\n0,0\n").contains("line: 2"));
        assert_eq!(
            why("time_s,x_m,y_m\n1,0,0\n0.5,0,0\n"),
            "line 3: time_s must not go back, got 0.5 s after 1 s"
        );
        assert!(why("time_s,point,x_m,y_m\n0,-1,0,0\n").contains("point must be 0, 1, 2"));
        assert!(why(&format!("time_s,x_m,y_m\n0,0,{}\n", "x".repeat(9999))).len() < 120);
    }
}
