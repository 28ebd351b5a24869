// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! `palpate live`: serves the live page.

use std::fs::OpenOptions;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::{ErrorKind, Write};
use std::net::IpAddr;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, Instant};

use clap::Args;
use palpate::scene::read_file;
use palpate_live::{Live, LiveError};

use crate::arguments::numbers::{count, within};
use crate::arguments::{ProfileChoice, Reading};
use crate::input;
use crate::interrupt::Interrupt;
use crate::outcome::{Failure, Outcome};
use crate::output::{self, shown};

/// How often the program looks whether it is to end.
const LOOK: Duration = Duration::from_millis(50);

/// How long a page may be gone, as while it is loaded again.
const AWAY: Duration = Duration::from_secs(3);

/// How long edits that wait may take when the program ends.
const SETTLING: Duration = Duration::from_secs(1);

/// The largest file of a port and a token [bytes].
const LONGEST_TOKEN: u64 = 4096;

/// The contact points of the hand on the built-in gallery: two hands.
const FINGERS: usize = 10;

pub(crate) fn run(options: &LiveOptions, interrupt: &Interrupt) -> Result<Outcome, Failure> {
    // An error of the scene is reported as by every command, before anything is served.
    input::scene(options.scene.as_deref(), options.reading)?;
    let (name, text) = input::scene_text(options.scene.as_deref(), options.reading)?;
    let points = options.points.unwrap_or(if options.scene.is_none() { FINGERS } else { 1 });
    let served = palpate_live::LiveOptions {
        points,
        rate: options.rate,
        stop: interrupt.stop_switch(),
        device: options.device.as_ref().map(|device| device.profile.clone()),
        ..palpate_live::LiveOptions::default()
    };
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
            options.token = Some(token.clone());
        }
        if let Some(address) = asked.bind {
            options.address = address;
        }
        let start = |port| {
            let options = palpate_live::LiveOptions { port, ..options.clone() };
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
    let (name, text) = input::gallery();
    let options = palpate_live::LiveOptions {
        points: FINGERS,
        rate,
        stop: interrupt.stop_switch(),
        ..palpate_live::LiveOptions::default()
    };
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

/// The most contact points of a hand.
const MOST_POINTS: usize = 100;

pub(crate) const EXAMPLES: &str = "\
Examples:
  palpate live
  palpate live scenes/memoir_star.json
  palpate live scenes/cup.json --port 8000
  palpate live scenes/cup.json --device virtuose --points 10

The page is for this machine alone, and for who knows the token in its address. To reach it from
another machine, forward its port: ssh -L 8000:127.0.0.1:8000 NAME";

/// The options of `palpate live`.
#[derive(Args, Debug)]
pub(crate) struct LiveOptions {
    /// The scene file, which is watched, and can be saved; the built-in gallery if left out.
    pub(crate) scene: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) page: PageOptions,
    /// The device that is simulated: a name of `palpate devices`, or a JSON file as `palpate
    /// identify` writes it; omega if left out.
    #[arg(long, value_name = "DEVICE")]
    pub(crate) device: Option<ProfileChoice>,
    /// The contact points of the hand, where the scene's tool does not say how many; 10 on the
    /// built-in gallery, or else 1, if left out.
    #[arg(long, allow_negative_numbers = true, value_parser = count(1, MOST_POINTS))]
    pub(crate) points: Option<usize>,
    /// Ticks a second [Hz].
    #[arg(long, allow_negative_numbers = true, default_value = "1000", value_parser = within(1.0, 100_000.0, "Hz"))]
    pub(crate) rate: f64,
    #[command(flatten)]
    pub(crate) reading: Reading,
}

/// Where the page is served.
#[derive(Args, Clone, Debug, Default, PartialEq)]
pub(crate) struct PageOptions {
    /// The port of the page; that of the scene's last run, or else any that is free, if left out.
    #[arg(long)]
    pub(crate) port: Option<u16>,
    /// Serve the page on this address, so that other machines reach it. The connection is not
    /// encrypted: anyone who can read the network can move the hand. Default: this machine alone.
    #[arg(long, value_name = "ADDRESS")]
    pub(crate) bind: Option<IpAddr>,
    /// A file with the token of the page, 32 hexadecimal digits; written if it does not exist.
    #[arg(long, value_name = "FILE")]
    pub(crate) token_file: Option<PathBuf>,
}

