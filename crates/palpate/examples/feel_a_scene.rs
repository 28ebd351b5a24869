// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A scene file, felt by a simulated hand in a servo thread; every tick goes to a CSV file while
//! the servo runs.

use std::time::Duration;

use palpate::device::profile_named;
use palpate::prelude::*;
use palpate::scene::AnyScene;
use palpate::servo_loop::{ServoThread, ThreadOptions, TraceWriter};
use palpate::sim::{Hand, SimulatedDevice, Tour};

const SECONDS: f64 = 2.0;

fn main() -> Result<(), Error> {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/cup.json");
    let AnyScene::Spatial(scene) = Scene::from_file(file)?.build()? else {
        return Err(std::io::Error::other("the cup is in space").into());
    };
    let profile = profile_named("omega")?;
    let map = scene.workspace_of(&profile, None)?;
    let bounds =
        scene.bounds().ok_or_else(|| std::io::Error::other("the cup has no bounds"))?;
    let tour = Tour::new(bounds, SECONDS)?.over(&scene.whole)?;
    let hand = Hand::new(tour.mapped(|point| map.point_to_device(point))?);
    let device = SimulatedDevice::new(profile, vec![hand])?;

    let servo = scene.servo(&device)?;
    let path = std::env::temp_dir().join("palpate_touch.csv");
    let file = std::fs::File::create(&path)?;
    let moving: Vec<_> = scene.moving().collect();
    let mut trace =
        TraceWriter::new(file).with_poses(moving, |body, time| scene.pose_at(body, time));

    // The servo never waits for the file: rows wait for it, for up to half a second.
    let options =
        ThreadOptions { duration: Some(SECONDS), rows: Some(500), ..ThreadOptions::default() }
            .with_motion(scene.motion());
    let mut thread = ServoThread::start(servo, Box::new(device), options)?;
    let records = thread.take_records();
    let mut records =
        records.ok_or_else(|| std::io::Error::other("no recorder was requested"))?;
    while !records.has_ended() {
        std::thread::sleep(Duration::from_millis(10));
        records.take().try_for_each(|row| trace.write(&row))?;
    }
    records.take().try_for_each(|row| trace.write(&row))?;
    let (rows, lost) = (trace.rows(), records.lost());
    trace.finish()?;

    let ended = thread.join();
    print!("{:#}", ended.report.unless_failed()?);
    println!("{}: {rows} rows, {lost} lost", path.display());
    Ok(())
}
