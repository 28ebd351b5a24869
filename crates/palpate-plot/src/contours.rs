// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Isolines of sampled values, by marching squares (the crate `contour`).

use contour::ContourBuilder;

use crate::geometry::Point;
use crate::slice::Samples;

/// Closed rings around the points where a field is at least `level` [m].
///
/// In plane coordinates [m]. Rings are nested, outer and inner alike, so the even-odd rule
/// fills them. Along the edge of the grid, a cell outside the window, they follow the edge.
pub(crate) fn rings(samples: &Samples, level: f64) -> Vec<Vec<Point>> {
    let Samples { columns, rows, cell, origin, ref values } = *samples;
    let lines =
        ContourBuilder::new(columns, rows, true).lines(values, &[level]).unwrap_or_default(); // fails for a wrong number of values only
    lines
        .into_iter()
        .flat_map(|line| line.into_inner().0.0)
        .map(|ring| {
            ring.0.iter().map(|p| [origin[0] + p.x * cell, origin[1] + p.y * cell]).collect()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::slice::{PlaneView, Sampling};

    fn disc(radius: f64, scale: f64) -> (Samples, Vec<Vec<Point>>) {
        let view = PlaneView::new([0.1 * scale, 0.0], 3.0 * scale, 2.5 * scale).unwrap();
        let samples = Samples::new(&view, Sampling::new(100).unwrap(), |points, out| {
            for (p, v) in points.iter().zip(out) {
                *v = p[0].hypot(p[1]) - radius * scale;
            }
        })
        .unwrap();
        let rings = rings(&samples, 0.0);
        (samples, rings)
    }

    /// Linear interpolation along a cell's edge h of a distance with curvature 1/r errs by at
    /// most h²/8r; a chord of the line sags as little again.
    #[test]
    fn a_disc_has_its_radius_at_every_scale() {
        for scale in [1e-6, 1.0, 1e6] {
            let (samples, rings) = disc(1.0, scale);
            // The outside touches the edge of the grid: one ring there, one around the disc.
            let circle = rings.iter().min_by_key(|ring| ring.len()).unwrap();
            assert_eq!(rings.len(), 2);
            let bound = samples.cell * samples.cell / (8.0 * scale) * 1.01;
            for p in circle {
                let error = (p[0].hypot(p[1]) - scale).abs();
                assert!(error <= bound, "{error} > {bound}");
            }
        }
    }

    #[test]
    fn a_field_of_one_sign_has_no_ring_within_the_window() {
        let view = PlaneView::new([0.0, 0.0], 1.0, 1.0).unwrap();
        let samples =
            Samples::new(&view, Sampling::new(10).unwrap(), |_, out| out.fill(0.25)).unwrap();
        assert!(rings(&samples, 0.5).is_empty());
        let around = rings(&samples, 0.0);
        assert!(around.iter().flatten().all(|p| p[0].abs() > 0.5 || p[1].abs() > 0.5));
    }
}
