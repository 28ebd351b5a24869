// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The emergency stop: who pressed it, and who may release it.
//!
//! The thread that reads a stop sets it at once, by [`Stop::press`], which waits for nobody. The
//! thread that leads the hand keeps count of it afterwards, in [`Stops`].

use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};

use palpate::haptics::StopSwitch;
use tungstenite::Utf8Bytes;

use super::pages::{PageId, Pages};
use crate::wire::{Ask, Question, Told, Unreadable};

/// How long the page that pressed waits before it may release: a second tap is no release.
const OWN_WAIT: Duration = Duration::from_secs(1);

/// How long another page waits: a person first reads who stopped.
const OTHERS_WAIT: Duration = Duration::from_secs(2);

/// The emergency stop, for the threads that press it.
#[derive(Debug)]
pub(crate) struct Stop {
    switch: StopSwitch,
    presses: Sender<Press>,
}

/// A press of the stop.
#[derive(Debug)]
struct Press {
    number: u64,
    at: Instant,
    by: Presser,
}

/// How a stop came.
#[derive(Debug)]
pub(crate) enum Presser {
    /// By the socket of a page, in a message that is not read yet.
    Page(PageId, Utf8Bytes),
    /// By `POST /stop`, with the digits of the press if it gave them.
    Request(Option<String>),
}

/// What is known of the last stop.
#[derive(Debug)]
struct Last {
    number: u64,
    at: Instant,
    /// The page that pressed it, as long as its connection lasts.
    page: Option<PageId>,
    press: Option<String>,
}

/// Keeps count of the stops, tells the pages, and decides who may release.
#[derive(Debug)]
pub(super) struct Stops {
    switch: StopSwitch,
    presses: Receiver<Press>,
    last: Option<Last>,
    /// How many pages had ever been open when they were told last.
    told: u64,
}

/// Both ends of the stop.
pub(super) fn stop(switch: StopSwitch) -> (Stop, Stops) {
    let (sender, presses) = channel();
    let stops = Stops { switch: switch.clone(), presses, last: None, told: 0 };
    (Stop { switch, presses: sender }, stops)
}

impl Stop {
    /// Holds all forces at zero from the next tick on.
    ///
    /// Waits for no other thread.
    pub(crate) fn press(&self, by: Presser) {
        let number = self.switch.stop();
        // Who keeps count may have ended: the stop holds all the same.
        let _ = self.presses.send(Press { number, at: Instant::now(), by });
    }

    /// As [`press`](Self::press), by nobody who is known.
    pub(crate) fn press_unnamed(&self) {
        self.switch.stop();
    }
}

impl Stops {
    /// The switch for a servo.
    pub(super) fn switch(&self) -> StopSwitch {
        self.switch.clone()
    }

    pub(super) fn is_stopped(&self) -> bool {
        self.switch.is_stopped()
    }

    /// Takes the presses that came, and tells the pages what is new.
    pub(super) fn go_on(&mut self, now: Instant, pages: &Pages) {
        let before = self.last.as_ref().map(|last| last.number);
        while let Ok(press) = self.presses.try_recv() {
            self.take(press, pages);
        }
        let number = self.switch.stops();
        if self.last.as_ref().map_or(0, |last| last.number) < number {
            // By nobody who is known: a signal, a page that is closed, or bodies of another servo.
            self.last = Some(Last { number, at: now, page: None, press: None });
        }
        let mut is_news = self.last.as_ref().map(|last| last.number) != before;
        if let Some(last) = &mut self.last
            && last.page.is_some_and(|page| !pages.is_open(page))
        {
            last.page = None;
            is_news = true;
        }
        let ever = pages.ever();
        if is_news {
            self.tell_all(now, pages);
        } else if ever != self.told {
            for page in pages.since(self.told) {
                self.tell(page, now, pages);
            }
        }
        self.told = ever;
    }

