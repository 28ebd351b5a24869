// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Grids as files.
//!
//! Little-endian, one after another: the head; of each brick a bound of its deviation from the source; of sparse grids each
//! brick's place; the samples as they are stored; those beyond the band; the BLAKE3 sum of all of it. Steepness and
//! slopes are not in the file, for they follow from the samples. What its author wrote of the source is believed: the
//! deviations, and the samples beyond the band.

use std::fs::File;
use std::io::{BufWriter, Read, Write};
use std::path::{Path, PathBuf};

use palpate_field::{Aabb, Deviation, LARGEST_LENGTH, Vector};

use crate::bake::{GridOptions, each};
use crate::certificate::Cells;
use crate::error::GridError;
use crate::grid::{Compared, Far, Grid, Known, Lattice, indices, unravelled};
use crate::samples::{
    BRICK, Codes, FAR_INSIDE, Order, Samples, Store, WIDE, Window, strides, wide_brick,
    wide_node,
};
use crate::spline::{GridKernel, QUADRATIC, TRILINEAR};

/// What a file begins with: the name, and the version of the format.
pub(crate) const MAGIC: [u8; 8] = *b"palpate\x01";

/// The bytes of the sum at the end.
const SUM: usize = blake3::OUT_LEN;

/// Files larger than this are neither written nor read: 4 GiB.
pub const LARGEST_FILE: u64 = 1 << 32;

/// Why a grid's file cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[error("{}: {problem}", path.display())]
pub struct GridFileError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong.
    pub problem: GridFileProblem,
}

/// What is wrong with a grid's file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GridFileProblem {
    /// Reading or writing failed.
    #[error("it cannot be read or written: {0}")]
    System(#[from] std::io::Error),
    /// It is a folder, a pipe or a device.
    #[error("it is no file")]
    NoFile,
    /// It is larger than [`LARGEST_FILE`].
    #[error(
        "it has {bytes} bytes, at most {LARGEST_FILE} are written and read: larger cells, i16 or a band make it smaller"
    )]
    TooLarge {
        /// Its size.
        bytes: u64,
    },
    /// It does not begin as a grid's file of this version.
    #[error("it is no grid of this version of palpate: make it again with `palpate grid`")]
    OtherFormat,
    /// It is of another dimension.
    #[error("it is a grid in {found}D, wanted one in {wanted}D")]
    Dimension {
        /// The file's.
        found: usize,
        /// What was asked for.
        wanted: usize,
    },
    /// It has another length than its head says, or another sum than its end.
    #[error("it is damaged ({what}): copy it again, or make it again with `palpate grid`")]
    Damaged {
        /// What does not fit.
        what: &'static str,
    },
    /// Its samples make no grid.
    #[error(transparent)]
    Grid(#[from] GridError),
}

/// A temporary file with the permissions of any new file, from which the user's mask takes away.
fn as_any_file() -> tempfile::Builder<'static, 'static> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".palpate-");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder
}

fn damaged(what: &'static str) -> GridFileProblem {
    GridFileProblem::Damaged { what }
}

