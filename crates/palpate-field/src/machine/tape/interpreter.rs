// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Runs tapes.

use super::instruction::{Instruction, Power, Profile, Register};
use super::{Column, LaneArray, OnTape, Rows, RowsMut, Step, Tape};
use crate::field::Asked;
use crate::scalar::{
    Circular, Cubic, Exponential, PowerForm, Quadratic, Quartic, Root, Scalar,
};
use crate::vector::array;

/// The registers while a tape runs.
struct Registers<'r, L> {
    all: &'r mut [L],
}

impl<L> Registers<'_, L> {
    /// The register of a result, to be written.
    ///
    /// # Safety
    ///
    /// It must be one of the registers, and no other reference to it may be in use.
    #[inline(always)]
    unsafe fn out<'l>(&mut self, register: Register) -> &'l mut L {
        debug_assert!((register as usize) < self.all.len());
        // SAFETY: the caller promises it.
        unsafe { &mut *self.all.as_mut_ptr().add(register as usize) }
    }

    /// The register of an argument.
    ///
    /// # Safety
    ///
    /// It must be one of the registers, and not that of the result.
    #[inline(always)]
    unsafe fn argument<'l>(&mut self, register: Register) -> &'l L {
        debug_assert!((register as usize) < self.all.len());
        // SAFETY: the caller promises it.
        unsafe { &*self.all.as_mut_ptr().add(register as usize) }
    }
}

/// Works through all lanes of one instruction: `$number` is computed in each lane from the argument
/// registers.
macro_rules! each_lane {
    ($registers:ident, $lanes:ident, $out:ident, [$($x:ident),*], $number:expr) => {{
        // SAFETY: the slice holds all the tape's registers, and the register of a step's result
        // differs from its argument registers.
        let out = unsafe { $registers.out($out) };
        $(
            // SAFETY: as above.
            let $x = unsafe { $registers.argument($x) };
        )*
        for i in 0..$lanes {
            // SAFETY: an earlier step wrote the first `$lanes` lanes of each argument.
            $(let $x = unsafe { $x.read(i) };)*
            out.write(i, $number);
        }
    }};
}

