// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What a file holds, to name the right command where it was given to another.

use std::fmt;
use std::path::Path;

use palpate::mesh::Format;

/// What a file holds, as far as its first bytes tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Mesh(Format),
    /// A picture in the format of that name.
    Picture(&'static str),
    /// A recording, as `palpate feel --wav` writes one.
    Recording,
    /// A CSV file.
    Table,
    Scene,
    Archive,
    Empty,
}

/// How files of other formats begin.
const BEGINNINGS: [(&[u8], Kind); 9] = [
    (b"\x89PNG", Kind::Picture("PNG")),
    (b"\xff\xd8\xff", Kind::Picture("JPEG")),
    (b"GIF8", Kind::Picture("GIF")),
    (b"%PDF", Kind::Picture("PDF")),
    (b"<svg", Kind::Picture("SVG")),
    (b"PK\x03\x04", Kind::Archive),
    (b"\x1f\x8b", Kind::Archive),
    (b"7z\xbc\xaf", Kind::Archive),
    (b"\xfd7zXZ", Kind::Archive),
];

impl Kind {
    /// What the bytes of a file look like; `None` if they could be anything.
    pub(crate) fn of(bytes: &[u8]) -> Option<Self> {
        let text = bytes.trim_ascii_start();
        if text.is_empty() {
            return Some(Self::Empty);
        }
        if let Some(format) = Format::of_content(bytes) {
            return Some(Self::Mesh(format));
        }
        if let Some((_, kind)) = BEGINNINGS.iter().find(|(begin, _)| text.starts_with(begin)) {
            return Some(*kind);
        }
        if let (Some(b"RIFF"), Some(of)) = (bytes.get(..4), bytes.get(8..12)) {
            let is_recording = of == b"WAVE";
            return Some(if is_recording { Self::Recording } else { Self::Picture("WebP") });
        }
        let line = text.split(|byte| *byte == b'\n').next().unwrap_or_default();
        let line = String::from_utf8_lossy(line);
        if line.starts_with('{') || text.starts_with(b"\xef\xbb\xbf{") {
            Some(Self::Scene)
        } else if line.contains("<svg") || text.starts_with(b"<?xml") && has_svg(text) {
            Some(Self::Picture("SVG"))
        } else {
            is_table(&line).then_some(Self::Table)
        }
    }

    /// What to do with the file at `path`.
    pub(crate) fn advice(self, path: &Path) -> String {
        let path_name = path.display();
        match self {
            Self::Mesh(format) if Format::of_input(path) == Some(format) => {
                format!("`palpate mesh {path_name}` checks it")
            }
            Self::Mesh(format) => {
                let renamed = path.with_extension(format.name().to_ascii_lowercase());
                format!("rename it to {}, for `palpate mesh`", renamed.display())
            }
            Self::Scene => format!("`palpate check {path_name}` checks it"),
            Self::Table => format!(
                "`palpate eval SCENE --points {path_name}` reads points, `palpate feel SCENE --path {path_name}` the path of a hand"
            ),
            Self::Picture(_) => "pictures are outputs alone".to_owned(),
            Self::Recording => "recordings are outputs alone".to_owned(),
            Self::Archive => "unpack it".to_owned(),
            Self::Empty => "write it again".to_owned(),
        }
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mesh(format) => write!(f, "it is a mesh ({})", format.name()),
            Self::Picture(format) => write!(f, "it is a picture ({format})"),
            Self::Recording => write!(f, "it is a recording (WAV)"),
            Self::Table => write!(f, "it is a table (CSV)"),
            Self::Scene => write!(f, "it is a scene (JSON)"),
            Self::Archive => write!(f, "it is a compressed file"),
            Self::Empty => write!(f, "it is an empty file"),
        }
    }
}

fn has_svg(text: &[u8]) -> bool {
    text.windows(4).take(1000).any(|window| window == b"<svg")
}

/// `true` for a line of two fields or more that are numbers, or names of columns.
fn is_table(line: &str) -> bool {
    let line = line.trim_start_matches('\u{feff}').trim_end();
    let is_field = |field: &str| {
        let is_plain = |c: char| c.is_alphanumeric() || " _-+.\"[]()/".contains(c);
        field.chars().all(is_plain)
    };
    let separator = [',', ';', '\t'].into_iter().find(|separator| line.contains(*separator));
    // A list of JSON is no table.
    !line.starts_with('[')
        && separator.is_some_and(|separator| line.split(separator).all(is_field))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_known_by_their_beginnings() {
        for (content, kind) in [
            (&b""[..], Some(Kind::Empty)),
            (b" \n", Some(Kind::Empty)),
            (b"\n{ \"palpate\": 1 }", Some(Kind::Scene)),
            (b"\xef\xbb\xbf{ \"palpate\": 1 }", Some(Kind::Scene)),
            (b"x_m,y_m\n0,0\n", Some(Kind::Table)),
            (b"\xef\xbb\xbfx [mm];y [mm]\r\n", Some(Kind::Table)),
            (b"0.5\t-1e-3\n", Some(Kind::Table)),
            (b"\x89PNG\r\n", Some(Kind::Picture("PNG"))),
            (b"<?xml version=\"1.0\"?>\n<svg/>", Some(Kind::Picture("SVG"))),
            (b"RIFF\x24\0\0\0WAVEfmt ", Some(Kind::Recording)),
            (b"RIFF\x24\0\0\0WEBPVP8 ", Some(Kind::Picture("WebP"))),
            (b"PK\x03\x04", Some(Kind::Archive)),
            (b"ply\nformat ascii 1.0\n", Some(Kind::Mesh(Format::Ply))),
            (b"[1, 2]", None),
            (b"hello, {world}", None),
        ] {
            assert_eq!(Kind::of(content), kind, "{content:?}");
        }
    }
}
