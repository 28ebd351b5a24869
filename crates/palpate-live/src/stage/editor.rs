// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The thread that edits and builds the scene.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::time::{Duration, Instant, SystemTime};

use palpate::field::catalogue::Entry;
use palpate::field::operator::Operator;
use palpate::haptics::Material;
use palpate::scene::{AnyScene, Scene, described_primitive, schema};
use serde_json::{Map, Value};

use super::described::{Drawing, described};
use super::document::{Document, Refusal};
use super::file::read_file;
use super::hand::tour;
use super::pages::{PageId, Pages, Received, Watch, Work};
use super::performance::{Changed, Order, Showing};
use super::room::Terms;
use super::unsaved::LatestScene;
use super::{Shared, Shown};
use crate::wire::{
    About, Ask, By, Change, DeviceTold, First, OperatorTold, Part, Question, SceneTold, Told,
    Unreadable, VERSION,
};

/// How often the file of the scene is looked at.
const LOOK: Duration = Duration::from_millis(500);

/// After so many looks in vain a file is gone: one that is being replaced is there again by then.
const MISSES_UNTIL_TOLD: u32 = 2;

/// The most tours that are searched at once: of a steep scene one takes minutes.
const MOST_SEARCHES: usize = 3;

/// What the thread is asked to do.
#[derive(Debug)]
pub(super) enum Edit {
    /// What a page asks for, which is not read yet.
    Asked(Received),
    /// To say when all that came before is done.
    Settle(SyncSender<()>),
}

/// The state of the thread.
#[derive(Debug)]
pub(super) struct Editor {
    document: Document,
    drawing: Drawing,
    /// 0 until a page is there.
    revision: u32,
    /// The scene as it is rendered, and as the pages were told it last.
    told: Option<SceneTold>,
    points: usize,
    terms: Terms,
    orders: SyncSender<Order>,
    pages: Arc<Pages>,
    shown: Arc<Shown>,
    latest: Arc<LatestScene>,
    watch: Watch,
    spent: Spent,
    /// The page that edited last.
    editing: Option<PageId>,
    /// The scene of a revision whose tour is to be found.
    to_tour: Option<(Arc<AnyScene>, u32)>,
    /// Held by each thread that searches a tour.
    searches: Arc<()>,
    /// How often the file was looked at in vain.
    misses: u32,
    /// Whether the file had an error when it was read last.
    is_file_wrong: bool,
    /// The files of the scene's meshes and volumes, as they were when they were read.
    data: Vec<DataFile>,
}

/// What parts of an edit took.
#[derive(Debug, Default)]
struct Spent {
    since: Option<Instant>,
    parts: Vec<Part>,
}

impl Spent {
    fn begin(&mut self) {
        self.since = Some(Instant::now());
    }

    /// Ends a part; the next one begins.
    fn end(&mut self, name: &'static str) {
        let since = self.since.replace(Instant::now());
        let time = since.map_or(0.0, |since| since.elapsed().as_secs_f64());
        self.parts.push(Part { name, time });
    }
}

impl Editor {
    pub(super) fn new(
        document: Document,
        terms: Terms,
        orders: SyncSender<Order>,
        shared: &Shared,
    ) -> Self {
        let Shared { pages, shown, latest, watch, .. } = shared.clone();
        Self {
            document,
            drawing: Drawing::default(),
            revision: 0,
            told: None,
            points: 0,
            terms,
            orders,
            pages,
            shown,
            latest,
            watch,
            spent: Spent::default(),
            editing: None,
            to_tour: None,
            searches: Arc::default(),
            misses: 0,
            is_file_wrong: false,
            data: Vec::new(),
        }
    }

    pub(super) fn run(mut self, edits: &Receiver<Edit>) {
        loop {
            match edits.recv_timeout(LOOK) {
                Ok(Edit::Asked(message)) => {
                    self.watch.begins(Work::Edit);
                    self.take(&message);
                }
                // Who waited may have gone.
                Ok(Edit::Settle(done)) => _ = done.try_send(()),
                Err(RecvTimeoutError::Timeout) => {
                    self.look_at_file();
                    self.look_at_data();
                    self.find_tour();
                }
                Err(RecvTimeoutError::Disconnected) => return,
            }
        }
    }

