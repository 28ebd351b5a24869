// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What is wrong with a volume.

use std::path::PathBuf;

use palpate_mesh::ContourError;

use super::LARGEST_VOLUME;

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
