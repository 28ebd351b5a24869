// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Edits that arrive together, from one thread to another that frees nothing.

use std::fmt;
use std::sync::Arc;

use crate::place::Place;

/// A box of edits, as an [`EditReceiver`] takes it.
#[derive(Default)]
pub struct Parcel<T> {
    /// The edits.
    pub content: T,
    /// The box that was returned before this one.
    below: Option<Box<Parcel<T>>>,
}

struct Channel<T> {
    /// Sent, but not yet taken.
    inbox: Place<Parcel<T>>,
    /// Taken and returned: a stack with the last one on top.
    returned: Place<Parcel<T>>,
}

/// The sending end of an [`edit_channel`].
pub struct EditSender<T: Send> {
    channel: Arc<Channel<T>>,
    /// A returned box to reuse.
    spare: Option<Box<Parcel<T>>>,
}

/// The receiving end of an [`edit_channel`]. It returns every box to the sender, so it allocates
/// and frees nothing.
pub struct EditReceiver<T: Send> {
    channel: Arc<Channel<T>>,
}

/// The two ends of a channel for edits, for two threads that never wait for each other. Edits that
/// were not taken yet are edited further, so that the receiver gets all of them at once or none.
///
/// ```
/// use palpate_device::edit_channel;
///
/// let (mut sender, mut receiver) = edit_channel::<Vec<u32>>();
/// sender.edit(|numbers| numbers.push(3));
/// sender.edit(|numbers| numbers.push(7));
/// // In the thread that must not wait:
/// let parcel = receiver.take().ok_or("there are edits")?;
/// assert_eq!(parcel.content, [3, 7]);
/// receiver.give_back(parcel);
/// // In the sender's thread, which frees what came back:
/// sender.collect(|numbers| numbers.clear());
/// # Ok::<(), &str>(())
/// ```
#[must_use]
pub fn edit_channel<T: Send>() -> (EditSender<T>, EditReceiver<T>) {
    let (inbox, returned) = (Place::holding(None), Place::holding(None));
    let channel = Arc::new(Channel { inbox, returned });
    (EditSender { channel: channel.clone(), spare: None }, EditReceiver { channel })
}

impl<T: Default + Send> EditSender<T> {
    /// Edits what the receiver takes next.
    pub fn edit(&mut self, edit: impl FnOnce(&mut T)) {
        let unseen = self.channel.inbox.exchange(None);
        let mut parcel = unseen.or_else(|| self.spare.take()).unwrap_or_default();
        edit(&mut parcel.content);
        // Only the sender fills the inbox, so the exchange returns `None`.
        self.channel.inbox.exchange(Some(parcel));
    }

    /// Calls `look` for every returned box, the last first, and keeps one box for reuse, with
    /// the content that `look` leaves in it.
    pub fn collect(&mut self, mut look: impl FnMut(&mut T)) {
        let mut top = self.channel.returned.exchange(None);
        while let Some(mut parcel) = top {
            top = parcel.below.take();
            look(&mut parcel.content);
            self.spare = Some(parcel);
        }
    }
}

impl<T: Send> EditReceiver<T> {
    /// Takes all edits since the last call.
    ///
    /// Real-time: allocates nothing, frees nothing, takes no lock, cannot panic.
    #[must_use]
    pub fn take(&mut self) -> Option<Box<Parcel<T>>> {
        self.channel.inbox.exchange(None)
    }

    /// Returns a box to the sender, with content that the sender must drop.
    ///
    /// Real-time: allocates nothing, frees nothing, takes no lock, cannot panic.
    pub fn give_back(&mut self, mut parcel: Box<Parcel<T>>) {
        parcel.below = self.channel.returned.exchange(None);
        // Only the receiver fills this place and it is empty now, so the exchange returns
        // `None` and frees nothing.
        self.channel.returned.exchange(Some(parcel));
    }
}

impl<T> fmt::Debug for Parcel<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Parcel").finish_non_exhaustive()
    }
}

impl<T: Send> fmt::Debug for EditSender<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("EditSender").finish_non_exhaustive()
    }
}

impl<T: Send> fmt::Debug for EditReceiver<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("EditReceiver").finish_non_exhaustive()
    }
}

#[cfg(test)]
#[expect(clippy::indexing_slicing, reason = "an index is within its list")]
mod tests {
    use loom::sync::atomic::{AtomicUsize, Ordering};
    use loom::thread;

    use super::*;

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
        receiver: EditReceiver<Edits>,
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
    fn collect(sender: &mut EditSender<Edits>, names: &mut Vec<u32>) {
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
            let (mut sender, receiver) = edit_channel::<Edits>();
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
            assert!(
                servo.poses.windows(2).all(|pair| pair[0].1 < pair[1].1),
                "{:?}",
                servo.poses
            );
            for (scene, poses) in &servo.poses {
                assert_eq!((poses[0], poses[1]), (scene + 1, scene + 1));
            }
            // Scene 0 came back in any case, and scene 1 came back or was never taken.
            assert!(dropped == [0, 1] || dropped == [101, 0], "{dropped:?}");
            assert_eq!(alive.load(Ordering::Relaxed), 1);
            servo.scene.servo = None;
        });
    }
}
