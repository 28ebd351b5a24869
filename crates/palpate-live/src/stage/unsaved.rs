// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The text of the scene for other threads, and what is kept of it when the program ends.

use std::collections::BTreeSet;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use serde_json::Value;

use super::document::Document;
use super::file::replace;

/// The most files of one name that are tried, before another folder is.
const MOST_NUMBERS: u32 = 1000;

/// The longest name of a file without its endings [bytes]: file systems take 255 with them.
const LONGEST_STEM: usize = 200;

/// The scene as it was edited last.
#[derive(Debug)]
pub(super) struct LatestScene(Mutex<Scene>);

#[derive(Debug)]
struct Scene {
    name: String,
    file: Option<PathBuf>,
    text: Arc<str>,
    is_saved: bool,
}

impl From<&Document> for Scene {
    fn from(document: &Document) -> Self {
        Self {
            name: document.name.clone(),
            file: document.file.clone(),
            text: document.text().into(),
            is_saved: document.is_saved(),
        }
    }
}

impl LatestScene {
    pub(super) fn of(document: &Document) -> Self {
        Self(Mutex::new(document.into()))
    }

    // The scene is whole even if a thread panicked while it held the lock.
    fn scene(&self) -> MutexGuard<'_, Scene> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn set(&self, document: &Document) {
        // Made before the lock is taken.
        let scene = document.into();
        *self.scene() = scene;
    }

    pub(super) fn text(&self) -> String {
        self.scene().text.to_string()
    }

    /// The scene, if it has edits that are not saved.
    pub(super) fn unsaved(&self) -> Option<Unsaved> {
        let scene = self.scene();
        let Scene { name, file, text, .. } = &*scene;
        let unsaved =
            || Unsaved { name: name.clone(), file: file.clone(), text: Arc::clone(text) };
        (!scene.is_saved).then(unsaved)
    }
}

/// A scene with edits that are not saved.
#[derive(Clone, Debug)]
pub struct Unsaved {
    name: String,
    /// The file that it came from.
    file: Option<PathBuf>,
    text: Arc<str>,
}

/// Why a scene with edits is not kept.
#[derive(Debug, thiserror::Error)]
#[error("the edits of {name} could not be kept: {}", reasons(tried))]
pub struct UnsavedError {
    name: String,
    tried: Vec<(PathBuf, std::io::Error)>,
}

fn reasons(tried: &[(PathBuf, std::io::Error)]) -> String {
    let reason =
        |(file, error): &(PathBuf, std::io::Error)| format!("{}: {error}", file.display());
    tried.iter().map(reason).collect::<Vec<_>>().join("; ")
}

impl Unsaved {
    /// Writes the scene to a new file `NAME.unsaved.json` beside its own, numbered where there is one
    /// already. Where that folder cannot be written, or the scene has no file, it is the current folder,
    /// then that of temporary files. In another folder than its own, its description names the files of
    /// meshes, volumes and grids that are not found from there.
    ///
    /// # Errors
    ///
    /// Why no folder takes it.
    pub fn keep(&self) -> Result<PathBuf, UnsavedError> {
        let here = self.file.as_deref().and_then(Path::parent).map(Path::to_owned);
        let elsewhere = [std::env::current_dir().ok(), Some(std::env::temp_dir())];
        self.keep_in(here.into_iter().chain(elsewhere.into_iter().flatten()))
    }

    fn keep_in(&self, folders: impl Iterator<Item = PathBuf>) -> Result<PathBuf, UnsavedError> {
        let mut tried = Vec::new();
        for folder in folders {
            let text = self.text_in(&folder);
            let files = (1..=MOST_NUMBERS).map(|number| folder.join(self.file_name(number)));
            for file in files {
                // A link counts too, wherever it leads.
                if file.symlink_metadata().is_ok() {
                    continue;
                }
                match replace(&file, &text, true) {
                    Ok(()) => return Ok(file),
                    Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                    Err(error) => {
                        tried.push((file, error));
                        break;
                    }
                }
            }
        }
        Err(UnsavedError { name: self.name.clone(), tried })
    }

    fn file_name(&self, number: u32) -> String {
        let name = self.file.as_deref().and_then(Path::file_name);
        let name = name.map_or(self.name.clone(), |name| name.to_string_lossy().into_owned());
        let stem = name.strip_suffix(".json").unwrap_or(&name);
        let is_plain = |c: char| c.is_alphanumeric() || "-_. ".contains(c);
        let stem: String = stem.chars().map(|c| if is_plain(c) { c } else { '_' }).collect();
        let stem = stem.get(..stem.floor_char_boundary(LONGEST_STEM)).unwrap_or_default();
        match number {
            1 => format!("{stem}.unsaved.json"),
            _ => format!("{stem}.unsaved.{number}.json"),
        }
    }

