// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Files without an end, outputs that take nothing, and what is left when a run is killed.

use std::fs;
#[cfg(unix)]
use std::io::Write;
#[cfg(unix)]
use std::process::{Command, Output, Stdio};

#[cfg(unix)]
use signal_hook::consts::{SIGKILL, SIGQUIT};

#[cfg(unix)]
use crate::common::program;
use crate::common::{Folder, errors, palpate, status, text};
#[cfg(unix)]
use crate::interrupted::Run;

const TOO_LARGE: &str = "is longer than 268435456 bytes, the most that are read";

/// What `sh` makes of a script, in which `palpate` is the program.
#[cfg(unix)]
fn shell(script: &str) -> Output {
    let eval = program(&[]);
    let mut shell = Command::new("bash");
    shell.args(["-c", &format!("palpate() {{ \"$0\" \"$@\"; }}; {script}")]);
    shell.arg(eval.get_program()).current_dir(eval.get_current_dir().unwrap());
    shell.env("PALPATE_CACHE", "").stdin(Stdio::null()).output().unwrap()
}

/// Each was read until the memory was full.
#[cfg(target_os = "linux")]
#[test]
fn no_file_without_an_end_is_read_to_its_end() {
    let folder = Folder::new();
    let device = folder.path("zero.json");
    std::os::unix::fs::symlink("/dev/zero", &device).unwrap();
    let device = device.to_str().unwrap();
    let simulated = format!("simulated:{device}");
    let row = "line 1: the row is longer than 1048576 bytes";
    let profile = "it is longer than 1048576 bytes, the most that are read";
    let token = "is longer than 4096 bytes";
    for (arguments, said) in [
        (&["check", "/dev/zero"][..], TOO_LARGE),
        (&["eval", "scenes/cup.json", "--points", "/dev/zero"], row),
        (&["feel", "scenes/cup.json", "--path", "/dev/zero"], row),
        (&["sweep", "scenes/cup.json", "--motion", "/dev/zero"], TOO_LARGE),
        (&["plot", "scenes/s1.json", "--map", "error", "--against", "/dev/zero"], TOO_LARGE),
        (&["feel", "scenes/cup.json", "--device", &simulated], profile),
        (&["devices", "--profile", device], profile),
        (&["live", "scenes/cup.json", "--token-file", "/dev/zero"], token),
    ] {
        let output = palpate(arguments);
        let errors = errors(&output);
        assert_eq!(status(&output), 2, "{arguments:?}: {errors}");
        assert!(errors.contains(said), "{arguments:?}: {errors}");
    }
}

#[test]
fn an_option_says_how_much_of_a_file_is_read() {
    let folder = Folder::new();
    let scene = folder.write("ball.json", crate::outputs::BALL);
    let rows = format!("x_m,y_m,z_m\n{}", "0.1,0.2,0.3\n".repeat(100));
    let points = folder.write("points.csv", &rows);
    let path = folder.write("path.csv", "time_s,x_m,y_m,z_m\n0,0,0,0\n0.1,0,0,0\n");
    for arguments in [
        &["check", &scene, "--largest-file", "20"][..],
        &["eval", &scene, "--points", &points, "--largest-file", "1000"],
        &["feel", &scene, "--path", &path, "--largest-file", "20"],
    ] {
        let output = palpate(arguments);
        let errors = errors(&output);
        assert_eq!(status(&output), 2, "{arguments:?}: {errors}");
        assert!(errors.contains("bytes, the most that are read; --largest-file"), "{errors}");
    }
    let exact = rows.len().to_string();
    let output = palpate(&["eval", &scene, "--points", &points, "--largest-file", &exact]);
    assert_eq!((status(&output), text(&output).lines().count()), (0, 101));
}

