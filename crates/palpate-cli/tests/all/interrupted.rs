// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Ctrl-C, SIGTERM and the end of a terminal: what was done is written and reported.
#![cfg(unix)]

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, Command, Stdio};

use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};

use crate::common::{Folder, program};

const INTERRUPTED: Option<i32> = Some(130);

/// A run of the program that is talked to.
pub(crate) struct Run(pub(crate) Child);

impl Run {
    pub(crate) fn start(arguments: &[&str]) -> Self {
        Self::of(program(arguments))
    }

    pub(crate) fn of(mut command: Command) -> Self {
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        Self(command.spawn().unwrap())
    }

    pub(crate) fn signal(&self, signal: i32) {
        let signal = rustix::process::Signal::from_named_raw(signal).unwrap();
        let child = rustix::process::Pid::from_child(&self.0);
        rustix::process::kill_process(child, signal).unwrap();
    }
}

/// A run that a failed test leaves behind ends with it.
impl Drop for Run {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// The next line of `pipe`.
pub(crate) fn line(pipe: &mut impl BufRead) -> String {
    let mut line = String::new();
    pipe.read_line(&mut line).unwrap();
    line
}

/// `true` if programs that this one starts are told that their terminal ended.
pub(crate) fn hears_hang_ups() -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let signals = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    signals.is_some_and(|signals| (signals >> (SIGHUP - 1)) & 1 == 0)
}

#[test]
fn feel_ends_with_trace_picture_and_report() {
    for signals in [&[SIGINT][..], &[SIGTERM], &[SIGHUP, SIGHUP], &[SIGTERM, SIGHUP]] {
        // A run of the tests that ignores the end of its terminal hands that on.
        if signals[0] == SIGHUP && !hears_hang_ups() {
            continue;
        }
        let folder = Folder::new();
        let (trace, plot) = (folder.name("trace.csv"), folder.name("touch.svg"));
        let mut run = Run::start(&[
            "feel",
            "scenes/cup.json",
            "--duration",
            "600",
            "--rate",
            "500",
            "--json",
            "--trace",
            &trace,
            "--plot",
            &plot,
        ]);
        let mut errors = BufReader::new(run.0.stderr.take().unwrap());
        assert!(line(&mut errors).contains("Ctrl-C ends"));
        signals.iter().for_each(|signal| run.signal(*signal));
        let mut report = String::new();
        run.0.stdout.take().unwrap().read_to_string(&mut report).unwrap();
        assert_eq!(run.0.wait().unwrap().code(), INTERRUPTED);
        let report: serde_json::Value = serde_json::from_str(&report).unwrap();
        assert_eq!(report["ending"]["kind"], "interrupted");
        let ticks = report["ticks"].as_u64().unwrap();
        assert!(ticks < 300_000, "{ticks}");
        let rows = fs::read_to_string(trace).unwrap().lines().count() as u64;
        assert_eq!(rows, 1 + ticks);
        assert!(fs::read_to_string(plot).unwrap().starts_with("<svg"));
    }
}

#[test]
fn eval_ends_after_whole_rows() {
    let mut run = Run::start(&["eval", "scenes/s1.json", "--points", "/dev/stdin"]);
    let mut points = run.0.stdin.take().unwrap();
    let mut answers = BufReader::new(run.0.stdout.take().unwrap());
    // More than a batch; none of it fits into a pipe unless it is read.
    let writer = std::thread::spawn(move || {
        writeln!(points, "x_m,y_m,z_m").unwrap();
        points.write_all("0.1,0.2,0.3\n".repeat(70_000).as_bytes()).unwrap();
        points
    });
    assert!(line(&mut answers).starts_with("x_m,"));
    let first = line(&mut answers);
    assert!(first.starts_with("0.1,0.2,0.3,"), "{first}");
    let reader = std::thread::spawn(move || answers.lines().map(Result::unwrap).collect());
    let mut points = writer.join().unwrap();
    run.signal(SIGINT);
    // It ends at one of the next points.
    while writeln!(points, "0.1,0.2,0.3").is_ok() {}
    let rest: Vec<String> = reader.join().unwrap();
    assert_eq!(run.0.wait().unwrap().code(), INTERRUPTED);
    assert_eq!((1 + rest.len()) % 65_536, 0);
    assert!(rest.iter().all(|line| *line == first.trim_end()));
}

