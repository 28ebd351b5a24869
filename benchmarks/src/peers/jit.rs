// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! fidget's evaluators, called at their lowest level.

use fidget::context::{Context, Tree};
use fidget::eval::{BulkEvaluator, Function, MathFunction, TracingEvaluator};
use fidget::types::Grad;
use fidget::var::Var;
