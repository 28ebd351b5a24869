// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Touches that loops play on a device that vibrates.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use palpate_device::DeviceLost;
use palpate_field::{Shape, Vector};
use palpate_haptics::servo_loop::{
    Ending, Pace, RunOptions, ServoThread, StartError, ThreadOptions, Vibration, VirtualClock,
    run,
};
use palpate_haptics::{Bodies, Body, HapticsError, Material, Servo, Surface};
use palpate_sim::{
    Fault, FaultKind, HandPath, Interpolation, RecordedDevice, SimulatedTransport,
    VibrationRecorder,
};
use palpate_vibration::{Command, Mapping, MappingOptions, Vibrates};

/// A hand that comes to a floor after 0.31 s, presses it and slides along it for ever.
fn hand(faults: Vec<Fault>) -> SimulatedTransport<RecordedDevice> {
    let places = [[0.0, 0.01, 0.0], [0.0, -0.003, 0.0], [5.0, -0.003, 0.0]].map(Vector);
    let times = vec![0.0, 0.5, 100.0];
    let path = HandPath::new(times, places.to_vec(), Interpolation::Linear).unwrap();
    SimulatedTransport::new(RecordedDevice::new(vec![path]).unwrap(), faults).unwrap()
}

fn servo(material: &Material) -> Servo {
    let floor = Shape::half_space([0.0, 1.0], 0.0).unwrap();
    let floor = Body::new(floor, Surface::new(material).unwrap()).unwrap();
    Servo::for_device(Bodies::new(vec![floor]).unwrap(), &hand(Vec::new())).unwrap()
}

fn wood() -> Material {
    Material::preset("wood").unwrap()
}

fn mapping() -> Mapping {
    Mapping::new(MappingOptions::default()).unwrap()
}

fn fast<'a>(duration: f64) -> RunOptions<'a> {
    RunOptions { pace: Pace::AsFastAsPossible, ..RunOptions::new(duration) }
}

fn plain() -> ThreadOptions {
    ThreadOptions { raises_priority: false, ..ThreadOptions::default() }
}

/// A motor whose commands the test sees, and that panics once, at the command of this number.
#[derive(Clone, Default)]
struct Motor {
    played: Arc<Mutex<Vec<Command>>>,
    panics_at: Option<usize>,
}

impl Motor {
    fn played(&self) -> Vec<Command> {
        self.played.lock().unwrap().clone()
    }

    /// The amplitudes of the last two commands.
    fn last(&self) -> [f64; 2] {
        let amplitudes: Vec<_> = self.played().iter().map(|c| c.tone.amplitude).collect();
        *amplitudes.last_chunk().unwrap()
    }
}

impl Vibrates for Motor {
    fn channels(&self) -> usize {
        1
    }
    fn play(&mut self, commands: &[Command]) -> Result<(), DeviceLost> {
        let number = {
            let mut played = self.played.lock().unwrap();
            played.extend_from_slice(commands);
            played.len()
        };
        assert!(self.panics_at != Some(number), "the motor is stuck");
        Ok(())
    }
}

/// A motor that is pulled out after some commands.
struct Pulled(u32);

impl Vibrates for Pulled {
    fn channels(&self) -> usize {
        1
    }
    fn play(&mut self, _: &[Command]) -> Result<(), DeviceLost> {
        self.0 = self.0.checked_sub(1).ok_or_else(|| DeviceLost::new("pulled out"))?;
        Ok(())
    }
}

#[test]
fn touches_are_played_and_a_device_that_shakes_no_more_ends_nothing() {
    let mut glove = VibrationRecorder::new(1);
    let (mut device, mut servo) = (hand(Vec::new()), servo(&Material::default()));
    let vibration = Vibration::new(mapping(), &mut glove).with_command_rate(100.0);
    let report =
        run(&mut servo, &mut device, RunOptions { vibration: Some(vibration), ..fast(1.0) })
            .unwrap();
    let played = report.vibration.unwrap();
    assert_eq!((played.commands, played.lost), (100, None));
    let amplitudes: Vec<_> =
        glove.played().map(|commands| commands[0].tone.amplitude).collect();
    // The probe touches after 0.31 s; the last is the silence after the run.
    assert!(amplitudes[..30].iter().all(|a| *a == 0.0) && amplitudes[40] > 0.0);
    assert_eq!((amplitudes.len(), amplitudes[100]), (101, 0.0));
    assert_eq!(amplitudes.iter().copied().fold(0.0, f64::max), played.strongest);

    let vibration = Vibration::new(mapping(), Pulled(10));
    let report =
        run(&mut servo, &mut device, RunOptions { vibration: Some(vibration), ..fast(1.0) })
            .unwrap();
    assert_eq!(report.ending, Ending::Finished);
    let played = report.vibration.unwrap();
    assert_eq!((played.commands, played.lost.as_deref()), (11, Some("pulled out")));
}

