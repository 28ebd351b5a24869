// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The scene as it is edited: its data, the steps back, the file it came from.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use palpate::scene::{AnyScene, Resources, Scene, SceneError, SceneProblem};
use serde_json::Value;

use super::file::{LARGEST, MOST_NODES, read_file, replace};
use crate::wire::{Change, DocumentTold, Problem};

/// The deepest that a part of a scene may be nested: more than any scene is.
const DEEPEST: usize = 200;

/// The most steps back, and the most that their texts are in all [bytes]: their scenes in memory are
/// about twenty times as large.
const MOST_STEPS: usize = 500;
const MOST_BYTES: usize = 16 << 20;

/// A scene that is edited.
#[derive(Clone, Debug)]
pub(super) struct Document {
    pub(super) name: String,
    pub(super) file: Option<PathBuf>,
    now: Arc<Version>,
    back: Vec<Arc<Version>>,
    forth: Vec<Arc<Version>>,
    /// Whether the last edit was a step of a drag that may go on.
    is_moving: bool,
    /// The text of the file that this scene came from or was saved as: another one in the file is
    /// somebody else's.
    saved: Arc<str>,
    /// The text that the file had when it was last looked at.
    seen: Arc<str>,
}

/// A scene with its text.
#[derive(Clone, Debug)]
struct Version {
    scene: Scene,
    text: String,
}

impl Version {
    /// The scene of a text; the files of its meshes are beside its own file.
    fn read(text: &str, file: Option<&Path>) -> Result<Arc<Self>, Refusal> {
        if text.len() > LARGEST {
            let size = text.len();
            return Err(format!("a scene has at most {LARGEST} bytes here, got {size}").into());
        }
        let mut resources = Resources::default().with_most_nodes(MOST_NODES);
        resources.folder = file.map(|file| file.parent().unwrap_or(Path::new("")).to_owned());
        let scene = Scene::from_json_in(text, resources)?;
        Ok(Arc::new(Self { scene, text: text.to_owned() }))
    }
}

/// Why an edit is refused.
#[derive(Debug)]
pub(crate) struct Refusal {
    pub(crate) message: String,
    pub(crate) problems: Vec<Problem>,
}

impl From<String> for Refusal {
    fn from(message: String) -> Self {
        Self { message, problems: Vec::new() }
    }
}

impl From<SceneError> for Refusal {
    fn from(error: SceneError) -> Self {
        let problems = error.problems().map(described).collect();
        Self { message: error.to_string(), problems }
    }
}

fn described(SceneProblem { path, line, problem, .. }: &SceneProblem) -> Problem {
    Problem { at: pointer(path), path: path.clone(), line: *line, problem: problem.clone() }
}

/// The JSON pointer of a path such as `bodies[0].shape."a.b"`.
fn pointer(path: &str) -> String {
    let mut pointer = String::new();
    let mut rest = path;
    while !rest.is_empty() {
        let (step, after) = if let Some(index) = rest.strip_prefix('[') {
            index.split_once(']').unwrap_or((index, ""))
        } else if let Some(quoted) = rest.strip_prefix('"') {
            quoted.split_once('"').unwrap_or((quoted, ""))
        } else {
            rest.split_at(rest.find(['.', '[']).unwrap_or(rest.len()))
        };
        pointer.push('/');
        pointer.push_str(&step.replace('~', "~0").replace('/', "~1"));
        rest = after.strip_prefix('.').unwrap_or(after);
    }
    pointer
}

impl Document {
    /// The scene of a text.
    pub(super) fn open(
        name: String,
        file: Option<PathBuf>,
        text: &str,
    ) -> Result<Self, Refusal> {
        let now = Version::read(text, file.as_deref())?;
        let saved: Arc<str> = now.text.as_str().into();
        let (back, forth) = (Vec::new(), Vec::new());
        let seen = Arc::clone(&saved);
        Ok(Self { name, file, now, back, forth, is_moving: false, saved, seen })
    }

    pub(super) fn scene(&self) -> &Scene {
        &self.now.scene
    }

    pub(super) fn text(&self) -> &str {
        &self.now.text
    }

