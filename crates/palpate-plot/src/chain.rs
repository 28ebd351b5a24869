// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Segments joined into lines.

/// Joins `segments` between numbered nodes into lines that pass each segment once, end to end.
///
/// Lines begin and end at nodes where other than two segments meet; a line without such a node
/// is closed, and its last node is its first. A segment from a node to itself is a line of its
/// own.
pub(crate) fn chains(segments: &[[usize; 2]]) -> Vec<Vec<usize>> {
    let count = segments.iter().flatten().max().map_or(0, |largest| largest + 1);
    let mut at_node = vec![Vec::new(); count];
    for (index, nodes) in segments.iter().enumerate() {
        nodes.iter().for_each(|&node| at_node[node].push(index));
    }
    let is_end = |node: usize| at_node[node].len() != 2;
    let mut is_used = vec![false; segments.len()];
    let mut lines = Vec::new();
    // Lines with ends first: what is left are closed ones.
    let from_ends = (0..count)
        .filter(|&node| is_end(node))
        .flat_map(|node| at_node[node].iter().map(move |&segment| (node, segment)));
    let closed = (0..segments.len()).map(|segment| (segments[segment][0], segment));
    for (start, first) in from_ends.chain(closed) {
        if is_used[first] {
            continue;
        }
        let (mut line, mut next) = (vec![start], Some(first));
        while let Some(segment) = next {
            is_used[segment] = true;
            let [a, b] = segments[segment];
            let node = if a == line[line.len() - 1] { b } else { a };
            line.push(node);
            next =
                at_node[node].iter().copied().find(|&other| !is_end(node) && !is_used[other]);
        }
        lines.push(line);
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_become_lines_and_rings() {
        let path = [[3, 1], [1, 0], [4, 3]];
        assert_eq!(chains(&path), [[0, 1, 3, 4]]);
        assert_eq!(chains(&[[0, 1], [2, 1], [0, 2]]), [[0, 1, 2, 0]]);
        assert_eq!(chains(&[[5, 5]]), [[5, 5]]);
        assert!(chains(&[]).is_empty());
    }

    #[test]
    fn lines_end_where_three_meet() {
        let star = [[0, 1], [0, 2], [3, 0], [3, 4]];
        assert_eq!(chains(&star), [vec![0, 1], vec![0, 2], vec![0, 3, 4]]);
    }
}
