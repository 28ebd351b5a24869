// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Reading of mesh files.
//!
//! A complaint says in our own words what is wrong, and where. Reading takes memory in
//! proportion to the size of the file.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use palpate_field::Point;

use crate::mesh::{MOST_CORNERS, MeshError, SINGLE_ROUNDING, TriangleMesh, triangulate};

mod glb;
mod obj;
mod ply;
mod stl;
mod text;

/// The largest file that is read [bytes]: 1 GiB.
pub const LARGEST_FILE: u64 = 1 << 30;

/// Characters of a complaint that are kept.
const LONGEST_COMPLAINT: usize = 300;

/// A format of mesh files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Format {
    /// Wavefront OBJ: its vertices and faces, all objects and groups together.
    Obj,
    /// STL, text or binary. Vertices that are exactly equal are welded.
    Stl,
    /// PLY, ASCII or binary of either byte order.
    Ply,
    /// Binary glTF 2.0: the triangles of its scene, where its nodes put them. The same as text
    /// is read if it holds its data.
    Glb,
}

impl Format {
    /// The format in which a file is written whose name has this ending.
    #[must_use]
    pub fn of(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "obj" => Some(Self::Obj),
            "stl" => Some(Self::Stl),
            "ply" => Some(Self::Ply),
            "glb" => Some(Self::Glb),
            _ => None,
        }
    }

    /// The format as which a file is read whose name has this ending: also `.gltf`, which is
    /// glTF as text, and is not written.
    #[must_use]
    pub fn of_input(path: &Path) -> Option<Self> {
        let is_text = path.extension().is_some_and(|end| end.eq_ignore_ascii_case("gltf"));
        if is_text { Some(Self::Glb) } else { Self::of(path) }
    }

    /// Whether its files hold coordinates in single precision.
    #[must_use]
    pub const fn is_single(self) -> bool {
        matches!(self, Self::Stl | Self::Glb)
    }

    /// The format that the first bytes of a file look like; `None` if they could be anything.
    ///
    /// ```
    /// use palpate_mesh::Format;
    ///
    /// assert_eq!(Format::of_content(b"ply\nformat ascii 1.0\n"), Some(Format::Ply));
    /// assert_eq!(Format::of_content(b"# a square\nv 0 0 0\nv 1 0 0\n"), Some(Format::Obj));
    /// assert_eq!(Format::of_content(b"{ \"palpate\": 1 }"), None);
    /// ```
    #[must_use]
    pub fn of_content(bytes: &[u8]) -> Option<Self> {
        if bytes.starts_with(b"glTF") || glb::is_likely_text(bytes) {
            return Some(Self::Glb);
        }
        let begin = text::without_mark(bytes);
        if begin.starts_with(b"ply\n") || begin.starts_with(b"ply\r") {
            return Some(Self::Ply);
        }
        if stl::is_likely(bytes) {
            return Some(Self::Stl);
        }
        obj::is_likely(bytes).then_some(Self::Obj)
    }

    /// The name of the format.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Obj => "OBJ",
            Self::Stl => "STL",
            Self::Ply => "PLY",
            Self::Glb => "GLB",
        }
    }

    /// The complaint that a file is not what this format asks for. A name in a file may be as
    /// long as the file: long complaints are cut.
    fn malformed(self, problem: impl std::fmt::Display) -> ReadProblem {
        let mut problem = problem.to_string();
        if let Some((end, _)) = problem.char_indices().nth(LONGEST_COMPLAINT) {
            problem.truncate(end);
            problem.push('…');
        }
        ReadProblem::Malformed { format: self.name(), problem }
    }
}

/// Reads a mesh file whose name ends in `.obj`, `.stl`, `.ply`, `.glb` or `.gltf`.
///
/// Coordinates are taken as metres; [`scaled`](crate::Mesh::scaled) makes metres of other
/// units. Faces with more than three corners are cut into triangles.
///
/// # Errors
///
/// If the file cannot be read, is larger than [`LARGEST_FILE`], is not what its ending
/// says, or holds no [mesh](crate::Mesh::new).
pub fn read_file(path: impl AsRef<Path>) -> Result<TriangleMesh, ReadError> {
    let path = path.as_ref();
    from_path(path).map_err(|problem| ReadError { path: path.to_owned(), problem })
}

impl TriangleMesh {
    /// Reads the mesh of a file, as [`read_file`] does.
    ///
    /// # Errors
    ///
    /// As of [`read_file`].
    ///
    /// ```
    /// use palpate_mesh::Mesh;
    ///
    /// # fn main() -> Result<(), palpate_mesh::ReadError> {
    /// # let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../testdata/meshes/nut.ply");
    /// let nut = Mesh::open(path)?;
    /// assert!(nut.report().is_watertight());
    /// # Ok(())
    /// # }
    /// ```
    pub fn open(path: impl AsRef<Path>) -> Result<Self, ReadError> {
        read_file(path)
    }
}

fn from_path(path: &Path) -> Result<TriangleMesh, ReadProblem> {
    let ending = || path.extension().unwrap_or_default().to_string_lossy().into_owned();
    let format =
        Format::of_input(path).ok_or_else(|| ReadProblem::Ending { ending: ending() })?;
    // A pipe or a device would never end, and opening one may wait for ever.
    if !std::fs::metadata(path)?.is_file() {
        return Err(ReadProblem::NoFile);
    }
    let file = File::open(path)?;
    let length = file.metadata()?.len();
    if length > LARGEST_FILE {
        return Err(ReadProblem::TooLarge { bytes: length });
    }
    let mut bytes = Vec::new();
    file.take(LARGEST_FILE + 1).read_to_end(&mut bytes)?;
    read(&bytes, format)
}

