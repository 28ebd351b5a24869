// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Suites of this program beside those of another revision, in turns on the same machine.
//!
//! The revision is built in a work tree of its own under `target/`. In each round both programs
//! run the suite. A key got slower if two ratios of this program to the other say so: the median
//! of those within each round, and that of the least numbers of all rounds. A machine that changes
//! its pace from minute to minute raises one of them alone. Times over the reference are compared
//! where both revisions print them: they do not depend on how busy the machine is. The reference
//! itself is a row, so that it cannot get slower unseen.

use std::collections::{BTreeMap, BTreeSet};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};

use clap::{Args, ValueEnum};

use crate::Instructions;
use crate::fields::Rows;
use crate::reference;
use crate::rounds::median;

/// What is compared with what.
#[derive(Debug, Args)]
pub(crate) struct Comparison {
    /// The revision to compare with, as git names it.
    revision: String,
    /// The suites, one after the other.
    #[arg(required = true)]
    suites: Vec<SuiteName>,
    /// The beginning of keys. Default: all times except maxima and those of peers.
    #[arg(long = "key", value_name = "KEY")]
    keys: Vec<String>,
    /// The largest ratio that is not slower.
    #[arg(long, default_value_t = 1.05)]
    at_most: f64,
    /// Another limit for keys that begin with PREFIX. The longest matching prefix applies.
    #[arg(long, value_name = "PREFIX=RATIO")]
    allow: Vec<Exception>,
    /// How often both programs run each suite.
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..))]
    rounds: u32,
    /// One part of the suite `collide` alone.
    #[arg(long, value_parser = clap::builder::PossibleValuesParser::new(crate::collide::parts()))]
    only: Option<String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum SuiteName {
    Fields,
    Collide,
    Haptics,
}

impl SuiteName {
    fn name(self) -> &'static str {
        match self {
            Self::Fields => "fields",
            Self::Collide => "collide",
            Self::Haptics => "haptics",
        }
    }
}

/// The largest ratio of the keys that begin with a prefix.
#[derive(Clone, Debug, PartialEq)]
struct Exception {
    prefix: String,
    at_most: f64,
}

impl std::str::FromStr for Exception {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("`{text}` is not PREFIX=RATIO, as in S3.distance=1.1");
        let (prefix, ratio) = text.rsplit_once('=').ok_or_else(wrong)?;
        let at_most = ratio.parse().map_err(|_| wrong())?;
        if prefix.is_empty() || !(at_most > 0.0 && f64::is_finite(at_most)) {
            return Err(wrong());
        }
        Ok(Self { prefix: prefix.to_owned(), at_most })
    }
}

/// A key and how this program stands to the other.
#[derive(Debug, PartialEq)]
struct Compared {
    key: String,
    /// Of the ratios of all rounds.
    median: f64,
    least: f64,
    largest: f64,
    /// The ratio of the least numbers of all rounds.
    of_least: f64,
}

impl Comparison {
    /// Runs both programs in turns, and prints how they stand; fails if a key got slower.
    pub(crate) fn run(
        &self,
        instructions: Option<Instructions>,
    ) -> Result<ExitCode, Box<dyn Error>> {
        if self.only.is_some() && self.suites != [SuiteName::Collide] {
            return Err("--only is for collide".into());
        }
        let other = build(&self.revision)?;
        let this = std::env::current_exe()?;
        let mut unused: BTreeSet<&str> =
            self.allow.iter().map(|exception| exception.prefix.as_str()).collect();
        let (mut slower, mut count) = (0, 0);
        for suite in &self.suites {
            let mut rounds = Vec::new();
            for round in 1..=self.rounds {
                eprintln!("{}: round {round} of {} …", suite.name(), self.rounds);
                let measure = |program| self.measure(program, *suite, instructions);
                // The two programs take turns to run first.
                rounds.push(if round % 2 == 0 {
                    let this = measure(&this)?;
                    (this, measure(&other)?)
                } else {
                    let other = measure(&other)?;
                    (measure(&this)?, other)
                });
            }
            let compared = compare(&rounds, &self.keys);
            count += compared.len();
            println!(
                "{:<60}  median  [least, largest]  of least",
                format!("{}: ratios of all rounds", suite.name())
            );
            for row in &compared {
                let exception = exception(&self.allow, &row.key);
                if let Some(exception) = exception {
                    unused.remove(exception.prefix.as_str());
                }
                let at_most = exception.map_or(self.at_most, |exception| exception.at_most);
                slower += usize::from(row.print(at_most));
            }
            for key in missing(&rounds, &self.keys) {
                println!("{key:<60} printed by {} alone", self.revision);
            }
        }
        if count == 0 {
            return Err("both revisions print none of these keys".into());
        }
        for prefix in unused {
            eprintln!("palpate-bench: no key begins with `{prefix}`, which --allow names");
        }
        println!(
            "{slower} of {count} keys got slower: above {} or above their --allow limit",
            self.at_most
        );
        Ok(if slower > 0 { ExitCode::FAILURE } else { ExitCode::SUCCESS })
    }

