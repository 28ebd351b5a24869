// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The samples in memory: all of them, or bricks of those near the surface.

use palpate_field::Vector;

use crate::grid::{indices, raveled};
use crate::spline::{OfTaps, Spline, value, value_slope};

/// Cells of a brick along an axis.
pub(crate) const BRICK: usize = 8;

/// Samples of a brick along an axis: one more on each side of its nodes.
pub(crate) const WIDE: usize = BRICK + 2;

/// How a grid's samples are stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Store {
    /// Single precision.
    #[default]
    F32,
    /// Whole numbers of 16 bits with one scale: half the memory, steps of the largest value / 32 767.
    I16,
    /// Whole numbers of 8 bits with one scale, steps of the largest value / 127: for what is not touched.
    I8,
}

impl Store {
    /// Every store.
    pub const ALL: [Self; 3] = [Self::F32, Self::I16, Self::I8];

    /// The name, which stays the same: "f32", "i16" or "i8".
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::F32 => "f32",
            Self::I16 => "i16",
            Self::I8 => "i8",
        }
    }

    /// The bytes of a sample.
    #[cfg(feature = "files")]
    pub(crate) const fn bytes(self) -> u64 {
        match self {
            Self::F32 => 4,
            Self::I16 => 2,
            Self::I8 => 1,
        }
    }

    /// The largest whole number; `None` in single precision.
    const fn largest(self) -> Option<f64> {
        match self {
            Self::F32 => None,
            Self::I16 => Some(i16::MAX as f64),
            Self::I8 => Some(i8::MAX as f64),
        }
    }

    /// The band as samples of it are stored, so that bricks with and without samples meet [m].
    pub(crate) fn band(self, wanted: f64) -> f64 {
        match self.largest() {
            None => f64::from(wanted as f32),
            Some(codes) => codes * (wanted / codes),
        }
    }

    /// How far a sample may be from the one that is stored [m].
    pub(crate) fn error(self, largest: f64, scale: f64) -> f64 {
        match self {
            Self::F32 => 0.5 * f64::from(f32::EPSILON) * largest,
            Self::I16 | Self::I8 => 0.5 * scale * (1.0 + 1e-9),
        }
    }

    /// The scale of samples of at most `largest` [m].
    pub(crate) fn scale(self, largest: f64) -> f64 {
        self.largest().map_or(1.0, |codes| largest / codes)
    }
}

/// The samples as stored, each times `scale` in metres.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Codes {
    F32(Vec<f32>),
    I16(Vec<i16>),
    I8(Vec<i8>),
}

/// A number as it is stored.
pub(crate) trait Code: Copy + Default + Into<f64> {}

impl Code for f32 {}
impl Code for i16 {}
impl Code for i8 {}

impl Codes {
    /// The nearest codes of samples [m].
    pub(crate) fn encode(store: Store, scale: f64, samples: &[f64]) -> Self {
        let whole = |sample: &f64| (sample / scale).round();
        match store {
            Store::F32 => Self::F32(samples.iter().map(|sample| *sample as f32).collect()),
            Store::I16 => {
                Self::I16(samples.iter().map(|sample| whole(sample) as i16).collect())
            }
            Store::I8 => Self::I8(samples.iter().map(|sample| whole(sample) as i8).collect()),
        }
    }

    pub(crate) fn store(&self) -> Store {
        match self {
            Self::F32(_) => Store::F32,
            Self::I16(_) => Store::I16,
            Self::I8(_) => Store::I8,
        }
    }

    pub(crate) fn len(&self) -> usize {
        match self {
            Self::F32(codes) => codes.len(),
            Self::I16(codes) => codes.len(),
            Self::I8(codes) => codes.len(),
        }
    }

    /// The largest code.
    pub(crate) fn largest(&self) -> f64 {
        match self {
            Self::F32(codes) => {
                codes.iter().fold(0.0, |largest, code| code.abs().max(largest)).into()
            }
            Self::I16(codes) => {
                codes.iter().map(|code| code.unsigned_abs()).max().unwrap_or(0).into()
            }
            Self::I8(codes) => {
                codes.iter().map(|code| code.unsigned_abs()).max().unwrap_or(0).into()
            }
        }
    }

    /// Some of the codes.
    fn run(&self, first: usize, count: usize) -> Self {
        match self {
            Self::F32(codes) => Self::F32(codes[first..][..count].to_vec()),
            Self::I16(codes) => Self::I16(codes[first..][..count].to_vec()),
            Self::I8(codes) => Self::I8(codes[first..][..count].to_vec()),
        }
    }

    /// Runs of one store, one after another; of none in single precision.
    pub(crate) fn joined<'a>(runs: impl Iterator<Item = &'a Self>) -> Self {
        let mut all: Option<Self> = None;
        for run in runs {
            match (&mut all, run) {
                (None, run) => all = Some(run.clone()),
                (Some(Self::F32(all)), Self::F32(run)) => all.extend_from_slice(run),
                (Some(Self::I16(all)), Self::I16(run)) => all.extend_from_slice(run),
                (Some(Self::I8(all)), Self::I8(run)) => all.extend_from_slice(run),
                _ => unreachable!("a grid has one store"),
            }
        }
        all.unwrap_or(Self::F32(Vec::new()))
    }
}