#[cfg(target_os = "linux")]
#[test]
fn a_run_that_outlives_its_terminal_goes_on() {
    let eval = program(&["eval", "scenes/s1.json", "--points", "/dev/stdin"]);
    // As `nohup` does.
    let mut ignoring = Command::new("sh");
    ignoring.args(["-c", "trap '' HUP; exec \"$0\" \"$@\""]);
    ignoring.arg(eval.get_program()).args(eval.get_args());
    ignoring.current_dir(eval.get_current_dir().unwrap());
    let mut run = Run::of(ignoring);
    let mut points = run.0.stdin.take().unwrap();
    let mut answers = BufReader::new(run.0.stdout.take().unwrap());
    writeln!(points, "x_m,y_m,z_m\n0.1,0.2,0.3").unwrap();
    assert!(line(&mut answers).starts_with("x_m,"));
    run.signal(SIGHUP);
    drop(points);
    assert!(line(&mut answers).starts_with("0.1,0.2,0.3,"));
    assert_eq!(run.0.wait().unwrap().code(), Some(0));
}

#[test]
fn a_second_signal_ends_at_once_and_leaves_the_old_output() {
    let folder = Folder::new();
    let output = folder.write("distances.csv", "the old distances");
    let mut run = Run::start(&[
        "eval",
        "scenes/s1.json",
        "--points",
        "/dev/stdin",
        "--output",
        &output,
        "--threads",
        "100000",
    ]);
    // Said before the points are read; the input stays open.
    let mut errors = BufReader::new(run.0.stderr.take().unwrap());
    assert!(line(&mut errors).contains("this machine runs"));
    run.signal(SIGINT);
    run.signal(SIGTERM);
    assert_eq!(run.0.wait().unwrap().code(), INTERRUPTED);
    assert_eq!(fs::read_to_string(output).unwrap(), "the old distances");
}

#[test]
fn the_gallery_ends_with_whole_sheets() {
    let folder = Folder::new();
    let output = folder.name("pictures");
    let mut run = Run::start(&["gallery", "--output", &output, "--format", "svg"]);
    let mut answers = BufReader::new(run.0.stdout.take().unwrap());
    let first = line(&mut answers);
    assert!(first.contains("shapes-of-the-plane.svg: "), "{first}");
    run.signal(SIGINT);
    let rest: Vec<String> = answers.lines().map(Result::unwrap).collect();
    assert_eq!(run.0.wait().unwrap().code(), INTERRUPTED);
    assert!(rest.len() < 4, "all sheets were drawn: {rest:?}");
    let sheets = fs::read_dir(&output).unwrap().count();
    assert_eq!(sheets, 1 + rest.len());
    for sheet in fs::read_dir(&output).unwrap() {
        let svg = fs::read_to_string(sheet.unwrap().path()).unwrap();
        assert!(svg.trim_end().ends_with("</svg>"));
    }
}

#[test]
fn a_turntable_keeps_the_pictures_that_are_finished() {
    let folder = Folder::new();
    let frames = folder.name("frames");
    let run = ["render", "scenes/cup.json", "--turntable", "1000", "--frames", &frames];
    let mut run = Run::start(&[&run[..], &["--width", "80", "--height", "60"]].concat());
    let mut answers = BufReader::new(run.0.stdout.take().unwrap());
    let first = line(&mut answers);
    assert!(first.ends_with("cup-0001.png\n"), "{first}");
    run.signal(SIGINT);
    let rest: Vec<String> = answers.lines().map(Result::unwrap).collect();
    assert_eq!(run.0.wait().unwrap().code(), INTERRUPTED);
    let finished = fs::read_dir(&frames).unwrap().count();
    assert!(finished < 1000, "all pictures were drawn");
    assert!(rest.len() == finished || rest.len() == finished - 1, "{rest:?}");
    for picture in fs::read_dir(&frames).unwrap() {
        let png = fs::read(picture.unwrap().path()).unwrap();
        assert!(png.ends_with(b"IEND\xAE\x42\x60\x82"));
    }
}