#[test]
fn another_number_of_channels_than_contact_points_is_refused() {
    let refused = HapticsError::ContactPoints { servo: 1, device: 2 };
    let two = || Vibration::new(mapping(), VibrationRecorder::new(2));
    let options = RunOptions { vibration: Some(two()), ..fast(1.0) };
    let error = run(&mut servo(&wood()), &mut hand(Vec::new()), options).unwrap_err();
    assert_eq!(error, refused);

    let options = ThreadOptions { vibration: Some(two()), ..plain() };
    let device = Box::new(hand(Vec::new()));
    let error = ServoThread::start(servo(&wood()), device, options).unwrap_err();
    assert_eq!(error, StartError::Haptics(refused));
}

#[test]
fn a_thread_plays_what_a_run_plays_and_what_it_gives_back_plays_again() {
    let vibration = |motor: &Motor| {
        let vibration = Vibration::new(mapping(), motor.clone());
        vibration.with_materials(&[wood()]).with_command_rate(80.0)
    };
    let in_run = Motor::default();
    let options = RunOptions { vibration: Some(vibration(&in_run)), ..fast(1.0) };
    let report = run(&mut servo(&wood()), &mut hand(Vec::new()), options).unwrap();

    let motor = Motor::default();
    let options =
        ThreadOptions { duration: Some(1.0), vibration: Some(vibration(&motor)), ..plain() };
    let (clock, device) = (VirtualClock::new(), Box::new(hand(Vec::new())));
    let ended = ServoThread::start_on(clock, servo(&wood()), device, options).unwrap().join();
    assert_eq!(motor.played(), in_run.played());
    assert_eq!(ended.report.vibration, report.vibration);
    let played = report.vibration.unwrap();
    assert!(played.commands == 80 && played.strongest > 0.1, "{played:?}");

    // A second thread begins with the hand above the floor, as the first did.
    let options = ThreadOptions {
        duration: Some(0.2),
        vibration: Some(ended.vibration.unwrap()),
        ..plain()
    };
    let (servo, device) = (ended.servo, ended.device);
    let thread = ServoThread::start_on(VirtualClock::new(), servo, device, options).unwrap();
    let ended = thread.join();
    assert_eq!(ended.report.vibration.unwrap().commands, 16);
    assert_eq!(motor.played().len(), 81 + 17);
    assert_eq!(ended.vibration.unwrap().into_device().channels(), 1);
}

#[test]
fn a_thread_that_ends_by_itself_leaves_the_motor_silent() {
    let lost = Fault { start: 0.6, duration: 0.0, kind: FaultKind::Lost { attempts: 9 } };
    let stuck = Motor { panics_at: Some(30), ..Motor::default() };
    let trapped = plain().with_motion(|time, _| assert!(time < 0.6, "the motion is trapped"));
    let panicked = |message: &str| Ending::Panicked { message: message.to_owned() };
    for (motor, faults, options, ending) in [
        (
            Motor::default(),
            vec![],
            ThreadOptions { duration: Some(0.6), ..plain() },
            Ending::Finished,
        ),
        (
            Motor::default(),
            vec![lost],
            plain(),
            Ending::DeviceLost { reason: "the plan of faults says so at 0.6 s".to_owned() },
        ),
        (Motor::default(), vec![], trapped, panicked("the motion is trapped")),
        (stuck, vec![], plain(), panicked("the motor is stuck")),
    ] {
        let options = ThreadOptions {
            vibration: Some(Vibration::new(mapping(), motor.clone())),
            ..options
        };
        let (clock, device) = (VirtualClock::new(), Box::new(hand(faults)));
        let mut thread = ServoThread::start_on(clock, servo(&wood()), device, options).unwrap();
        while !thread.control().has_ended() {
            std::thread::yield_now();
        }
        // It is silent before anyone is told of the end.
        let [before, last] = motor.last();
        assert!(before > 0.0 && last == 0.0, "{ending:?}: {before} {last}");
        let ended = thread.join();
        assert_eq!(ended.report.ending, ending);
        let played = ended.report.vibration.unwrap();
        assert_eq!((played.commands, played.lost), (30, None), "{ending:?}");
        assert_eq!(motor.played().len(), 31);
        assert!(ended.vibration.is_some());
    }
}

#[test]
fn a_thread_that_is_ended_or_dropped_leaves_the_motor_silent() {
    for is_dropped in [false, true] {
        let motor = Motor::default();
        let options = ThreadOptions {
            vibration: Some(Vibration::new(mapping(), motor.clone())),
            ..plain()
        };
        let (clock, mut driver) = VirtualClock::driven();
        let device = Box::new(hand(Vec::new()));
        let thread = ServoThread::start_on(clock, servo(&wood()), device, options).unwrap();
        driver.advance(Duration::from_millis(600));
        assert!(motor.last()[1] > 0.0);
        drop(driver);
        if is_dropped {
            drop(thread);
        } else {
            assert_eq!(thread.end().report.ending, Ending::Finished);
        }
        assert!(motor.last()[0] > 0.0 && motor.last()[1] == 0.0);
    }
}