/// A pipe says no length: the rows before the limit are answered.
#[cfg(unix)]
#[test]
fn points_of_a_pipe_are_counted() {
    let output = shell(
        "yes 0.1,0.2,0.3 | sed '1s/.*/x_m,y_m,z_m/' | \
         palpate eval scenes/s1.json --points /dev/stdin --largest-file 1000000",
    );
    assert_eq!(status(&output), 2);
    assert!(errors(&output).contains("is longer than 1000000 bytes"), "{}", errors(&output));
    // Rows without an end that are no rows.
    for row in ["", "oops,0,0"] {
        let output = shell(&format!(
            "yes '{row}' | sed '1s/.*/x_m,y_m,z_m/' | \
             palpate eval scenes/s1.json --points /dev/stdin --largest-file 4000000"
        ));
        assert_eq!(status(&output), 2, "{row}");
        assert!(errors(&output).contains("longer than"), "{}", errors(&output));
    }
}

#[cfg(unix)]
#[test]
fn a_closed_standard_output_is_an_error() {
    let commands = ["eval scenes/s1.json --at 0,0,0", "shapes --json", "--help", "schema"];
    for closing in [">&-", "<&- >&-"] {
        for command in commands {
            let output = shell(&format!("palpate {command} {closing}"));
            let said = "palpate: the output cannot be written: standard output is closed\n";
            assert_eq!((status(&output), errors(&output).as_str()), (2, said), "{command}");
        }
    }
    // Where the answer is not wanted, it is not missed, however the caller opened that.
    for null in ["> /dev/null", "1<> /dev/null"] {
        let output = shell(&format!("palpate eval scenes/s1.json --at 0,0,0 {null}"));
        assert_eq!((status(&output), errors(&output).as_str()), (0, ""), "{null}");
    }
}

#[cfg(unix)]
#[test]
fn a_reader_that_leaves_ends_the_run_quietly() {
    for command in [
        "schema | head -c 1",
        "yes 0.1,0.2,0.3 | sed '1s/.*/x_m,y_m,z_m/' | \
         palpate eval scenes/s1.json --points /dev/stdin | head -1",
        "yes 0.1,0.2,0.3 | sed '1s/.*/x_m,y_m,z_m/' | \
         palpate eval scenes/s1.json --points /dev/stdin --output /dev/stdout | head -1",
    ] {
        let first = if command.starts_with("yes") { "" } else { "palpate " };
        let status_of = "${PIPESTATUS[@]: -2:1}";
        let output = shell(&format!("{first}{command} > /dev/null; exit \"{status_of}\""));
        assert_eq!((status(&output), errors(&output).as_str()), (141, ""), "{command}");
    }
}

/// A signal that ends the run left a file of another name.
#[cfg(target_os = "linux")]
#[test]
fn nothing_is_left_of_a_file_that_is_too_large() {
    let folder = Folder::new();
    let place = folder.name("cup.stl");
    let output = shell(&format!(
        "ulimit -f 10; palpate mesh scenes/cup.json --cell 0.01 --output {place}"
    ));
    assert_eq!(status(&output), 2);
    assert!(errors(&output).contains("cup.stl: File too large"), "{}", errors(&output));
    assert_eq!(fs::read_dir(folder.path("")).unwrap().count(), 0);
}

#[cfg(target_os = "linux")]
#[test]
fn nothing_is_left_of_a_run_that_is_killed() {
    for signal in [SIGQUIT, SIGKILL] {
        let folder = Folder::new();
        let place = folder.name("distances.csv");
        let eval =
            program(&["eval", "scenes/s1.json", "--points", "/dev/stdin", "--output", &place]);
        let mut without_core = Command::new("sh");
        without_core.args(["-c", "ulimit -c 0; exec \"$0\" \"$@\""]);
        without_core.arg(eval.get_program()).args(eval.get_args());
        without_core.current_dir(eval.get_current_dir().unwrap());
        let mut run = Run::of(without_core);
        let points = run.0.stdin.as_mut().unwrap();
        writeln!(points, "x_m,y_m,z_m").unwrap();
        // More than a pipe holds: the run reads them, and has its output open.
        points.write_all("0.1,0.2,0.3\n".repeat(200_000).as_bytes()).unwrap();
        run.signal(signal);
        assert_eq!(run.0.wait().unwrap().code(), None);
        assert_eq!(fs::read_dir(folder.path("")).unwrap().count(), 0);
    }
}
