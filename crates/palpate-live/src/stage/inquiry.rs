// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The threads that answer questions about the scene: of a page one long question at a time, and one
//! short one, so that long questions keep neither the pointer of their page waiting nor other pages.

use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

use palpate::field::Vector;
use palpate::render::{Camera, Lens, Settings, Shadows, SrgbColor, Subject, render};
use palpate::scene::{AnyScene, BuiltScene};

use super::Shared;
use super::pages::{Out, PageId, Pages, Received, Work, point_of};
use super::questions::{Answer, CANCELLED, Cancel, answer};
use crate::wire::{Ask, Unreadable, picture};

/// The threads, beside those of the servo, of the hand and of the editor.
const THREADS: usize = 3;

/// The questions of a page that may wait: more are refused.
const WAITING: usize = 32;

/// The most pixels along a side of a picture.
const LARGEST: u32 = 2048;

/// The questions that wait for an answer.
#[derive(Debug, Default)]
pub(super) struct Inquiries {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct State {
    waiting: VecDeque<Asked>,
    working: Vec<Working>,
    has_ended: bool,
}

/// A question that waits. It is read when its turn comes.
#[derive(Debug)]
pub(super) struct Asked {
    pub(super) message: Received,
    pub(super) id: Option<u32>,
    /// Whether its answer takes no time that a person notices.
    pub(super) is_short: bool,
}

/// A question that is worked on.
#[derive(Debug)]
struct Working {
    page: PageId,
    id: Option<u32>,
    is_short: bool,
    cancel: Cancel,
}

impl Inquiries {
    // The state is valid even if a thread panicked while it held the lock.
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Begins to answer.
    pub(super) fn start(self: &Arc<Self>, shared: &Shared) {
        for _ in 0..THREADS {
            let (inquiries, shared) = (Arc::clone(self), shared.clone());
            // It ends with the stage; nothing waits for what it still does.
            std::thread::spawn(move || inquiries.run(&shared));
        }
    }

    /// Takes a question; whether there is no room for it.
    pub(super) fn take(&self, asked: Asked) -> bool {
        let mut state = self.state();
        let page = asked.message.page;
        let is_full =
            state.waiting.iter().filter(|other| other.message.page == page).count() >= WAITING;
        if !is_full {
            state.waiting.push_back(asked);
            self.changed.notify_one();
        }
        is_full
    }

    /// Ends a question, whether it waits or is worked on; whether there is one of this number.
    pub(super) fn cancel(&self, page: PageId, id: u32, pages: &Pages) -> bool {
        let mut state = self.state();
        let is_it = |asked: &Asked| asked.message.page == page && asked.id == Some(id);
        if let Some(place) = state.waiting.iter().position(is_it) {
            state.waiting.remove(place);
            pages.refuse(page, Some(id), CANCELLED, &[]);
            return true;
        }
        let work = state.working.iter().find(|work| work.page == page && work.id == Some(id));
        work.map(|work| work.cancel.set()).is_some()
    }

    /// Forgets the questions of pages that are closed.
    pub(super) fn forget_closed(&self, pages: &Pages) {
        let mut state = self.state();
        state.waiting.retain(|asked| pages.is_open(asked.message.page));
        let closed = state.working.iter().filter(|work| !pages.is_open(work.page));
        closed.for_each(|work| work.cancel.set());
    }

    /// Ends the threads.
    pub(super) fn end(&self) {
        let mut state = self.state();
        state.has_ended = true;
        state.working.iter().for_each(|work| work.cancel.set());
        self.changed.notify_all();
    }

    fn run(&self, Shared { pages, shown, watch, .. }: &Shared) {
        while let Some((Asked { message, id, .. }, cancel)) = self.next() {
            let page = message.page;
            let _done = Done { inquiries: self, cancel: &cancel };
            watch.begins(Work::Question);
            let question = message.read();
            drop(message);
            let (question, scene) = match (question, shown.get()) {
                (Ok(question), Some(scene)) => (question, scene),
                (Ok(_), None) => {
                    pages.refuse(page, id, "there is no scene yet: say hello first", &[]);
                    continue;
                }
                (Err(Unreadable { id, why }), _) => {
                    pages.not_read(page, id, &why);
                    continue;
                }
            };
            let (scene, revision) = scene;
            match answered(&scene, &question.ask, id, &cancel) {
                // Nobody knows an answer without a number.
                Ok(Answer::Text(text)) if id.is_some() => {
                    pages.send(page, Out::Text(text.into()));
                }
                Ok(Answer::Text(_)) => {}
                Ok(Answer::Grid(grid)) => {
                    let bytes = grid.bytes(id.unwrap_or_default(), revision);
                    pages.send(page, Out::Binary(bytes));
                }
                Ok(Answer::Picture(png)) => {
                    let bytes = picture(id.unwrap_or_default(), revision, &png);
                    pages.send(page, Out::Binary(bytes));
                }
                Err(why) => pages.refuse(page, id, &why, &[]),
            }
        }
    }