    pub(super) fn can_undo(&self) -> bool {
        !self.back.is_empty()
    }

    pub(super) fn can_redo(&self) -> bool {
        !self.forth.is_empty()
    }

    /// What the pages are told of its file and its steps.
    pub(super) fn told(&self) -> DocumentTold {
        DocumentTold {
            name: self.name.clone(),
            file: self.file.as_ref().map(|file| file.display().to_string()),
            is_saved: self.is_saved(),
            can_undo: self.can_undo(),
            can_redo: self.can_redo(),
        }
    }

    pub(super) fn is_saved(&self) -> bool {
        self.now.text == *self.saved
    }

    /// The built scene.
    pub(super) fn built(&self) -> Result<AnyScene, Refusal> {
        Ok(self.now.scene.build()?)
    }

    /// Makes changes, all or none. `is_moving` while a control is dragged: the edits of a drag are
    /// one step back.
    pub(super) fn edit(&mut self, changes: &[Change], is_moving: bool) -> Result<(), Refusal> {
        let mut data = serde_json::to_value(&self.now.scene)
            .map_err(|error| Refusal::from(error.to_string()))?;
        for change in changes {
            apply(&mut data, change)?;
        }
        // Through the text, so that a problem has a line in the file as it would be saved.
        let scene: Result<Scene, _> = serde_json::from_value(data.clone());
        let text = match scene {
            Ok(scene) => scene.to_json(),
            Err(_) => serde_json::to_string_pretty(&data).unwrap_or_default(),
        };
        let version = Version::read(&text, self.file.as_deref())?;
        let is_same_drag = self.is_moving && !self.back.is_empty();
        if is_same_drag {
            self.now = version;
        } else {
            self.push(version);
        }
        self.is_moving = is_moving;
        Ok(())
    }

    fn push(&mut self, version: Arc<Version>) {
        self.back.push(std::mem::replace(&mut self.now, version));
        let size = |back: &[Arc<Version>]| -> usize {
            back.iter().map(|version| version.text.len()).sum()
        };
        while self.back.len() > MOST_STEPS || size(&self.back) > MOST_BYTES {
            self.back.remove(0);
        }
        self.forth.clear();
    }

    /// Ends a drag: the next edit is a step of its own.
    pub(super) fn end_drag(&mut self) {
        self.is_moving = false;
    }

    /// Goes a step back; `false` if there is none.
    pub(super) fn undo(&mut self) -> bool {
        self.is_moving = false;
        let Some(before) = self.back.pop() else { return false };
        self.forth.push(std::mem::replace(&mut self.now, before));
        true
    }

    /// Goes a step forth again; `false` if there is none.
    pub(super) fn redo(&mut self) -> bool {
        self.is_moving = false;
        let Some(after) = self.forth.pop() else { return false };
        self.back.push(std::mem::replace(&mut self.now, after));
        true
    }

    /// Writes the scene to its file, unless the file has another text than was read or saved.
    pub(super) fn save(&mut self, is_forced: bool) -> Result<(), Refusal> {
        let Some(file) = self.file.clone() else {
            return Err("this scene came from no file: save it as one".to_owned().into());
        };
        let shown = file.display();
        let failed = |error: std::io::Error| Refusal::from(format!("{shown}: {error}"));
        match read_file(&file) {
            Ok(text) if text != *self.saved && !is_forced => {
                return Err(format!(
                    "{shown} was changed elsewhere meanwhile: open it again, or save over it"
                )
                .into());
            }
            Ok(_) => {}
            Err(error) if error.kind() == ErrorKind::NotFound => {}
            // A file that is not UTF-8 is replaced only if that is forced.
            Err(error) if error.kind() == ErrorKind::InvalidData && is_forced => {}
            Err(error) => return Err(failed(error)),
        }
        replace(&file, &self.now.text, false).map_err(failed)?;
        self.saved = self.now.text.as_str().into();
        self.seen = Arc::clone(&self.saved);
        Ok(())
    }