    /// The rows that a program prints.
    fn measure(
        &self,
        program: &Path,
        suite: SuiteName,
        instructions: Option<Instructions>,
    ) -> Result<Rows, Box<dyn Error>> {
        let mut command = Command::new(program);
        command.stderr(Stdio::null()).arg(suite.name());
        if suite != SuiteName::Fields {
            command.args(["--runs", "1"]);
        }
        if let Some(part) = &self.only {
            command.args(["--only", part]);
        }
        if let Some(set) = instructions.and_then(|set| set.to_possible_value()) {
            command.args(["--instructions", set.get_name()]);
        }
        let rows: BTreeMap<String, Option<f64>> =
            serde_json::from_str(&printed(command.arg("--json"))?)?;
        // What is not finite is null in JSON.
        Ok(rows.into_iter().filter_map(|(key, number)| Some((key, number?))).collect())
    }
}

impl Compared {
    /// Prints the row; `true` if it is slower.
    fn print(&self, at_most: f64) -> bool {
        let Self { key, median, least, largest, of_least } = self;
        let is_slower = median.min(*of_least) > at_most;
        let verdict = if is_slower { format!("slower than {at_most}") } else { String::new() };
        println!(
            "{key:<60} {median:>7.3}  [{least:.3}, {largest:.3}]  {of_least:>7.3}  {verdict}"
        );
        is_slower
    }
}

/// The exception for a key: that of the longest prefix.
fn exception<'e>(all: &'e [Exception], key: &str) -> Option<&'e Exception> {
    let fitting = all.iter().filter(|exception| key.starts_with(&exception.prefix));
    fitting.max_by_key(|exception| exception.prefix.len())
}

/// `true` if a key was asked for.
fn is_asked(key: &str, asked: &[String]) -> bool {
    match asked {
        [] => is_ours(key),
        _ => asked.iter().any(|asked| key.starts_with(asked.as_str())),
    }
}

/// The keys that the second program of each round prints alone.
fn missing(rounds: &[(Rows, Rows)], asked: &[String]) -> Vec<String> {
    let Some((this, other)) = rounds.first() else { return Vec::new() };
    let is_missing = |key: &&String| !this.contains_key(*key) && is_asked(key, asked);
    other.keys().filter(is_missing).cloned().collect()
}

/// How the first program of each round stands to the second, for each key that both print.
fn compare(rounds: &[(Rows, Rows)], asked: &[String]) -> Vec<Compared> {
    let Some((this, other)) = rounds.first() else { return Vec::new() };
    let both = |key: &str| this.contains_key(key) && other.contains_key(key);
    // Of a time that both divide by the reference, the ratio.
    let is_best = |key: &&String| match reference::over(key) {
        Some(over) => !both(&over),
        None => key.ends_with(reference::OVER),
    };
    let keys = this.keys().filter(|key| both(key) && is_asked(key, asked)).filter(is_best);
    keys.map(|key| {
        let ratios =
            rounds.iter().filter_map(|(this, other)| Some(this.get(key)? / other.get(key)?));
        let ratios: Vec<f64> = ratios.collect();
        Compared {
            key: key.clone(),
            least: ratios.iter().copied().fold(f64::INFINITY, f64::min),
            largest: ratios.iter().copied().fold(0.0, f64::max),
            of_least: least_of(rounds.iter().map(|(this, _)| this), key)
                / least_of(rounds.iter().map(|(_, other)| other), key),
            median: median(ratios),
        }
    })
    .collect()
}

/// The least number of a key in all rounds.
fn least_of<'r>(rounds: impl Iterator<Item = &'r Rows>, key: &str) -> f64 {
    rounds.filter_map(|rows| rows.get(key)).copied().fold(f64::INFINITY, f64::min)
}

/// `true` for times of ours that mean something from one run to the next.
fn is_ours(key: &str) -> bool {
    let is_of_peer = ["fidget", "parry"].iter().any(|peer| key.contains(peer));
    let is_extreme = [".max", ".clock"].iter().any(|stat| key.contains(stat));
    !is_of_peer && !is_extreme
}

