//! fidget's evaluators, called at their lowest level.

use fidget::context::{Context, Tree};
use fidget::eval::{BulkEvaluator, Function, MathFunction, TracingEvaluator};
use fidget::types::Grad;
use fidget::var::Var;
