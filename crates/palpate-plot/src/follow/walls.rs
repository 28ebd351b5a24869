// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Zeros on edges along which the sign changes.

use super::{Asked, BoundedField, Corner, Corners, Edge, Lattice, Zeros, sorted_edges};
use crate::error::PlotError;

/// Probes of an edge at most.
const PROBES: usize = 4;

/// A zero is found where the value is this small, over the sum of those at the ends.
const FOUND: f64 = 0.02;

/// The search for a zero, by the method of false position with halved values (Illinois).
struct Search {
    edge: Edge,
    /// Shares of the way along the edge, and values there, of which the signs differ [m].
    ends: [(f64, f64); 2],
    /// Where the field is asked next.
    probe: f64,
    /// The value at which the search ends [m].
    near: f64,
    is_open: bool,
}

/// Finds the changes of sign on the edges of `cells`.
pub(super) fn find(
    cells: &[Corner],
    lattice: &Lattice,
    field: &mut Asked<impl BoundedField>,
) -> Result<Zeros, PlotError> {
    let values = Corners::of(cells, lattice, |places| field.values(places))?;
    let search = |edge: Edge| {
        let [a, b] = edge.ends().map(|at| values.get(at));
        Search::new(edge, a?, b?)
    };
    let mut searches: Vec<_> = sorted_edges(cells).into_iter().filter_map(search).collect();
    for _ in 0..PROBES {
        let open = || searches.iter().filter(|search| search.is_open);
        let places: Vec<_> =
            open().map(|search| search.edge.point(lattice, search.probe)).collect();
        let values = field.values(&places)?;
        let open = searches.iter_mut().filter(|search| search.is_open);
        open.zip(values).for_each(|(search, value)| search.take(value));
    }
    let place = |search: &Search| search.edge.point(lattice, search.probe);
    Ok(Zeros {
        edges: searches.iter().map(|search| search.edge).collect(),
        places: searches.iter().map(place).collect(),
    })
}

impl Search {
    /// `None` if the signs of the values at the ends are the same.
    fn new(edge: Edge, a: f64, b: f64) -> Option<Self> {
        let mut search = Self {
            edge,
            ends: [(0.0, a), (1.0, b)],
            probe: 0.0,
            near: FOUND * (a.abs() + b.abs()),
            is_open: true,
        };
        search.aim();
        ((a < 0.0) != (b < 0.0)).then_some(search)
    }

    /// Chooses the zero of the chord.
    fn aim(&mut self) {
        let [(from, a), (to, b)] = self.ends;
        self.probe = from + (to - from) * (a / (a - b));
    }

    fn take(&mut self, value: f64) {
        if value.abs() <= self.near {
            self.is_open = false;
            return;
        }
        let replaced = usize::from((value < 0.0) != (self.ends[0].1 < 0.0));
        self.ends[replaced] = (self.probe, value);
        self.ends[1 - replaced].1 *= 0.5;
        self.aim();
    }
}
