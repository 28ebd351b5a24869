// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Rims: the edges at which triangles meet, the end points at which segments do.

/// A rim of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::solid) struct Side {
    /// The vertices of the rim, the lower first; an end point twice.
    pub(in crate::solid) rim: [u32; 2],
    pub(in crate::solid) element: u32,
    /// Which of the element's sides it is: from this corner on, or at it.
    pub(in crate::solid) number: u8,
    /// Whether the element passes from the lower vertex to the higher, or begins at the end point. Two
    /// elements agree on the inside if they pass their rim in both directions.
    pub(in crate::solid) is_forward: bool,
}

/// The sides of all elements, sorted by rim.
pub(in crate::solid) fn sides<const N: usize>(elements: &[[u32; N]]) -> Vec<Side> {
    let mut sides = Vec::with_capacity(N * elements.len());
    for (element, indices) in (0..).zip(elements) {
        for i in 0..N {
            let (from, to) = (indices[i], indices[(i + 1) % N]);
            let (rim, is_forward) = match N {
                2 => ([from; 2], i == 0),
                _ => ([from.min(to), from.max(to)], from < to),
            };
            sides.push(Side { rim, element, number: i as u8, is_forward });
        }
    }
    sides.sort_unstable();
    sides
}

/// The sides at each rim.
pub(in crate::solid) fn by_rim(sides: &[Side]) -> impl Iterator<Item = &[Side]> {
    sides.chunk_by(|a, b| a.rim == b.rim)
}

/// The pieces of a mesh, whose elements meet in pairs: of each element the number of its piece, and how many
/// pieces there are.
pub(super) fn pieces<const N: usize>(elements: &[[u32; N]]) -> (Vec<usize>, usize) {
    let mut parents: Vec<usize> = (0..elements.len()).collect();
    for at_rim in by_rim(&sides(elements)) {
        if let [a, b] = at_rim {
            let (a, b) = (
                root(&mut parents, a.element as usize),
                root(&mut parents, b.element as usize),
            );
            parents[a.max(b)] = a.min(b);
        }
    }
    let (mut numbers, mut count) = (vec![usize::MAX; elements.len()], 0);
    for element in 0..elements.len() {
        let first = root(&mut parents, element);
        // The root of a piece is its first element.
        if first == element {
            numbers[element] = count;
            count += 1;
        } else {
            numbers[element] = numbers[first];
        }
    }
    (numbers, count)
}

fn root(parents: &mut [usize], mut i: usize) -> usize {
    while parents[i] != i {
        parents[i] = parents[parents[i]];
        i = parents[i];
    }
    i
}
