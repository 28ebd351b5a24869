// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The names of columns, and what may be meant by others.

use csv::StringRecord;
use palpate::scene::near_names;

/// The columns of a table.
pub(super) struct Header {
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
    pub(super) fn new(fields: &StringRecord, line: u64) -> Result<Self, String> {
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
    pub(super) fn line(&self) -> u64 {
        self.line
    }

    pub(super) fn len(&self) -> usize {
        self.names.len()
    }

    pub(super) fn name(&self, column: usize) -> &str {
        self.names.get(column).map_or("", String::as_str)
    }

    pub(super) fn place(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|known| known == name)
    }

    /// The places of columns that `what` has.
    ///
    /// # Errors
    ///
    /// If one is missing, or is there more than once.
    pub(super) fn columns(&self, names: &[&str], what: &str) -> Result<Vec<usize>, String> {
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
        let found = self.names.join(",");
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
mod tests {
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
