// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Fields beside fidget and parry: distances and gradients of S1 to S4 and of a 2D
//! scene; operators beside their children.

mod operators;
mod ours;
mod points;
mod theirs;

use std::collections::BTreeMap;
use std::error::Error;

use crate::peers::{Body, Dimensions, Space, Tape, formula};
use crate::reference::{self, Reference};
use crate::rounds::{self, Subject};
use crate::scenes::{self, Work};
use fidget::jit::JitFunction;
use fidget::vm::VmFunction;
use ours::Ours;
pub(crate) use points::Points;

/// Keys and numbers.
pub(crate) type Rows = BTreeMap<String, f64>;

/// All rows of the suite.
pub(crate) fn measure() -> Result<Rows, Box<dyn Error>> {
    let mut rows = Rows::new();
    let reference = Reference::new()?;
    for work in scenes::spatial()? {
        eprintln!("measuring {} …", work.name);
        measure_work(&work, &reference, &mut rows)?;
        if ["S2", "S3"].contains(&work.name) {
            operators::beside_child(&work, &reference, &mut rows)?;
        }
    }
    let wrench = scenes::wrench()?;
    eprintln!("measuring {} …", wrench.name);
    measure_work(&wrench, &reference, &mut rows)?;
    eprintln!("measuring a thousand …");
    operators::thousand(&reference, &mut rows)?;
    eprintln!("measuring cells at surfaces …");
    operators::at_surfaces(&reference, &mut rows)?;
    measure_build(&reference, &mut rows)?;
    derive_ratios(&mut rows);
    rows.insert(reference::KEY.into(), reference.time());
    Ok(rows)
}

fn measure_work<const D: usize>(
    work: &Work<D>,
    reference: &Reference,
    rows: &mut Rows,
) -> Result<(), Box<dyn Error>>
where
    Points<D>: Ours<D>,
    Dimensions: Space<D>,
{
    let points = Points::new(work.half);
    let formula = formula(&work.shape)?;
    let mut jit = Tape::<JitFunction>::new(&formula);
    let vm = Tape::<VmFunction>::new(&formula);
    theirs::agree(&work.shape, &points, &mut jit)?;
    let body = Body::of(&work.shape);

    let jit = std::cell::RefCell::new(jit);
    let vm = std::cell::RefCell::new(vm);
    let mut subjects: Vec<Subject<'_>> = Vec::new();
    points.ours(work.name, &work.shape, &mut subjects);
    theirs::tape(work.name, "fidget_jit", &points, &jit, &mut subjects);
    theirs::tape(work.name, "fidget_vm", &points, &vm, &mut subjects);
    if let Some(body) = &body {
        theirs::parry(work.name, &points, body, &mut subjects);
    }
    rounds::measure(&mut subjects, reference).iter().for_each(|row| row.insert(rows));
    Ok(())
}

/// Building S4 from its data.
fn measure_build(reference: &Reference, rows: &mut Rows) -> Result<(), Box<dyn Error>> {
    for work in scenes::spatial()? {
        if let Ok(members) = scenes::members(&work.shape) {
            scenes::build(&members)?;
            let key = format!("{}.build.scene", work.name);
            let mut subjects = [Subject::new(key, 1, || {
                scenes::build(&members).map_or(f64::NAN, |shape| shape.depth() as f64)
            })];
            rounds::measure(&mut subjects, reference).iter().for_each(|row| row.insert(rows));
        }
    }
    Ok(())
}

/// The key of our blocks in double precision, from that of a slice.
fn in_double(key: &str) -> String {
    let (question, case) = key.rsplit_once('.').unwrap_or((key, ""));
    format!("{question}_f64.{case}")
}

/// Ours over each peer.
fn derive_ratios(rows: &mut Rows) {
    let times = rows.clone();
    for (key, time) in &times {
        let Some(key) = key.strip_suffix(".ns") else { continue };
        if let Some((ours, peer)) = key.rsplit_once('.')
            && theirs::PEERS.contains(&peer)
        {
            // Our key for a point is the peer's. For a slice it is the key in double precision,
            // since our blocks hold only `f64`.
            let ours = if ours.ends_with(".point") { ours.to_owned() } else { in_double(ours) };
            if let Some(own) = times.get(&format!("{ours}.ns")) {
                rows.insert(format!("{ours}.ours_over_{peer}"), own / time);
            }
        }
    }
    best_of_clustered(rows);
}

/// For clustered points, the better of fidget's JIT as it is and simplified for
/// each cluster.
fn best_of_clustered(rows: &mut Rows) {
    let simplified: Vec<_> = rows
        .iter()
        .filter_map(|(key, time)| {
            let work = key.strip_suffix(".clustered_simplified.fidget_jit.ns")?;
            Some((work.to_owned(), *time))
        })
        .collect();
    for (work, time) in simplified {
        let plain = rows.get(&format!("{work}.clustered.fidget_jit.ns")).copied();
        let ours = rows.get(&format!("{work}_f64.clustered.ns")).copied();
        if let (Some(plain), Some(ours)) = (plain, ours) {
            let ratio = ours / plain.min(time);
            rows.insert(format!("{work}_f64.clustered.ours_over_fidget_jit"), ratio);
        }
    }
}
