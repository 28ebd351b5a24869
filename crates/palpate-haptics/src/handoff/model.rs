// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Model checking of the exchanges in every interleaving of two threads, by loom.

use std::sync::Arc;

use loom::sync::Mutex;
use loom::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use loom::thread;

use super::exchange::{Flag, Medium, Place, Receiver, Sender, edit_channel, latest};

/// Atomic operations whose interleavings loom explores.
struct Model;

impl Medium for Model {
    type Place<T: Send> = Mutex<Option<Box<T>>>;
    type Flag = ModelFlag;
}

/// One atomic step, like the machine's exchange of a pointer.
impl<T: Send> Place<T> for Mutex<Option<Box<T>>> {
    fn holding(content: Option<Box<T>>) -> Self {
        Self::new(content)
    }

    fn exchange(&self, content: Option<Box<T>>) -> Option<Box<T>> {
        std::mem::replace(&mut *self.lock().unwrap(), content)
    }
}

struct ModelFlag(AtomicBool);

impl Default for ModelFlag {
    fn default() -> Self {
        Self(AtomicBool::new(false))
    }
}

impl Flag for ModelFlag {
    fn set(&self, is_set: bool) {
        self.0.store(is_set, Ordering::Release);
    }

    fn is_set(&self) -> bool {
        self.0.load(Ordering::Acquire)
    }
}

#[test]
fn readers_see_the_latest_whole_and_in_order() {
    loom::model(|| {
        let (mut writer, mut reader) = latest::<_, Model>([0_u32; 2]);
        let writing = thread::spawn(move || {
            for number in 1..=4 {
                writer.publish(|value| value.fill(number));
            }
        });
        let mut before = 0;
        for _ in 0..3 {
            let [a, b] = reader.latest().copied().unwrap_or_default();
            assert!(a == b && a >= before, "{a} {b} after {before}");
            before = a;
        }
        writing.join().unwrap();
        assert_eq!(reader.latest(), Some(&[4, 4]));
        assert_eq!(reader.latest(), Some(&[4, 4]));
    });
}

/// A scene that counts live instances and checks the thread on which it is dropped.
#[derive(Debug)]
struct Scene {
    name: u32,
    alive: Arc<AtomicUsize>,
    servo: Option<thread::ThreadId>,
}

impl Scene {
    fn new(name: u32, alive: &Arc<AtomicUsize>) -> Self {
        alive.fetch_add(1, Ordering::Relaxed);
        Self { name, alive: alive.clone(), servo: None }
    }
}

impl Drop for Scene {
    fn drop(&mut self) {
        self.alive.fetch_sub(1, Ordering::Relaxed);
        assert_ne!(self.servo, Some(thread::current().id()), "freed by the servo");
    }
}

/// Edits in the model: a scene, and two poses that belong together.
#[derive(Debug, Default)]
struct Edits {
    scene: Option<Scene>,
    poses: Option<[u32; 2]>,
}

/// A servo that starts with scene 0 and records the poses and scenes that it receives.
struct ModelServo {
    receiver: Receiver<Edits, Model>,
    scene: Scene,
    poses: Vec<(u32, [u32; 2])>,
}

impl ModelServo {
    fn tick(&mut self) {
        let Some(mut parcel) = self.receiver.take() else { return };
        let edits = &mut parcel.content;
        if let Some(mut scene) = edits.scene.take() {
            scene.servo = Some(thread::current().id());
            edits.scene = Some(std::mem::replace(&mut self.scene, scene));
        }
        self.poses.extend(edits.poses.map(|poses| (self.scene.name, poses)));
        self.receiver.give_back(parcel);
    }
}

/// Drops returned edits and records the names of their scenes.
fn collect(sender: &mut Sender<Edits, Model>, names: &mut Vec<u32>) {
    let mut scenes = Vec::new();
    sender.collect(|edits| {
        edits.poses = None;
        scenes.extend(edits.scene.take());
    });
    names.extend(scenes.iter().rev().map(|scene| scene.name));
}

#[test]
fn edits_arrive_whole_in_order_and_scenes_come_back_once() {
    loom::model(|| {
        let alive = Arc::new(AtomicUsize::new(0));
        let (mut sender, receiver) = edit_channel::<Edits, Model>();
        let scene = Scene::new(0, &alive);
        let mut servo = ModelServo { receiver, scene, poses: Vec::new() };
        let ticking = thread::spawn(move || {
            servo.tick();
            servo.tick();
            servo
        });
        let mut dropped = Vec::new();
        // Poses of the old scene, a new scene with its own, and once more.
        sender.edit(|edits| edits.poses = Some([1, 1]));
        sender.edit(|edits| {
            let scene = Some(Scene::new(1, &alive));
            *edits = Edits { scene, poses: Some([2, 2]) };
        });
        collect(&mut sender, &mut dropped);
        sender.edit(|edits| {
            dropped.extend(edits.scene.take().map(|scene| scene.name + 100));
            *edits = Edits { scene: Some(Scene::new(2, &alive)), poses: Some([3, 3]) };
        });
        let mut servo = ticking.join().unwrap();
        servo.tick();
        collect(&mut sender, &mut dropped);

        // The latest scene is rendered, no edit arrived twice, and poses arrived with their own
        // scene.
        assert_eq!(servo.scene.name, 2);
        assert_eq!(servo.poses.last(), Some(&(2, [3, 3])));
        assert!(servo.poses.windows(2).all(|pair| pair[0].1 < pair[1].1), "{:?}", servo.poses);
        for (scene, poses) in &servo.poses {
            assert_eq!((poses[0], poses[1]), (scene + 1, scene + 1));
        }
        // Scene 0 came back in any case, and scene 1 came back or was never taken.
        assert!(dropped == [0, 1] || dropped == [101, 0], "{dropped:?}");
        assert_eq!(alive.load(Ordering::Relaxed), 1);
        servo.scene.servo = None;
    });
}

#[test]
fn a_flag_that_is_seen_brings_what_was_done_before_it() {
    loom::model(|| {
        let flag = Arc::new(ModelFlag::default());
        let done = Arc::new(AtomicUsize::new(0));
        let setting = {
            let (flag, done) = (flag.clone(), done.clone());
            thread::spawn(move || {
                done.store(1, Ordering::Relaxed);
                flag.set(true);
            })
        };
        if flag.is_set() {
            assert_eq!(done.load(Ordering::Relaxed), 1);
        }
        setting.join().unwrap();
        assert!(flag.is_set());
    });
}
