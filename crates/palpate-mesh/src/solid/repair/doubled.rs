// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Elements with the vertices of others, and the patches that they make.

use std::collections::HashMap;

use super::rims::{by_rim, root, sides};

/// What a patch of doubled elements is, by the other elements at its border.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Patch {
    /// An even number at each rim of its border: a wall between two volumes.
    Wall,
    /// None at all, and it is not closed: a sheet with two sides.
    Free,
    /// Else: a surface that is there twice.
    Surface,
}

/// The doubled elements.
pub(super) struct Doubled {
    /// The elements with the same vertices.
    pub(super) groups: Vec<Vec<usize>>,
    /// Whether all elements are doubled.
    pub(super) are_all: bool,
    /// Of each group, the first group of its patch, and of that, what the patch is.
    first: Vec<usize>,
    patches: Vec<Patch>,
}

impl Doubled {
    pub(super) fn of<const N: usize>(elements: &[[u32; N]]) -> Self {
        let mut copies: HashMap<[u32; N], Vec<usize>> = HashMap::new();
        for (i, element) in elements.iter().enumerate() {
            let mut key = *element;
            key.sort_unstable();
            copies.entry(key).or_default().push(i);
        }
        let mut groups: Vec<_> = copies.into_values().filter(|same| same.len() > 1).collect();
        groups.sort_unstable();
        let mut of_element = vec![None; elements.len()];
        for (group, same) in groups.iter().enumerate() {
            same.iter().for_each(|element| of_element[*element] = Some(group));
        }
        let mut first: Vec<usize> = (0..groups.len()).collect();
        // Of each rim of a group: the group, how many others it has, and whether it is the only group there.
        let mut rims = Vec::new();
        for at_rim in by_rim(&sides(elements)) {
            let all = at_rim.iter().map(|side| of_element[side.element as usize]);
            let mut here: Vec<usize> = all.flatten().collect();
            let others = at_rim.len() - here.len();
            here.sort_unstable();
            here.dedup();
            let Some(group) = here.first() else { continue };
            for other in &here[1..] {
                let [a, b] = [*group, *other].map(|group| root(&mut first, group));
                first[a.max(b)] = a.min(b);
            }
            rims.push((*group, others, here.len() == 1));
        }
        let first: Vec<usize> = (0..groups.len()).map(|i| root(&mut first, i)).collect();
        let mut borders = vec![Border::default(); groups.len()];
        for (group, others, is_alone) in rims {
            let border = &mut borders[first[group]];
            border.is_odd |= !others.is_multiple_of(2);
            border.has_others |= others > 0;
            border.is_open |= others == 0 && is_alone;
        }
        let patches = borders.iter().map(Border::patch).collect();
        let are_all = of_element.iter().all(Option::is_some);
        Self { groups, are_all, first, patches }
    }

    /// What the patch of a group is.
    pub(super) fn patch_of(&self, group: usize) -> Patch {
        self.patches[self.first[group]]
    }
}

/// The border of a patch.
#[derive(Clone, Copy, Debug, Default)]
struct Border {
    /// Whether a rim has an odd number of other elements.
    is_odd: bool,
    /// Whether a rim has other elements.
    has_others: bool,
    /// Whether a rim has nothing but one group.
    is_open: bool,
}

impl Border {
    fn patch(&self) -> Patch {
        match self {
            Self { is_odd: false, has_others: true, .. } => Patch::Wall,
            Self { has_others: false, is_open: true, .. } => Patch::Free,
            _ => Patch::Surface,
        }
    }
}
