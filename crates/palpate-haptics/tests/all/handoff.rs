// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A servo thread and what goes to and from it, on a clock that tests move.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use crate::common::{ball, body, half_space, without_limits};
use palpate_device::{Device, DeviceLost, DeviceProfile, PointState, Reading};
use palpate_field::{CustomField, Point, Pose, Promise, Shape, Vector};
use palpate_haptics::servo_loop::{
    ClockDriver, Ending, Priority, ServoThread, StartError, ThreadOptions, VirtualClock,
};
use palpate_haptics::{
    Bodies, Body, EventKind, HandoffOptions, HapticsError, Probe, Protection, Servo,
    ServoOptions, Surface, Unprotected, handoff,
};
use palpate_safety::Acceptance;

const TICK: Duration = Duration::from_millis(1);

/// A device whose points are moved by the test, and that keeps what is written.
#[derive(Clone)]
struct Hand {
    at: Arc<Mutex<Vec<Point<3>>>>,
    written: Arc<Mutex<Vec<Vec<Vector<f64, 3>>>>>,
    profile: DeviceProfile,
    /// When it is unplugged [s].
    until: f64,
}

impl Hand {
    fn at(points: &[[f64; 2]]) -> Self {
        Self {
            at: Arc::new(Mutex::new(
                points.iter().map(|point| Vector(*point).in_space()).collect(),
            )),
            written: Arc::default(),
            profile: DeviceProfile::unlimited("hand"),
            until: f64::INFINITY,
        }
    }

    fn move_to(&self, point: [f64; 2]) {
        self.at.lock().unwrap()[0] = Vector(point).in_space();
    }

    fn last_forces(&self) -> Vec<Vector<f64, 3>> {
        self.written.lock().unwrap().last().unwrap().clone()
    }
}

impl Device for Hand {
    fn points(&self) -> usize {
        self.at.lock().unwrap().len()
    }
    fn profile(&self) -> &DeviceProfile {
        &self.profile
    }
    fn read(&mut self, time: f64, points: &mut [PointState]) -> Result<Reading, DeviceLost> {
        if time >= self.until {
            return Err(DeviceLost { reason: "unplugged".to_owned() });
        }
        for (point, at) in points.iter_mut().zip(&*self.at.lock().unwrap()) {
            *point = PointState::at_rest(*at);
        }
        Ok(Reading::Fresh { time })
    }
    fn write(&mut self, forces: &[Vector<f64, 3>]) -> Result<(), DeviceLost> {
        self.written.lock().unwrap().push(forces.to_vec());
        Ok(())
    }
}

fn unprotected(bodies: impl Into<Bodies>, points: usize) -> Servo<Unprotected> {
    let options = ServoOptions {
        probe: Probe::new(0.0).unwrap(),
        max_force: f64::INFINITY,
        ..ServoOptions::default()
    };
    Servo::new(bodies, points, options).unwrap()
}

fn servo(bodies: impl Into<Bodies>, points: usize) -> Servo {
    without_limits(unprotected(bodies, points))
}

/// All points with y ≤ `height`, at 512 N/m.
fn floor(height: f64) -> Bodies {
    body(half_space([0.0, 1.0], height), Surface::smooth(512.0, 0.0).unwrap())
}

fn start(servo: Servo, hand: &Hand, options: ThreadOptions) -> (ServoThread, ClockDriver) {
    let (clock, mut driver) = VirtualClock::driven();
    let thread = ServoThread::start_on(clock, servo, Box::new(hand.clone()), options).unwrap();
    // Tick 0 is over.
    driver.advance(Duration::ZERO);
    (thread, driver)
}

fn plain() -> ThreadOptions {
    ThreadOptions { raises_priority: false, ..ThreadOptions::default() }
}

fn up(way: f64) -> Pose<3> {
    Pose::translation(Vector([0.0, way, 0.0]))
}

#[test]
fn bodies_handed_to_a_protected_servo_are_as_soft_as_its_device_needs() {
    // Once they went as they were, whatever the device could render.
    let profile = DeviceProfile { least_damping: 0.064, ..DeviceProfile::unlimited("gentle") };
    for is_strict in [false, true] {
        let servo = unprotected(
            body(half_space([0.0, 1.0], 0.0), Surface::smooth(64.0, 0.0).unwrap()),
            1,
        );
        let protection = Protection::new(profile.clone()).with(|s| {
            s.acceptance = Acceptance::Passive;
            s.is_strict = is_strict
        });
        let mut servo = servo.protected(&protection).unwrap();
        let (mut control, mut end) = handoff(&servo, HandoffOptions::default());
        // 2 b / T is 128 N/m.
        let replaced = control.replace_bodies(floor(0.0));
        end.receive(&mut servo);
        let stiffness = servo.bodies().bodies()[0].surface().stiffness();
        if is_strict {
            assert!(replaced.is_err() && stiffness == 64.0);
        } else {
            assert_eq!((replaced.unwrap()[0].stiffness_factor, stiffness), (0.25, 128.0));
        }
    }
}

