// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Hand paths from CSV files.

use std::fs::File;
use std::path::Path;

use csv::StringRecord;
use palpate::devices::{HandPath, Interpolation};
use palpate::field::Vector;

use crate::input::AXES;
use crate::outcome::Failure;

/// The columns of the coordinates: `x_m`, `y_m` (and `z_m` in space).
pub(crate) fn columns<const D: usize>(header: &StringRecord) -> Result<[usize; D], String> {
    let mut columns = [0; D];
    for (column, axis) in columns.iter_mut().zip(AXES) {
        let name = format!("{axis}_m");
        *column = position(header, &name)
            .ok_or_else(|| format!("line 1: there is no column {name} for a {D}D scene"))?;
    }
    if position(header, "z_m").is_some() && D == 2 {
        return Err("line 1: the column z_m is for 3D scenes, but this scene is 2D".to_owned());
    }
    Ok(columns)
}

fn position(header: &StringRecord, name: &str) -> Option<usize> {
    header.iter().position(|column| column == name)
}

/// Reads a path for each contact point from the columns `time_s,x_m,y_m[,z_m]` and, optionally,
/// `point`, the number of the row's contact point.
pub(crate) fn read<const D: usize>(path: &Path) -> Result<Vec<HandPath<D>>, Failure> {
    let wrong = |problem: String| Failure::file(path, problem);
    let file = File::open(path).map_err(|error| Failure::file(path, error))?;
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(file);
    let header = reader.headers().map_err(|error| Failure::file(path, error))?.clone();
    let coordinates = columns::<D>(&header).map_err(wrong)?;
    let time = position(&header, "time_s")
        .ok_or_else(|| wrong("line 1: there is no column time_s".to_owned()))?;
    let point = position(&header, "point");
    let mut paths: Vec<(Vec<f64>, Vec<Vector<f64, D>>)> = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| Failure::file(path, error))?;
        let line = record.position().map_or(0, csv::Position::line);
        let number = |column: usize| -> Result<f64, Failure> {
            let field = record.get(column).unwrap_or_default();
            field.parse().ok().filter(|number: &f64| number.is_finite()).ok_or_else(|| {
                wrong(format!("line {line}: every field must be a number, got {field:?}"))
            })
        };
        let index = match point {
            None => 0,
            Some(column) => whole(record.get(column).unwrap_or_default(), paths.len())
                .map_err(|problem| wrong(format!("line {line}: {problem}")))?,
        };
        if index == paths.len() {
            paths.push((Vec::new(), Vec::new()));
        }
        let mut position = Vector::ZERO;
        for axis in 0..D {
            position[axis] = number(coordinates[axis])?;
        }
        paths[index].0.push(number(time)?);
        paths[index].1.push(position);
    }
    if paths.is_empty() {
        return Err(wrong("there are no rows".to_owned()));
    }
    paths
        .into_iter()
        .map(|(times, positions)| {
            HandPath::new(times, positions, Interpolation::Smooth)
                .map_err(|error| wrong(error.to_string()))
        })
        .collect()
}

/// The number of a contact point: one of the `known`, or the next.
fn whole(field: &str, known: usize) -> Result<usize, String> {
    match field.parse::<usize>() {
        Ok(index) if index <= known => Ok(index),
        _ => Err(format!(
            "points must be numbered 0, 1, 2 … in order, got {field:?} after {known} points"
        )),
    }
}