/// Where a page is to be served.
#[derive(Debug)]
struct Place {
    port: Option<u16>,
    token: Option<String>,
    /// Where port and token are written.
    memory: Memory,
}

#[derive(Debug)]
enum Memory {
    /// A file of the command line: the token alone.
    Token(PathBuf),
    /// The user's own: port and token.
    Last(PathBuf),
    /// None: a new token for each run.
    None,
}

impl Place {
    /// Each scene has its own file of port and token, so that programs which are started in another
    /// order keep theirs.
    fn of(asked: &PageOptions, scene: Option<&Path>) -> Result<Self, Failure> {
        if let Some(file) = &asked.token_file {
            let token = match read_file(file, LONGEST_TOKEN) {
                Ok(text) => Some(String::from_utf8_lossy(&text).trim().to_owned()),
                Err(error) if error.kind() == ErrorKind::NotFound => None,
                Err(error) => return Err(Failure::file(file, error)),
            };
            return Ok(Self { port: None, token, memory: Memory::Token(file.clone()) });
        }
        let Some(folder) = dirs::runtime_dir().or_else(dirs::cache_dir) else {
            return Ok(Self { port: None, token: None, memory: Memory::None });
        };
        let name = scene.map_or_else(|| "page".to_owned(), name_for);
        let file = folder.join("palpate").join(name);
        // A damaged file counts as missing.
        let text = read_file(&file, LONGEST_TOKEN).unwrap_or_default();
        let text = String::from_utf8_lossy(&text);
        let (port, token) = text.trim().split_once(' ').unzip();
        let port = port.and_then(|port| port.parse().ok());
        let is_token =
            |token: &&str| token.len() == 32 && token.bytes().all(|b| b.is_ascii_hexdigit());
        let token = token.filter(is_token).map(str::to_owned);
        Ok(Self { port, token, memory: Memory::Last(file) })
    }

    /// Keeps where the page is, for the next run.
    fn remember(&self, live: &Live) -> Result<(), Failure> {
        match &self.memory {
            Memory::Token(file) if self.token.is_none() => {
                let written = write(file, live.token());
                written.map_err(|error| Failure::file(file, error))
            }
            // The port of the last run stays that of the program which has it, or of a run without --port.
            Memory::Last(_) if self.port.is_some_and(|port| port != live.address().port()) => {
                Ok(())
            }
            Memory::Last(file) => {
                let folder = file.parent().map_or(Ok(()), std::fs::create_dir_all);
                let text = format!("{} {}", live.address().port(), live.token());
                // Without it, an open page does not find the next run, and no more.
                let _ = folder.and_then(|()| write(file, &text));
                Ok(())
            }
            Memory::Token(file) => {
                warn_of_readers(file);
                Ok(())
            }
            Memory::None => Ok(()),
        }
    }
}

/// The name of the file for a scene, of its path.
fn name_for(scene: &Path) -> String {
    let mut hasher = DefaultHasher::new();
    scene.canonicalize().unwrap_or_else(|_| scene.to_owned()).hash(&mut hasher);
    format!("page-{:016x}", hasher.finish())
}

/// Warns of a file with a token that others can read.
fn warn_of_readers(file: &Path) {
    #[cfg(unix)]
    if let Ok(metadata) = std::fs::metadata(file)
        && std::os::unix::fs::MetadataExt::mode(&metadata) & 0o077 != 0
    {
        let file = file.display();
        output::remark(format_args!(
            "warning: others on this machine can read {file}, and with it move the hand: chmod 600 {file}"
        ));
    }
    #[cfg(not(unix))]
    let _ = file;
}

/// Writes a file that only its owner can read.
fn write(file: &Path, text: &str) -> std::io::Result<()> {
    let mut options = OpenOptions::new();
    options.write(true).create(true).truncate(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    let mut opened = options.open(file)?;
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        opened.set_permissions(std::fs::Permissions::from_mode(0o600))?;
    }
    writeln!(opened, "{text}")
}