/// A signal did nothing until the body was weighed, half a minute later.
#[test]
fn mass_ends_while_it_weighs_a_body() {
    let folder = Folder::new();
    let torus = r#"{ "torus": { "ring_radius": 0.5, "radius": 0.2 } }"#;
    let row = r#"{ "spacing": 2, "first": -20, "last": 20 }"#;
    let many =
        format!(r#"{{ "repeat": {{ "x": {row}, "y": {row}, "z": {row} }}, "of": {torus} }}"#);
    let scene = format!(
        r#"{{ "palpate": 1, "dimension": 3, "bodies": [
            {{ "name": "one", "shape": {torus} }}, {{ "name": "many", "shape": {many} }} ] }}"#
    );
    let scene = folder.write("many.json", &scene);
    let arguments = ["mass", &scene, "--tolerance", "0.002", "--cells", "6000000"];
    let mut run = Run::start(&arguments);
    let mut answers = BufReader::new(run.0.stdout.take().unwrap());
    assert!(line(&mut answers).starts_with("one, "));
    run.signal(SIGINT);
    let told: Vec<_> = answers.lines().map(Result::unwrap).collect();
    assert_eq!(run.0.wait().unwrap().code(), INTERRUPTED);
    assert!(!told.iter().any(|line| line.starts_with("many, ")), "{told:?}");
}

/// A thousand bodies are not weighed between one line and the next.
#[test]
fn mass_tells_of_the_bodies_that_it_has_weighed() {
    let folder = Folder::new();
    let body = |i: u32| {
        let shape = r#"{ "torus": { "ring_radius": 0.5, "radius": 0.2 } }"#;
        format!(r#"{{ "name": "body {i}", "shape": {shape} }}"#)
    };
    let bodies: Vec<_> = (0..1000).map(body).collect();
    let bodies = bodies.join(", ");
    let scene = format!(r#"{{ "palpate": 1, "dimension": 3, "bodies": [{bodies}] }}"#);
    let scene = folder.write("many.json", &scene);
    let mut run = Run::start(&["mass", &scene, "--tolerance", "0.002"]);
    let mut answers = BufReader::new(run.0.stdout.take().unwrap());
    assert!(line(&mut answers).starts_with("body 0, "));
    run.signal(SIGINT);
    let told = answers.lines().map(Result::unwrap);
    let told = told.filter(|line| line.starts_with("body ")).count();
    assert_eq!(run.0.wait().unwrap().code(), INTERRUPTED);
    assert!(told < 999, "all bodies were weighed");
}

/// A local search beside a proof could not be interrupted, and the proof was lost with it.
#[cfg(target_os = "linux")]
#[test]
fn sweep_reports_its_proof_when_a_local_search_is_interrupted() {
    let folder = Folder::new();
    let scene = folder.write(
        "falls.json",
        r#"{ "palpate": 1, "dimension": 3, "bodies": [
            { "name": "floor", "shape": { "cuboid": { "size": [1, 0.1, 1] } } },
            { "name": "ball", "shape": { "ball": { "radius": 0.02 } },
              "pose": { "translation": [0, 0.3, 0] } } ],
          "motions": [{ "body": "ball", "to": { "translation": [0, 0.08, 0] } }] }"#,
    );
    let arguments = ["sweep", &scene, "--method", "naive", "--samples", "10000"];
    let mut run = Run::start(&arguments);
    // The proof has its end when the thread of the local search begins.
    let tasks = format!("/proc/{}/task", run.0.id());
    let is_begun = || {
        let tasks = fs::read_dir(&tasks).unwrap().flatten();
        let name = |task: fs::DirEntry| fs::read_to_string(task.path().join("comm"));
        tasks.filter_map(|task| name(task).ok()).any(|name| name == "interruptible\n")
    };
    while !is_begun() {
        assert_eq!(run.0.try_wait().unwrap(), None, "it has ended");
        std::thread::yield_now();
    }
    run.signal(SIGTERM);
    let mut said = String::new();
    run.0.stdout.take().unwrap().read_to_string(&mut said).unwrap();
    assert_eq!(run.0.wait().unwrap().code(), INTERRUPTED);
    assert!(
        said.starts_with(
            "floor \u{2013} ball: apart all the time by more than half of the gap, proven"
        ),
        "{said}"
    );
}
