// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Poses with proven separations, as `testdata/recall` keeps them.
//!
//! A [`Row`] is a pose of the second body of a [`Pair`], and an interval that
//! [`separation`](crate::separation) proved. [`draw`] makes one from a seed.

mod pairs;

use std::fmt;
use std::path::PathBuf;
use std::str::FromStr;

use arbitrary::Unstructured;
use palpate_field::{Pose, Rotation, Shape, ShapeError, Vector};

use crate::arbitrary::{direction, unit, within};
use crate::cases::entropy;
use crate::kernels::Space;
use crate::separation::{Interval, separation};

pub use pairs::{in_space, in_the_plane};

/// The least and the largest gap or overlap [m]; bodies are about 1 m large.
pub const GAPS: [f64; 2] = [1e-4, 1e-1];

/// The width of a proven interval, as a share of the gap.
const SHARE: f64 = 0.05;

/// The budget of a proof, in cells.
const CELLS: usize = 1_000_000;

/// The budget of a step of a bisection, in cells.
const HASTE: usize = 1500;

/// A distance at which no two bodies here touch [m].
const FAR: f64 = 4.0;

/// Where bisection ends, as a share of the gap.
const PLACED: f64 = 0.02;

/// Translations are kept as multiples of this, so that rows are short [m].
const GRID: f64 = 1e-7;

/// Rotations are kept as multiples of this.
const TURN_GRID: f64 = 1e-3;

/// Attempts at a row.
const ATTEMPTS: u64 = 100;

/// Two bodies that are put together in many ways.
#[derive(Clone, Debug)]
pub struct Pair<const D: usize> {
    /// The name in rows.
    pub name: &'static str,
    /// The bodies; the pose moves the second.
    pub bodies: [Shape<D>; 2],
    /// The number of rows.
    pub rows: usize,
}

/// A pose with its separation.
#[derive(Clone, Debug, PartialEq)]
pub struct Row<const D: usize> {
    /// The name of the pair.
    pub pair: String,
    /// The seed of the pose.
    pub seed: u64,
    /// The rotation of the second body: its angle [rad], or its quaternion
    /// `x, y, z, w` of any length.
    pub turn: Vec<f64>,
    /// Its translation after that [m].
    pub offset: Vector<f64, D>,
    /// The separation [m].
    pub truth: Interval,
}

/// Rotations as rows keep them.
pub trait Turned<const D: usize> {
    /// How many numbers a rotation has.
    const NUMBERS: usize;

    /// The file in `testdata/recall`.
    const FILE: &'static str;

    /// The first line of the file.
    const COLUMNS: &'static str;

    /// The rotation of these numbers.
    ///
    /// # Errors
    ///
    /// If the numbers are not a rotation.
    fn rotation(turn: &[f64]) -> Result<Rotation<D>, ShapeError>;
}

impl Turned<2> for Space {
    const NUMBERS: usize = 1;
    const FILE: &'static str = "plane.csv";
    const COLUMNS: &'static str = "pair,seed,angle,x,y,lower_m,upper_m";

    fn rotation(turn: &[f64]) -> Result<Rotation<2>, ShapeError> {
        Rotation::from_angle(turn.first().copied().unwrap_or(f64::NAN))
    }
}

impl Turned<3> for Space {
    const NUMBERS: usize = 4;
    const FILE: &'static str = "space.csv";
    const COLUMNS: &'static str = "pair,seed,qx,qy,qz,qw,x,y,z,lower_m,upper_m";

    fn rotation(turn: &[f64]) -> Result<Rotation<3>, ShapeError> {
        Rotation::from_quaternion(turn.try_into().unwrap_or([f64::NAN; 4]))
    }
}

/// Where rows are kept.
#[must_use]
pub fn folder() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../testdata/recall"))
}

impl<const D: usize> Row<D>
where
    Space: Turned<D>,
{
    /// The pose of the second body, `world_from_body`.
    ///
    /// # Errors
    ///
    /// If the numbers of the row are not a rotation.
    pub fn pose(&self) -> Result<Pose<D>, ShapeError> {
        Ok(Pose::new(<Space as Turned<D>>::rotation(&self.turn)?, self.offset))
    }

    fn separation(
        &self,
        pair: &Pair<D>,
        cells: usize,
        is_enough: impl Fn(&Interval) -> bool,
    ) -> Result<Interval, ShapeError> {
        let [a, b] = &pair.bodies;
        Ok(separation([(a, Pose::identity()), (b, self.pose()?)], cells, is_enough))
    }

    /// The separation of the row's bodies, proven anew.
    ///
    /// # Errors
    ///
    /// If the numbers of the row are not a rotation.
    pub fn prove(&self, pair: &Pair<D>) -> Result<Interval, ShapeError> {
        self.separation(pair, CELLS, |interval| interval.is_within(SHARE))
    }
}

impl<const D: usize> fmt::Display for Row<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{},{}", self.pair, self.seed)?;
        for number in self.turn.iter().chain(&self.offset.0) {
            write!(f, ",{number}")?;
        }
        write!(f, ",{:e},{:e}", self.truth.lower, self.truth.upper)
    }
}