    fn take(&mut self, press: Press, pages: &Pages) {
        let Press { number, at, by } = press;
        let (page, digits) = match by {
            Presser::Request(digits) => (None, digits),
            Presser::Page(page, text) => {
                let digits = match Question::read(&text) {
                    Ok(Question { id, ask: Ask::Stop { press } }) => {
                        pages.done(page, id);
                        press
                    }
                    Ok(_) => None,
                    Err(Unreadable { id, why }) => {
                        pages.not_read(page, id, &why);
                        None
                    }
                };
                (Some(page), digits)
            }
        };
        // A press that came both ways is the page's, whichever came first.
        let is_same =
            digits.is_some() && self.last.as_ref().is_some_and(|last| last.press == digits);
        let before = self.last.take().filter(|_| is_same).and_then(|last| last.page);
        self.last = Some(Last { number, at, page: page.or(before), press: digits });
    }

    /// Tells a page of the stop that holds.
    pub(super) fn tell(&self, page: PageId, now: Instant, pages: &Pages) {
        if let Some(last) = self.last.as_ref().filter(|_| self.is_stopped()) {
            let told = Told::Stopped {
                number: last.number,
                is_mine: last.page == Some(page),
                release_after: last.wait(page).saturating_sub(now - last.at).as_secs_f64(),
            };
            pages.send(page, told);
        }
    }

    fn tell_all(&self, now: Instant, pages: &Pages) {
        for page in pages.since(0) {
            self.tell(page, now, pages);
        }
    }

    /// Releases a stop for a page.
    ///
    /// # Errors
    ///
    /// Why it holds, in words for a person.
    pub(super) fn release(
        &mut self,
        page: PageId,
        number: Option<u64>,
        now: Instant,
        pages: &Pages,
    ) -> Result<(), String> {
        self.go_on(now, pages);
        let Some(last) = self.last.as_ref().filter(|_| self.is_stopped()) else {
            return Err("nothing is stopped".to_owned());
        };
        if number != Some(last.number) {
            return Err(
                "STOP was pressed again meanwhile: a release is for the last STOP that \
                        this page shows"
                    .to_owned(),
            );
        }
        let left = last.wait(page).saturating_sub(now - last.at);
        if !left.is_zero() {
            let who = if last.page == Some(page) { "on this page" } else { "elsewhere" };
            let left = left.as_secs_f64();
            return Err(format!("STOP was pressed {who}: it can be released in {left:.1} s"));
        }
        let number = last.number;
        if !self.switch.release_of(number) {
            return Err("STOP was pressed again in this moment".to_owned());
        }
        pages.broadcast(Told::Released { number });
        Ok(())
    }
}