    /// Waits for a question whose page has no other of its kind, short or long, in work; `None` at the
    /// end.
    fn next(&self) -> Option<(Asked, Cancel)> {
        let mut state = self.state();
        loop {
            if state.has_ended {
                return None;
            }
            let State { waiting, working, .. } = &mut *state;
            let long = working.iter().filter(|work| !work.is_short).count();
            let is_free = |asked: &Asked| {
                // One thread is left to short questions.
                (asked.is_short || long + 1 < THREADS)
                    && working.iter().all(|work| {
                        work.page != asked.message.page || work.is_short != asked.is_short
                    })
            };
            if let Some(place) = waiting.iter().position(is_free)
                && let Some(asked) = waiting.remove(place)
            {
                let cancel = Cancel::default();
                let (page, id, is_short) = (asked.message.page, asked.id, asked.is_short);
                working.push(Working { page, id, is_short, cancel: cancel.clone() });
                return Some((asked, cancel));
            }
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }
}

/// Takes a question off those that are worked on, when it is answered, and if answering it panics too.
struct Done<'a> {
    inquiries: &'a Inquiries,
    cancel: &'a Cancel,
}

impl Drop for Done<'_> {
    fn drop(&mut self) {
        self.inquiries.state().working.retain(|work| !work.cancel.is(self.cancel));
        // A question of the same page may wait.
        self.inquiries.changed.notify_all();
    }
}

/// The answer to a question, without the servo, if it is one in text.
#[cfg(any(test, feature = "fuzzing"))]
pub(crate) fn answer_alone(scene: &AnyScene, ask: &Ask) -> Option<String> {
    match answered(scene, ask, None, &Cancel::default()) {
        Ok(Answer::Text(text)) => Some(text),
        _ => None,
    }
}

fn answered(
    scene: &AnyScene,
    ask: &Ask,
    id: Option<u32>,
    cancel: &Cancel,
) -> Result<Answer, String> {
    match (scene, ask) {
        (AnyScene::Spatial(scene), Ask::Picture { .. }) => drawn(scene, ask, cancel),
        (AnyScene::Planar(_), Ask::Picture { .. }) => {
            Err("a scene in the plane is drawn from samples".to_owned())
        }
        (AnyScene::Planar(scene), ask) => answer(scene, ask, id, cancel),
        (AnyScene::Spatial(scene), ask) => answer(scene, ask, id, cancel),
    }
}

/// The scene as `palpate render` draws it, without shadows.
fn drawn(scene: &BuiltScene<3>, ask: &Ask, cancel: &Cancel) -> Result<Answer, String> {
    let Ask::Picture { eye, target, field_of_view, width, height } = ask else {
        return Err("not about a picture".to_owned());
    };
    if !(1..=LARGEST).contains(width) || !(1..=LARGEST).contains(height) {
        return Err(format!(
            "a picture has 1 to {LARGEST} pixels along a side, got {width} × {height}"
        ));
    }
    let said = |error: palpate::render::RenderError| error.to_string();
    let body =
        |(number, body): (usize, &palpate::scene::BuiltBody<3>)| palpate::render::LitBody {
            shape: body.shape.clone(),
            color: SrgbColor::of_body(number),
        };
    let subject = Subject::new(scene.bodies.iter().enumerate().map(body).collect());
    let subject = subject.map_err(said)?;
    let (eye, target): (Vector<f64, 3>, _) = (point_of(eye)?, point_of(target)?);
    let camera = Camera::looking(eye, target, Lens::Perspective(*field_of_view));
    let camera = camera.map_err(said)?;
    let settings =
        Settings { samples: 2, shadows: Shadows::None, ..Settings::new(*width, *height) };
    let drawn = render(&subject, &camera, &settings, &|_| !cancel.is_set()).map_err(said)?;
    let drawn = drawn.ok_or(CANCELLED)?;
    let mut png = Vec::new();
    drawn.image.write_png(&mut png).map_err(said)?;
    Ok(Answer::Picture(png))
}
