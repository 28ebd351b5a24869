// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Runs the loops over blocks with the best instruction set of the machine.
//!
//! The loops of kernels and operators are compiled twice, with AVX2 and with AVX-512, and one copy
//! is chosen at run time. LLVM vectorises both. On machines without AVX2, blocks go through a
//! [`Tape`](super::Tape), or point by point. All of these give the same bits, since no formula uses
//! a fused multiply-add.

use std::sync::atomic::{AtomicU8, Ordering};

use super::block::{Rows, RowsMut, filled};

/// A set of vector instructions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum InstructionSet {
    /// The instructions that every machine of the target has.
    Baseline = 1,
    /// 256-bit vectors on x86-64.
    Avx2 = 2,
    /// 512-bit vectors on x86-64.
    Avx512 = 3,
}

/// The instruction set in use; zero until it is first asked for.
static IN_USE: AtomicU8 = AtomicU8::new(0);

impl InstructionSet {
    /// All of them, from the plainest to the widest.
    pub const ALL: [Self; 3] = [Self::Baseline, Self::Avx2, Self::Avx512];

    /// `true` if this machine has it.
    #[must_use]
    pub fn is_available(self) -> bool {
        match self {
            Self::Baseline => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => is_x86_feature_detected!("avx2") && is_x86_feature_detected!("bmi2"),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => {
                Self::Avx2.is_available()
                    && is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512vl")
                    && is_x86_feature_detected!("avx512dq")
                    && is_x86_feature_detected!("avx512bw")
            }
            #[cfg(not(target_arch = "x86_64"))]
            _ => false,
        }
    }

    /// The instruction set that evaluates blocks: the widest available, unless
    /// [`select`](Self::select) chose another.
    #[inline(always)]
    #[must_use]
    pub fn in_use() -> Self {
        match IN_USE.load(Ordering::Relaxed) {
            1 => Self::Baseline,
            2 => Self::Avx2,
            3 => Self::Avx512,
            _ => Self::detect(),
        }
    }

    /// `true` if the loops of kernels and operators are compiled for it.
    #[inline(always)]
    pub(crate) fn has_loops(self) -> bool {
        self >= Self::Avx2
    }

    /// Evaluates all blocks of this process with `self` from now on, to compare
    /// instruction sets; `false`, and nothing changes, if the machine lacks it.
    pub fn select(self) -> bool {
        let available = self.is_available();
        if available {
            IN_USE.store(self as u8, Ordering::Relaxed);
        }
        available
    }

    #[cold]
    fn detect() -> Self {
        let widest = Self::ALL.into_iter().rev().find(|set| set.is_available());
        let set = widest.unwrap_or(Self::Baseline);
        IN_USE.store(set as u8, Ordering::Relaxed);
        set
    }
}

/// The work in one lane of a block.
///
/// `lane` must be `#[inline(always)]`, and so must all that it calls, to be
/// compiled with the instructions of the loop around it.
pub(crate) trait Job<A, B, Out> {
    /// The output for the inputs `a` and `b`.
    fn lane(&self, a: A, b: B) -> Out;
}

/// The loop: `job` in the lanes of the first `count` points, with their line
/// completed.
///
/// Inputs and output are arguments, not fields of the job, so that LLVM knows
/// that they do not overlap.
#[inline(always)]
fn for_each_lane<A, B, Out, J>(job: &J, a: &A, b: &B, count: usize, out: &mut Out)
where
    A: Rows,
    B: Rows,
    Out: RowsMut,
    J: Job<A::Item, B::Item, Out::Item>,
{
    let lanes = filled::<Out>(count);
    assert!(lanes <= a.written() && lanes <= b.written(), "{lanes} lanes are not written");
    for i in 0..lanes {
        // SAFETY: `i` is less than `lanes`, which was checked against both.
        let (a, b) = unsafe { (a.read(i), b.read(i)) };
        out.write(i, job.lane(a, b));
    }
    // SAFETY: the loop wrote them.
    unsafe { out.set_written(lanes) };
}