impl Last {
    /// How long a page waits after this stop before it may release it.
    fn wait(&self, page: PageId) -> Duration {
        if self.page == Some(page) { OWN_WAIT } else { OTHERS_WAIT }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stage::pages::Out;

    const SECOND: Duration = Duration::from_secs(1);

    struct Scene {
        pages: Pages,
        stop: Stop,
        stops: Stops,
        start: Instant,
    }

    impl Scene {
        fn new() -> Self {
            let (stop, stops) = stop(StopSwitch::new());
            Self { pages: Pages::default(), stop, stops, start: Instant::now() }
        }

        fn pressed(&mut self, page: PageId, digits: &str) {
            let text = format!(r#"{{"do":"stop","press":"{digits}"}}"#);
            self.stop.press(Presser::Page(page, text.into()));
            self.count();
        }

        fn count(&mut self) {
            self.stops.go_on(Instant::now(), &self.pages);
        }

        /// A release after so many seconds.
        fn release(&mut self, page: PageId, number: u64, seconds: f64) -> Result<(), String> {
            let at = self.stops.last.as_ref().map_or(self.start, |last| last.at);
            let now = at + SECOND.mul_f64(seconds);
            self.stops.release(page, Some(number), now, &self.pages)
        }
    }

    #[test]
    fn the_page_that_pressed_releases_after_a_second_and_others_after_two() {
        let mut scene = Scene::new();
        let (own, _told) = scene.pages.add(2).unwrap().parts();
        let (other, mut told) = scene.pages.add(2).unwrap().parts();
        assert_eq!(scene.release(own, 0, 9.0), Err("nothing is stopped".to_owned()));
        scene.pressed(own, "aa");
        assert!(scene.release(own, 1, 0.99).is_err() && scene.release(other, 1, 1.99).is_err());
        assert!(
            scene.stops.release(own, None, scene.start + 9 * SECOND, &scene.pages).is_err()
        );
        scene.release(own, 1, 1.0).unwrap();
        assert!(!scene.stops.is_stopped());
        scene.pressed(own, "ab");
        let words = scene.release(other, 1, 9.0).unwrap_err();
        assert!(words.contains("pressed again"), "{words}");
        scene.release(other, 2, 2.0).unwrap();
        let Ok(Out::Text(first)) = told.try_recv() else { panic!("it is told") };
        assert!(
            first.contains(r#""do":"stopped","number":1,"is_mine":false,"release_after":"#),
            "{first}"
        );
        let Ok(Out::Text(next)) = told.try_recv() else { panic!("it is told") };
        assert_eq!(next.as_str(), r#"{"do":"released","number":1}"#);
    }

    #[test]
    fn another_press_makes_everybody_wait_anew() {
        let mut scene = Scene::new();
        let (own, _told) = scene.pages.add(2).unwrap().parts();
        let (other, _seen) = scene.pages.add(2).unwrap().parts();
        scene.pressed(own, "aa");
        scene.pressed(other, "bb");
        assert!(scene.release(own, 2, 1.5).is_err(), "the last press is the other's");
        scene.release(other, 2, 1.5).unwrap();
    }

    #[test]
    fn a_press_that_comes_both_ways_is_the_pages() {
        for is_request_first in [true, false] {
            let mut scene = Scene::new();
            let (own, _told) = scene.pages.add(2).unwrap().parts();
            let request = Presser::Request(Some("c0ffee".to_owned()));
            if is_request_first {
                scene.stop.press(request);
                scene.count();
                scene.pressed(own, "c0ffee");
            } else {
                scene.pressed(own, "c0ffee");
                scene.stop.press(request);
                scene.count();
            }
            scene.release(own, 2, 1.0).unwrap();
            // A request alone belongs to no page.
            scene.stop.press(Presser::Request(None));
            scene.count();
            assert!(scene.release(own, 3, 1.5).is_err());
            scene.release(own, 3, 2.0).unwrap();
        }
    }

    #[test]
    fn a_stop_of_a_closed_page_makes_all_pages_wait_two_seconds() {
        let mut scene = Scene::new();
        let (own, _told) = scene.pages.add(2).unwrap().parts();
        let (other, mut told) = scene.pages.add(2).unwrap().parts();
        scene.pressed(own, "aa");
        scene.pages.remove(own);
        scene.count();
        assert!(scene.release(other, 1, 1.5).is_err());
        // The other page hears of the press, then that the pressing page has gone. A late page hears of the stop that holds.
        let (late, mut seen) = scene.pages.add(2).unwrap().parts();
        scene.count();
        let count = |told: &mut tokio::sync::mpsc::Receiver<Out>| {
            (0..).take_while(|_| told.try_recv().is_ok()).count()
        };
        assert_eq!((count(&mut told), count(&mut seen)), (2, 1));
        scene.release(late, 1, 2.0).unwrap();
    }

    #[test]
    fn the_program_stops_by_its_switch() {
        let mut scene = Scene::new();
        let (page, _told) = scene.pages.add(1).unwrap().parts();
        scene.stops.switch().stop();
        scene.count();
        assert!(scene.release(page, 1, 1.9).is_err());
        scene.release(page, 1, 2.0).unwrap();
    }
}