/// Reads a mesh from the bytes of a file; see [`read_file`].
///
/// # Errors
///
/// If the bytes are not what the format asks for, or hold no [mesh](crate::Mesh::new).
pub fn read(bytes: &[u8], format: Format) -> Result<TriangleMesh, ReadProblem> {
    if bytes.len() as u64 > LARGEST_FILE {
        return Err(ReadProblem::TooLarge { bytes: bytes.len() as u64 });
    }
    match format {
        Format::Obj => obj::read(bytes),
        Format::Stl => stl::read(bytes),
        Format::Ply => ply::read(bytes),
        // Where nodes place the vertices, their numbers do not show that they were single.
        Format::Glb => glb::read(bytes).map(|mesh| mesh.with_rounding(SINGLE_ROUNDING)),
    }
}

/// That a text ends in the line of a complaint, if it does: it may be cut off.
fn cut_off(text: &str, line: usize) -> &'static str {
    let is_last = text::lines(text).nth(line).is_none();
    if is_last && !text.ends_with(['\n', '\r']) {
        "; the file ends there: it may be cut off"
    } else {
        ""
    }
}

/// The mesh of polygons: how many corners each has, and the corners of all.
fn of_polygons(
    vertices: Vec<Point<3>>,
    sizes: &[u32],
    corners: &[u32],
    format: Format,
) -> Result<TriangleMesh, ReadProblem> {
    let mut triangles = Vec::with_capacity(sizes.len());
    let mut rest = corners;
    for (face, &size) in sizes.iter().enumerate() {
        let size = size as usize;
        let Some((polygon, after)) = rest.split_at_checked(size) else {
            return Err(format.malformed(format_args!("face {face} ends too early")));
        };
        rest = after;
        if size < 3 {
            return Err(format.malformed(format_args!("face {face} has {size} corners")));
        }
        if size > MOST_CORNERS {
            return Err(ReadProblem::Polygon { face, corners: size });
        }
        if let Some(&index) = polygon.iter().find(|&&i| i as usize >= vertices.len()) {
            let vertices = vertices.len();
            let index = u64::from(index);
            return Err(crate::MeshError::Index { element: face, index, vertices }.into());
        }
        triangulate(polygon, &vertices, &mut triangles);
    }
    Ok(TriangleMesh::new(vertices, triangles)?)
}

/// What is wrong with the contents of a file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadProblem {
    /// The file name has no ending of a known format.
    #[error(
        "the ending {ending:?} is none of .obj, .stl, .ply, .glb and .gltf: convert the file"
    )]
    Ending {
        /// The ending, after the last dot.
        ending: String,
    },
    /// Reading failed.
    #[error("it cannot be read: {0}")]
    Unreadable(#[from] std::io::Error),
    /// It is a folder, a pipe or a device.
    #[error("it is no file")]
    NoFile,
    /// The file is larger than [`LARGEST_FILE`].
    #[error("it has {bytes} bytes, {LARGEST_FILE} at most: cut the mesh into parts")]
    TooLarge {
        /// The size of the file.
        bytes: u64,
    },
    /// The file breaks the rules of its format.
    #[error("it is no good {format}: {problem}; export it again")]
    Malformed {
        /// The name of the format.
        format: &'static str,
        /// What is wrong, and where.
        problem: String,
    },
    /// The file uses a part of its format that this crate does not read.
    #[error("it has {what}, which are not read: {advice}")]
    Unsupported {
        /// The part of the format.
        what: &'static str,
        /// What to do instead.
        advice: &'static str,
    },
    /// The file cannot be shown without an extension of glTF that this crate does not read.
    #[error("it needs the glTF extension {name}, which is not read: {advice}")]
    Extension {
        /// The name of the extension.
        name: String,
        /// What to do instead.
        advice: &'static str,
    },
    /// The text is UTF-16.
    #[error(
        "it is text in {encoding}: save it as UTF-8, for example with `iconv -f {encoding} -t UTF-8`"
    )]
    Utf16 {
        /// `UTF-16LE` or `UTF-16BE`.
        encoding: &'static str,
    },
    /// The nodes of a small file place much more than it describes.
    #[error(
        "its nodes and instances place {placed} {what}, and a file of {bytes} bytes may place {most}: \
         export a part of the scene, or join what lies together"
    )]
    Unfolds {
        /// Triangles, vertices or primitives.
        what: &'static str,
        /// How many would be placed.
        placed: usize,
        /// The size of the file.
        bytes: usize,
        /// The most that a file of this size may place.
        most: usize,
    },
    /// A face has more than [`MOST_CORNERS`] corners.
    #[error("face {face} has {corners} corners, {MOST_CORNERS} at most: export triangles")]
    Polygon {
        /// The face, counted from 0.
        face: usize,
        /// How many corners it has.
        corners: usize,
    },
    /// The contents are no mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

/// Why a file is no mesh.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[error("{}: {problem}", path.display())]
pub struct ReadError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it.
    pub problem: ReadProblem,
}
