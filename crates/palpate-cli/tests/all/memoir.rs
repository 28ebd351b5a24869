// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The commands of the guide's page on the memoir, as they stand there.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use crate::common::{Folder, errors, status};

const PAGE: &str = include_str!("../../../../docs/guide/memoir.md");

/// A folder with the scenes of the repository, as the commands name them.
fn root() -> Folder {
    let folder = Folder::new();
    fs::create_dir(folder.path("scenes")).unwrap();
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    for scene in fs::read_dir(scenes).unwrap() {
        let scene = scene.unwrap();
        if scene.path().is_dir() {
            continue;
        }
        let name = scene.file_name().into_string().unwrap();
        fs::copy(scene.path(), folder.path("scenes").join(name)).unwrap();
    }
    folder
}

/// A command ends with a yes, unless a comment says "no"; each picture is new, and a PNG.
#[test]
#[ignore = "slow: cargo xtask test --thorough"]
fn every_command_of_the_page_runs_and_draws_what_it_names() {
    let folder = root();
    let commands: Vec<&str> =
        PAGE.lines().filter(|line| line.starts_with("palpate ")).collect();
    let mut pictures = BTreeSet::new();
    for line in &commands {
        let (command, comment) = line.split_once(" # ").unwrap_or((line, ""));
        let arguments: Vec<&str> = command.split_whitespace().skip(1).collect();
        let output = folder.run(&arguments);
        let expected = i32::from(comment.trim() == "no");
        assert_eq!(status(&output), expected, "{line}: {}", errors(&output));
        let named =
            arguments.windows(2).filter(|pair| ["--plot", "--output"].contains(&pair[0]));
        for picture in named.map(|pair| pair[1]) {
            let bytes = fs::read(folder.path(picture)).unwrap();
            assert!(bytes.starts_with(b"\x89PNG"), "{line}");
            assert!(pictures.insert(picture), "{picture} is drawn twice");
        }
    }
    for figure in ["1", "2", "3", "4a", "4b", "5", "6"] {
        let name = format!("figure-{figure}.png");
        assert!(pictures.contains(name.as_str()), "no command draws figure {figure}");
    }
    let methods = ["naive", "frank_wolfe", "golden_section", "minimax_proximal", "differences"];
    for method in methods.iter().chain(&["dichotomy", "adaptive_dichotomy", "closest_vector"]) {
        assert!(commands.iter().any(|line| line.contains(method)), "no command runs {method}");
    }
}