    /// Writes the scene to another file, beside its own or in the folder where the program was
    /// started, which becomes its file.
    pub(super) fn save_as(&mut self, name: &str, is_forced: bool) -> Result<(), Refusal> {
        let is_plain = |c: char| !c.is_control() && !r#"/\:*?"<>|"#.contains(c);
        let stem = name.strip_suffix(".json").unwrap_or_default();
        if stem.is_empty()
            || name.starts_with('.')
            || name.len() > 200
            || !name.chars().all(is_plain)
        {
            return Err(format!(
                "a scene is saved as a file in the same folder whose name ends in .json, got {name:?}"
            )
            .into());
        }
        let file =
            self.file.as_deref().map_or_else(|| name.into(), |file| file.with_file_name(name));
        let shown = file.display();
        if file.symlink_metadata().is_ok() && !is_forced {
            return Err(format!(
                "there is a file {shown} already: save over it, or choose another name"
            )
            .into());
        }
        let written = replace(&file, &self.now.text, !is_forced);
        written.map_err(|error| format!("{shown}: {error}"))?;
        self.saved = self.now.text.as_str().into();
        self.seen = Arc::clone(&self.saved);
        (self.name, self.file) = (name.to_owned(), Some(file));
        Ok(())
    }

    /// Takes the text that its file has now, as a step that can be undone; `None` if it is known.
    pub(super) fn take_file(&mut self, text: &str) -> Option<Result<(), Refusal>> {
        if text == &*self.seen {
            return None;
        }
        self.seen = text.into();
        if text == self.now.text {
            self.saved = text.into();
            return None;
        }
        self.is_moving = false;
        let read = Version::read(text, self.file.as_deref());
        Some(read.map(|version| {
            self.saved = text.into();
            self.push(version);
        }))
    }

    /// Takes note that the file was looked at: a text with an error is told once. It is still
    /// somebody else's, which is not saved over.
    pub(super) fn take_note_of_file(&mut self, other: &Self) {
        self.seen = Arc::clone(&other.seen);
    }
}

/// How deep a value is nested.
fn depth(value: &Value) -> usize {
    let mut deepest = 0;
    let mut left = vec![(value, 1)];
    while let Some((value, depth)) = left.pop() {
        deepest = deepest.max(depth);
        match value {
            Value::Array(all) => left.extend(all.iter().map(|one| (one, depth + 1))),
            Value::Object(all) => left.extend(all.values().map(|one| (one, depth + 1))),
            _ => {}
        }
    }
    deepest
}

