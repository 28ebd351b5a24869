// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Hand paths from CSV files.

use std::path::Path;

use palpate::field::Vector;
use palpate::sim::{HandPath, Interpolation};

use crate::outcome::Failure;
use crate::table::{Table, coordinates};

/// The times [s] and positions [m] of a contact point.
type Samples = (Vec<f64>, Vec<Vector<f64, 3>>);

/// Reads a path for each contact point of a scene of `D` dimensions from the columns `time_s,x_m,y_m[,z_m]` and, optionally,
/// `point`, the number of the row's contact point.
pub(crate) fn read<const D: usize>(path: &Path) -> Result<Vec<HandPath>, Failure> {
    let mut table = Table::open(path)?;
    let columns = coordinates::<D>(&table, &format!("a hand path in {D}D"), &["time_s"])?;
    let point = table.column("point");
    let mut paths: Vec<Samples> = Vec::new();
    while table.advance()? {
        let index = match point {
            None => Some(0),
            Some(column) => number_of_point(&mut table, column, paths.len()),
        };
        let numbers: Vec<_> = columns.iter().map(|column| table.number(*column)).collect();
        let numbers: Option<Vec<f64>> = numbers.into_iter().collect();
        let (Some(index), Some([time, position @ ..])) = (index, numbers.as_deref()) else {
            continue;
        };
        if index == paths.len() {
            paths.push((Vec::new(), Vec::new()));
        }
        let before = paths[index].0.last().copied().filter(|before| *time <= *before);
        if let Some(before) = before {
            let rule = format!("must be more than that of the row before, {before} s");
            table.note_at(columns[0], &format!("{rule}, got {time} s"));
        }
        paths[index].0.push(*time);
        paths[index]
            .1
            .push(Vector::<_, D>(std::array::from_fn(|axis| position[axis])).in_space());
    }
    table.finish()?;
    if paths.is_empty() {
        return Err(table.failure("there are no rows"));
    }
    let path = |(times, positions): Samples| {
        HandPath::new(times, positions, Interpolation::Monotone)
            .map_err(|error| table.failure(error))
    };
    paths.into_iter().map(path).collect()
}

/// The number of a contact point: one of the `known`, or the next.
fn number_of_point(table: &mut Table, column: usize, known: usize) -> Option<usize> {
    let field = table.text(column);
    let index = field.parse::<usize>().ok().filter(|index| *index <= known);
    if index.is_none() {
        let problem = format!(
            "points must be numbered 0, 1, 2 … in order, got {field:?} after {known} points"
        );
        table.note_at(column, &problem);
    }
    index
}
