// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Volumes of scanners.
//!
//! Volumes of a scanner, and the surfaces in them.
//!
//! Samples of a scan are densities, not distances: a value makes a surface, which becomes a mesh.

use std::fs::File;
use std::io::Read;
use std::path::{Component, Path, PathBuf};

use flate2::read::{MultiGzDecoder, ZlibDecoder};
use palpate_field::{Point, Vector};
use palpate_mesh::{ContourError, utf16_is_little_endian};

use self::head::LONGEST_HEAD;
use crate::grid::unravelled;

mod head;
mod meta;
mod nanovdb;
mod nifti;
mod npy;
mod nrrd;
mod surface;

/// The size of the largest file that is read, in bytes: 1 GiB.
pub const LARGEST_VOLUME: u64 = 1 << 30;

/// A format of files of volumes.
#[derive(Clone, Copy, Debug)]
enum Format {
    Nrrd,
    MetaImage,
    Nifti,
    NumPy,
    NanoVdb,
}

impl Format {
    /// What the names of files end in.
    const ENDINGS: [(&str, Self); 8] = [
        (".nrrd", Self::Nrrd),
        (".nhdr", Self::Nrrd),
        (".mha", Self::MetaImage),
        (".mhd", Self::MetaImage),
        (".nii", Self::Nifti),
        (".nii.gz", Self::Nifti),
        (".npy", Self::NumPy),
        (".nvdb", Self::NanoVdb),
    ];

    /// By the name of a file, in lower case.
    fn of(name: &str) -> Option<Self> {
        let found = Self::ENDINGS.iter().find(|(ending, _)| name.ends_with(ending));
        found.map(|(_, format)| *format)
    }
}

/// The name of a file, in lower case.
fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().to_ascii_lowercase()
}

/// The side of a value that is inside.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Inside {
    /// Where samples are larger: densities.
    #[default]
    Above,
    /// Where samples are smaller: distances, negative inside, as of level sets.
    Below,
}

impl Inside {
    /// Both sides.
    pub const ALL: [Self; 2] = [Self::Above, Self::Below];

    /// The name, which stays the same: "above" or "below".
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Above => "above",
            Self::Below => "below",
        }
    }
}

/// The cosine of the angle between two axes of a lattice that are taken to be square to each other.
const SQUARE: f64 = 1e-3;

/// Samples at the nodes of a lattice in space, as a scanner gives them.
///
/// [`open`](Self::open) reads NRRD, MetaImage, NIfTI, NumPy and NanoVDB files, with the spacing, place and
/// orientation of their heads, in metres. Where the head tells how a patient lies, x is to the right, y to the front and
/// z to the top, whatever the format. The place is that of ITK or nibabel; where they leave it open, the file is refused.
///
/// ```
/// use palpate_field::Vector;
/// use palpate_grid::Volume;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let head = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 3 3 3\nencoding: raw\nspacings: 2 2 2\n\n";
/// let mut file = head.as_bytes().to_vec();
/// file.extend((0..27).map(|node| if node == 13 { 200 } else { 0 }));
/// let volume = Volume::from_bytes(&file, std::path::Path::new("dot.nrrd"))?;
/// assert_eq!(volume.counts(), [3; 3]);
/// assert_eq!(volume.node([1, 1, 1]), Vector([0.002; 3])); // millimetres are made metres
/// // Half of the dot's value lies a millimetre from it along each axis.
/// let mesh = volume.surface(100.0)?;
/// assert!(mesh.report().is_watertight());
/// assert!(mesh.vertices().iter().all(|v| (*v - Vector([0.002; 3])).norm() < 0.0018));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Volume {
    counts: [usize; 3],
    origin: Point<3>,
    steps: [Vector<f64, 3>; 3],
    samples: Vec<f32>,
    inside: Inside,
}

