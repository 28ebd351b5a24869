// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Several views of one scene, at one scale and with one legend.

use crate::drawing::Drawing;
use crate::geometry::Rect;
use crate::isolines::{ABOVE_LEGEND, Isolines, MOST_HEIGHT};
use crate::legend::{self, Entry};

/// Between two views [px].
const BETWEEN: f64 = 24.0;
/// Views stand one below the other only if that makes them this many times as large, because a
/// wide figure fits a page better.
const WORTH_STACKING: f64 = 1.5;
/// The least width of a plot beside others [px], with room for ticks and a scale bar.
const NARROWEST: f64 = 150.0;

/// Views of one scene.
#[derive(Debug, Clone)]
pub(crate) struct Views {
    views: Vec<Isolines>,
}

/// Where views stand.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Layout {
    is_row: bool,
    /// Pixels per metre.
    scale: f64,
}

impl Views {
    pub(crate) fn new(views: Vec<Isolines>) -> Self {
        Self { views }
    }

    /// Room for the left axis in a picture `width` wide [px].
    pub(crate) fn gutter(&self, width: f64) -> f64 {
        self.views.iter().map(|view| view.gutter(width)).fold(0.0, f64::max)
    }

    /// Draws the views into `area` from its top, the plots starting `gutter` right of its left
    /// edge. Returns the height used. All [px].
    pub(crate) fn draw(&self, drawing: &mut Drawing, area: &Rect, gutter: f64) -> f64 {
        if self.views.is_empty() {
            return 0.0;
        }
        let extents: Vec<[f64; 2]> = self.views.iter().map(Isolines::extent).collect();
        let layout = layout(&extents, area.width(), gutter);
        let mut entries: Vec<Entry> = Vec::new();
        let [mut left, mut top] = area.min;
        let mut bottom = top;
        for (view, [width, _]) in self.views.iter().zip(&extents) {
            let width = gutter + layout.scale * width;
            let centring = if layout.is_row { 0.0 } else { 0.5 * (area.width() - width) };
            let place = Rect::new(left + centring, top, width, 0.0);
            let (height, legend) = view.draw_plot(drawing, &place, gutter);
            bottom = f64::max(bottom, top + height);
            if layout.is_row {
                left += width + BETWEEN;
            } else {
                top = bottom + BETWEEN;
            }
            for entry in legend {
                if entries.iter().all(|known| !known.is_same(&entry)) {
                    entries.push(entry);
                }
            }
        }
        let origin = [area.min[0] + gutter, bottom + ABOVE_LEGEND];
        origin[1] + legend::draw(drawing, &entries, origin, area.max[0] - origin[0])
            - area.min[1]
    }
}

/// The layout, a row or a column, that draws windows of these widths and heights [m] larger
/// within `width` [px].
fn layout(extents: &[[f64; 2]], width: f64, gutter: f64) -> Layout {
    let sum = |i: usize| extents.iter().map(|extent| extent[i]).sum::<f64>();
    let largest = |i: usize| extents.iter().map(|extent| extent[i]).fold(0.0, f64::max);
    let count = extents.len() as f64;
    let free = width - count * gutter - (count - 1.0) * BETWEEN;
    let row = (free / sum(0)).min(MOST_HEIGHT / largest(1));
    let column = ((width - gutter) / largest(0)).min(MOST_HEIGHT / sum(1));
    let narrowest = extents.iter().map(|extent| extent[0] * row).fold(f64::INFINITY, f64::min);
    let is_row = narrowest >= NARROWEST && column < WORTH_STACKING * row;
    Layout { is_row, scale: if is_row { row } else { column } }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn square_views_stand_in_a_row_and_wide_ones_in_a_column() {
        let cup = layout(&[[0.14, 0.12], [0.14, 0.14]], 760.0, 60.0);
        assert_eq!(cup, Layout { is_row: true, scale: 616.0 / 0.28 });
        let gallery = layout(&[[0.85, 0.3], [0.85, 0.25]], 760.0, 60.0);
        assert_eq!(gallery, Layout { is_row: false, scale: 700.0 / 0.85 });
        let narrow = layout(&[[0.1, 1.0], [0.1, 0.1]], 760.0, 60.0);
        assert!(!narrow.is_row);
    }

    #[test]
    fn one_view_is_as_large_as_it_would_be_alone() {
        let one = layout(&[[0.2, 0.1]], 760.0, 60.0);
        assert_eq!(one.scale, 700.0 / 0.2);
    }
}
