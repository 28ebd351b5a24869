// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Rows of a running servo: none is lost unnoticed, however the run ends.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use crate::common::ball;
use palpate_device::{Device, DeviceLost, DeviceProfile, PointState, Reading};
use palpate_field::{Point, Vector};
use palpate_haptics::Servo;
use palpate_haptics::servo_loop::{
    Ending, Pace, Recorder, RunOptions, ServoThread, ThreadOptions, TraceRow, VirtualClock,
    run, run_on,
};
use palpate_sim::{HandPath, Interpolation, RecordedDevice};

/// Two contact points on their way into a ball, for a second.
fn device() -> RecordedDevice {
    let press = |x: f64| {
        let places = vec![Vector([x, 0.08, 0.0]), Vector([x, 0.04, 0.0])];
        HandPath::new(vec![0.0, 1.0], places, Interpolation::Smooth).unwrap()
    };
    RecordedDevice::new(vec![press(0.0), press(0.01)]).unwrap()
}

fn servo(device: &impl Device) -> Servo {
    Servo::for_device(ball::<2>(0.05), device).unwrap()
}

/// Time, contact point and forces: what two runs have in common, whatever they cost.
fn what_is_felt(rows: &[TraceRow]) -> Vec<(f64, u32, Point<3>, Vector<f64, 3>)> {
    rows.iter().map(|row| (row.time_s, row.point, row.proxy, row.force)).collect()
}

#[test]
fn a_sink_gets_every_row_in_order_at_either_pace() {
    for pace in [Pace::AsFastAsPossible, Pace::RealTime] {
        let mut device = device();
        let mut servo = servo(&device);
        let mut recorder = Recorder::new(2000);
        let mut rows = Vec::new();
        let mut sink = |row: &TraceRow| rows.push(*row);
        let options = RunOptions {
            pace,
            recorder: Some(&mut recorder),
            sink: Some(&mut sink),
            ..RunOptions::new(1.0)
        };
        // On a virtual clock the run is faster than the thread of the sink, whose queue has room
        // for a second.
        let mut clock = VirtualClock::new();
        let report = run_on(&mut clock, &mut servo, &mut device, options).unwrap();
        assert_eq!((report.ticks, report.rows_dropped), (1000, 0));
        assert_eq!(rows, recorder.rows(), "{pace:?}");
        assert_eq!(rows.len(), 2000);
    }
}

#[test]
fn an_interrupted_run_keeps_what_it_has() {
    let left = AtomicBool::new(false);
    let mut device = device();
    let mut servo = servo(&device);
    let mut rows = Vec::new();
    let mut sink = |row: &TraceRow| {
        rows.push(*row);
        left.store(row.time_s >= 0.25, Ordering::Relaxed);
    };
    let options = RunOptions {
        pace: Pace::AsFastAsPossible,
        interrupt: Some(&left),
        sink: Some(&mut sink),
        ..RunOptions::new(1.0)
    };
    let report = run(&mut servo, &mut device, options).unwrap();
    assert_eq!((report.ending, report.ticks), (Ending::Interrupted, 251));
    assert_eq!(rows.len(), 502);
}

/// A device that is unplugged after a quarter of a second.
struct Unplugged(RecordedDevice);

impl Device for Unplugged {
    fn points(&self) -> usize {
        self.0.points()
    }
    fn profile(&self) -> &DeviceProfile {
        self.0.profile()
    }
    fn read(&mut self, time: f64, points: &mut [PointState]) -> Result<Reading, DeviceLost> {
        if time >= 0.25 {
            return Err(DeviceLost { reason: "unplugged".to_owned() });
        }
        self.0.read(time, points)
    }
    fn write(&mut self, forces: &[Vector<f64, 3>]) -> Result<(), DeviceLost> {
        self.0.write(forces)
    }
}

#[test]
fn a_thread_keeps_the_rows_before_its_device_was_lost() {
    let device = Box::new(Unplugged(device()));
    let options =
        ThreadOptions { raises_priority: false, rows: Some(1000), ..ThreadOptions::default() };
    let servo = servo(&*device);
    let thread = ServoThread::start_on(VirtualClock::new(), servo, device, options).unwrap();
    let ended = thread.join();
    let mut records = ended.records.unwrap();
    let rows: Vec<_> = records.take().collect();
    assert_eq!((rows.len(), records.lost(), ended.report.rows_dropped), (500, 0, 0));
    assert!(records.has_ended());
    assert_eq!(rows.last().unwrap().time_s, 0.249);
}

#[test]
fn a_thread_whose_rows_are_taken_meanwhile_loses_none() {
    let mut in_call = device();
    let mut recorder = Recorder::new(2000);
    let options = RunOptions {
        pace: Pace::AsFastAsPossible,
        recorder: Some(&mut recorder),
        ..RunOptions::new(1.0)
    };
    run(&mut servo(&in_call), &mut in_call, options).unwrap();

    let device = Box::new(device());
    let servo = servo(&*device);
    let (clock, mut driver) = VirtualClock::driven();
    let options = ThreadOptions {
        raises_priority: false,
        duration: Some(1.0),
        rows: Some(64),
        ..ThreadOptions::default()
    };
    let mut thread = ServoThread::start_on(clock, servo, device, options).unwrap();
    let mut records = thread.take_records().unwrap();
    assert!(thread.take_records().is_none());
    let mut rows = Vec::new();
    for _ in 0..40 {
        driver.advance(Duration::from_millis(25));
        rows.extend(records.take());
    }
    drop(driver);
    let ended = thread.join();
    rows.extend(records.take());
    assert!(ended.records.is_none());
    assert_eq!((records.lost(), ended.report.rows_dropped), (0, 0));
    assert_eq!(what_is_felt(&rows), what_is_felt(recorder.rows()));
}

#[test]
fn a_thread_says_how_many_rows_nobody_took() {
    let device = Box::new(device());
    let servo = servo(&*device);
    let options = ThreadOptions {
        raises_priority: false,
        duration: Some(1.0),
        rows: Some(64),
        ..ThreadOptions::default()
    };
    let thread = ServoThread::start_on(VirtualClock::new(), servo, device, options).unwrap();
    let ended = thread.join();
    let mut records = ended.records.unwrap();
    assert_eq!((records.lost(), ended.report.rows_dropped), (1936, 1936));
    assert_eq!(records.take().last().unwrap().time_s, 0.031);
    let said = ended.report.to_string();
    assert!(said.ends_with("; finished; 1936 rows lost"), "{said}");
    let said = format!("{:#}", ended.report);
    assert!(said.contains("\n  rows lost      1936; "), "{said}");
}