impl Volume {
    /// A volume of samples, inside above a value.
    ///
    /// # Errors
    ///
    /// If an axis has fewer than two nodes, there are not as many samples as nodes, a step or a sample is not finite,
    /// or steps are zero or not square to each other.
    pub fn new(
        counts: [usize; 3],
        origin: Point<3>,
        steps: [Vector<f64, 3>; 3],
        samples: Vec<f32>,
    ) -> Result<Self, VolumeProblem> {
        let nodes = counts.iter().try_fold(1_usize, |all, count| all.checked_mul(*count));
        if nodes != Some(samples.len()) || counts.iter().any(|count| *count < 2) {
            return Err(VolumeProblem::Counts { counts, samples: samples.len() });
        }
        let is_finite = origin.is_finite() && steps.iter().all(Vector::is_finite);
        let lengths = steps.map(Vector::norm);
        if !is_finite || lengths.iter().any(|length| *length <= 0.0 || length.is_infinite()) {
            return Err(VolumeProblem::Spacing { steps: lengths });
        }
        for (a, b) in [(0, 1), (0, 2), (1, 2)] {
            let cosine = steps[a].dot(steps[b]) / (lengths[a] * lengths[b]);
            if cosine.abs() > SQUARE {
                return Err(VolumeProblem::Shear { cosine });
            }
        }
        if let Some(node) = samples.iter().position(|sample| !sample.is_finite()) {
            return Err(VolumeProblem::NotFinite { node: unravelled(node, counts) });
        }
        Ok(Self { counts, origin, steps, samples, inside: Inside::Above })
    }

    /// The same with another side of a value inside. Without it the samples above a value are inside, of a level set of
    /// NanoVDB those below.
    ///
    /// ```
    /// use palpate_field::Vector;
    /// use palpate_grid::{Inside, Volume};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// // Distances [m] to a ball of 1.2 m about the middle node: |p - (2, 2, 2)| - 1.2.
    /// let middle = Vector([2.0; 3]);
    /// let node = |i: usize| Vector([(i % 5) as f64, (i / 5 % 5) as f64, (i / 25) as f64]);
    /// let samples = (0..125).map(|i| ((node(i) - middle).norm() - 1.2) as f32).collect();
    /// let steps = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Vector);
    /// let volume = Volume::new([5; 3], Vector([0.0; 3]), steps, samples)?.with_inside(Inside::Below);
    /// let ball = volume.surface(0.0)?;
    /// // So few nodes make less of it than 4/3 π 1.2³ m³, and more than the octahedron with its corners, 4/3 1.2³ m³.
    /// assert!(ball.report().enclosed.is_some_and(|m3| (2.3..7.24).contains(&m3)));
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn with_inside(self, inside: Inside) -> Self {
        Self { inside, ..self }
    }

    /// The side of a value that is inside.
    #[must_use]
    pub const fn inside(&self) -> Inside {
        self.inside
    }

    /// How many nodes there are along each axis.
    #[must_use]
    pub const fn counts(&self) -> [usize; 3] {
        self.counts
    }

    /// The place of the first node [m].
    #[must_use]
    pub const fn origin(&self) -> Point<3> {
        self.origin
    }

    /// The way from a node to the next along each axis [m].
    #[must_use]
    pub const fn steps(&self) -> [Vector<f64, 3>; 3] {
        self.steps
    }

    /// The samples, the first axis first.
    #[must_use]
    pub fn samples(&self) -> &[f32] {
        &self.samples
    }

    /// A node's place [m].
    #[must_use]
    pub fn node(&self, index: [usize; 3]) -> Point<3> {
        (0..3).fold(self.origin, |p, axis| p + self.steps[axis] * index[axis] as f64)
    }

    /// Whether a file has the name of a volume: the ending of one that [`open`](Self::open) reads.
    ///
    /// ```
    /// use palpate_grid::Volume;
    ///
    /// assert!(Volume::is_named("head.nii.gz") && !Volume::is_named("head.stl"));
    /// ```
    #[must_use]
    pub fn is_named(path: impl AsRef<Path>) -> bool {
        Format::of(&name_of(path.as_ref())).is_some()
    }