#[test]
fn edits_are_seen_in_the_next_tick() {
    let hand = Hand::at(&[[0.0, 0.25]]);
    let (mut thread, mut driver) = start(servo(floor(0.0), 1), &hand, plain());
    hand.move_to([0.0, -0.0078125]);
    driver.advance(TICK);
    assert!((hand.last_forces()[0] - Vector([0.0, 4.0, 0.0])).norm() < 1e-6);

    thread.control().set_poses(&[(0, up(-1.0))], Duration::ZERO).unwrap();
    driver.advance(TICK);
    assert_eq!(hand.last_forces(), [Vector::ZERO]);
    let snapshot = thread.control().latest().unwrap();
    assert_eq!((snapshot.progress.ticks, snapshot.progress.contacts), (3, 0));

    // The last of several poses counts; of a scene replaced, none does.
    thread.control().set_poses(&[(0, up(3.0)), (0, up(-1.0))], Duration::ZERO).unwrap();
    thread.control().set_poses(&[(0, up(0.5))], Duration::ZERO).unwrap();
    thread.control().replace_bodies(floor(-0.0078125)).unwrap();
    thread.control().set_poses(&[(0, up(3.0))], Duration::ZERO).unwrap();
    thread.control().set_poses(&[(0, up(-0.25))], Duration::ZERO).unwrap();
    driver.advance(TICK);
    assert_eq!(hand.last_forces(), [Vector::ZERO]);
    hand.move_to([0.0, -0.25 - 2.0 * 0.0078125]);
    driver.advance(TICK);
    assert!((hand.last_forces()[0] - Vector([0.0, 4.0, 0.0])).norm() < 1e-6);
    let snapshot = thread.control().latest().unwrap();
    assert!((snapshot.reactions[0].force - Vector([0.0, -4.0, 0.0])).norm() < 1e-6);

    thread.control().limit_force(1.0).unwrap();
    driver.advance(TICK);
    assert!((hand.last_forces()[0] - Vector([0.0, 1.0, 0.0])).norm() < 1e-9);
    drop(driver);
    let ended = thread.end();
    assert_eq!((ended.report.ending, ended.priority), (Ending::Finished, Priority::Normal));
}

#[test]
fn a_batch_of_poses_is_seen_whole() {
    // A hand between two floors that go up together: it would feel one that goes alone.
    let two = || {
        let floor = |height| {
            let shape = half_space([0.0, 1.0], height);
            Body::new(shape, Surface::smooth(512.0, 0.0).unwrap()).unwrap()
        };
        Bodies::new(vec![floor(0.0), floor(0.0)]).unwrap()
    };
    let hand = Hand::at(&[[0.0, 0.25]]);
    let (mut thread, mut driver) = start(servo(two(), 1), &hand, plain());
    for tick in 1..=100 {
        let way = -0.001 * f64::from(tick);
        thread.control().set_poses(&[(0, up(-way)), (1, up(way))], Duration::ZERO).unwrap();
        thread.control().set_poses(&[(1, up(way)), (0, up(way))], Duration::ZERO).unwrap();
        hand.move_to([0.0, way + 0.0005]);
        driver.advance(TICK);
        let snapshot = thread.control().latest().unwrap();
        assert_eq!(snapshot.progress.contacts, 0, "tick {tick}");
        assert_eq!(snapshot.reactions.len(), 2);
    }
    let error =
        thread.control().set_poses(&[(0, up(0.0)), (2, up(0.0))], Duration::ZERO).unwrap_err();
    assert_eq!(error, HapticsError::NoSuchBody { body: 2, bodies: 2 });
    assert_eq!(
        thread.control().set_poses(&[(0, up(f64::NAN))], Duration::ZERO),
        Err(HapticsError::Pose)
    );
    assert!(thread.control().limit_force(f64::NAN).is_err());
    drop(driver);
    // What was refused moved nothing.
    let ended = thread.end();
    assert_eq!(ended.servo.bodies().bodies()[0].world_from_body(), &up(-0.1));
}