    /// The text for a file in a folder.
    fn text_in(&self, folder: &Path) -> String {
        let own = self.file.as_deref().and_then(Path::parent);
        if own == Some(folder) {
            return self.text.to_string();
        }
        let Ok(mut scene) = serde_json::from_str::<Value>(&self.text) else {
            return self.text.to_string();
        };
        let lost: Vec<_> =
            files(&scene).into_iter().filter(|file| !folder.join(file).is_file()).collect();
        if lost.is_empty() {
            return self.text.to_string();
        }
        let from = own.map_or_else(String::new, |own| {
            format!(" They were in {}.", own.canonicalize().unwrap_or(own.to_owned()).display())
        });
        let note = format!("Not found from this folder: {}.{from}", lost.join(", "));
        let before = scene["description"].as_str().map(|text| format!("{text} "));
        scene["description"] = format!("{}{note}", before.unwrap_or_default()).into();
        serde_json::to_string_pretty(&scene).unwrap_or_else(|_| self.text.to_string())
    }
}

/// The files that a scene names: of meshes, volumes and grids.
fn files(scene: &Value) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let mut left = vec![scene];
    while let Some(value) = left.pop() {
        match value {
            Value::Array(all) => left.extend(all),
            Value::Object(all) => {
                let named = ["mesh", "volume", "grid"].iter().filter_map(|key| {
                    all.get(*key).and_then(|part| part.get("file")).and_then(Value::as_str)
                });
                found.extend(named.map(str::to_owned));
                left.extend(all.values());
            }
            _ => {}
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: &str = r#"{ "palpate": 1, "dimension": 3, "bodies": [ { "name": "nut", "shape": { "union":
        [ { "mesh": { "file": "parts/nut.ply" } }, { "ball": { "radius": 1 } } ] } } ] }"#;

    fn unsaved(name: &str, file: Option<PathBuf>) -> Unsaved {
        Unsaved { name: name.to_owned(), file, text: SCENE.into() }
    }

    #[test]
    fn edits_are_kept_beside_the_scene_over_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let scene = unsaved("cup.json", Some(folder.path().join("cup.json")));
        std::fs::write(folder.path().join("cup.unsaved.json"), "of another run").unwrap();
        let names = ["cup.unsaved.2.json", "cup.unsaved.3.json"];
        for name in names {
            assert_eq!(scene.keep().unwrap(), folder.path().join(name));
            assert_eq!(std::fs::read_to_string(folder.path().join(name)).unwrap(), SCENE);
        }
        let first = std::fs::read_to_string(folder.path().join("cup.unsaved.json")).unwrap();
        assert_eq!(first, "of another run");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 3);
    }

    #[test]
    fn another_folder_takes_what_the_own_one_does_not() {
        let folder = tempfile::tempdir().unwrap();
        let gone = folder.path().join("gone");
        let scene = unsaved("cup.json", Some(gone.join("cup.json")));
        let kept = scene.keep_in([gone.clone(), folder.path().to_owned()].into_iter()).unwrap();
        assert_eq!(kept, folder.path().join("cup.unsaved.json"));
        let text = std::fs::read_to_string(&kept).unwrap();
        let note = format!(
            "Not found from this folder: parts/nut.ply. They were in {}.",
            gone.display()
        );
        let scene_of_text: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(scene_of_text["description"], note);
        // Where they are found, nothing is said.
        std::fs::create_dir(folder.path().join("parts")).unwrap();
        std::fs::write(folder.path().join("parts/nut.ply"), "").unwrap();
        assert_eq!(scene.text_in(folder.path()), SCENE);
        let error = scene.keep_in([gone.clone()].into_iter()).unwrap_err().to_string();
        assert!(error.starts_with("the edits of cup.json could not be kept: "), "{error}");
        assert!(error.contains(&gone.display().to_string()), "{error}");
    }

    #[test]
    fn a_scene_without_a_file_gets_a_plain_name() {
        let folder = tempfile::tempdir().unwrap();
        for (name, file) in
            [("gallery", "gallery.unsaved.json"), ("../a\nb", ".._a_b.unsaved.json")]
        {
            let kept = unsaved(name, None).keep_in([folder.path().to_owned()].into_iter());
            assert_eq!(kept.unwrap(), folder.path().join(file));
        }
    }

    /// Edits once were written into a file with two names, and through a link to nothing.
    #[cfg(unix)]
    #[test]
    fn no_name_of_a_file_and_no_link_is_written_over() {
        let folder = tempfile::tempdir().unwrap();
        let [first, backup, link, victim] =
            ["cup.unsaved.json", "backup", "cup.unsaved.2.json", "victim"]
                .map(|name| folder.path().join(name));
        std::fs::write(&first, "of another run").unwrap();
        std::fs::hard_link(&first, &backup).unwrap();
        std::os::unix::fs::symlink(&victim, &link).unwrap();
        let scene = unsaved("cup.json", Some(folder.path().join("cup.json")));
        assert_eq!(scene.keep().unwrap(), folder.path().join("cup.unsaved.3.json"));
        assert_eq!(std::fs::read_to_string(&backup).unwrap(), "of another run");
        assert!(link.is_symlink() && !victim.exists());
    }
}