    /// The least and the largest sample.
    #[must_use]
    pub fn range(&self) -> [f32; 2] {
        self.samples
            .iter()
            .fold([f32::INFINITY, f32::NEG_INFINITY], |[least, largest], sample| {
                [least.min(*sample), largest.max(*sample)]
            })
    }

    /// Whether the border of the samples cuts off what lies within the surface at a value: a sample there is inside.
    ///
    /// ```
    /// use palpate_field::Vector;
    /// use palpate_grid::Volume;
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let steps = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Vector);
    /// let with_one = |node: usize| {
    ///     let samples = (0..27).map(|i| if i == node { 1.0 } else { 0.0 }).collect();
    ///     Volume::new([3; 3], Vector([0.0; 3]), steps, samples)
    /// };
    /// assert!(!with_one(13)?.is_cut_off(0.5)); // the middle
    /// assert!(with_one(14)?.is_cut_off(0.5)); // in a face of the lattice
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn is_cut_off(&self, value: f64) -> bool {
        let is_inside = |sample: f32| match self.inside {
            Inside::Above => f64::from(sample) > value,
            Inside::Below => f64::from(sample) < value,
        };
        let is_at_border = |number: usize| {
            let node = unravelled(number, self.counts);
            (0..3).any(|axis| node[axis] == 0 || node[axis] + 1 == self.counts[axis])
        };
        let mut samples = self.samples.iter().enumerate();
        samples.any(|(number, sample)| is_inside(*sample) && is_at_border(number))
    }

    /// Reads a volume whose file name ends in `.nrrd`, `.nhdr`, `.mha`, `.mhd`, `.nii`, `.nii.gz`, `.npy` or
    /// `.nvdb`. A head that names a file of samples reads it from the same folder.
    ///
    /// A sparse grid of NanoVDB becomes samples over the box of its active voxels and one voxel around it; voxels that
    /// are not active have the value that the file tells of them. Its units are metres. Of a file with several grids,
    /// [`open_grid`](Self::open_grid) reads one.
    ///
    /// # Errors
    ///
    /// If the file cannot be read, is larger than [`LARGEST_VOLUME`], is damaged, or is no volume, or has several.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, VolumeError> {
        let path = path.as_ref();
        let read = || Self::from_bytes(&bytes(path)?, path);
        read().map_err(|problem| VolumeError { path: path.to_owned(), problem })
    }

    /// Reads the grid of this name, of a file of NanoVDB.
    ///
    /// ```
    /// use palpate_grid::Volume;
    ///
    /// let error = Volume::open_grid("head.nii.gz", "density").unwrap_err();
    /// assert!(error.to_string().contains("only a file of NanoVDB has grids with names"));
    /// ```
    ///
    /// # Errors
    ///
    /// As of [`open`](Self::open); if the file is none of NanoVDB, or has no or several grids of this name.
    pub fn open_grid(path: impl AsRef<Path>, name: &str) -> Result<Self, VolumeError> {
        let path = path.as_ref();
        let read = || match Format::of(&name_of(path)) {
            Some(Format::NanoVdb) => nanovdb::read(&bytes(path)?, Some(name)),
            _ => match Self::from_bytes(&[], path) {
                Err(problem @ (VolumeProblem::OpenVdb | VolumeProblem::Ending { .. })) => {
                    Err(problem)
                }
                _ => Err(VolumeProblem::NoGrids { name: name.to_owned() }),
            },
        };
        read().map_err(|problem| VolumeError { path: path.to_owned(), problem })
    }

    /// The files that [`open`](Self::open) reads: the one named, and that of the samples if its head names one.
    ///
    /// # Errors
    ///
    /// If the file cannot be read.
    pub fn files(path: impl AsRef<Path>) -> Result<Vec<PathBuf>, VolumeError> {
        let path = path.as_ref();
        let read = || -> Result<Vec<u8>, VolumeProblem> {
            let mut head = Vec::new();
            opened(path)?.take(LONGEST_HEAD as u64).read_to_end(&mut head)?;
            Ok(head)
        };
        let head = read().map_err(|problem| VolumeError { path: path.to_owned(), problem })?;
        let samples = match Format::of(&name_of(path)) {
            Some(Format::Nrrd) => nrrd::samples_file(without_mark(&head)),
            Some(Format::MetaImage) => meta::samples_file(without_mark(&head)),
            _ => None,
        };
        let beside = samples.map(|name| path.with_file_name(name));
        Ok(std::iter::once(path.to_owned()).chain(beside).collect())
    }

    /// Reads the bytes of a file; `path` tells the format, and where a file of samples lies.
    ///
    /// # Errors
    ///
    /// As of [`open`](Self::open).
    pub fn from_bytes(bytes: &[u8], path: &Path) -> Result<Self, VolumeProblem> {
        let name = name_of(path);
        let folder = path.parent().unwrap_or(Path::new(""));
        let format = Format::of(&name);
        if matches!(format, Some(Format::Nrrd | Format::MetaImage)) {
            check_encoding(bytes)?;
        }
        match format {
            Some(Format::Nrrd) => nrrd::read(without_mark(bytes), folder),
            Some(Format::MetaImage) => meta::read(without_mark(bytes), folder),
            Some(Format::Nifti) => nifti::read(bytes),
            Some(Format::NumPy) => npy::read(bytes),
            Some(Format::NanoVdb) => nanovdb::read(bytes, None),
            None if name.ends_with(".vdb") => Err(VolumeProblem::OpenVdb),
            None => Err(VolumeProblem::Ending { name }),
        }
    }
}

