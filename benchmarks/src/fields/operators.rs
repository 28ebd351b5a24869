// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Operators beside their children, and the union of a thousand.

use std::error::Error;

use palpate::field::kernel::Ball;
use palpate::field::operator::Copies;
use palpate::field::{BLOCK, Column, Shape, ShapeError};

use super::Rows;
use super::ours::{Ours, in_double, in_single};
use super::points::{Points, SINGLE};
use crate::reference::Reference;
use crate::rounds::{self, Subject};
use crate::scenes::{self, Work};

/// How fast a twisted shape turns [rad/m].
const RATE: f64 = 1.0;

/// How far a displaced surface moves at most [m].
const HEIGHT: f64 = 0.02;

/// Adds the rows of a thousand placed primitives, asked in every way.
pub(super) fn thousand(reference: &Reference, rows: &mut Rows) -> Result<(), Box<dyn Error>> {
    let work = scenes::thousand()?;
    let points = Points::new(work.half);
    let mut subjects = Vec::new();
    points.ours(work.name, &work.shape, &mut subjects);
    rounds::measure(&mut subjects, reference).iter().for_each(|row| row.insert(rows));
    Ok(())
}

/// Adds the rows of cells next to the surface of unions, and how they compare with those of S3.
pub(super) fn at_surfaces(
    reference: &Reference,
    rows: &mut Rows,
) -> Result<(), Box<dyn Error>> {
    let mut works = vec![scenes::s3()?];
    works.extend(scenes::spatial()?.into_iter().filter(|work| work.name == "S4"));
    works.push(scenes::thousand()?);
    let cells: Vec<_> = works
        .iter()
        .map(|work| Points::<3>::new(work.half).cells_at_surface(&work.shape, work.half))
        .collect();
    let mut subjects: Vec<Subject<'_>> = Vec::new();
    for (work, cells) in works.iter().zip(&cells) {
        let key = format!("{}.model.surface", work.name);
        subjects.push(Subject::new(key, SINGLE, move || {
            let mut out = Column::zero();
            for block in cells {
                work.shape.block_distances(block, BLOCK, &mut out);
            }
            out.get(0).value
        }));
    }
    let times = rounds::measure(&mut subjects, reference);
    for time in &times {
        time.insert(rows);
    }
    for time in &times[1..] {
        rows.insert(format!("{}.over_S3_model", time.key), time.ns / times[0].ns);
    }
    Ok(())
}

/// Adds the rows of a work twisted and displaced, and how they compare with the work
/// itself.
pub(super) fn beside_child(
    work: &Work<3>,
    reference: &Reference,
    rows: &mut Rows,
) -> Result<(), Box<dyn Error>> {
    let child = &work.shape;
    let shapes = [
        ("child", child.clone()),
        ("twisted", child.clone().twisted(RATE)?),
        ("displaced", child.clone().displaced(bumps()?, HEIGHT)?),
    ];
    let points = Points::<3>::new(work.half);
    let scattered = &points.scattered[..SINGLE];
    let mut subjects: Vec<Subject<'_>> = Vec::new();
    for (name, shape) in &shapes {
        let name = format!("{}_{name}", work.name);
        in_single(&name, "1024", (shape, scattered), &mut subjects);
        in_double(&name, "1024", (shape, scattered), &mut subjects);
    }
    let times = rounds::measure(&mut subjects, reference);
    let (of_child, of_others) = times.split_at(times.len() / shapes.len());
    for (k, other) in of_others.iter().enumerate() {
        other.insert(rows);
        let child = &of_child[k % of_child.len()];
        rows.insert(format!("{}.over_child", other.key), other.ns / child.ns);
    }
    Ok(())
}

/// Bumps all over space, in a raster along the axes.
fn bumps() -> Result<Shape<3>, ShapeError> {
    Shape::from_kernel(Ball::new(0.05)?).repeated([Copies::Endless { spacing: 0.2 }; 3])
}