/// Where the samples of a cell lie.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Window<const D: usize> {
    /// The first sample's place, and the way to the next along each axis.
    Stored { first: usize, strides: [usize; D] },
    /// All samples of the cell are the band, or minus the band.
    Far { inside: bool },
}

/// What a brick's place in the table says where it has no samples.
pub(crate) const FAR_OUTSIDE: u32 = u32::MAX;
/// The same, inside.
pub(crate) const FAR_INSIDE: u32 = u32::MAX - 1;

/// The order of the samples.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Order<const D: usize> {
    /// All nodes, the first axis first.
    Dense { strides: [usize; D] },
    /// Bricks of cells, each with all the samples that its cells take.
    Bricks {
        /// Each brick's number among those with samples, or on which side it is far.
        table: Vec<u32>,
    },
}

/// Samples, and where each cell finds its own.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Samples<const D: usize> {
    pub(crate) codes: Codes,
    pub(crate) scale: f64,
    /// Values are clamped to this many metres on both sides; infinite if they are not.
    pub(crate) band: f64,
    pub(crate) order: Order<D>,
    /// Bricks along each axis.
    pub(crate) bricks: [usize; D],
}

/// The steps from sample to sample along each axis, where there are `counts` of them.
pub(crate) fn strides<const D: usize>(counts: [usize; D]) -> [usize; D] {
    let mut stride = 1;
    counts.map(|count| {
        let way = stride;
        stride *= count;
        way
    })
}

/// A brick, with what is stored of it if it is near the surface.
pub(crate) enum Brick<T> {
    FarInside,
    FarOutside,
    Near(T),
}

impl<T> Brick<T> {
    pub(crate) fn map<U>(self, change: impl FnOnce(T) -> U) -> Brick<U> {
        match self {
            Self::FarInside => Brick::FarInside,
            Self::FarOutside => Brick::FarOutside,
            Self::Near(samples) => Brick::Near(change(samples)),
        }
    }
}

/// How many samples a brick has.
pub(crate) const fn wide_brick(dimension: usize) -> usize {
    WIDE.pow(dimension as u32)
}

impl<const D: usize> Samples<D> {
    /// The samples of bricks, the first axis first.
    pub(crate) fn of_bricks(
        made: &[Brick<Codes>],
        scale: f64,
        band: f64,
        bricks: [usize; D],
    ) -> Self {
        let near = made.iter().filter_map(|brick| match brick {
            Brick::Near(codes) => Some(codes),
            Brick::FarInside | Brick::FarOutside => None,
        });
        let codes = Codes::joined(near);
        let mut number = 0;
        let table = made
            .iter()
            .map(|brick| match brick {
                Brick::FarInside => FAR_INSIDE,
                Brick::FarOutside => FAR_OUTSIDE,
                Brick::Near(_) => {
                    number += 1;
                    number - 1
                }
            })
            .collect();
        Self { codes, scale, band, order: Order::Bricks { table }, bricks }
    }

    /// What is stored of a brick.
    pub(crate) fn codes_of(&self, brick: [usize; D]) -> Brick<Codes> {
        let Order::Bricks { table } = &self.order else {
            unreachable!("only bricks are made again")
        };
        match table[self.number(brick)] {
            FAR_OUTSIDE => Brick::FarOutside,
            FAR_INSIDE => Brick::FarInside,
            number => {
                Brick::Near(self.codes.run(number as usize * wide_brick(D), wide_brick(D)))
            }
        }
    }

    /// Where the cell finds its samples whose first one is the node `first`, of `taps` along each axis.
    #[inline(always)]
    pub(crate) fn window(&self, first: [usize; D], taps: usize) -> Window<D> {
        match &self.order {
            Order::Dense { strides } => {
                let place = (0..D).map(|i| first[i] * strides[i]).sum();
                Window::Stored { first: place, strides: *strides }
            }
            Order::Bricks { table } => {
                let strides = strides([WIDE; D]);
                let (mut brick, mut way, mut inside) = (0, 1, 0);
                for i in 0..D {
                    // Cells are told by their middle node, or the lower of two.
                    let key = first[i] + (taps - 2);
                    brick += (key / BRICK) * way;
                    way *= self.bricks[i];
                    // Samples begin one node before the brick's own.
                    inside += (key % BRICK + 1 - (taps - 2)) * strides[i];
                }
                match table[brick] {
                    FAR_OUTSIDE => Window::Far { inside: false },
                    FAR_INSIDE => Window::Far { inside: true },
                    number => {
                        let first = number as usize * wide_brick(D) + inside;
                        Window::Stored { first, strides }
                    }
                }
            }
        }
    }