impl<const D: usize> Grid<D> {
    /// Writes the grid to a file, which is there whole or not at all.
    ///
    /// ```
    /// use palpate_field::Shape;
    /// use palpate_grid::{Grid, GridOptions};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// # let folder = tempfile::tempdir()?;
    /// # let path = folder.path().join("ball.grid");
    /// let grid = Grid::bake(&Shape::sphere(0.05)?, &GridOptions::with_cell(0.005))?;
    /// grid.save(&path)?;
    /// let again = Grid::<3>::open(&path)?;
    /// assert_eq!(again.promise(), grid.promise());
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    ///
    /// If the file cannot be written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), GridFileError> {
        self.save_at(path.as_ref())
    }

    #[inline(never)]
    pub(crate) fn save_at(&self, path: &Path) -> Result<(), GridFileError> {
        let written = || -> Result<(), GridFileProblem> {
            let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
            let file = as_any_file().tempfile_in(folder.unwrap_or(Path::new(".")))?;
            self.write(BufWriter::new(file.as_file()))?;
            file.as_file().sync_all()?;
            file.persist(path).map_err(|error| error.error)?;
            Ok(())
        };
        written().map_err(|problem| GridFileError { path: path.to_owned(), problem })
    }

    /// Reads the grid of a file.
    ///
    /// # Errors
    ///
    /// If the file cannot be read, is no grid of this dimension, or is damaged.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, GridFileError> {
        Self::open_at(path.as_ref())
    }

    #[inline(never)]
    pub(crate) fn open_at(path: &Path) -> Result<Self, GridFileError> {
        let read = || -> Result<Self, GridFileProblem> {
            if !std::fs::metadata(path)?.is_file() {
                return Err(GridFileProblem::NoFile);
            }
            let file = File::open(path)?;
            let bytes = file.metadata()?.len();
            if bytes > LARGEST_FILE {
                return Err(GridFileProblem::TooLarge { bytes });
            }
            let mut text = Vec::new();
            // One more: a file that grows meanwhile is not cut in silence.
            file.take(LARGEST_FILE + 1).read_to_end(&mut text)?;
            Self::from_bytes(&text)
        };
        read().map_err(|problem| GridFileError { path: path.to_owned(), problem })
    }

    /// Writes the bytes of a file.
    ///
    /// # Errors
    ///
    /// As of `out`; if there are more bytes than [`LARGEST_FILE`], before the first one is written.
    pub fn write(&self, out: impl Write) -> Result<(), GridFileProblem> {
        let bytes = self.file_bytes();
        if bytes > LARGEST_FILE {
            return Err(GridFileProblem::TooLarge { bytes });
        }
        Ok(self.put(out)?)
    }

    /// The bytes of the file.
    fn file_bytes(&self) -> u64 {
        let head = MAGIC.len() + 4 + 8 * (5 + 4 * D) + 8 + SUM;
        let table = match &self.samples.order {
            Order::Bricks { table } => table.len(),
            Order::Dense { .. } => 0,
        };
        let far = self.far.as_ref().map_or(0, |far| far.samples.codes.len());
        let own = self.stored_samples() as u64 * self.store().bytes();
        own + (head + 8 * self.certificates.len() + 4 * (table + far)) as u64
    }

    /// Writes what a file holds.
    pub(crate) fn put(&self, out: impl Write) -> std::io::Result<()> {
        let mut out = Summed { out, sum: blake3::Hasher::new() };
        let lattice = self.lattice();
        let Samples { codes, scale, band, order, .. } = &self.samples;
        out.write_all(&MAGIC)?;
        let is_sparse = matches!(order, Order::Bricks { .. });
        // Its bounds are those of the source too.
        let promise = self.promise();
        let compared = promise.deviation.zip(promise.bounds);
        out.write_all(&[
            D as u8 | u8::from(compared.is_some()) << 7,
            match self.kernel() {
                GridKernel::Quadratic => 0,
                GridKernel::Trilinear => 1,
            },
            match codes.store() {
                Store::F32 => 0,
                Store::I16 => 1,
                Store::I8 => 2,
            },
            u8::from(is_sparse),
        ])?;
        let (value, within, bounds) = match compared {
            Some((deviation, bounds)) => (deviation.value, deviation.within, bounds.aabb),
            None => (0.0, 0.0, Aabb { min: Vector::ZERO, max: Vector::ZERO }),
        };
        for number in [lattice.cell, *scale, *band, value, within] {
            out.write_all(&number.to_le_bytes())?;
        }
        for i in 0..D {
            out.write_all(&(lattice.counts[i] as u64).to_le_bytes())?;
            for number in [lattice.origin[i], bounds.min[i], bounds.max[i]] {
                out.write_all(&number.to_le_bytes())?;
            }
        }
        for certificate in &self.certificates {
            out.write_all(&certificate.deviation.to_le_bytes())?;
        }
        if let Order::Bricks { table } = order {
            for place in table {
                out.write_all(&place.to_le_bytes())?;
            }
        }
        match codes {
            Codes::F32(codes) => codes.iter().try_for_each(|c| out.write_all(&c.to_le_bytes())),
            Codes::I16(codes) => codes.iter().try_for_each(|c| out.write_all(&c.to_le_bytes())),
            Codes::I8(codes) => codes.iter().try_for_each(|c| out.write_all(&c.to_le_bytes())),
        }?;
        let far = self.far.as_ref();
        out.write_all(&far.map_or(-1.0, |far| far.reach).to_le_bytes())?;
        if let Some(Far { samples: Samples { codes: Codes::F32(codes), .. }, .. }) = far {
            codes.iter().try_for_each(|c| out.write_all(&c.to_le_bytes()))?;
        }
        let sum = out.sum.finalize();
        out.out.write_all(sum.as_bytes())?;
        out.out.flush()
    }

    /// Reads the bytes of a file.
    ///
    /// # Errors
    ///
    /// As of [`open`](Self::open).
    #[inline(never)]
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, GridFileProblem> {
        let Some(rest) = bytes.strip_prefix(&MAGIC) else {
            return Err(GridFileProblem::OtherFormat);
        };
        let head = rest.first_chunk::<4>().ok_or(damaged("it ends in its head"))?;
        let found = usize::from(head[0] & 0x7f);
        if found != D {
            return Err(GridFileProblem::Dimension { found, wanted: D });
        }
        // The sum proves that the bytes are those that were written, not who wrote them: what follows is checked too.
        let Some((text, sum)) = bytes.split_last_chunk::<SUM>() else {
            return Err(damaged("it ends in its head"));
        };
        if blake3::hash(text) != blake3::Hash::from_bytes(*sum) {
            return Err(damaged("its checksum does not match"));
        }
        let is_compared = head[0] & 0x80 != 0;
        let kernel = match head[1] {
            0 => GridKernel::Quadratic,
            1 => GridKernel::Trilinear,
            _ => return Err(damaged("its kernel is unknown")),
        };
        let (store, width) = match head[2] {
            0 => (Store::F32, 4),
            1 => (Store::I16, 2),
            2 => (Store::I8, 1),
            _ => return Err(damaged("its store is unknown")),
        };
        let mut numbers = Numbers(text.get(MAGIC.len() + 4..).unwrap_or_default());
        let [cell, scale, band, value, within] = numbers.floats()?;
        let (mut counts, mut origin) = ([0; D], Vector([0.0; D]));
        let (mut min, mut max) = (Vector([0.0; D]), Vector([0.0; D]));
        for i in 0..D {
            counts[i] = usize::try_from(u64::from_le_bytes(numbers.take()?))
                .map_err(|_| damaged("it has too many nodes"))?;
            [origin[i], min[i], max[i]] = numbers.floats()?;
        }
        let lattice = Lattice { origin, cell, counts };
        let is_small = counts.iter().any(|count| *count < kernel.taps());
        if is_small || lattice.nodes().is_none() {
            return Err(damaged("it has too few nodes, or too many"));
        }
        let is_sparse = match head[3] {
            0 => false,
            1 => true,
            _ => return Err(damaged("its order is unknown")),
        };
        let is_length = |x: &f64| x.abs() <= LARGEST_LENGTH;
        let is_placed = min.0.iter().chain(&max.0).all(is_length) && lattice.check().is_ok();
        let is_known = [value, within].iter().all(|x| *x >= 0.0 && is_length(x));
        let is_scaled =
            if store == Store::F32 { scale == 1.0 } else { scale > 0.0 && is_length(&scale) };
        let widest = GridOptions::SMALLEST_BAND * cell * (1.0 - 1e-9);
        let is_banded =
            if is_sparse { band >= widest && is_length(&band) } else { band == f64::INFINITY };
        GridOptions::with_cell(cell).check()?;
        if !(is_placed && is_known && is_scaled && is_banded) {
            return Err(damaged("a number of its head is out of range"));
        }
        let bricks = counts.map(|count| count.div_ceil(BRICK));
        let count = bricks.iter().product::<usize>();
        let has = |bytes: usize| count.checked_mul(bytes).is_some_and(|all| all <= text.len());
        if !has(if is_sparse { 12 } else { 8 }) {
            return Err(damaged("it ends before its samples"));
        }
        let deviations = (0..count)
            .map(|_| Ok(numbers.floats::<1>()?[0]))
            .collect::<Result<Vec<_>, GridFileProblem>>()?;
        if deviations.iter().any(|deviation| deviation.is_nan() || *deviation < 0.0) {
            return Err(damaged("a deviation is no distance"));
        }
        let (order, nodes) = if is_sparse {
            let table = (0..count)
                .map(|_| Ok(u32::from_le_bytes(numbers.take()?)))
                .collect::<Result<Vec<_>, GridFileProblem>>()?;
            let near = table.iter().filter(|place| **place < FAR_INSIDE).count();
            if table.iter().any(|place| *place < FAR_INSIDE && *place as usize >= near) {
                return Err(damaged("a brick has no samples"));
            }
            (Order::Bricks { table }, near * wide_brick(D))
        } else {
            (Order::Dense { strides: strides(counts) }, lattice.nodes().unwrap_or(usize::MAX))
        };
        let counted = || damaged("it has another number of samples than its head says");
        let own = nodes.checked_mul(width).filter(|own| *own <= numbers.0.len());
        let (own, rest) = numbers.0.split_at(own.ok_or_else(counted)?);
        let codes = Codes::from_le_bytes(store, own);
        numbers.0 = rest;
        let [reach] = numbers.floats()?;
        let nodes_far =
            if reach < 0.0 { 0 } else { Far::lattice(&lattice).nodes().unwrap_or(usize::MAX) };
        if nodes_far.checked_mul(4) != Some(numbers.0.len()) || reach.is_nan() {
            return Err(counted());
        }
        let far = Codes::from_le_bytes(Store::F32, numbers.0);
        if !codes.are_finite() || !far.are_finite() {
            return Err(damaged("a sample is no number"));
        }
        let samples = Samples { codes, scale, band, order, bricks };
        if !samples.agree(counts) {
            return Err(damaged("bricks differ at their border"));
        }
        let compared = is_compared.then_some(Compared {
            deviation: Deviation { value, within },
            bounds: Aabb { min, max },
        });
        let far = match far {
            Codes::F32(far) if reach >= 0.0 => Some(Far::of_samples(&lattice, far, reach)?),
            _ => None,
        };
        let known = Known { compared, far };
        Ok(Self::from_samples_of_file(lattice, kernel, samples, (&deviations, known))?)
    }

    fn from_samples_of_file(
        lattice: Lattice<D>,
        kernel: GridKernel,
        samples: Samples<D>,
        (deviations, known): (&[f64], Known<D>),
    ) -> Result<Self, GridError> {
        let cells = Cells::without_source(&lattice);
        let certificates = each(deviations.len(), |number| {
            let brick = unravelled(number, samples.bricks);
            let mut certificate = match kernel {
                GridKernel::Quadratic => cells.of_brick::<QUADRATIC>(&samples, brick),
                GridKernel::Trilinear => cells.of_brick::<TRILINEAR>(&samples, brick),
            };
            certificate.deviation = deviations[number];
            Ok(certificate)
        })?;
        Self::assemble(lattice, kernel, samples, certificates, known)
    }
}

