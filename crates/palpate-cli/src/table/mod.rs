// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! CSV files of numbers, and what is wrong with them.

mod header;

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};

use csv::{ErrorKind, StringRecord};
use palpate::field::LARGEST_LENGTH;
use palpate::scene::{NotUtf8, shortened, utf8};

use crate::input::AXES;
use crate::kind::Kind;
use crate::outcome::Failure;
use header::Header;

/// Bytes of a file that are looked at before it is read: more than any header has.
const HEAD: usize = 1 << 16;

/// How a file may begin that says its encoding.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// The most problems that are told.
const MOST: usize = 20;

/// A CSV file, read row by row. Bad values are noted, and told of all together.
pub(crate) struct Table {
    path: PathBuf,
    reader: csv::Reader<BufReader<File>>,
    header: Header,
    record: StringRecord,
    /// The first problems, and how many there are in all.
    problems: Vec<String>,
    count: usize,
}

impl Table {
    /// Opens a table with a header.
    ///
    /// # Errors
    ///
    /// If the file is something else than a table with commas and a header: what it is.
    pub(crate) fn open(path: &Path) -> Result<Self, Failure> {
        let wrong = |problem: String| Failure::file(path, problem);
        if path.is_dir() {
            return Err(wrong("is a folder; name a file in it".into()));
        }
        let file = File::open(path).map_err(|error| Failure::file(path, error))?;
        let mut file = BufReader::with_capacity(HEAD, file);
        // One read, so that a pipe need not be full before its first row is answered.
        let head = file.fill_buf().map_err(|error| Failure::file(path, error))?;
        if let Err(refused @ NotUtf8::Utf16 { .. }) = utf8(head) {
            return Err(wrong(refused.to_string()));
        }
        match Kind::of(head) {
            None | Some(Kind::Table) => {}
            Some(kind @ Kind::Empty) => return Err(wrong(kind.to_string())),
            Some(kind) => {
                let problem = format!("{kind}, not a table (CSV); {}", kind.advice(path));
                return Err(wrong(problem));
            }
        }
        if head.starts_with(BYTE_ORDER_MARK) {
            file.consume(BYTE_ORDER_MARK.len());
        }
        let mut reader =
            csv::ReaderBuilder::new().trim(csv::Trim::All).flexible(true).from_reader(file);
        let fields = reader.headers().map_err(|error| wrong(in_words(&error)))?.clone();
        let line = reader.position().line().saturating_sub(1).max(1);
        let header = Header::new(&fields, line).map_err(wrong)?;
        let (path, record) = (path.to_owned(), StringRecord::new());
        Ok(Self { path, reader, header, record, problems: Vec::new(), count: 0 })
    }

    /// The place of a column, if it is there.
    pub(crate) fn column(&self, name: &str) -> Option<usize> {
        self.header.place(name)
    }

    /// The failure of the file, for a reason.
    pub(crate) fn failure(&self, problem: impl std::fmt::Display) -> Failure {
        Failure::file(&self.path, problem)
    }

    /// How many bytes of the file were read.
    pub(crate) fn position(&self) -> u64 {
        self.reader.position().byte()
    }

    /// Goes to the next row; `false` if there is none. A row with another number of fields than
    /// the header is noted.
    pub(crate) fn advance(&mut self) -> Result<bool, Failure> {
        let is_there = match self.reader.read_record(&mut self.record) {
            Ok(is_there) => is_there,
            Err(error) => {
                let problem = in_words(&error);
                return Err(self.failure(problem));
            }
        };
        let (fields, columns) = (self.record.len(), self.header.len());
        if is_there && fields != columns {
            let comma = if fields > columns {
                "; a decimal comma makes two fields of a number"
            } else {
                ""
            };
            self.note(format!("{fields} fields, and the header has {columns}{comma}"));
        }
        Ok(is_there)
    }

    /// A number of the row that is finite and at most 1e15 in size; `None` if it is not, which is
    /// noted.
    pub(crate) fn number(&mut self, column: usize) -> Option<f64> {
        let field = self.record.get(column)?;
        let number = field.parse().ok().filter(|x: &f64| x.abs() <= LARGEST_LENGTH);
        if number.is_none() {
            let why = why_no_number(field);
            self.note_at(column, &why);
        }
        number
    }

    /// The text of a field of the row.
    pub(crate) fn text(&self, column: usize) -> &str {
        self.record.get(column).unwrap_or_default()
    }

    /// Notes what is wrong with a field of the row.
    pub(crate) fn note_at(&mut self, column: usize, problem: &str) {
        let name = self.header.name(column);
        self.note_in(&format!(", column {name}"), problem);
    }

    fn note(&mut self, problem: String) {
        self.note_in("", &problem);
    }

    fn note_in(&mut self, place: &str, problem: &str) {
        let line = self.record.position().map_or(0, csv::Position::line);
        if self.problems.len() < MOST {
            self.problems.push(format!("line {line}{place}: {problem}"));
        }
        self.count += 1;
    }

    /// `true` if no problem was noted.
    pub(crate) fn is_good(&self) -> bool {
        self.count == 0
    }

    /// Tells of all problems that were noted.
    pub(crate) fn finish(&self) -> Result<(), Failure> {
        let told = match &self.problems[..] {
            [] => return Ok(()),
            [problem] => problem.clone(),
            problems => {
                let first = if self.count > MOST {
                    format!(", the first {MOST}")
                } else {
                    String::new()
                };
                format!("{} problems{first}:\n  {}", self.count, problems.join("\n  "))
            }
        };
        Err(self.failure(told))
    }
}

/// The places of the columns `others`, then of the coordinates of `D` dimensions, that `what` has.
pub(crate) fn coordinates<const D: usize>(
    table: &Table,
    what: &str,
    others: &[&str],
) -> Result<Vec<usize>, Failure> {
    let axes: Vec<_> = AXES[..D].iter().map(|axis| format!("{axis}_m")).collect();
    let names: Vec<_> = others.iter().copied().chain(axes.iter().map(String::as_str)).collect();
    let places =
        table.header.columns(&names, what).map_err(|problem| table.failure(problem))?;
    if D == 2 && table.column("z_m").is_some() {
        let line = table.header.line();
        let problem = "the column z_m is for 3D scenes, but this scene is 2D";
        return Err(table.failure(format!("line {line}: {problem}")));
    }
    Ok(places)
}

/// Why a field is no number.
fn why_no_number(field: &str) -> String {
    let rule = format!("must be a finite number of at most {LARGEST_LENGTH:e} in size");
    let point = field.replacen(',', ".", 1);
    if field.is_empty() {
        format!("{rule}, got nothing")
    } else if field.contains(',') && point.parse::<f64>().is_ok() {
        format!("{rule}, got \"{field}\"; a decimal comma is written {point}")
    } else {
        format!("{rule}, got \"{}\"", shortened(field))
    }
}

/// An error of a reader, with its line.
fn in_words(error: &csv::Error) -> String {
    match error.kind() {
        ErrorKind::Utf8 { pos, .. } => {
            let line = pos.as_ref().map_or(0, csv::Position::line);
            format!("line {line} is not UTF-8; save the file as UTF-8")
        }
        _ => error.to_string(),
    }
}
