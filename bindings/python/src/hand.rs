// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Simulated devices in hands, as the program makes them.

use palpate::device::{Device, profile_named};
use palpate::field::Vector;
use palpate::hands::{HandWay, swing};
use palpate::scene::{BuiltScene, BuiltTool};
use palpate::sim::{Hand, HandPath, Interpolation, SimulatedDevice};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arrays::{misshapen, numbers};
use crate::ending::detach;
use crate::error::OrRaise;

/// A simulated device in hands that go along paths in the world: rows of time [s] and position [m], one such array for
/// each contact point, one position to rest at, or a tour over all bodies, of so many points [s].
pub(crate) fn simulated<const D: usize>(
    scene: &BuiltScene<D>,
    profile: &str,
    hand: Option<&Bound<'_, PyAny>>,
    (points, duration): (usize, f64),
    py: Python<'_>,
) -> PyResult<Box<dyn Device + Send>> {
    check_points(points)?;
    let profile = profile_named(profile).or_raise(py)?;
    let tool = scene.tool.as_ref().map_or(Ok(None), BuiltTool::in_hand).or_raise(py)?;
    if points != 1 && (tool.is_some() || scene.contact_points().next().is_some()) {
        let problem = "points= is for scenes whose tool has neither points nor a shape";
        return Err(PyValueError::new_err(problem));
    }
    let map = scene.workspace_of(&profile, tool.as_ref()).or_raise(py)?;
    let (paths, turns) = match hand {
        Some(hand) => (given(scene, hand, points)?, None),
        None if scene.bounds().is_none() => {
            let problem = "no body has bounds: tell where the hand goes, by hand=";
            return Err(PyValueError::new_err(problem));
        }
        None => {
            let way = detach(py, || HandWay::tour(scene, duration, points)).or_raise(py)?;
            let turns = tool.is_some().then(|| swing::<D>(duration)).transpose();
            (way.paths().or_raise(py)?, turns.or_raise(py)?)
        }
    };
    let mut hands = Vec::with_capacity(paths.len());
    for path in paths {
        let hand = Hand::new(path.mapped(|point| map.point_to_device(point)).or_raise(py)?);
        hands.push(match &turns {
            Some(turns) => hand.with_turns(turns.clone()),
            None => hand,
        });
    }
    Ok(Box::new(SimulatedDevice::new(profile, hands).or_raise(py)?))
}

/// The most contact points.
const MOST_POINTS: usize = 1000;

/// Refuses contact points that nobody has.
pub(crate) fn check_points(points: usize) -> PyResult<()> {
    if !(1..=MOST_POINTS).contains(&points) {
        let problem = format!("points must be 1 to {MOST_POINTS} contact points, got {points}");
        return Err(PyValueError::new_err(problem));
    }
    Ok(())
}

/// The paths of the contact points that a caller gives.
fn given<const D: usize>(
    scene: &BuiltScene<D>,
    hand: &Bound<'_, PyAny>,
    points: usize,
) -> PyResult<Vec<HandPath>> {
    let py = hand.py();
    if points != 1 {
        let problem = "points= is about the tour of a hand: give an array of shape (points, n, …) instead";
        return Err(PyValueError::new_err(problem));
    }
    let array = numbers(hand, "hand")?;
    let all = array.as_doubles()?;
    let place = |row: &[f64]| Vector::<f64, D>(std::array::from_fn(|i| row[i])).in_space();
    let path = |rows: &[f64]| {
        let rows = rows.chunks_exact(D + 1);
        let times = rows.clone().map(|row| row[0]).collect();
        let places = rows.map(|row| place(&row[1..])).collect();
        HandPath::new(times, places, Interpolation::Monotone).or_raise(py)
    };
    match array.shape() {
        [columns] if *columns == D => {
            let places = vec![place(&all); 2];
            let rest = HandPath::new(vec![0.0, 1.0], places, Interpolation::Linear);
            HandWay::along(scene, rest.or_raise(py)?).paths().or_raise(py)
        }
        [_, columns] if *columns == D + 1 => {
            HandWay::along(scene, path(&all)?).paths().or_raise(py)
        }
        [count, rows, columns] if *columns == D + 1 && *rows > 0 => {
            let needed = scene.contact_points().count();
            if needed != 0 && needed != *count {
                let problem = format!(
                    "the tool of the scene has {needed} contact points, hand has paths of {count}: give one path, which \
                     carries the tool, or {needed}"
                );
                return Err(PyValueError::new_err(problem));
            }
            all.chunks_exact(rows * columns).map(path).collect()
        }
        shape => {
            let columns = D + 1;
            let expected =
                format!("({D},), or (n, {columns}) or (points, n, {columns}) with times first");
            Err(misshapen("hand", &expected, shape))
        }
    }
}
