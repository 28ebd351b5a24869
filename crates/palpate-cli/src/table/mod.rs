// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Tables in CSV files.

mod limited;

use std::fs::File;
use std::io::{BufRead, BufReader, ErrorKind as IoErrorKind};
use std::path::{Path, PathBuf};

use csv::{ErrorKind, StringRecord};
use palpate::field::LARGEST_LENGTH;
use palpate::scene::{NotUtf8, near_names, shortened, too_large, utf8};

use self::limited::Limited;
use crate::arguments::{Reading, unread};
use crate::input::AXES;
use crate::kind::Kind;
use crate::outcome::Failure;

/// Bytes of a file that are looked at before it is read: more than any header has.
const HEAD: usize = 1 << 16;

/// How a file may begin that says its encoding.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// The most problems that are told.
const MOST: usize = 20;

/// An error lists at most so many names of columns.
const MOST_NAMES: usize = 60;

/// A CSV file, read row by row. Bad values are noted, and told of all together.
pub(crate) struct Table {
    path: PathBuf,
    reader: csv::Reader<Limited<BufReader<File>>>,
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
    /// If the file is something else than a table with commas and a header: what it is; if it is too
    /// large.
    pub(crate) fn open(path: &Path, reading: Reading) -> Result<Self, Failure> {
        let wrong = |problem: String| Failure::file(path, problem);
        if path.is_dir() {
            return Err(wrong("is a folder; name a file in it".into()));
        }
        let file = File::open(path).map_err(|error| Failure::file(path, error))?;
        let most = reading.largest_file;
        if file.metadata().is_ok_and(|found| found.len() > most) {
            return Err(unread(path, &too_large(most)));
        }
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
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .flexible(true)
            .from_reader(Limited::new(file, most));
        let fields = match reader.headers() {
            Ok(fields) => fields.clone(),
            Err(error) => return Err(refused(path, 1, error)),
        };
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
        let line = self.reader.position().line();
        self.reader.get_mut().begin_row();
        let read = self.reader.read_record(&mut self.record);
        let is_there = read.map_err(|error| refused(&self.path, line, error))?;
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

/// The failure to read the row that begins in a line.
fn refused(path: &Path, line: u64, error: csv::Error) -> Failure {
    match error.into_kind() {
        ErrorKind::Utf8 { pos, .. } => {
            let line = pos.as_ref().map_or(line, csv::Position::line);
            Failure::file(
                path,
                format_args!("line {line} is not UTF-8; save the file as UTF-8"),
            )
        }
        ErrorKind::Io(error) if error.kind() == IoErrorKind::InvalidData => {
            Failure::file(path, format_args!("line {line}: {error}"))
        }
        ErrorKind::Io(error) => unread(path, &error),
        _ => Failure::file(path, format_args!("line {line} is no row of a table (CSV)")),
    }
}

/// The columns of a table.
struct Header {
    names: Vec<String>,
    line: u64,
}

/// Units that a header may have, what they measure, and how many of them are one metre or second.
const UNITS: [(&str, &str, f64); 16] = [
    ("m", "m", 1.0),
    ("mm", "m", 1e3),
    ("cm", "m", 1e2),
    ("dm", "m", 10.0),
    ("km", "m", 1e-3),
    ("um", "m", 1e6),
    ("µm", "m", 1e6),
    ("nm", "m", 1e9),
    ("in", "m", 1.0 / 0.0254),
    ("inch", "m", 1.0 / 0.0254),
    ("ft", "m", 1.0 / 0.3048),
    ("s", "s", 1.0),
    ("ms", "s", 1e3),
    ("us", "s", 1e6),
    ("µs", "s", 1e6),
    ("min", "s", 1.0 / 60.0),
];

impl Header {
    /// The header of a table.
    ///
    /// # Errors
    ///
    /// If the fields are separated by something else than commas, or are numbers.
    fn new(fields: &StringRecord, line: u64) -> Result<Self, String> {
        let names: Vec<String> = fields.iter().map(str::to_owned).collect();
        if names.first().is_some_and(|first| first.starts_with('#')) {
            return Err(format!(
                "line {line}: comments are not read; the first line names the columns"
            ));
        }
        if let [all] = &names[..] {
            let separators = [(';', "semicolons"), ('\t', "tabs"), (' ', "spaces")];
            let found = separators.iter().find(|(separator, _)| all.contains(*separator));
            if let Some((_, name)) = found {
                return Err(format!(
                    "line {line}: the columns are separated by {name}; separate them by commas, and \
                     write numbers with a decimal point"
                ));
            }
        }
        let is_number = |name: &String| name.replace(',', ".").parse::<f64>().is_ok();
        if !names.is_empty() && names.iter().all(is_number) {
            return Err(format!(
                "line {line}: there is no header; the first line names the columns"
            ));
        }
        Ok(Self { names, line })
    }

    /// Its line in the file, from 1.
    fn line(&self) -> u64 {
        self.line
    }

    fn len(&self) -> usize {
        self.names.len()
    }

    fn name(&self, column: usize) -> &str {
        self.names.get(column).map_or("", String::as_str)
    }

    fn place(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|known| known == name)
    }

    /// The places of columns that `what` has.
    ///
    /// # Errors
    ///
    /// If one is missing, or is there more than once.
    fn columns(&self, names: &[&str], what: &str) -> Result<Vec<usize>, String> {
        for name in names {
            let count = self.names.iter().filter(|known| known == name).count();
            if count > 1 {
                let line = self.line;
                return Err(format!(
                    "line {line}: the column {name} is there {count} times; keep the one that is meant"
                ));
            }
        }
        let missing = names.iter().filter(|name| self.place(name).is_none());
        let missing: Vec<_> = missing.map(|name| self.missing(name, names)).collect();
        if missing.is_empty() {
            return Ok(names.iter().filter_map(|name| self.place(name)).collect());
        }
        let (line, names) = (self.line, names.join(","));
        let shown = self.names.iter().take(MOST_NAMES).map(|name| shortened(name));
        let mut found = shown.collect::<Vec<_>>().join(",");
        if self.len() > MOST_NAMES {
            found.push_str(&format!(",… ({} in all)", self.len()));
        }
        let problems = missing.join("; ");
        Err(format!(
            "line {line}: {what} has the columns {names}, the file has {found}: {problems}"
        ))
    }

    /// That a column is missing, and which may be meant by it: none of those that are wanted too.
    fn missing(&self, name: &str, wanted_too: &[&str]) -> String {
        let (wanted, unit) = name.split_once('_').unwrap_or((name, ""));
        let meant = self.names.iter().filter_map(|found| {
            let (quantity, written) = Written::of(found);
            (quantity == wanted || quantity == "t" && wanted == "time")
                .then_some((found, written))
        });
        for (found, written) in meant {
            match written {
                Written::Unit(_, measured, 1.0) if measured == unit => {
                    return format!("rename `{found}` to {name}");
                }
                Written::Unit(symbol, measured, parts) if measured == unit => {
                    return format!(
                        "`{found}` is in {symbol}: {}, and call it {name}",
                        converted(parts)
                    );
                }
                Written::None => {
                    return format!(
                        "`{found}` says no unit: if it is in {unit}, call it {name}; if not, \
                         convert it first"
                    );
                }
                Written::Unit(..) => {}
            }
        }
        let others =
            self.names.iter().map(String::as_str).filter(|name| !wanted_too.contains(name));
        let others: Vec<_> = others.collect();
        match near_names(name, &others).first() {
            Some(near) => format!("there is no {name}, did you mean `{near}`?"),
            None => format!("there is no {name}"),
        }
    }
}

/// How to convert a number of which so many are one.
fn converted(parts: f64) -> String {
    if parts >= 1.0 && parts.fract() < f64::EPSILON {
        format!("divide by {parts}")
    } else {
        format!("multiply by {}", (1e12 / parts).round() / 1e12)
    }
}

/// The unit that the name of a column says.
enum Written {
    None,
    /// Its symbol, what it measures, and how many are one of that.
    Unit(&'static str, &'static str, f64),
}

impl Written {
    /// The quantity and the unit of a column: `x_mm`, `X [mm]`, `x (mm)`, `x`. Of several units, as
    /// in `x_m [mm]`, the last is taken.
    fn of(column: &str) -> (String, Self) {
        let name = column.trim().to_lowercase();
        let end = name.find(|c: char| !c.is_alphanumeric()).unwrap_or(name.len());
        let (quantity, rest) = name.split_at(end);
        let mut words = rest.split(|c: char| !c.is_alphanumeric());
        let unit = words.rfind(|word| !word.is_empty()).unwrap_or_default();
        let unit = UNITS.iter().find(|(symbol, ..)| *symbol == unit);
        let written = unit.map_or(Self::None, |(symbol, measured, parts)| {
            Self::Unit(symbol, measured, *parts)
        });
        (quantity.to_owned(), written)
    }
}

#[cfg(test)]
mod header_tests {
    use super::*;

