//! Blocks: many points evaluated together, one array a coordinate.

use crate::scalar::{Float, Model, Scalar};
use crate::vector::{Vector, array};

/// The most points that a block holds.
pub const BLOCK: usize = 64;

/// The points of the short block, for searches that look at a few at a time.
pub const SHORT: usize = 8;

/// `W` numbers in memory order, aligned to a cache line.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct Lanes<T, const W: usize>(pub [T; W]);

/// `W` models, one array for each of their parts.
#[derive(Clone, Copy, Debug)]
pub struct ModelLanes<const W: usize> {
    value: Lanes<f64, W>,
    gradient: [Lanes<f64, W>; 3],
    lower: Lanes<f64, W>,
    upper: Lanes<f64, W>,
}

/// A place for as many numbers as a block has points.
pub trait LaneArray<S>: Clone + std::fmt::Debug + Send + Sync {
    /// All lanes zero.
    fn zero() -> Self;

    /// The number in lane `i`.
    fn lane(&self, i: usize) -> S;

    /// Puts a number into lane `i`.
    fn set_lane(&mut self, i: usize, number: S);
}

/// A number of which a block can hold many.
pub trait Lane: Scalar + Send + Sync + 'static {
    /// Where `W` of them are kept.
    type Lanes<const W: usize>: LaneArray<Self>;

    /// Lanes are worked through in lines of this many.
    const LINE: usize;

    /// The smallest and the largest value that the number stands for.
    fn range(&self) -> (f64, f64);

    /// `kernel` at `p`, by the best rule the kernel has for this number.
    fn evaluate<K: crate::kernel::Kernel<D>, const D: usize>(
        kernel: &K,
        p: Vector<Self, D>,
    ) -> Self;
}

impl<T: Float, const W: usize> LaneArray<T> for Lanes<T, W> {
    #[inline(always)]
    fn zero() -> Self {
        Self([T::default(); W])
    }

    #[inline(always)]
    fn lane(&self, i: usize) -> T {
        self.0[i]
    }

    #[inline(always)]
    fn set_lane(&mut self, i: usize, number: T) {
        self.0[i] = number;
    }
}

impl<const W: usize> LaneArray<Model> for ModelLanes<W> {
    #[inline(always)]
    fn zero() -> Self {
        let zero = Lanes([0.0; W]);
        Self { value: zero, gradient: [zero; 3], lower: zero, upper: zero }
    }

    #[inline(always)]
    fn lane(&self, i: usize) -> Model {
        Model {
            value: self.value.0[i],
            gradient: [self.gradient[0].0[i], self.gradient[1].0[i], self.gradient[2].0[i]],
            lower: self.lower.0[i],
            upper: self.upper.0[i],
        }
    }

    #[inline(always)]
    fn set_lane(&mut self, i: usize, number: Model) {
        self.value.0[i] = number.value;
        self.gradient[0].0[i] = number.gradient[0];
        self.gradient[1].0[i] = number.gradient[1];
        self.gradient[2].0[i] = number.gradient[2];
        self.lower.0[i] = number.lower;
        self.upper.0[i] = number.upper;
    }
}

macro_rules! float_lane {
    ($t:ident) => {
        impl Lane for $t {
            type Lanes<const W: usize> = Lanes<$t, W>;
            const LINE: usize = <$t as Float>::LINE;

            #[inline(always)]
            fn range(&self) -> (f64, f64) {
                (f64::from(*self), f64::from(*self))
            }

            #[inline(always)]
            fn evaluate<K: crate::kernel::Kernel<D>, const D: usize>(
                kernel: &K,
                p: Vector<Self, D>,
            ) -> Self {
                kernel.distance(p)
            }
        }
    };
}

float_lane!(f32);
float_lane!(f64);

impl Lane for Model {
    type Lanes<const W: usize> = ModelLanes<W>;
    const LINE: usize = 8;

    #[inline(always)]
    fn range(&self) -> (f64, f64) {
        (self.minimum(), self.maximum())
    }

    #[inline(always)]
    fn evaluate<K: crate::kernel::Kernel<D>, const D: usize>(
        kernel: &K,
        p: Vector<Self, D>,
    ) -> Self {
        kernel.model(p)
    }
}

/// Up to `W` numbers, one a point.
#[derive(Clone, Debug)]
pub struct Column<S: Lane, const W: usize>(S::Lanes<W>);

impl<S: Lane, const W: usize> Column<S, W> {
    /// All zero.
    #[inline(always)]
    #[must_use]
    pub fn zero() -> Self {
        Self(S::Lanes::zero())
    }

    /// The number in lane `i`.
    #[inline(always)]
    #[must_use]
    pub fn get(&self, i: usize) -> S {
        self.0.lane(i)
    }

    /// Puts a number into lane `i`.
    #[inline(always)]
    pub fn set(&mut self, i: usize, number: S) {
        self.0.set_lane(i, number);
    }
}

/// Up to `W` points in `D` dimensions.
///
/// ```
/// use palpate_field::{BLOCK, Block, Vector};
///
/// let mut points = Block::<f64, 2, BLOCK>::zero();
/// points.set(3, Vector([1.0, 2.0]));
/// assert_eq!(points.get(3), Vector([1.0, 2.0]));
/// ```
#[derive(Clone, Debug)]
pub struct Block<S: Lane, const D: usize, const W: usize>([Column<S, W>; D]);

impl<S: Lane, const D: usize, const W: usize> Block<S, D, W> {
    /// All points at the origin.
    #[inline(always)]
    #[must_use]
    pub fn zero() -> Self {
        Self(std::array::from_fn(|_| Column::zero()))
    }

    /// The point in lane `i`.
    #[inline(always)]
    #[must_use]
    pub fn get(&self, i: usize) -> Vector<S, D> {
        Vector(array!(k < D => self.0[k].get(i)))
    }

    /// Puts a point into lane `i`.
    #[inline(always)]
    pub fn set(&mut self, i: usize, point: Vector<S, D>) {
        for k in 0..D {
            self.0[k].set(i, point.0[k]);
        }
    }
}

/// The distances at up to `W` points, and their gradients.
#[derive(Clone, Debug)]
pub struct Gradients<T: Lane, const D: usize, const W: usize> {
    /// The distances [m].
    pub distance: Column<T, W>,
    /// The gradients.
    pub gradient: Block<T, D, W>,
}

impl<T: Lane, const D: usize, const W: usize> Gradients<T, D, W> {
    /// All zero.
    #[inline(always)]
    #[must_use]
    pub fn zero() -> Self {
        Self { distance: Column::zero(), gradient: Block::zero() }
    }
}

/// The lanes to work through for `count` points: whole lines, so that no scalar
/// remainder is left over. The lanes past `count` hold what the caller left
/// there and are computed to no purpose.
#[inline(always)]
pub(crate) fn lanes<S: Lane, const W: usize>(count: usize) -> usize {
    if W <= S::LINE { W } else { (count.div_ceil(S::LINE) * S::LINE).min(W) }
}