/// Makes one change.
fn apply(data: &mut Value, change: &Change) -> Result<(), Refusal> {
    // What is nested too deep would overflow the stack of who reads it.
    let deepest = change.at.matches('/').count() + change.to.as_ref().map_or(0, depth);
    if deepest > DEEPEST {
        return Err(format!("a scene is nested at most {DEEPEST} deep, got {deepest}").into());
    }
    let nowhere = || Refusal::from(format!("the scene has nothing at {:?}", change.at));
    let Some((parent, key)) = change.at.rsplit_once('/') else {
        return Err(format!("{:?} is no JSON pointer to a part of the scene", change.at).into());
    };
    let key = key.replace("~1", "/").replace("~0", "~");
    match (data.pointer_mut(parent), &change.to) {
        (Some(Value::Object(fields)), Some(to)) => {
            fields.insert(key, to.clone());
        }
        // Keys stay in their order.
        (Some(Value::Object(fields)), None) => {
            fields.shift_remove(&key).ok_or_else(nowhere)?;
        }
        (Some(Value::Array(elements)), Some(to)) if key == "-" => elements.push(to.clone()),
        (Some(Value::Array(elements)), to) => {
            let index: usize = key.parse().map_err(|_| nowhere())?;
            let element = elements.get_mut(index).ok_or_else(nowhere)?;
            match to {
                Some(to) => *element = to.clone(),
                None => drop(elements.remove(index)),
            }
        }
        _ => return Err(nowhere()),
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    const SCENE: &str = r#"{ "palpate": 1, "dimension": 2,
        "bodies": [ { "name": "coin", "shape": { "circle": { "radius": 0.5 } } } ] }"#;
    const RADIUS: &str = "/bodies/0/shape/circle/radius";

    fn coin() -> Document {
        Document::open("coin".into(), None, SCENE).unwrap()
    }

    fn to(at: &str, to: Value) -> [Change; 1] {
        [Change { at: at.into(), to: Some(to) }]
    }

    fn radius(document: &Document) -> f64 {
        let data = serde_json::to_value(document.scene()).unwrap();
        data.pointer(RADIUS).and_then(Value::as_f64).unwrap()
    }

    #[test]
    fn a_drag_is_one_step_back() {
        let mut document = coin();
        for (size, is_moving) in [(0.6, true), (0.7, true), (0.8, false), (0.9, false)] {
            document.edit(&to(RADIUS, size.into()), is_moving).unwrap();
        }
        assert_eq!(radius(&document), 0.9);
        assert!(document.undo() && document.can_redo());
        assert_eq!(radius(&document), 0.8);
        assert!(document.undo() && !document.can_undo());
        assert_eq!(radius(&document), 0.5);
        assert!(document.redo() && document.redo() && !document.redo());
        assert_eq!(radius(&document), 0.9);
    }

    #[test]
    fn a_wrong_edit_changes_nothing_and_says_where() {
        let mut document = coin();
        let refusal = document.edit(&to(RADIUS, (-1.0).into()), false).unwrap_err();
        assert!(refusal.message.contains("radius must be positive, got -1 m"), "{refusal:?}");
        assert_eq!(refusal.problems[0].at, RADIUS);
        assert!(refusal.problems[0].line > 1);
        let refusal = document.edit(&to("/bodies/7/name", "x".into()), false).unwrap_err();
        assert_eq!(refusal.message, "the scene has nothing at \"/bodies/7/name\"");
        assert!(document.edit(&to("bodies", "x".into()), false).is_err());
        assert!(!document.can_undo() && radius(&document) == 0.5);
    }

    #[test]
    fn what_is_nested_too_deep_is_refused() {
        let mut document = coin();
        let mut nested = json!(0);
        for _ in 0..120 {
            nested = json!([nested]);
        }
        let change = |level: usize| Change {
            at: format!("/description{}", "/0".repeat(120 * level)),
            to: Some(nested.clone()),
        };
        let changes: Vec<_> = (0..40).map(change).collect();
        let refusal = document.edit(&changes, false).unwrap_err();
        assert!(refusal.message.contains("200 deep"), "{refusal:?}");
    }

    /// Each edit of a scene that unfolds took seconds, in which no other was read.
    #[test]
    fn what_unfolds_to_too_many_nodes_is_refused() {
        let mut document = coin();
        let list = vec![json!("coin"); MOST_NODES];
        let changes = [
            Change {
                at: "/shapes".into(),
                to: Some(json!({ "coin": { "circle": { "radius": 1 } } })),
            },
            Change { at: "/bodies/0/shape".into(), to: Some(json!({ "union": list })) },
        ];
        let refusal = document.edit(&changes, false).unwrap_err();
        assert!(refusal.message.contains("more than 20000 nodes"), "{refusal:?}");
        assert!(!document.can_undo() && radius(&document) == 0.5);
    }

    /// The text of another file was once written over what a link there leads to.
    #[cfg(unix)]
    #[test]
    fn a_scene_is_saved_over_no_link_out_of_its_folder() {
        let [own, other] = [(); 2].map(|()| tempfile::tempdir().unwrap());
        let outside = other.path().join("outside.json");
        std::os::unix::fs::symlink(&outside, own.path().join("out.json")).unwrap();
        let file = own.path().join("coin.json");
        let mut document = Document::open("coin".into(), Some(file.clone()), SCENE).unwrap();
        let refusal = document.save_as("out.json", true).unwrap_err();
        assert!(refusal.message.contains("is a link out of its folder"), "{refusal:?}");
        std::os::unix::fs::symlink(&outside, &file).unwrap();
        assert!(document.save(true).is_err() && !outside.exists());
    }

    #[test]
    fn parts_are_added_and_removed() {
        let mut document = coin();
        let body = json!({ "name": "b", "shape": { "circle": { "radius": 1 } } });
        document.edit(&to("/bodies/-", body), false).unwrap();
        assert_eq!(document.scene().bodies.len(), 2);
        let remove = [Change { at: "/bodies/0".into(), to: None }];
        document.edit(&remove, false).unwrap();
        assert_eq!(document.scene().bodies[0].name, "b");
    }

    #[test]
    fn a_file_that_was_changed_elsewhere_is_not_overwritten() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("coin.json");
        std::fs::write(&file, SCENE).unwrap();
        let mut document = Document::open("coin".into(), Some(file.clone()), SCENE).unwrap();
        document.edit(&to(RADIUS, 0.75.into()), false).unwrap();
        assert!(!document.is_saved());
        document.save(false).unwrap();
        assert!(document.is_saved());
        assert_eq!(std::fs::read_to_string(&file).unwrap(), document.text());

        std::fs::write(&file, "half of a").unwrap();
        assert!(matches!(document.take_file("half of a"), Some(Err(_))));
        assert!(document.save(false).is_err(), "what cannot be read is somebody's too");
        std::fs::write(&file, SCENE).unwrap();
        document.edit(&to(RADIUS, 1.0.into()), false).unwrap();
        let refusal = document.save(false).unwrap_err();
        assert!(refusal.message.contains("was changed elsewhere"), "{refusal:?}");
        assert!(matches!(document.take_file(SCENE), Some(Ok(()))));
        assert_eq!((radius(&document), document.take_file(SCENE).is_none()), (0.5, true));
        assert!(document.undo() && radius(&document) == 1.0);
        document.save(true).unwrap();
        assert!(coin().save(true).is_err(), "no file");
    }

    #[test]
    fn a_scene_is_saved_as_another_file() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("coin.json");
        let mut document = Document::open("coin".into(), Some(file.clone()), SCENE).unwrap();
        for name in
            ["", ".json", ".hidden.json", "../up.json", "a/b.json", "coin.txt", "c:d.json"]
        {
            assert!(document.save_as(name, true).is_err(), "{name:?}");
        }
        document.save_as("other.json", false).unwrap();
        let other = folder.path().join("other.json");
        assert_eq!(std::fs::read_to_string(&other).unwrap(), SCENE);
        assert_eq!(
            (document.file.as_ref(), document.name.as_str()),
            (Some(&other), "other.json")
        );
        assert!(document.save_as("other.json", false).is_err());
        assert!(!file.exists() && document.save_as("coin.json", false).is_ok());
    }

    /// A file that is saved keeps its hard links; one that is read-only is not replaced; one that was
    /// deleted meanwhile can be read by whom other new files can.
    #[cfg(unix)]
    #[test]
    fn saving_respects_links_and_permissions() {
        use std::os::unix::fs::{MetadataExt, PermissionsExt};
        let folder = tempfile::tempdir().unwrap();
        let [file, link, fresh] =
            ["coin.json", "link.json", "fresh"].map(|name| folder.path().join(name));
        std::fs::write(&file, SCENE).unwrap();
        std::fs::hard_link(&file, &link).unwrap();
        let mut document = Document::open("coin".into(), Some(file.clone()), SCENE).unwrap();
        document.edit(&to(RADIUS, 0.75.into()), false).unwrap();
        document.save(false).unwrap();
        assert_eq!(std::fs::read_to_string(&link).unwrap(), document.text());
        std::fs::remove_file(&link).unwrap();
        std::fs::set_permissions(&file, PermissionsExt::from_mode(0o444)).unwrap();
        document.edit(&to(RADIUS, 0.25.into()), false).unwrap();
        let refusal = document.save(false).unwrap_err();
        assert!(refusal.message.contains("is read-only"), "{refusal:?}");
        std::fs::remove_file(&file).unwrap();
        document.save(false).unwrap();
        std::fs::write(&fresh, "").unwrap();
        let mode = |path| std::fs::metadata(path).unwrap().mode();
        assert_eq!(mode(&file), mode(&fresh));
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
    }

    #[test]
    fn paths_become_pointers() {
        assert_eq!(pointer("bodies[0].shape.ball.radius"), "/bodies/0/shape/ball/radius");
        assert_eq!(pointer("shapes.\"a/b\"[2]"), "/shapes/a~1b/2");
        assert_eq!(pointer(""), "");
    }
}