/// The bytes of a head that is text, without the mark of UTF-8 with which some editors begin.
fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

/// Refuses a head in UTF-16. A reader of UTF-8 would find no fields in it.
fn check_encoding(bytes: &[u8]) -> Result<(), VolumeProblem> {
    match utf16_is_little_endian(bytes) {
        None => Ok(()),
        Some(true) => Err(VolumeProblem::Utf16 { encoding: "UTF-16LE" }),
        Some(false) => Err(VolumeProblem::Utf16 { encoding: "UTF-16BE" }),
    }
}

/// A file that is no pipe.
fn opened(path: &Path) -> Result<File, VolumeProblem> {
    if !std::fs::metadata(path)?.is_file() {
        return Err(VolumeProblem::NoFile);
    }
    Ok(File::open(path)?)
}

/// The bytes of a file that is not too large.
fn bytes(path: &Path) -> Result<Vec<u8>, VolumeProblem> {
    let file = opened(path)?;
    let length = file.metadata()?.len();
    if length > LARGEST_VOLUME {
        return Err(VolumeProblem::TooLarge { bytes: length });
    }
    let mut bytes = Vec::new();
    file.take(LARGEST_VOLUME + 1).read_to_end(&mut bytes)?;
    // The file may have grown.
    match bytes.len() as u64 {
        length if length > LARGEST_VOLUME => Err(VolumeProblem::TooLarge { bytes: length }),
        _ => Ok(bytes),
    }
}

/// The bytes of a file beside a head, which names it.
fn beside(folder: &Path, name: &str) -> Result<Vec<u8>, VolumeProblem> {
    let elsewhere = || VolumeProblem::Elsewhere { name: name.to_owned() };
    let mut parts = Path::new(name).components().filter(|part| *part != Component::CurDir);
    if !matches!((parts.next(), parts.next()), (Some(Component::Normal(_)), None)) {
        return Err(elsewhere());
    }
    let path = folder.join(name);
    // The folder of a file that is named alone is empty.
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let read = || {
        if !path.canonicalize()?.starts_with(folder.canonicalize()?) {
            return Err(elsewhere());
        }
        bytes(&path)
    };
    read().map_err(|problem| match problem {
        VolumeProblem::Elsewhere { .. } => problem,
        problem => VolumeProblem::Beside { name: name.to_owned(), problem: Box::new(problem) },
    })
}