    fn columns(header: &[&str]) -> String {
        let header = Header::new(&StringRecord::from(header.to_vec()), 1);
        header.and_then(|header| header.columns(&["x_m", "y_m"], "a point")).unwrap_err()
    }

    #[test]
    fn other_names_and_units_are_told_of() {
        for (header, expected) in [
            (
                &["x_mm", "y_mm"][..],
                "`x_mm` is in mm: divide by 1000, and call it x_m; \
                 `y_mm` is in mm: divide by 1000, and call it y_m",
            ),
            (&["x [cm]", "y_m"], "`x [cm]` is in cm: divide by 100, and call it x_m"),
            (&["X (in)", "y_m"], "`X (in)` is in in: multiply by 0.0254, and call it x_m"),
            (&["x_m [mm]", "y_m"], "`x_m [mm]` is in mm: divide by 1000, and call it x_m"),
            (&["X [m]", "y_m"], "rename `X [m]` to x_m"),
            (
                &["x", "y_m"],
                "`x` says no unit: if it is in m, call it x_m; if not, convert it first",
            ),
            (&["x_m", "yy_m"], "there is no y_m, did you mean `yy_m`?"),
            (&["x_m", "z_m"], "there is no y_m, did you mean `z_m`?"),
            (&["left", "right"], "there is no x_m; there is no y_m"),
            (&["x_m", "t_s"], "there is no y_m"),
        ] {
            let has = "line 1: a point has the columns x_m,y_m, the file has";
            assert_eq!(columns(header), format!("{has} {}: {expected}", header.join(",")));
        }
    }

    #[test]
    fn a_column_is_there_once() {
        let expected = "line 1: the column y_m is there 2 times; keep the one that is meant";
        assert_eq!(columns(&["x_m", "y_m", "y_m"]), expected);
    }

    #[test]
    fn other_separators_and_missing_headers_are_told_of() {
        let separated = |by: &str| {
            format!(
                "line 1: the columns are separated by {by}; separate them by commas, and write \
                 numbers with a decimal point"
            )
        };
        assert_eq!(columns(&["x_m;y_m"]), separated("semicolons"));
        assert_eq!(columns(&["x_m\ty_m"]), separated("tabs"));
        assert_eq!(columns(&["x_m y_m"]), separated("spaces"));
        let comment = "line 1: comments are not read; the first line names the columns";
        assert_eq!(columns(&["# of the hand"]), comment);
        let none = "line 1: there is no header; the first line names the columns";
        assert_eq!(columns(&["0.5", "-1e3"]), none);
    }
}