/// Runs `job` on the lanes of `a` and `b` with AVX2 or AVX-512.
///
/// # Panics
///
/// On machines without AVX2, for which it is not compiled.
#[inline(always)]
pub(crate) fn run_wide<A, B, Out, J>(job: &J, a: &A, b: &B, count: usize, out: &mut Out)
where
    A: Rows,
    B: Rows,
    Out: RowsMut,
    J: Job<A::Item, B::Item, Out::Item>,
{
    let set = InstructionSet::in_use();
    if set == InstructionSet::Baseline {
        require_loops();
    }
    #[cfg(target_arch = "x86_64")]
    if set == InstructionSet::Avx512 {
        // SAFETY: in_use() returns only sets for which is_available() found
        // every feature that the function is compiled with.
        unsafe { with_avx512(job, a, b, count, out) }
    } else {
        // SAFETY: as above, or require_loops() found AVX2.
        unsafe { with_avx2(job, a, b, count, out) }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (job, a, b, count, out);
}

/// Panics if this machine has no AVX2. If it has AVX2, another thread has just selected the
/// baseline; the AVX2 loop still gives the same bits.
#[cold]
#[inline(never)]
fn require_loops() {
    assert!(InstructionSet::Avx2.is_available(), "the loops of kernels need AVX2");
}

/// Runs `job` on the lanes of `a` and `b` with the instruction set in use, on every machine.
#[inline(always)]
pub(crate) fn run<A, B, Out, J>(job: &J, a: &A, b: &B, count: usize, out: &mut Out)
where
    A: Rows,
    B: Rows,
    Out: RowsMut,
    J: Job<A::Item, B::Item, Out::Item>,
{
    #[cfg(target_arch = "x86_64")]
    {
        let set = InstructionSet::in_use();
        if set == InstructionSet::Avx512 && Out::WIDTH > Out::LINE {
            // SAFETY: in_use() returns only sets for which is_available() found
            // every feature that the function is compiled with.
            return unsafe { with_avx512(job, a, b, count, out) };
        }
        if set >= InstructionSet::Avx2 {
            // SAFETY: as above; AVX-512 includes AVX2.
            return unsafe { with_avx2(job, a, b, count, out) };
        }
    }
    baseline(job, a, b, count, out);
}

/// The loop, in functions compiled with the instructions that the attributes enable.
macro_rules! compiled_loops {
    ($($(#[$attribute:meta])* $name:ident;)*) => {$(
        $(#[$attribute])*
        fn $name<A, B, Out, J>(job: &J, a: &A, b: &B, count: usize, out: &mut Out)
        where
            A: Rows,
            B: Rows,
            Out: RowsMut,
            J: Job<A::Item, B::Item, Out::Item>,
        {
            for_each_lane(job, a, b, count, out);
        }
    )*};
}

compiled_loops! {
    #[inline(never)]
    baseline;

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,bmi2")]
    with_avx2;

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,bmi2,avx512f,avx512vl,avx512dq,avx512bw")]
    with_avx512;
}

/// The work at one point, for jobs long enough to gain from wider instructions.
pub(crate) trait PointJob<T, G> {
    /// The distance at a point; puts its gradient into `gradient`.
    fn at(&self, x: T, y: T, z: T, gradient: &mut G) -> T;
}

/// Runs `job` with the instruction set in use: with AVX2 at most, since one point
/// fills no wider vector. Its blends replace branches that are hard to predict.
#[inline(always)]
pub(crate) fn run_point<T, G, J: PointJob<T, G>>(
    job: &J,
    (x, y, z): (T, T, T),
    gradient: &mut G,
) -> T {
    #[cfg(target_arch = "x86_64")]
    if InstructionSet::in_use() >= InstructionSet::Avx2 {
        // SAFETY: in_use() returns only sets for which is_available() found every
        // feature that the function is compiled with; AVX-512 includes AVX2.
        return unsafe { point_with_avx2(job, x, y, z, gradient) };
    }
    job.at(x, y, z, gradient)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,bmi2")]
fn point_with_avx2<T, G, J: PointJob<T, G>>(job: &J, x: T, y: T, z: T, gradient: &mut G) -> T {
    job.at(x, y, z, gradient)
}

/// Work that gains from wider instructions, as a loop over arrays does.
///
/// [`run`](Self::run) must be `#[inline(always)]`, and so must all that it calls, to be compiled with them.
pub trait Wide {
    /// What it gives.
    type Out;

    /// Does the work.
    fn run(self) -> Self::Out;
}

/// Does some work with the instruction set in use: with AVX2 at most. The bits are the same with each.
///
/// ```
/// use palpate_field::{Wide, wide};
///
/// struct Sum<'a>(&'a [f64; 8]);
///
/// impl Wide for Sum<'_> {
///     type Out = f64;
///
///     #[inline(always)]
///     fn run(self) -> f64 {
///         self.0.iter().sum()
///     }
/// }
///
/// assert_eq!(wide(Sum(&[0.5; 8])), 4.0);
/// ```
#[inline(always)]
pub fn wide<W: Wide>(work: W) -> W::Out {
    #[cfg(target_arch = "x86_64")]
    if InstructionSet::in_use() >= InstructionSet::Avx2 {
        // SAFETY: in_use() returns only sets for which is_available() found every
        // feature that the function is compiled with; AVX-512 includes AVX2.
        return unsafe { wide_with_avx2(work) };
    }
    work.run()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,bmi2")]
fn wide_with_avx2<W: Wide>(work: W) -> W::Out {
    work.run()
}