/// Why a file is no volume.
#[derive(Debug, thiserror::Error)]
#[error("{}: {problem}", path.display())]
pub struct VolumeError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong.
    pub problem: VolumeProblem,
}

/// What is wrong with a volume.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum VolumeProblem {
    /// Reading failed.
    #[error("it cannot be read: {0}")]
    Unreadable(#[from] std::io::Error),
    /// It is a folder, a pipe or a device.
    #[error("it is no file")]
    NoFile,
    /// It is larger than [`LARGEST_VOLUME`].
    #[error(
        "it has {bytes} bytes, {LARGEST_VOLUME} at most: cut the volume, or sample it coarser"
    )]
    TooLarge {
        /// Its size.
        bytes: u64,
    },
    /// Its name ends in nothing known.
    #[error(
        "{name}: a volume ends in .nrrd, .nhdr, .mha, .mhd, .nii, .nii.gz, .npy or .nvdb; dcm2niix makes .nii.gz of DICOM"
    )]
    Ending {
        /// The name.
        name: String,
    },
    /// Its head is UTF-16.
    #[error(
        "its head is text in {encoding}: save it as UTF-8, for example with `iconv -f {encoding} -t UTF-8`"
    )]
    Utf16 {
        /// `UTF-16LE` or `UTF-16BE`.
        encoding: &'static str,
    },
    /// It is a file of OpenVDB.
    #[error(
        "it is a file of OpenVDB, which is not read: `nanovdb_convert in.vdb out.nvdb` of OpenVDB's tools makes of it one that is"
    )]
    OpenVdb,
    /// A grid was asked for by its name, of a file that has none.
    #[error("there is no grid {name:?} in it: only a file of NanoVDB has grids with names")]
    NoGrids {
        /// The name.
        name: String,
    },
    /// The active voxels of a sparse grid, and one around them, are too many for a volume.
    #[error(
        "its active voxels span {spans:?} nodes, at most {allowed} in all are made of a file of its size: cut it, or resample it coarser"
    )]
    TooWide {
        /// The nodes along each axis.
        spans: [u64; 3],
        /// How many there may be.
        allowed: u64,
    },
    /// Its head names a file elsewhere.
    #[error("its head names the file {name:?}: the samples must lie in the folder of the head")]
    Elsewhere {
        /// The name.
        name: String,
    },
    /// The file that its head names for the samples cannot be had.
    #[error("its head names the file {name:?} for the samples: {problem}")]
    Beside {
        /// The name.
        name: String,
        /// What is wrong with that file.
        problem: Box<VolumeProblem>,
    },
    /// It breaks the rules of its format.
    #[error("it is no good {format}: {problem}")]
    Malformed {
        /// The name of the format.
        format: &'static str,
        /// What is wrong.
        problem: String,
    },
    /// It has not as many samples as nodes, or an axis of one node.
    #[error(
        "{} × {} × {} nodes need as many samples, got {samples}; each axis needs at least 2 nodes",
        counts[0], counts[1], counts[2]
    )]
    Counts {
        /// The nodes along each axis.
        counts: [usize; 3],
        /// The samples.
        samples: usize,
    },
    /// A step is zero or no number.
    #[error("the spacing must be positive and finite, got {steps:?} m")]
    Spacing {
        /// The lengths of the steps [m].
        steps: [f64; 3],
    },
    /// The axes are not square to each other.
    #[error(
        "its axes are sheared (the cosine between two is {cosine:.4}): resample it on square axes"
    )]
    Shear {
        /// The cosine of the angle between two axes.
        cosine: f64,
    },
    /// A sample is no number.
    #[error(
        "the sample at node {node:?} is NaN or beyond single precision: replace it by the value of what is around the body"
    )]
    NotFinite {
        /// The node's number along each axis, from 0.
        node: [usize; 3],
    },
    /// The value makes no surface.
    #[error("the samples are from {least} to {largest}: no surface lies at {value}")]
    NoSurface {
        /// The value asked for.
        value: f64,
        /// The least sample.
        least: f32,
        /// The largest sample.
        largest: f32,
    },
    /// The surface takes too many triangles.
    #[error(
        "the surface passes more than {limit} cells: resample the volume coarser, or cut it"
    )]
    TooFine {
        /// How many cells it may pass.
        limit: usize,
    },
    /// The surface cannot be meshed.
    #[error(transparent)]
    Contour(ContourError),
}

