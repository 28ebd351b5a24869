// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A scene file, felt by a simulated hand in a servo thread; every tick goes to a CSV file.

use std::io::Write as _;

use palpate::devices::{Hand, SimulatedDevice, Tour, profile_named};
use palpate::prelude::*;
use palpate::scene::AnyScene;
use palpate::servo_loop::{ServoThread, ThreadOptions};

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
    let options = ThreadOptions::default().with_duration(SECONDS).with_recorder(2000);
    let ended = ServoThread::start(servo, Box::new(device), options)?.join();

    let path = std::env::temp_dir().join("palpate_touch.csv");
    let mut csv = std::io::BufWriter::new(std::fs::File::create(&path)?);
    writeln!(csv, "time_s,x_m,y_m,z_m,force_N")?;
    for row in ended.recorder.iter().flat_map(|recorder| recorder.rows()) {
        let [x, y, z] = row.device.0;
        writeln!(csv, "{},{x},{y},{z},{}", row.time_s, row.force.norm())?;
    }
    ended.report.clone().unless_failed()?;
    println!("{}: {}", ended.report, path.display());
    Ok(())
}