impl<const D: usize> Samples<D> {
    /// Whether each sample that several bricks hold is the same in all of them.
    fn agree(&self, counts: [usize; D]) -> bool {
        if matches!(self.order, Order::Dense { .. }) {
            return true;
        }
        let mut samples = Vec::new();
        indices([0; D], self.bricks).all(|brick| {
            self.brick(brick, counts, &mut samples);
            indices([0; D], [WIDE; D]).zip(&samples).all(|(index, sample)| {
                let node: [usize; D] =
                    std::array::from_fn(|i| wide_node(brick[i], index[i], counts[i]));
                let own = match self.window(node, 2) {
                    Window::Far { inside } => self.far(inside),
                    Window::Stored { first, .. } => self.decoded(first),
                };
                own == *sample
            })
        })
    }
}

impl Codes {
    /// The codes that a file holds.
    fn from_le_bytes(store: Store, bytes: &[u8]) -> Self {
        match store {
            Store::F32 => {
                Self::F32(bytes.as_chunks().0.iter().map(|c| f32::from_le_bytes(*c)).collect())
            }
            Store::I16 => {
                Self::I16(bytes.as_chunks().0.iter().map(|c| i16::from_le_bytes(*c)).collect())
            }
            Store::I8 => Self::I8(bytes.iter().map(|c| c.cast_signed()).collect()),
        }
    }