/// Deflate makes at most so many bytes of one.
const MOST_INFLATED: usize = 1040;

/// The most samples of a volume: a gigabyte in memory.
const MOST_SAMPLES: usize = 1 << 28;

/// How a number is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

/// How bytes are packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Packing {
    Raw,
    Gzip,
    Zlib,
}

impl Kind {
    const fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }
}

/// A number's samples of a format.
#[derive(Clone, Copy, Debug)]
struct Stored {
    format: &'static str,
    kind: Kind,
    is_big: bool,
    packing: Packing,
    count: usize,
}

impl Stored {
    fn wrong(&self, problem: String) -> VolumeProblem {
        VolumeProblem::Malformed { format: self.format, problem }
    }

    /// The bytes of the samples, unpacked.
    fn length(&self) -> Result<usize, VolumeProblem> {
        self.count
            .checked_mul(self.kind.bytes())
            .ok_or_else(|| self.wrong("it has too many samples".to_owned()))
    }

    /// The samples at the beginning of `bytes`.
    fn read(&self, bytes: &[u8]) -> Result<Vec<f32>, VolumeProblem> {
        let wrong = |problem: String| self.wrong(problem);
        let length = self.length()?;
        let short =
            |found: usize| wrong(format!("its samples take {length} bytes, it has {found}"));
        if self.count > MOST_SAMPLES {
            return Err(wrong(format!(
                "it has {} samples, {MOST_SAMPLES} at most: cut it, or resample it coarser",
                self.count
            )));
        }
        let unpacked = match self.packing {
            Packing::Raw => None,
            _ if length > bytes.len().saturating_mul(MOST_INFLATED) => {
                return Err(short(bytes.len()));
            }
            Packing::Gzip => Some(inflated(MultiGzDecoder::new(bytes), length)),
            Packing::Zlib => Some(inflated(ZlibDecoder::new(bytes), length)),
        };
        let unpacked = unpacked.transpose().map_err(|error| wrong(error.to_string()))?;
        let bytes = unpacked.as_deref().unwrap_or(bytes);
        if bytes.len() > length {
            return Err(wrong(format!("its samples take {length} bytes, and more follow")));
        }
        let bytes = bytes.get(..length).ok_or_else(|| short(bytes.len()))?;
        Ok(self.numbers(bytes))
    }

    fn numbers(&self, bytes: &[u8]) -> Vec<f32> {
        macro_rules! all {
            ($t:ty) => {
                bytes
                    .as_chunks()
                    .0
                    .iter()
                    .map(|b| {
                        if self.is_big {
                            <$t>::from_be_bytes(*b)
                        } else {
                            <$t>::from_le_bytes(*b)
                        }
                    })
                    .map(|number| number as f32)
                    .collect()
            };
        }
        match self.kind {
            Kind::I8 => all!(i8),
            Kind::U8 => all!(u8),
            Kind::I16 => all!(i16),
            Kind::U16 => all!(u16),
            Kind::I32 => all!(i32),
            Kind::U32 => all!(u32),
            Kind::I64 => all!(i64),
            Kind::U64 => all!(u64),
            Kind::F32 => all!(f32),
            Kind::F64 => all!(f64),
        }
    }
}

/// The unpacked bytes, at most `length + 1`: one byte more shows that they are more than is said, and reading to the end
/// compares the checksum.
fn inflated(from: impl Read, length: usize) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    from.take(length as u64 + 1).read_to_end(&mut bytes)?;
    Ok(bytes)
}