/// All instructions, one after the other, for `W` lanes at a time.
#[inline(always)]
fn interpret<S: OnTape, const W: usize>(
    tape: &Tape,
    coordinates: &[&Column<S>],
    all: usize,
    registers: &mut [S::Lanes<W>],
    out: &mut Column<S>,
) {
    use Instruction as I;
    assert!(tape.registers <= registers.len(), "{} registers", registers.len());
    let mut r = Registers { all: registers };
    for first in (0..all).step_by(W) {
        let n = W.min(all - first);
        for Step { out, instruction } in &tape.steps {
            let o = *out;
            match *instruction {
                I::Coordinate(axis) => {
                    // SAFETY: the register is one of the tape's.
                    let out = unsafe { r.out(o) };
                    for i in 0..n {
                        // SAFETY: `run` checked that these lanes of each coordinate are written.
                        out.write(i, unsafe { coordinates[axis].read(first + i) });
                    }
                }
                I::AskPlanar(of, field) => ask::<S, W>(&*tape.asked[field], &of, &mut r, o, n),
                I::AskSpatial(of, field) => ask::<S, W>(&*tape.asked[field], &of, &mut r, o, n),
                I::Constant(c) => each_lane!(r, n, o, [], S::constant(c)),
                I::Add([a, b]) => each_lane!(r, n, o, [a, b], a + b),
                I::Sub([a, b]) => each_lane!(r, n, o, [a, b], a - b),
                I::Mul([a, b]) => each_lane!(r, n, o, [a, b], a * b),
                I::Div([a, b]) => each_lane!(r, n, o, [a, b], a / b),
                I::Minus([a], c) => each_lane!(r, n, o, [a], a.minus(c)),
                I::Scale([a], c) => each_lane!(r, n, o, [a], a.scale(c)),
                I::Neg([a]) => each_lane!(r, n, o, [a], -a),
                I::Abs([a]) => each_lane!(r, n, o, [a], Scalar::abs(a)),
                I::Squared([a]) => each_lane!(r, n, o, [a], a.squared()),
                I::Sqrt([a]) => each_lane!(r, n, o, [a], Scalar::sqrt(a)),
                I::Min([a, b]) => each_lane!(r, n, o, [a, b], Scalar::min(a, b)),
                I::Max([a, b]) => each_lane!(r, n, o, [a, b], Scalar::max(a, b)),
                I::MinConstant([a], c) => {
                    each_lane!(r, n, o, [a], Scalar::min(a, S::constant(c)));
                }
                I::MaxConstant([a], c) => {
                    each_lane!(r, n, o, [a], Scalar::max(a, S::constant(c)));
                }
                I::ConstantMin([a], c) => {
                    each_lane!(r, n, o, [a], Scalar::min(S::constant(c), a));
                }
                I::ConstantMax([a], c) => {
                    each_lane!(r, n, o, [a], Scalar::max(S::constant(c), a));
                }
                I::SelectLess([a, b, c, d]) => {
                    each_lane!(r, n, o, [a, b, c, d], S::select_less(a, b, c, d));
                }
                I::Sin([a]) => each_lane!(r, n, o, [a], Scalar::sin(a)),
                I::Cos([a]) => each_lane!(r, n, o, [a], Scalar::cos(a)),
                I::Turn([a, b]) => each_lane!(r, n, o, [a, b], S::turn(a, b)),
                I::Norm1([a]) => each_lane!(r, n, o, [a], S::norm([a])),
                I::Norm2([a, b]) => each_lane!(r, n, o, [a, b], S::norm([a, b])),
                I::Norm3([a, b, c]) => each_lane!(r, n, o, [a, b, c], S::norm([a, b, c])),
                I::Orthant1([a]) => each_lane!(r, n, o, [a], S::orthant([a])),
                I::Orthant2([a, b]) => each_lane!(r, n, o, [a, b], S::orthant([a, b])),
                I::Orthant3([a, b, c]) => each_lane!(r, n, o, [a, b, c], S::orthant([a, b, c])),
                I::WeightedSum1([a], w) => each_lane!(r, n, o, [a], S::weighted_sum([a], &w)),
                I::WeightedSum2([a, b], w) => {
                    each_lane!(r, n, o, [a, b], S::weighted_sum([a, b], &w));
                }
                I::WeightedSum3([a, b, c], w) => {
                    each_lane!(r, n, o, [a, b, c], S::weighted_sum([a, b, c], &w));
                }
                I::SmoothMin([a, b], Profile::Quadratic, unit) => {
                    each_lane!(r, n, o, [a, b], a.smooth_min::<Quadratic>(b, unit));
                }
                I::SmoothMin([a, b], Profile::Cubic, unit) => {
                    each_lane!(r, n, o, [a, b], a.smooth_min::<Cubic>(b, unit));
                }
                I::SmoothMin([a, b], Profile::Quartic, unit) => {
                    each_lane!(r, n, o, [a, b], a.smooth_min::<Quartic>(b, unit));
                }
                I::SmoothMin([a, b], Profile::Circular, unit) => {
                    each_lane!(r, n, o, [a, b], a.smooth_min::<Circular>(b, unit));
                }
                I::SmoothMin([a, b], Profile::Root, unit) => {
                    each_lane!(r, n, o, [a, b], a.smooth_min::<Root>(b, unit));
                }
                I::SmoothMin([a, b], Profile::Exponential, unit) => {
                    each_lane!(r, n, o, [a, b], a.smooth_min::<Exponential>(b, unit));
                }
                I::NearestMultiple([a], [spacing, low, high]) => {
                    each_lane!(r, n, o, [a], a.nearest_multiple(spacing, low, high));
                }
                I::PlanarPower(of, form, power) => {
                    powers::<S, W, 2>(&mut r, o, of, (form, power), n);
                }
                I::SpatialPower(of, form, power) => {
                    powers::<S, W, 3>(&mut r, o, of, (form, power), n);
                }
                I::GiveOrTake([a, b]) => each_lane!(r, n, o, [a, b], a.give_or_take(b)),
                I::PlanarOrBySteepness([a, b, c], evaluations) => {
                    each_lane!(r, n, o, [a, b, c], a.or_by_steepness([b, c], evaluations));
                }
                I::SpatialOrBySteepness([a, b, c, d], evaluations) => {
                    each_lane!(
                        r,
                        n,
                        o,
                        [a, b, c, d],
                        a.or_by_steepness([b, c, d], evaluations)
                    );
                }
            }
        }
        // SAFETY: the last step wrote this register of the tape.
        let result = unsafe { r.argument(tape.result) };
        for i in 0..n {
            // SAFETY: that step wrote its first `n` lanes.
            out.write(first + i, unsafe { result.read(i) });
        }
    }
}