impl<const D: usize> FromStr for Row<D>
where
    Space: Turned<D>,
{
    type Err = String;

    fn from_str(line: &str) -> Result<Self, String> {
        let fields: Vec<&str> = line.split(',').collect();
        let turns = <Space as Turned<D>>::NUMBERS;
        if fields.len() != 4 + turns + D {
            return Err(format!("{} fields in {line:?}", fields.len()));
        }
        let wrong = |field: &str| format!("{field:?} in {line:?}");
        let numbers: Vec<f64> = fields[2..]
            .iter()
            .map(|field| field.parse().map_err(|_| wrong(field)))
            .collect::<Result<_, String>>()?;
        let rest = &numbers[turns..];
        Ok(Self {
            pair: fields[0].to_owned(),
            seed: fields[1].parse().map_err(|_| wrong(fields[1]))?,
            turn: numbers[..turns].to_vec(),
            offset: Vector(std::array::from_fn(|k| rest[k])),
            truth: Interval { lower: rest[D], upper: rest[D + 1] },
        })
    }
}

/// The rows of `testdata/recall`.
///
/// # Errors
///
/// If the file cannot be read, or a line is not a row.
pub fn rows<const D: usize>() -> Result<Vec<Row<D>>, String>
where
    Space: Turned<D>,
{
    let path = folder().join(<Space as Turned<D>>::FILE);
    let text = std::fs::read_to_string(&path)
        .map_err(|error| format!("{}: {error}; see `cargo xtask oracle`", path.display()))?;
    text.lines().skip(1).map(str::parse).collect()
}

/// The row of a pair for `slot`, from the first of the slot's seeds that gives one.
#[must_use]
pub fn draw<const D: usize>(pair: &Pair<D>, slot: u64) -> Option<Row<D>>
where
    Space: Turned<D>,
{
    (slot * ATTEMPTS..(slot + 1) * ATTEMPTS).find_map(|seed| {
        let bytes = entropy(seed);
        attempt(pair, seed, &mut Unstructured::new(&bytes)).ok().flatten()
    })
}

/// Turns the second body, moves it from far away towards a point about the first, and bisects
/// to a gap or an overlap.
fn attempt<const D: usize>(
    pair: &Pair<D>,
    seed: u64,
    u: &mut Unstructured<'_>,
) -> arbitrary::Result<Option<Row<D>>>
where
    Space: Turned<D>,
{
    let mut row = Row {
        pair: pair.name.to_owned(),
        seed,
        turn: Vec::new(),
        offset: Vector::ZERO,
        truth: Interval { lower: 0.0, upper: 0.0 },
    };
    // Some directions are along the axes, so that flat faces meet.
    let plain = u.ratio(1_u8, 8_u8)?;
    for _ in 0..<Space as Turned<D>>::NUMBERS {
        let number =
            if plain { f64::from(u.int_in_range(-1..=1_i8)?) } else { within(u, -1.0, 1.0)? };
        row.turn.push(rounded(number, TURN_GRID));
    }
    if D == 2 && plain {
        row.turn[0] *= std::f64::consts::FRAC_PI_2;
    } else if D == 2 {
        row.turn[0] = rounded(row.turn[0] * std::f64::consts::PI, TURN_GRID);
    }
    let sign = if u.arbitrary()? { 1.0 } else { -1.0 };
    let gap = sign * GAPS[0] * (GAPS[1] / GAPS[0]).powf(within(u, 0.02, 0.98)?);
    let way = direction::<D>(u)?;
    // An unbounded body has its surface about the origin.
    let (centre, half) =
        pair.bodies[0].promise().bounds.map_or((Vector::ZERO, Vector::constant(0.2)), |b| {
            (b.aabb.centre(), b.aabb.half_extents())
        });
    let mut towards = centre;
    for k in 0..D {
        towards[k] += half[k] * (2.0 * unit(u)? - 1.0);
    }
    let (mut near, mut far) = (0.0, FAR);
    let mut is_less = |apart: f64| {
        row.offset = Vector((towards + way * apart).0.map(|x| rounded(x, GRID)));
        let is_enough = |known: &Interval| known.upper < gap || known.lower >= gap;
        row.separation(pair, HASTE, is_enough).ok().map(|known| known.upper < gap)
    };
    if is_less(near) != Some(true) || is_less(far) != Some(false) {
        return Ok(None);
    }
    while far - near > PLACED * gap.abs() {
        let middle = 0.5 * (near + far);
        if is_less(middle) == Some(true) { near = middle } else { far = middle }
    }
    let Ok(truth) = row.prove(pair) else { return Ok(None) };
    row.truth = Interval { lower: short(truth.lower, false), upper: short(truth.upper, true) };
    let smallest = row.truth.lower.abs().min(row.truth.upper.abs());
    let is_wanted = row.truth.has_sign() && (GAPS[0]..=GAPS[1]).contains(&smallest);
    Ok(is_wanted.then_some(row))
}

/// The multiple of `grid`, a power of ten below one, that is nearest to `x`, as a decimal.
fn rounded(x: f64, grid: f64) -> f64 {
    let per_unit = (1.0 / grid).round();
    (x * per_unit).round() / per_unit
}

/// `x` rounded to five digits, up or down.
fn short(x: f64, up: bool) -> f64 {
    if x == 0.0 {
        return x;
    }
    let unit = 10.0_f64.powi(x.abs().log10().floor() as i32 - 4);
    let whole = x / unit;
    let whole = if up { whole.ceil() + 1.0 } else { whole.floor() - 1.0 };
    let text = format!("{:.4e}", whole * unit);
    text.parse().unwrap_or(x)
}