/// A ball that can be counted.
#[derive(Debug)]
struct Counted {
    promise: Promise<2>,
    _count: Arc<()>,
}

impl CustomField<2> for Counted {
    fn distance(&self, p: Point<2>) -> f64 {
        p.norm() - 0.5
    }
    fn distance_gradient(&self, p: Point<2>) -> (f64, Vector<f64, 2>) {
        (p.norm() - 0.5, p.normalized().unwrap_or(Vector::ZERO))
    }
    fn promise(&self) -> &Promise<2> {
        &self.promise
    }
}

#[test]
fn scenes_come_back_and_are_dropped_by_the_next_call() {
    let count = Arc::new(());
    let scene = || {
        let promise = *ball(0.5).promise();
        Bodies::from(Shape::custom(Counted { promise, _count: count.clone() }))
    };
    let hand = Hand::at(&[[0.0, 1.0]]);
    let (mut thread, mut driver) = start(servo(scene(), 1), &hand, plain());
    assert_eq!(Arc::strong_count(&count), 2);
    thread.control().replace_bodies(scene()).unwrap();
    // Not seen yet: the next one takes its place, and it is dropped at once.
    thread.control().replace_bodies(scene()).unwrap();
    assert_eq!(Arc::strong_count(&count), 3);
    driver.advance(TICK);
    assert_eq!(Arc::strong_count(&count), 3);
    thread.control().collect();
    assert_eq!(Arc::strong_count(&count), 2);
    for _ in 0..100 {
        thread.control().replace_bodies(scene()).unwrap();
        driver.advance(TICK);
        assert!(Arc::strong_count(&count) <= 4);
    }
    let many = || (0..1025).map(|_| Body::new(ball::<2>(0.1), Surface::default()).unwrap());
    let error = thread.control().replace_bodies(Bodies::new(many().collect()).unwrap());
    assert_eq!(error, Err(HapticsError::TooManyBodies { bodies: 1025, most: 1024 }));
    drop(driver);
    drop(thread.end());
    assert_eq!(Arc::strong_count(&count), 1);
}

#[test]
fn events_come_in_order_with_their_ticks_and_are_counted_where_there_is_no_room() {
    let hand = Hand::at(&[[0.0, 0.25]]);
    let handoff = HandoffOptions { events: 3, ..HandoffOptions::default() };
    let options = ThreadOptions { handoff, ..plain() };
    let (mut thread, mut driver) = start(servo(floor(0.0), 1), &hand, options);
    let mut tap = |times: u64| {
        for _ in 0..times {
            hand.move_to([0.0, -0.001]);
            driver.advance(TICK);
            hand.move_to([0.0, 0.25]);
            driver.advance(TICK);
        }
    };
    tap(1);
    let touch = thread.control().next_event().unwrap();
    assert_eq!((touch.tick, touch.body), (1, 0));
    assert!(matches!(touch.kind, EventKind::Touch { .. }));
    tap(2);
    let ticks: Vec<_> =
        std::iter::from_fn(|| thread.control().next_event()).map(|event| event.tick).collect();
    assert_eq!(ticks, [2, 3, 4]);
    assert_eq!(thread.control().latest().unwrap().events_lost, 2);
    tap(1);
    assert_eq!(thread.control().next_event().unwrap().tick, 7);
    drop(driver);
}

#[test]
fn an_emergency_stop_takes_all_forces_until_it_is_released() {
    let hand = Hand::at(&[[0.0, 0.25], [1.0, 0.25]]);
    let (thread, mut driver) = start(servo(floor(0.0), 2), &hand, plain());
    let mut thread = thread;
    hand.move_to([0.0, -0.0078125]);
    driver.advance(TICK);
    assert!(hand.last_forces()[0][1] > 3.9);
    let switch = thread.control().stop_switch();
    assert!(!thread.control().latest().unwrap().is_stopped);
    std::thread::scope(|scope| scope.spawn(|| switch.stop()).join().unwrap());
    driver.advance(TICK);
    assert_eq!(hand.last_forces(), [Vector::ZERO; 2]);
    assert!(thread.control().latest().unwrap().is_stopped);
    driver.advance(TICK);
    assert_eq!(hand.last_forces(), [Vector::ZERO; 2]);
    switch.release();
    driver.advance(TICK);
    assert!(hand.last_forces()[0][1] > 3.9);
    assert!(!thread.control().latest().unwrap().is_stopped);
    drop(driver);
    let report = thread.end().report;
    // Both contact points were stopped, once.
    let said = format!("{report:#}");
    assert!(said.contains("  0 watchdog trips, 1 emergency stop\n"), "{said}");
    assert_eq!(hand.last_forces(), [Vector::ZERO; 2]);
}

