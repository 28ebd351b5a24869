// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate live`: serves a page on which a scene is seen, touched, edited and measured.

mod place;

use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, Instant};

use palpate_live::{Live, LiveError};

use crate::arguments::{LiveOptions, PageOptions};
use crate::input;
use crate::interrupt::Interrupt;
use crate::outcome::{Failure, Outcome};
use crate::output::{self, shown};
use place::Place;

/// How often the program looks whether it is to end.
const LOOK: Duration = Duration::from_millis(50);

/// How long a page may be gone, as while it is loaded again.
const AWAY: Duration = Duration::from_secs(3);

/// How long edits that wait may take when the program ends.
const SETTLING: Duration = Duration::from_secs(1);

/// The contact points of the hand on the built-in gallery: two hands.
const FINGERS: usize = 10;

pub(crate) fn run(options: &LiveOptions, interrupt: &Interrupt) -> Result<Outcome, Failure> {
    // An error of the scene is reported as by every command, before anything is served.
    input::scene(options.scene.as_deref())?;
    let (name, text) = input::scene_text(options.scene.as_deref())?;
    let points = options.points.unwrap_or(if options.scene.is_none() { FINGERS } else { 1 });
    let mut served = palpate_live::LiveOptions::default()
        .with_points(points)
        .with_rate(options.rate)
        .with_stop_switch(interrupt.stop_switch());
    if let Some(device) = &options.device {
        served = served.with_device(device.profile.clone());
    }
    let short = options.scene.as_deref().and_then(Path::file_name);
    let name = short.map_or(name, |short| short.to_string_lossy().into_owned());
    let live =
        Page { name, file: options.scene.clone(), text }.served(&options.page, served)?;
    output::remark(format_args!("live at {}", live.url()));
    output::remark("open this address in a browser; Ctrl-C ends the program");
    interrupt.heed();
    while !interrupt.is_asked() {
        thread::sleep(LOOK);
    }
    Served(Some(live)).end()?;
    Ok(Outcome::Yes)
}

/// A page that is served, whose edits are kept however the command ends.
#[derive(Debug)]
pub(crate) struct Served(Option<Live>);

impl Served {
    /// Ends all forces, and then keeps the edits that are not saved.
    fn end(mut self) -> Result<(), Failure> {
        self.0.take().map_or(Ok(()), keep_edits)
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        if let Some(Err(failure)) = self.0.take().map(keep_edits) {
            output::remark(format_args!("{failure}"));
        }
    }
}

fn keep_edits(live: Live) -> Result<(), Failure> {
    live.stop_switch().stop();
    let unsaved = live.unsaved(SETTLING);
    // Its connections may hold all file descriptors that there are.
    drop(live);
    let Some(unsaved) = unsaved else { return Ok(()) };
    let kept = unsaved.keep().map_err(|error| Failure::input(shown(&error.to_string())))?;
    let kept = kept.display().to_string();
    output::remark(format_args!("edits that were not saved are kept in {}", shown(&kept)));
    Ok(())
}

/// What a page shows first.
struct Page {
    name: String,
    file: Option<PathBuf>,
    text: String,
}

impl Page {
    fn served(
        self,
        asked: &PageOptions,
        options: palpate_live::LiveOptions,
    ) -> Result<Live, Failure> {
        let place = Place::of(asked, self.file.as_deref())?;
        if let Some(address) = asked.bind.filter(|address| !address.is_loopback()) {
            output::remark(format_args!(
                "warning: {address} is reached from other machines, and nothing is encrypted: who can read \
                 the network can read the token, and move the hand. Better forward a port: \
                 ssh -L 8000:127.0.0.1:8000 NAME"
            ));
        }
        let mut options = options;
        if let Some(token) = &place.token {
            options = options.with_token(token.as_str());
        }
        if let Some(address) = asked.bind {
            options = options.with_address(address);
        }
        let start = |port| {
            let options = options.clone().with_port(port);
            Live::start(self.name.as_str(), self.file.clone(), &self.text, options)
        };
        let live = match (asked.port, place.port) {
            (Some(port), _) => start(port),
            // The port of the last run, at which a page may still wait, unless it is taken.
            (None, Some(port)) => match start(port) {
                Err(LiveError::Address { .. }) => start(0),
                live => live,
            },
            (None, None) => start(0),
        };
        let live = live.map_err(|error| Failure::input(shown(&error.to_string())))?;
        place.remember(&live)?;
        Ok(live)
    }
}

/// The page of the built-in gallery, beside a run that feels it; `None` where it cannot be served,
/// which is said and ends no run.
pub(crate) fn beside(
    asked: &PageOptions,
    rate: f64,
    interrupt: &Interrupt,
) -> Result<Option<Served>, Failure> {
    let (name, text) = input::scene_text(None)?;
    let options = palpate_live::LiveOptions::default()
        .with_points(FINGERS)
        .with_rate(rate)
        .with_stop_switch(interrupt.stop_switch());
    match (Page { name, file: None, text }).served(asked, options) {
        Ok(live) => {
            output::remark(format_args!("live at {}", live.url()));
            Ok(Some(Served(Some(live))))
        }
        Err(failure) if *asked == PageOptions::default() => {
            output::remark(format_args!("without a page: {failure}"));
            Ok(None)
        }
        Err(failure) => Err(failure),
    }
}

/// Waits until all pages are closed, or the program is asked to end.
pub(crate) fn until_closed(served: &Served, interrupt: &Interrupt) {
    let Some(live) = &served.0 else { return };
    if live.pages() > 0 {
        output::remark("a page is open: the program stays until it is closed, or Ctrl-C");
    }
    let mut seen = Instant::now();
    let was_opened = live.was_opened();
    while was_opened && !interrupt.is_asked() && seen.elapsed() < AWAY {
        if live.pages() > 0 {
            seen = Instant::now();
        }
        thread::sleep(LOOK);
    }
}