    fn are_finite(&self) -> bool {
        match self {
            Self::F32(codes) => codes.iter().all(|code| code.is_finite()),
            Self::I16(_) | Self::I8(_) => true,
        }
    }
}

/// Numbers one after another.
struct Numbers<'a>(&'a [u8]);

impl Numbers<'_> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], GridFileProblem> {
        let (first, rest) =
            self.0.split_first_chunk::<N>().ok_or(damaged("it ends before its samples"))?;
        self.0 = rest;
        Ok(*first)
    }

    fn floats<const N: usize>(&mut self) -> Result<[f64; N], GridFileProblem> {
        let mut floats = [0.0; N];
        for float in &mut floats {
            *float = f64::from_le_bytes(self.take()?);
        }
        Ok(floats)
    }
}

/// A writer that sums what it writes.
struct Summed<W> {
    out: W,
    sum: blake3::Hasher,
}

impl<W: Write> Write for Summed<W> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let written = self.out.write(bytes)?;
        self.sum.update(&bytes[..written]);
        Ok(written)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.out.flush()
    }
}

#[cfg(test)]
mod tests {
    use palpate_field::Shape;

    use super::*;

    #[test]
    fn the_length_of_a_file_is_known_before_it_is_written() {
        let ball = Shape::<3>::ball(0.05).unwrap();
        for options in [
            GridOptions::with_cell(0.005),
            GridOptions { store: Store::I16, ..GridOptions::with_cell(0.005) },
            GridOptions {
                band: Some(GridOptions::SMALLEST_BAND),
                ..GridOptions::with_cell(0.003)
            },
        ] {
            let grid = Grid::bake(&ball, &options).unwrap();
            let mut bytes = Vec::new();
            grid.write(&mut bytes).unwrap();
            assert_eq!(grid.file_bytes(), bytes.len() as u64);
        }
    }
}