#[test]
fn ten_kilohertz_have_ten_times_the_ticks() {
    let run = |rate| {
        let hand = Hand::at(&[[0.0, -0.001]]);
        let options = ServoOptions { rate, ..ServoOptions::default() };
        let servo = Servo::new(half_space([0.0, 1.0], 0.0), 1, options).unwrap();
        let servo = without_limits(servo);
        let options = ThreadOptions { duration: Some(0.5), ..plain() };
        let hand_of_thread = Box::new(hand.clone());
        let clock = VirtualClock::new();
        let ended =
            ServoThread::start_on(clock, servo, hand_of_thread, options).unwrap().join();
        let lateness = ended.report.lateness.unwrap();
        assert_eq!((lateness.max, ended.report.missed_deadlines), (0.0, 0));
        // And once zero at the end.
        assert_eq!(hand.written.lock().unwrap().len() as u64, ended.report.ticks + 1);
        assert_eq!(hand.last_forces(), [Vector::ZERO]);
        (ended.report.ticks, ended.report.duration)
    };
    assert_eq!((run(1000.0), run(10_000.0)), ((500, 0.5), (5000, 0.5)));
}

/// A field that panics below 0.1 m.
#[derive(Debug)]
struct Trap(Promise<2>);

impl CustomField<2> for Trap {
    fn distance(&self, p: Point<2>) -> f64 {
        self.distance_gradient(p).0
    }
    fn distance_gradient(&self, p: Point<2>) -> (f64, Vector<f64, 2>) {
        assert!(p[1] > 0.1, "the trap snapped");
        (p[1], Vector([0.0, 1.0]))
    }
    fn promise(&self) -> &Promise<2> {
        &self.0
    }
}

#[test]
fn a_lost_device_or_a_panic_ends_the_thread_with_no_force() {
    let mut hand = Hand::at(&[[0.0, -0.001]]);
    hand.until = 0.01;
    let clock = VirtualClock::new();
    let device = Box::new(hand.clone());
    let thread = ServoThread::start_on(clock, servo(floor(0.0), 1), device, plain()).unwrap();
    let ended = thread.join();
    assert_eq!(ended.report.ending, Ending::DeviceLost { reason: "unplugged".to_owned() });
    assert_eq!((ended.report.ticks, hand.last_forces()), (10, vec![Vector::ZERO]));
    assert!(ended.control.has_ended());

    let trap = Shape::custom(Trap(Promise::lipschitz(None, 1.0)));
    let hand = Hand::at(&[[0.0, 0.5]]);
    let (mut thread, mut driver) = start(servo(trap, 1), &hand, plain());
    hand.move_to([0.0, -0.5]);
    driver.advance(TICK);
    assert!(thread.control().has_ended());
    let ended = thread.join();
    assert_eq!(
        ended.report.ending,
        Ending::Panicked { message: "the trap snapped".to_owned() }
    );
    assert_eq!(hand.last_forces(), [Vector::ZERO]);
}

#[test]
fn what_cannot_run_is_refused() {
    let two = Box::new(Hand::at(&[[0.0, 0.0], [1.0, 0.0]]));
    let error = ServoThread::start(servo(floor(0.0), 1), two, plain()).unwrap_err();
    let refused = HapticsError::ContactPoints { servo: 1, device: 2 };
    assert_eq!(error, StartError::Haptics(refused));
    let one = Box::new(Hand::at(&[[0.0, 0.0]]));
    let options = ThreadOptions { duration: Some(-1.0), ..plain() };
    let error = ServoThread::start(servo(floor(0.0), 1), one, options).unwrap_err();
    assert_eq!(error.to_string(), "duration must be zero or more and finite, got -1 s");
}

#[test]
fn a_thread_on_the_clock_of_the_machine_runs_and_ends() {
    let hand = Hand::at(&[[0.0, -0.001]]);
    let options = ThreadOptions::default();
    let thread = ServoThread::start(servo(floor(0.0), 1), Box::new(hand.clone()), options);
    let mut thread = thread.unwrap();
    // Waits for a hundred ticks, however long they take.
    while thread.control().latest().is_none_or(|snapshot| snapshot.progress.ticks < 100) {
        std::thread::yield_now();
    }
    let ended = thread.end();
    assert_eq!(ended.report.ending, Ending::Finished);
    assert!(ended.report.ticks >= 100 && ended.priority != Priority::Normal);
    assert_eq!(hand.last_forces(), [Vector::ZERO]);
}
