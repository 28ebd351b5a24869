// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Zeros on edges with one sign at both ends: wires, and gaps and walls thinner than a cell.

use super::{Asked, BoundedField, Corner, Corners, Edge, Lattice, Zeros, sorted_edges};
use crate::error::PlotError;
use crate::slope::SampledSlope;

/// Probes of an edge at most.
const PROBES: usize = 5;

/// A zero is found where the value is this small, over the sum of those at the ends.
const FOUND: f64 = 0.05;

/// A point of an edge: its share of the way, the value [m], and its change along the edge [m].
#[derive(Debug, Clone, Copy)]
struct End {
    share: f64,
    value: f64,
    along: f64,
}

/// The search for the smallest value: where the tangents of both ends meet (Kelley 1960).
struct Search {
    edge: Edge,
    ends: [End; 2],
    /// Where the field is asked next, or where the zero was found.
    probe: f64,
    /// The value at which the search ends [m].
    near: f64,
    state: State,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    Open,
    Found,
    Without,
}

/// Finds zeros on those edges of `cells` on which the sign does not change.
pub(super) fn find(
    cells: &[Corner],
    lattice: &Lattice,
    field: &mut Asked<impl BoundedField>,
) -> Result<Zeros, PlotError> {
    let slopes = Corners::of(cells, lattice, |places| field.slopes(places))?;
    let search = |edge: Edge| {
        let [a, b] = edge.ends().map(|at| slopes.get(at));
        let ends = [(0.0, a?), (1.0, b?)];
        Some(Search::new(edge, ends.map(|(share, slope)| edge.end(lattice, share, slope))))
    };
    let mut searches: Vec<_> = sorted_edges(cells).into_iter().filter_map(search).collect();
    for _ in 0..PROBES {
        searches.retain(|search| search.state != State::Without);
        let open = || searches.iter().filter(|search| search.state == State::Open);
        let places: Vec<_> =
            open().map(|search| search.edge.point(lattice, search.probe)).collect();
        let slopes = field.slopes(&places)?;
        let open = searches.iter_mut().filter(|search| search.state == State::Open);
        for (search, slope) in open.zip(slopes) {
            search.take(search.edge.end(lattice, search.probe, slope));
        }
    }
    searches.retain(|search| search.state == State::Found);
    let place = |search: &Search| search.edge.point(lattice, search.probe);
    Ok(Zeros {
        edges: searches.iter().map(|search| search.edge).collect(),
        places: searches.iter().map(place).collect(),
    })
}

impl Edge {
    fn end(self, lattice: &Lattice, share: f64, slope: SampledSlope) -> End {
        End { share, value: slope.value, along: slope.gradient[self.axis] * lattice.edge }
    }
}

impl Search {
    fn new(edge: Edge, ends: [End; 2]) -> Self {
        let near = FOUND * (ends[0].value.abs() + ends[1].value.abs());
        let mut search = Self { edge, ends, probe: 0.0, near, state: State::Without };
        if (ends[0].value < 0.0) == (ends[1].value < 0.0) {
            search.state = State::Open;
            search.aim();
        }
        search
    }

    fn sign(&self) -> f64 {
        if self.ends[0].value < 0.0 { -1.0 } else { 1.0 }
    }

    /// Chooses the point where the tangents of both ends meet. There is no zero if the values do
    /// not fall towards it from both ends, or the tangents meet far from zero; written so that
    /// NaN ends the search.
    fn aim(&mut self) {
        let (sign, [a, b]) = (self.sign(), self.ends);
        let at_start = |end: &End| end.value - end.share * end.along;
        let meet = (at_start(&b) - at_start(&a)) / (a.along - b.along);
        let value = sign * (at_start(&a) + meet * a.along);
        let falls = sign * a.along <= 0.0 && sign * b.along >= 0.0;
        if falls && a.share <= meet && meet <= b.share && value <= self.near {
            self.probe = meet;
        } else {
            self.state = State::Without;
        }
    }

    fn take(&mut self, probe: End) {
        let (sign, value) = (self.sign(), probe.value);
        if sign * value <= self.near {
            self.state = State::Found;
            return;
        }
        let replaced = usize::from(sign * probe.along >= 0.0);
        self.ends[replaced] = probe;
        self.aim();
    }
}
