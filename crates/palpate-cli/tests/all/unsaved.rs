// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What becomes of edits that are not saved when the program of a page ends.
#![cfg(unix)]

use std::fs;
use std::io::{BufReader, Read};
use std::net::TcpStream;
use std::process::ChildStderr;

use serde_json::{Value, json};
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use tungstenite::client::IntoClientRequest;
use tungstenite::{Message, WebSocket};

use crate::common::{Folder, disc, program};
use crate::interrupted::{Run, hears_hang_ups, line};

/// A program that serves a page, and the page.
struct Served {
    run: Run,
    errors: BufReader<ChildStderr>,
    host: String,
    page: WebSocket<TcpStream>,
}

impl Served {
    /// Serves a scene from a folder, in which a stand-in for the page may be.
    fn start(folder: &Folder, scene: Option<&str>, web: Option<&str>) -> Self {
        let mut command = program(&["live"]);
        command
            .args(scene)
            .current_dir(folder.path(""))
            .env("XDG_RUNTIME_DIR", folder.path(""));
        if let Some(web) = web {
            command.env("PALPATE_WEB", web);
        }
        let mut run = Run::of(command);
        let mut errors = BufReader::new(run.0.stderr.take().unwrap());
        let address = line(&mut errors);
        let (_, address) = address.trim().split_once("http://").unwrap();
        let (host, token) = address.split_once("/#").unwrap();
        line(&mut errors);
        let request = format!("ws://{host}/socket?token={token}").into_client_request();
        let mut request = request.unwrap();
        let origin = format!("http://{host}").parse().unwrap();
        request.headers_mut().insert("origin", origin);
        let stream = TcpStream::connect(host).unwrap();
        let (mut page, _) = tungstenite::client(request, stream).unwrap();
        say(&mut page, &json!({ "do": "hello", "version": 2 }));
        heard(&mut page, |message| message["do"] == "scene");
        Self { run, errors, host: host.to_owned(), page }
    }

    fn edit(&mut self, name: &str) {
        let change = json!({ "at": "/bodies/0/name", "to": name });
        say(&mut self.page, &json!({ "do": "edit", "base": 1, "changes": [change], "id": 5 }));
        assert_eq!(heard(&mut self.page, |message| message["id"] == 5)["do"], "done");
    }

    /// Ends the program by a signal; its status, and what it says until then.
    fn end(mut self, signal: i32) -> (Option<i32>, String) {
        self.run.signal(signal);
        let mut said = String::new();
        self.errors.read_to_string(&mut said).unwrap();
        (self.run.0.wait().unwrap().code(), said)
    }
}

fn say(page: &mut WebSocket<TcpStream>, message: &Value) {
    page.send(Message::Text(message.to_string().into())).unwrap();
}

fn heard(page: &mut WebSocket<TcpStream>, is_wanted: impl Fn(&Value) -> bool) -> Value {
    loop {
        if let Message::Text(text) = page.read().unwrap() {
            let message = serde_json::from_str(&text).unwrap();
            if is_wanted(&message) {
                return message;
            }
        }
    }
}

#[test]
fn edits_are_kept_beside_the_scene() {
    for signal in [SIGINT, SIGTERM, SIGHUP] {
        if signal == SIGHUP && !hears_hang_ups() {
            continue;
        }
        let folder = Folder::new();
        let scene = folder.write("coin.json", &disc(0.05));
        let mut served = Served::start(&folder, Some(&scene), None);
        served.edit("penny");
        let (status, said) = served.end(signal);
        let kept = folder.name("coin.unsaved.json");
        assert_eq!(said, format!("edits that were not saved are kept in {kept}\n"));
        assert_eq!(status, Some(0));
        assert!(fs::read_to_string(&kept).unwrap().contains("penny"));
        assert_eq!(fs::read_to_string(&scene).unwrap(), disc(0.05));
    }
}

#[test]
fn a_scene_that_is_saved_is_kept_nowhere_else() {
    let folder = Folder::new();
    let scene = folder.write("coin.json", &disc(0.05));
    let served = Served::start(&folder, Some(&scene), None);
    let (status, said) = served.end(SIGTERM);
    assert_eq!((status, said.as_str()), (Some(0), ""));
    assert!(!folder.path("coin.unsaved.json").exists());
}

#[test]
fn edits_of_the_gallery_are_kept_in_the_current_folder() {
    let folder = Folder::new();
    let mut served = Served::start(&folder, None, None);
    served.edit("first");
    let (_, said) = served.end(SIGINT);
    let (_, file) = said.trim_end().split_once(" are kept in ").unwrap();
    assert!(file.ends_with("gallery.unsaved.json"), "{said}");
    assert!(fs::read_to_string(file).unwrap().contains("\"first\""));
}

/// A thread that read a file once kept the program from ending.
#[test]
fn a_thread_that_hangs_keeps_no_program_from_ending() {
    let folder = Folder::new();
    let scene = folder.write("coin.json", &disc(0.05));
    let web = folder.path("web");
    fs::create_dir(&web).unwrap();
    // Whoever reads a pipe that nobody writes waits for good.
    let pipe = web.join("main.js");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status().unwrap();
    assert!(made.success());
    let mut served = Served::start(&folder, Some(&scene), web.to_str());
    served.edit("penny");
    let hanging: Vec<_> = (0..8)
        .map(|_| {
            let mut stream = TcpStream::connect(&served.host).unwrap();
            let request = format!("GET /main.js HTTP/1.1\r\nHost: {}\r\n\r\n", served.host);
            std::io::Write::write_all(&mut stream, request.as_bytes()).unwrap();
            stream
        })
        .collect();
    // Messages of a page that come later are still heard.
    served.edit_again();
    let (status, said) = served.end(SIGINT);
    assert!(status == Some(0) && said.contains("coin.unsaved.json"), "{status:?} {said}");
    drop(hanging);
}

impl Served {
    fn edit_again(&mut self) {
        say(&mut self.page, &json!({ "do": "undo" }));
        say(&mut self.page, &json!({ "do": "redo", "id": 6 }));
        assert_eq!(heard(&mut self.page, |message| message["id"] == 6)["do"], "done");
    }
}
