// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! fidget's evaluators, called at their lowest level.

use fidget::context::{Context, Tree};
use fidget::eval::{BulkEvaluator, Function, MathFunction, TracingEvaluator};
use fidget::types::{Grad, Interval};
use fidget::var::Var;

type PointTape<F> = <<F as Function>::PointEval as TracingEvaluator>::Tape;
type FloatTape<F> = <<F as Function>::FloatSliceEval as BulkEvaluator>::Tape;
type GradTape<F> = <<F as Function>::GradSliceEval as BulkEvaluator>::Tape;
type IntervalTape<F> = <<F as Function>::IntervalEval as TracingEvaluator>::Tape;

/// One formula, compiled for every way of evaluation that fidget offers.
pub(crate) struct Tape<F: MathFunction> {
    function: F,
    point: (F::PointEval, PointTape<F>),
    float: (F::FloatSliceEval, FloatTape<F>),
    grad: (F::GradSliceEval, GradTape<F>),
    interval: (F::IntervalEval, IntervalTape<F>),
    workspace: F::Workspace,
    /// Which coordinate each of the formula's variables is.
    order: Vec<usize>,
}

impl<F: MathFunction> Tape<F> {
    pub(crate) fn new(tree: &Tree) -> Self {
        let mut context = Context::new();
        let node = context.import(tree);
        let function = F::new(&context, &[node]).expect("the node is of this context");
        let mut order = vec![usize::MAX; function.vars().len()];
        for (axis, var) in [Var::X, Var::Y, Var::Z].iter().enumerate() {
            if let Some(index) = function.vars().get(var) {
                order[index] = axis;
            }
        }
        Self {
            point: (F::new_point_eval(), function.point_tape(Default::default())),
            float: (F::new_float_slice_eval(), function.float_slice_tape(Default::default())),
            grad: (F::new_grad_slice_eval(), function.grad_slice_tape(Default::default())),
            interval: (F::new_interval_eval(), function.interval_tape(Default::default())),
            workspace: Default::default(),
            order,
            function,
        }
    }

    /// The distance at one point.
    pub(crate) fn distance(&mut self, p: [f32; 3]) -> f32 {
        let vars = self.ordered(p);
        let (evaluator, tape) = &mut self.point;
        let result = evaluator.eval(tape, &vars[..self.order.len()]);
        result.expect("all variables are given").0[0]
    }

    /// The distance of the last of the points with the given coordinates.
    pub(crate) fn distances(&mut self, p: [&[f32]; 3]) -> f32 {
        let vars = self.ordered(p);
        let (evaluator, tape) = &mut self.float;
        let result = evaluator.eval(tape, &vars[..self.order.len()]);
        last(&result.expect("all variables are given")[0])
    }

    /// The gradient of the last of the points with the given coordinates, each
    /// with itself as its derivative.
    pub(crate) fn gradients(&mut self, p: [&[Grad]; 3]) -> Grad {
        let vars = self.ordered(p);
        let (evaluator, tape) = &mut self.grad;
        let result = evaluator.eval(tape, &vars[..self.order.len()]);
        last(&result.expect("all variables are given")[0])
    }

    /// As [`distances`](Self::distances), by a formula simplified to what matters
    /// in the box around the points.
    pub(crate) fn simplified_distances(&mut self, p: [&[f32]; 3]) -> f32 {
        let range = |x: &[f32]| {
            let low = x.iter().copied().fold(f32::INFINITY, f32::min);
            let high = x.iter().copied().fold(f32::NEG_INFINITY, f32::max);
            Interval::new(low, high)
        };
        let vars = self.ordered(p.map(range));
        let (evaluator, tape) = &mut self.interval;
        let result = evaluator.eval(tape, &vars[..self.order.len()]);
        let Some(trace) = result.expect("all variables are given").1 else {
            return self.distances(p);
        };
        let simple = self
            .function
            .simplify(trace, Default::default(), &mut self.workspace)
            .expect("the trace is of this function");
        let order: Vec<_> = [Var::X, Var::Y, Var::Z]
            .iter()
            .enumerate()
            .filter_map(|(axis, var)| simple.vars().get(var).map(|index| (index, axis)))
            .collect();
        let mut vars = p;
        for (index, axis) in &order {
            vars[*index] = p[*axis];
        }
        let tape = simple.float_slice_tape(Default::default());
        let result = self.float.0.eval(&tape, &vars[..order.len()]);
        last(&result.expect("all variables are given")[0])
    }

    /// The coordinates in the order of the formula's variables.
    fn ordered<T: Copy>(&self, p: [T; 3]) -> [T; 3] {
        std::array::from_fn(|i| self.order.get(i).map_or(p[0], |axis| p[*axis]))
    }
}

fn last<T: Copy + Default>(values: &[T]) -> T {
    values.last().copied().unwrap_or_default()
}