    /// The value at `local`, from 0 to 1 along each axis of a cell [m], and its change from one side of the
    /// cell to the other.
    #[inline(always)]
    pub(crate) fn value_slope<const K: usize>(
        &self,
        first: [usize; D],
        local: [f64; D],
    ) -> (f64, Vector<f64, D>)
    where
        OfTaps<K>: Spline<K>,
    {
        let (first, strides) = match self.window(first, K) {
            Window::Far { inside } => return (self.far(inside), Vector::ZERO),
            Window::Stored { first, strides } => (first, strides),
        };
        let (value, slope) = match &self.codes {
            Codes::F32(codes) => slope_of::<f32, K, D>(&codes[first..], strides, local),
            Codes::I16(codes) => slope_of::<i16, K, D>(&codes[first..], strides, local),
            Codes::I8(codes) => slope_of::<i8, K, D>(&codes[first..], strides, local),
        };
        (value * self.scale, slope * self.scale)
    }

    /// The value alone.
    #[inline(always)]
    pub(crate) fn value<const K: usize>(&self, first: [usize; D], local: [f64; D]) -> f64
    where
        OfTaps<K>: Spline<K>,
    {
        let (first, strides) = match self.window(first, K) {
            Window::Far { inside } => return self.far(inside),
            Window::Stored { first, strides } => (first, strides),
        };
        let value = match &self.codes {
            Codes::F32(codes) => value_of::<f32, K, D>(&codes[first..], strides, local),
            Codes::I16(codes) => value_of::<i16, K, D>(&codes[first..], strides, local),
            Codes::I8(codes) => value_of::<i8, K, D>(&codes[first..], strides, local),
        };
        value * self.scale
    }

    /// Writes the samples that a brick's cells take [m], also where a dense grid has none: those of its border.
    pub(crate) fn brick(&self, brick: [usize; D], counts: [usize; D], out: &mut Vec<f64>) {
        out.clear();
        let place = match &self.order {
            Order::Dense { strides } => {
                let nodes = indices([0; D], [WIDE; D]).map(|index| {
                    (0..D).map(|i| wide_node(brick[i], index[i], counts[i]) * strides[i]).sum()
                });
                return out.extend(nodes.map(|place: usize| self.decoded(place)));
            }
            Order::Bricks { table } => table[self.number(brick)],
        };
        match place {
            FAR_OUTSIDE => out.resize(wide_brick(D), self.band),
            FAR_INSIDE => out.resize(wide_brick(D), -self.band),
            number => {
                let first = number as usize * wide_brick(D);
                out.extend((first..first + wide_brick(D)).map(|place| self.decoded(place)));
            }
        }
    }

    /// On which side a brick without samples lies: `true` inside.
    pub(crate) fn far_brick(&self, brick: [usize; D]) -> Option<bool> {
        let Order::Bricks { table } = &self.order else { return None };
        match table[self.number(brick)] {
            FAR_OUTSIDE => Some(false),
            FAR_INSIDE => Some(true),
            _ => None,
        }
    }

    /// A brick's place in the table.
    #[inline]
    pub(crate) fn number(&self, brick: [usize; D]) -> usize {
        raveled(brick, self.bricks)
    }

    pub(crate) fn far(&self, inside: bool) -> f64 {
        if inside { -self.band } else { self.band }
    }

    #[inline]
    pub(crate) fn decoded(&self, place: usize) -> f64 {
        match &self.codes {
            Codes::F32(codes) => f64::from(codes[place]),
            Codes::I16(codes) => f64::from(codes[place]) * self.scale,
            Codes::I8(codes) => f64::from(codes[place]) * self.scale,
        }
    }
}

/// The node along an axis of a sample of a brick, the nearest where there is none.
#[inline]
pub(crate) fn wide_node(brick: usize, index: usize, count: usize) -> usize {
    (brick * BRICK + index).saturating_sub(1).min(count - 1)
}

/// Where a row of a cell's samples along the first axis begins.
#[inline(always)]
pub(crate) fn row_place<const K: usize, const D: usize>(
    mut row: usize,
    strides: [usize; D],
) -> usize {
    let mut place = 0;
    for stride in strides.into_iter().skip(1) {
        place += row % K * stride;
        row /= K;
    }
    place
}

#[inline(always)]
fn row_of<T: Code, const K: usize>(codes: &[T], place: usize) -> [f64; K] {
    let row = &codes[place..place + K];
    std::array::from_fn(|tap| row[tap].into())
}

#[inline(always)]
fn value_of<T: Code, const K: usize, const D: usize>(
    codes: &[T],
    strides: [usize; D],
    local: [f64; D],
) -> f64
where
    OfTaps<K>: Spline<K>,
{
    value(|row| row_of::<T, K>(codes, row_place::<K, D>(row, strides)), local)
}

#[inline(always)]
fn slope_of<T: Code, const K: usize, const D: usize>(
    codes: &[T],
    strides: [usize; D],
    local: [f64; D],
) -> (f64, Vector<f64, D>)
where
    OfTaps<K>: Spline<K>,
{
    value_slope(|row| row_of::<T, K>(codes, row_place::<K, D>(row, strides)), local)
}