/// The program of a revision, built in a work tree under `target/`.
fn build(revision: &str) -> Result<PathBuf, Box<dyn Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize()?;
    let git = |arguments: &[&str]| {
        let mut command = Command::new("git");
        command.current_dir(&root).args(arguments);
        printed(&mut command)
    };
    let commit = git(&["rev-parse", "--verify", &format!("{revision}^{{commit}}")])?;
    let commit = commit.trim();
    let tree = root.join("target/compare").join(commit);
    if !tree.join("Cargo.toml").exists() {
        // Those whose folders were removed are forgotten first.
        git(&["worktree", "prune"])?;
        let place = tree.to_str().ok_or("the repository's path is not Unicode")?;
        git(&["worktree", "add", "--detach", place, commit])?;
    }
    eprintln!("building {commit} …");
    let target = tree.join("target");
    let status = Command::new("cargo")
        .args(["build", "--release", "--locked", "--quiet", "-p", "palpate-bench"])
        .current_dir(&tree)
        .env("CARGO_TARGET_DIR", &target)
        .status()?;
    if !status.success() {
        return Err(format!("{commit} does not build").into());
    }
    let name = format!("palpate-bench{}", std::env::consts::EXE_SUFFIX);
    Ok(target.join("release").join(name))
}

/// What a program prints on standard output.
fn printed(command: &mut Command) -> Result<String, Box<dyn Error>> {
    let output = command.output()?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        return Err(format!("{command:?} failed: {said}").into());
    }
    Ok(String::from_utf8(output.stdout)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(rows: &[(&str, f64)]) -> Rows {
        rows.iter().map(|(key, number)| ((*key).to_owned(), *number)).collect()
    }

    #[test]
    fn ratios_are_taken_within_rounds() {
        // The machine is three times as slow in the second round, for both.
        let rounds = [
            (rows(&[("a.ns", 2.0)]), rows(&[("a.ns", 4.0)])),
            (rows(&[("a.ns", 6.0)]), rows(&[("a.ns", 12.0)])),
            (rows(&[("a.ns", 5.0)]), rows(&[("a.ns", 4.0)])),
        ];
        let compared = compare(&rounds, &[]);
        let key = "a.ns".into();
        // Of the least numbers: 2 and 4.
        let expected = Compared { key, median: 0.5, least: 0.5, largest: 1.25, of_least: 0.5 };
        assert_eq!(compared, [expected]);
    }

    #[test]
    fn ratios_to_the_reference_are_compared_where_both_print_them() {
        let this =
            rows(&[("a.ns", 2.0), ("a.over_S3", 1.0), ("b.ns", 3.0), ("b.over_S3", 1.5)]);
        let other = rows(&[("a.ns", 4.0), ("a.over_S3", 0.5), ("b.ns", 2.0)]);
        let keys = |compared: &[Compared]| -> Vec<(String, f64)> {
            compared.iter().map(|row| (row.key.clone(), row.median)).collect()
        };
        let compared = compare(&[(this, other)], &[]);
        let expected = [("a.over_S3".to_owned(), 2.0), ("b.ns".to_owned(), 1.5)];
        assert_eq!(keys(&compared), expected);
    }

    #[test]
    fn keys_are_chosen_by_how_they_begin() {
        let row = rows(&[
            ("tick.S3.p50_ns", 1.0),
            ("tick.S3.max_ns", 1.0),
            ("tick.S3.evaluations", 1.0),
            ("S3.distance.point.fidget_jit.ns", 1.0),
            (reference::KEY, 1.0),
        ]);
        let rounds = [(row.clone(), row)];
        let keys = |asked: &[&str]| -> Vec<String> {
            let asked: Vec<_> = asked.iter().map(|key| (*key).to_owned()).collect();
            compare(&rounds, &asked).into_iter().map(|row| row.key).collect()
        };
        assert_eq!(keys(&[]), [reference::KEY, "tick.S3.p50_ns"]);
        assert_eq!(keys(&["tick"]), ["tick.S3.max_ns", "tick.S3.p50_ns"]);
        assert_eq!(keys(&["nothing"]), [""; 0]);
    }

    #[test]
    fn keys_that_are_gone_are_named() {
        let rounds = [(rows(&[("a.ns", 1.0)]), rows(&[("a.ns", 1.0), ("b.ns", 1.0)]))];
        assert_eq!(missing(&rounds, &[]), ["b.ns"]);
        assert_eq!(missing(&rounds, &["a".to_owned()]), [""; 0]);
    }

    #[test]
    fn the_longest_prefix_counts() {
        let all: Vec<Exception> =
            ["S=2", "S3.distance=1.1"].iter().map(|text| text.parse().unwrap()).collect();
        let at_most = |key| exception(&all, key).map(|exception| exception.at_most);
        assert_eq!(at_most("S3.distance.64.ns"), Some(1.1));
        assert_eq!(at_most("S3.model.64.ns"), Some(2.0));
        assert_eq!(at_most("tick.S3"), None);
        for wrong in ["S3", "=1", "S3=", "S3=x", "S3=-1", "S3=inf"] {
            assert!(wrong.parse::<Exception>().unwrap_err().contains(wrong));
        }
    }
}
