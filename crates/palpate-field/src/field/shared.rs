// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Fields that several shapes and fields hold, and the one place that chooses how a block is answered.

use std::ops::Deref;
use std::sync::{Arc, OnceLock};

use super::Field;
use crate::machine::{Block, Column, Gradients, InstructionSet, OnTape, Tape};
use crate::scalar::{Model, Purpose, Recorded, SpaceTimeModel};
use crate::vector::Vector;

/// A field that several shapes and fields may hold, with its tapes.
#[derive(Debug)]
pub struct SharedField<const D: usize>(Arc<Held<dyn Field<D>>>);

#[derive(Debug)]
struct Held<F: ?Sized> {
    /// The tape of the distances, once recorded.
    values: OnceLock<Box<Tape>>,
    /// The tape of the models, once recorded.
    models: OnceLock<Box<Tape>>,
    /// Whether all tapes are recorded, also those of fields that they call.
    prepared: OnceLock<()>,
    field: F,
}

impl<const D: usize> Clone for SharedField<D> {
    fn clone(&self) -> Self {
        Self(Arc::clone(&self.0))
    }
}

impl<const D: usize> Deref for SharedField<D> {
    type Target = dyn Field<D>;

    fn deref(&self) -> &Self::Target {
        &self.0.field
    }
}

impl<const D: usize> SharedField<D> {
    /// A field to be shared.
    pub(crate) fn new(field: impl Field<D> + 'static) -> Self {
        let (values, models, prepared) = (OnceLock::new(), OnceLock::new(), OnceLock::new());
        Self(Arc::new(Held { values, models, prepared, field }))
    }

    /// The answers in the first `count` lanes of a block; those of `out` past them are unspecified.
    #[inline]
    pub fn evaluate<S: Evaluate>(&self, p: &Block<S, D>, count: usize, out: &mut Column<S>) {
        S::evaluate(self, p, count, out);
    }

    /// The distances and gradients in the first `count` lanes of a block; those of `out` past them are
    /// unspecified.
    #[inline]
    pub fn gradients(&self, p: &Block<f64, D>, count: usize, out: &mut Gradients<f64, D>) {
        if InstructionSet::in_use().has_loops() || !self.has_formula() {
            self.distances_gradients(p, count, out);
        } else {
            self.gradients_point_by_point(p, count, out);
        }
    }

    #[cold]
    #[inline(never)]
    fn gradients_point_by_point(
        &self,
        p: &Block<f64, D>,
        count: usize,
        out: &mut Gradients<f64, D>,
    ) {
        out.fill(count, |i| {
            let (x, y, z) = p.get(i).coordinates();
            let mut gradient = Vector::ZERO;
            let distance = self.distance_gradient(x, y, z, &mut gradient);
            (distance, gradient)
        });
    }

    /// The distances on a machine without loops: by the tape, or point by point if it is long.
    #[cold]
    #[inline(never)]
    fn distances_without_loops(&self, p: &Block<f64, D>, count: usize, out: &mut Column<f64>) {
        let tape = self.tape(Purpose::Values);
        if tape.is_short::<f64>() {
            return tape.run(&p.columns(), count, out);
        }
        out.fill(count, |i| {
            let (x, y, z) = p.get(i).coordinates();
            self.distance(x, y, z)
        });
    }

    /// The models by the tape.
    #[cold]
    #[inline(never)]
    fn models_by_tape(&self, p: &Block<Model, D>, count: usize, out: &mut Column<Model>) {
        self.tape(Purpose::Models).run(&p.columns(), count, out);
    }

    /// `true` if both are one field.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }

    /// Records the tapes that blocks need on this machine. Without this the first evaluation would
    /// record them and allocate, which a servo may not.
    pub fn prepare(&self) {
        if InstructionSet::in_use().has_loops() {
            return;
        }
        self.0.prepared.get_or_init(|| {
            if self.has_formula() {
                self.tape(Purpose::Values).prepare();
            }
            if self.own_models().is_none() {
                self.tape(Purpose::Models).prepare();
            }
            self.members().unwrap_or_default().iter().for_each(Self::prepare);
        });
    }

    /// The formula of the field at `p`. While a tape is recorded, a field without tape operations
    /// becomes one instruction that calls it.
    pub(crate) fn record(&self, p: Vector<Recorded, D>) -> Option<Recorded> {
        let field = &**self;
        let answers_itself = match Recorded::purpose() {
            Purpose::Formula | Purpose::Shader => false,
            Purpose::Values => !field.has_formula(),
            Purpose::Models => field.own_models().is_some(),
        };
        if answers_itself {
            return Some(Recorded::asked(Arc::new(self.clone()), p));
        }
        field.record(p)
    }