/// Norms of powers. Not inlined: they are rare and long.
#[inline(never)]
fn powers<S: OnTape, const W: usize, const N: usize>(
    r: &mut Registers<'_, S::Lanes<W>>,
    out: Register,
    of: [Register; N],
    (form, power): (PowerForm, Power),
    n: usize,
) {
    for i in 0..n {
        // SAFETY: the registers are some of the tape's, and steps before wrote `n` lanes of them.
        let x = array!(k < N => unsafe { r.argument(of[k]).read(i) });
        let number = match (form, power) {
            (PowerForm::Norm, Power::Four) => S::power_norm::<4, N>(x),
            (PowerForm::Norm, Power::Six) => S::power_norm::<6, N>(x),
            (PowerForm::Norm, Power::Eight) => S::power_norm::<8, N>(x),
            (PowerForm::Orthant, Power::Four) => S::power_orthant::<4, N>(x),
            (PowerForm::Orthant, Power::Six) => S::power_orthant::<6, N>(x),
            (PowerForm::Orthant, Power::Eight) => S::power_orthant::<8, N>(x),
        };
        // SAFETY: the register is one of the tape's, and none of the arguments'.
        unsafe { r.out(out) }.write(i, number);
    }
}

/// The answers of a field at the points in some registers.
#[inline(never)]
fn ask<S: OnTape, const W: usize>(
    field: &dyn Asked,
    of: &[Register],
    r: &mut Registers<'_, S::Lanes<W>>,
    out: Register,
    n: usize,
) {
    let mut answers = Column::scratch();
    let coordinate = |axis: usize, lane: usize| {
        assert!(lane < n);
        // SAFETY: the register is one of the tape's, and a step before wrote `n` lanes of it.
        unsafe { (*r.all.as_ptr().add(of[axis] as usize)).read(lane) }
    };
    S::ask(field, n, &coordinate, &mut answers);
    // SAFETY: the register is one of the tape's.
    let out = unsafe { r.out(out) };
    (0..n).for_each(|i| out.write(i, answers.get(i)));
}

/// The interpreter, in functions compiled with the instructions that the attributes enable.
macro_rules! compiled_interpreters {
    ($($(#[$attribute:meta])* $name:ident;)*) => {$(
        $(#[$attribute])*
        pub(super) fn $name<S: OnTape, const W: usize>(
            tape: &Tape,
            coordinates: &[&Column<S>],
            lanes: usize,
            registers: &mut [S::Lanes<W>],
            out: &mut Column<S>,
        ) {
            interpret::<S, W>(tape, coordinates, lanes, registers, out);
        }
    )*};
}

compiled_interpreters! {
    #[inline(never)]
    everywhere;

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,bmi2")]
    with_avx2;

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,bmi2,avx512f,avx512vl,avx512dq,avx512bw")]
    with_avx512;
}
