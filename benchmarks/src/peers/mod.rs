//! The peers, asked the same questions.

mod expression;
mod formula;
mod parry;
mod tape;

pub(crate) use formula::formula;
pub(crate) use parry::Body;
pub(crate) use tape::Tape;