    /// The tape of a field that does not answer itself.
    fn tape(&self, purpose: Purpose) -> &Tape {
        let held = &*self.0;
        let tape = if purpose == Purpose::Models { &held.models } else { &held.values };
        tape.get_or_init(|| {
            let recorded = Recorded::graph(purpose, |p| held.field.record(p));
            let (graph, result) = recorded.expect("a field without a formula has no tape");
            Box::new(Tape::new(graph, result))
        })
    }
}

/// A number that fields are evaluated with in blocks: [`f64`], [`Model`] and [`SpaceTimeModel`].
pub trait Evaluate: OnTape {
    /// The answers of a field: [`SharedField::evaluate`].
    fn evaluate<const D: usize>(
        field: &SharedField<D>,
        p: &Block<Self, D>,
        count: usize,
        out: &mut Column<Self>,
    );
}

impl Evaluate for f64 {
    #[inline]
    fn evaluate<const D: usize>(
        field: &SharedField<D>,
        p: &Block<Self, D>,
        count: usize,
        out: &mut Column<Self>,
    ) {
        if InstructionSet::in_use().has_loops() || !field.has_formula() {
            field.distances(p, count, out);
        } else {
            field.distances_without_loops(p, count, out);
        }
    }
}

impl Evaluate for Model {
    #[inline]
    fn evaluate<const D: usize>(
        field: &SharedField<D>,
        p: &Block<Self, D>,
        count: usize,
        out: &mut Column<Self>,
    ) {
        if InstructionSet::in_use().has_loops() || field.own_models().is_some() {
            field.models(p, count, out);
        } else {
            field.models_by_tape(p, count, out);
        }
    }
}

impl Evaluate for SpaceTimeModel {
    #[inline]
    fn evaluate<const D: usize>(
        field: &SharedField<D>,
        p: &Block<Self, D>,
        count: usize,
        out: &mut Column<Self>,
    ) {
        match field.own_models() {
            Some(own) => own.space_time_models(p, count, out),
            None => field.tape(Purpose::Models).run(&p.columns(), count, out),
        }
    }
}

/// A field that a tape calls, of any dimension. `coordinate(axis, lane)` gives one coordinate of
/// one point.
pub trait Asked: std::fmt::Debug + Send + Sync {
    /// As [`SharedField::prepare`].
    fn prepare_it(&self);

    /// The distances in the first `count` lanes.
    fn distances_at(
        &self,
        count: usize,
        coordinate: &dyn Fn(usize, usize) -> f64,
        out: &mut Column<f64>,
    );

    /// The models in the first `count` lanes.
    fn models_at(
        &self,
        count: usize,
        coordinate: &dyn Fn(usize, usize) -> Model,
        out: &mut Column<Model>,
    );

    /// The models in space and time in the first `count` lanes.
    fn space_time_models_at(
        &self,
        count: usize,
        coordinate: &dyn Fn(usize, usize) -> SpaceTimeModel,
        out: &mut Column<SpaceTimeModel>,
    );
}

impl<const D: usize> SharedField<D> {
    fn answer<S: Evaluate>(
        &self,
        count: usize,
        coordinate: &dyn Fn(usize, usize) -> S,
        out: &mut Column<S>,
    ) {
        let mut p = Block::scratch();
        p.fill(count, |i| Vector(std::array::from_fn(|axis| coordinate(axis, i))));
        self.evaluate(&p, count, out);
    }
}

impl<const D: usize> Asked for SharedField<D> {
    fn prepare_it(&self) {
        self.prepare();
    }

    fn distances_at(
        &self,
        count: usize,
        coordinate: &dyn Fn(usize, usize) -> f64,
        out: &mut Column<f64>,
    ) {
        self.answer(count, coordinate, out);
    }

    fn models_at(
        &self,
        count: usize,
        coordinate: &dyn Fn(usize, usize) -> Model,
        out: &mut Column<Model>,
    ) {
        self.answer(count, coordinate, out);
    }

    fn space_time_models_at(
        &self,
        count: usize,
        coordinate: &dyn Fn(usize, usize) -> SpaceTimeModel,
        out: &mut Column<SpaceTimeModel>,
    ) {
        self.answer(count, coordinate, out);
    }
}