    fn take(&mut self, message: &Received) {
        let page = message.page;
        let Question { id, ask } = match message.read() {
            Ok(question) => question,
            Err(Unreadable { id, why }) => return self.pages.not_read(page, id, &why),
        };
        match self.obey(page, ask) {
            Ok(()) => self.pages.done(page, id),
            Err(Refusal { message, problems }) => {
                self.pages.refuse(page, id, &message, &problems);
            }
        }
        self.latest.set(&self.document);
    }

    fn obey(&mut self, page: PageId, ask: Ask) -> Result<(), Refusal> {
        self.spent = Spent::default();
        match ask {
            Ask::Hello { version } => self.welcome(page, version),
            Ask::Edit { base, changes, moving } => {
                if self.editing.replace(page) != Some(page) {
                    self.document.end_drag();
                }
                self.edit(base, &changes, moving)
            }
            Ask::Undo {} => {
                if !self.document.undo() {
                    return Err("there is nothing to undo".to_owned().into());
                }
                self.show(By::Undo, false).inspect_err(|_| {
                    self.document.redo();
                })
            }
            Ask::Redo {} => {
                if !self.document.redo() {
                    return Err("there is nothing to do again".to_owned().into());
                }
                self.show(By::Redo, false).inspect_err(|_| {
                    self.document.undo();
                })
            }
            Ask::Open { name, text } => {
                let opened = Document::open(name, None, &text)?;
                let before = std::mem::replace(&mut self.document, opened);
                self.misses = 0;
                self.show(By::Open, false).inspect_err(|_| self.document = before)
            }
            Ask::Save { force, name } => {
                match name {
                    None => self.document.save(force)?,
                    Some(name) => self.document.save_as(&name, force)?,
                }
                self.tell_saved();
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn welcome(&mut self, page: PageId, version: u32) -> Result<(), Refusal> {
        if version != VERSION {
            return Err(format!(
                "this program speaks version {VERSION} and the page {version}: load the page again"
            )
            .into());
        }
        let welcome = Told::Welcome {
            version: VERSION,
            rate: self.terms.rate,
            catalogue: catalogue()?,
            operators: operators(),
            presets: presets()?,
            schema: schema(),
        };
        self.pages.send(page, welcome);
        match &self.told {
            None => self.show(By::Open, false)?,
            Some(told) => self.pages.send(page, Told::Scene(told)),
        }
        // Who leads the hand knows of the stop that holds.
        self.orders.send(Order::TellStop(page)).map_err(|_| "the program ends".to_owned())?;
        Ok(())
    }

    fn edit(&mut self, base: u32, changes: &[Change], is_moving: bool) -> Result<(), Refusal> {
        if base != self.revision {
            return Err(format!(
                "the scene was edited elsewhere: it has revision {}, the edit is for {base}",
                self.revision
            )
            .into());
        }
        let before = self.document.clone();
        self.spent.begin();
        self.document.edit(changes, is_moving)?;
        self.spent.end("read");
        self.show(By::Edit, is_moving).inspect_err(|_| self.document = before)
    }

    /// Tells the pages the file of the scene, and whether the scene is saved there.
    fn tell_saved(&mut self) {
        if let Some(told) = &mut self.told {
            told.document = self.document.told();
            self.pages.broadcast(Told::Scene(told));
        }
    }

    /// Takes the text of the file, if that was changed elsewhere.
    fn look_at_file(&mut self) {
        let Some(file) = self.document.file.clone().filter(|_| self.revision > 0) else {
            return;
        };
        // A file that is being replaced may not be there for a moment.
        let text = match read_file(&file) {
            Ok(text) => text,
            Err(error) => return self.miss_file(&file, &error),
        };
        self.misses = 0;
        let before = self.document.clone();
        let taken = match self.document.take_file(&text) {
            None => {
                if self.document.text() == text && std::mem::take(&mut self.is_file_wrong) {
                    self.tell_of_file(&format!("{} is as it was again", file.display()));
                }
                if self.document.is_saved() != before.is_saved() {
                    self.tell_saved();
                }
                return;
            }
            Some(taken) => taken.and_then(|()| self.show(By::File, false)),
        };
        self.is_file_wrong = taken.is_err();
        if let Err(Refusal { message, .. }) = taken {
            let looked = std::mem::replace(&mut self.document, before);
            self.document.take_note_of_file(&looked);
            let message =
                format!("{} was changed, and has an error: {message}", file.display());
            self.tell_of_file(&message);
        }
    }

    /// Shows the scene anew if the file of a mesh or a volume was changed.
    fn look_at_data(&mut self) {
        if !self.data.iter_mut().any(DataFile::has_changed) {
            return;
        }
        // Which one it was, the error says.
        if let Err(Refusal { message, .. }) = self.show(By::File, false) {
            self.data.iter_mut().for_each(|file| _ = file.has_changed());
            let message =
                format!("a file of the scene was changed, and has an error: {message}");
            self.tell_of_file(&message);
        }
    }

    /// Tells the pages once of a file that cannot be read, however often it is looked at.
    fn miss_file(&mut self, file: &Path, error: &std::io::Error) {
        self.misses = self.misses.saturating_add(1);
        if self.misses == MISSES_UNTIL_TOLD {
            let message = format!(
                "{} cannot be read any more: {error}; the page keeps the scene, and Save writes the file anew",
                file.display()
            );
            self.tell_of_file(&message);
        }
    }

    fn tell_of_file(&self, message: &str) {
        self.pages.broadcast(Told::Notice { message, about: Some(About::File) });
    }

    /// Renders the scene, and tells the pages.
    fn show(&mut self, by: By, is_moving: bool) -> Result<(), Refusal> {
        self.spent.begin();
        let scene = Arc::new(self.document.built()?);
        self.spent.end("build");
        let new = self.document.scene();
        let change = match &self.told {
            Some(old) if by != By::Open => changed(&old.scene, new),
            _ => Changed::Scene,
        };
        let revision = self.revision + 1;
        let (reply, showing) = sync_channel(1);
        let order = Order::Show { scene: Arc::clone(&scene), revision, change, reply };
        let gone = |_| Refusal::from("the program ends".to_owned());
        self.orders.send(order).map_err(|_| gone(()))?;
        let shown = showing.recv().map_err(|_| gone(()))?;
        self.spent.end("hand over");
        let (restarted, has_begun) = match shown {
            Showing::Replaced => (None, false),
            Showing::Began { points } => {
                self.points = points;
                let why = match change {
                    Changed::Scene => "another scene was opened",
                    Changed::Servo => "the tool, the motions or the dimension changed",
                    Changed::Bodies | Changed::Guides => "the last one had ended",
                };
                let why = format!("another servo began: {why}");
                (self.told.is_some().then_some(why), true)
            }
            Showing::Refused(why) => return Err(why.into()),
        };
        self.data = data_files(&scene, self.document.file.as_deref());
        self.revision = revision;
        self.shown.set(Arc::clone(&scene), revision);
        self.latest.set(&self.document);
        let built = described(&scene);
        self.spent.end("describe");
        let way = self.drawing.of(&scene, is_moving);
        self.spent.end("formula");
        let told = self.told.insert(SceneTold {
            revision,
            by,
            document: self.document.told(),
            scene: self.document.scene().clone(),
            text: self.document.text().to_owned(),
            built,
            way,
            spent: std::mem::take(&mut self.spent.parts),
            device: DeviceTold {
                name: self.terms.profile.name.to_string(),
                points: self.points,
                max_force: self.terms.profile.max_force,
                rate: self.terms.rate,
            },
            restarted,
        });
        self.pages.broadcast(Told::Scene(told));
        if has_begun {
            self.to_tour = Some((scene, revision));
            self.find_tour();
        }
        Ok(())
    }

    /// Finds the tour of the scene in a thread of its own, unless too many are searching.
    fn find_tour(&mut self) {
        if Arc::strong_count(&self.searches) > MOST_SEARCHES {
            return;
        }
        let Some((scene, revision)) = self.to_tour.take() else { return };
        let (points, searches) = (self.points, Arc::clone(&self.searches));
        let (orders, pages) = (self.orders.clone(), Arc::clone(&self.pages));
        std::thread::spawn(move || {
            send_tour(&scene, points, revision, &orders, &pages);
            drop(searches);
        });
    }
}

/// Finds a tour, and sends it to the hand.
fn send_tour(
    scene: &AnyScene,
    points: usize,
    revision: u32,
    orders: &SyncSender<Order>,
    pages: &Pages,
) {
    let path = match scene {
        AnyScene::Planar(scene) => tour(scene, points),
        AnyScene::Spatial(scene) => tour(scene, points),
    };
    match path {
        Some(Ok(path)) => {
            // A hand without a tour rests.
            let _ = orders.send(Order::TakeTour { path, revision });
        }
        Some(Err(error)) => {
            let message = format!("the hand has no tour of this scene: {error}");
            pages.broadcast(Told::Notice { message: &message, about: None });
        }
        None => {}
    }
}

/// A file that a scene reads beside its own.
#[derive(Debug)]
struct DataFile {
    path: PathBuf,
    /// When it was written, and its bytes; `None` where there is no file.
    seen: Option<(SystemTime, u64)>,
}

impl DataFile {
    fn of(path: PathBuf) -> Self {
        let seen = Self::now(&path);
        Self { path, seen }
    }

    fn now(path: &Path) -> Option<(SystemTime, u64)> {
        let metadata = std::fs::metadata(path).ok()?;
        Some((metadata.modified().ok()?, metadata.len()))
    }

    /// Whether it is another than when this was asked last. One that is being replaced may not be there for a
    /// moment, which is no change.
    fn has_changed(&mut self) -> bool {
        let now = Self::now(&self.path);
        let is_new = now.is_some() && now != self.seen;
        if is_new {
            self.seen = now;
        }
        is_new
    }
}

/// The files of the meshes and volumes of a scene.
fn data_files(scene: &AnyScene, file: Option<&Path>) -> Vec<DataFile> {
    let Some(folder) = file.and_then(Path::parent) else { return Vec::new() };
    let meshes = match scene {
        AnyScene::Planar(scene) => &scene.meshes,
        AnyScene::Spatial(scene) => &scene.meshes,
    };
    meshes.iter().flat_map(|mesh| mesh.files(folder)).map(DataFile::of).collect()
}

/// What changed from one scene to another.
fn changed(old: &Scene, new: &Scene) -> Changed {
    let is_for_one_servo = old.dimension() == new.dimension()
        && old.tool == new.tool
        && old.motions == new.motions
        && (old.motions.is_empty() || old.bodies.len() == new.bodies.len());
    match is_for_one_servo {
        false => Changed::Servo,
        true if old.guides == new.guides => Changed::Bodies,
        true => Changed::Guides,
    }
}

/// The numbers of each material that has a name.
fn presets() -> Result<Map<String, Value>, Refusal> {
    let named = Material::preset_names().map(|name| {
        let material = Material::preset(name).map_err(|error| error.to_string())?;
        let numbers = serde_json::to_value(material).map_err(|error| error.to_string())?;
        Ok::<_, String>((name.to_owned(), numbers))
    });
    Ok(named.collect::<Result<_, _>>()?)
}

/// The operators on one shape with the numbers to begin with, on a shape 1 m wide.
fn operators() -> Vec<OperatorTold> {
    let told = |operator: &Operator| {
        let first = if operator.is_per_axis {
            First::PerAxis(operator.first)
        } else {
            First::One(operator.first[0])
        };
        OperatorTold { name: operator.name, first }
    };
    Operator::ALL.iter().map(told).collect()
}

fn catalogue() -> Result<Vec<Value>, Refusal> {
    let planar = Entry::<2>::ALL.iter().map(described_primitive);
    let all = planar.chain(Entry::<3>::ALL.iter().map(described_primitive));
    Ok(all.collect::<Result<_, _>>()?)
}
