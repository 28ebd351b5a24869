// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Winding numbers: how often the elements of a mesh go around a point.
//!
//! The share of an element is the angle under which the point sees it, over a whole turn, exactly by
//! Van Oosterom and Strackee (1983) for triangles. Seen from afar, a group of elements has the share
//!
//! ```text
//! space: (S·R/|R|³ + tr M/|R|³ − 3 R·M·R/|R|⁵)/4π,  plane: (S·R/|R|² + tr M/|R|² − 2 R·M·R/|R|⁴)/2π
//! ```
//!
//! with `R` from the point to the group's centroid, `S = ∫ n dA` and `M = ∫ (x − c) ⊗ n dA`. The rest of the
//! series is bounded in closed form. At `x` the `k`th term of the kernel (`k = 1` gives `S`, `k = 2` gives `M`) is at most
//! `k·|x − c|ᵏ⁻¹/|R|ᵏ⁺¹` in space, by the inequality of Bernstein and Szegő for Legendre polynomials, and
//! `|x − c|ᵏ⁻¹/|R|ᵏ` in the plane. In each term from `k = 3` on, two factors `|x − c|` are integrated to
//! `Q = ∫ |x − c|² dA`, and the others are at most the radius of the group, `ρ|R|`:
//!
//! ```text
//! space: Q (3 − 2ρ)/(1 − ρ)²/(4π|R|⁴),  plane: Q/(1 − ρ)/(2π|R|³)
//! ```

use std::f64::consts::{PI, TAU};

use palpate_field::{Point, Vector, Wide, wide};

use super::field::across;
use crate::tree::{BallTree, FAN};

/// Error bounds of a group, tried in this order until the question is settled; with 0 every element is summed.
const ERRORS: [f64; 4] = [2e-2, 2e-3, 1e-4, 0.0];

/// The rounding of the share of a group, and of an element in units of how much its terms cancel.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// From within a ball of a radius nearer to the distance, rounding matters in what remains of the series.
const LARGEST_RHO: f64 = 0.99;

/// A group of elements as seen from afar.
#[derive(Clone, Copy, Debug)]
struct Moments<const D: usize> {
    centroid: Point<D>,
    /// From the centroid to the farthest corner [m].
    radius: f64,
    /// `∫ |x − c|² dA` [m⁴], in the plane [m³], rounded up.
    second: f64,
    /// How far rounding may turn `normals`, and `first` over the radius [m²], in the plane [m].
    rounding: f64,
    /// `∫ n dA`.
    normals: Vector<f64, D>,
    /// `∫ (x − c) ⊗ n dA`, by rows.
    first: [Vector<f64, D>; D],
}

/// The winding number of a point, and how far it may be from the true one.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Winding {
    pub(crate) number: f64,
    pub(crate) error: f64,
}

impl Winding {
    /// Whether the point is within; `None` if that is not certain.
    pub(crate) fn is_inside(self) -> Option<bool> {
        ((self.number - 0.5).abs() > self.error).then_some(self.number > 0.5)
    }
}

/// What winding numbers of a mesh are made of.
#[derive(Clone, Debug)]
pub(crate) struct WindingTree<const N: usize, const D: usize> {
    /// As [`Boxes`](super::faces::Boxes): of eight elements each, of eight of those, and so on.
    levels: Vec<Level<D>>,
}

/// The groups of a level, by eights.
#[derive(Clone, Debug)]
struct Level<const D: usize> {
    eights: Vec<Eight<D>>,
    /// How many groups there are.
    count: usize,
}

impl<const N: usize, const D: usize> WindingTree<N, D> {
    /// Of elements in the order of the tree.
    pub(crate) fn new(elements: &[[Point<D>; N]]) -> Self {
        let mut levels = Vec::new();
        let mut size = FAN;
        loop {
            let groups: Vec<_> = elements.chunks(size).map(Moments::of).collect();
            let count = groups.len();
            levels.push(Level { eights: groups.chunks(FAN).map(Eight::of).collect(), count });
            if count <= FAN {
                return Self { levels };
            }
            size *= FAN;
        }
    }

    /// Whether a point is within the solid of winding numbers above one half.
    pub(crate) fn is_inside(&self, elements: &[[Point<D>; N]], p: Point<D>) -> bool {
        self.settled(elements, p, |w| w.is_inside().is_some()).number > 0.5
    }

    /// The winding number of a point, as exact as it takes to settle a question, or as it can be.
    pub(crate) fn settled(
        &self,
        elements: &[[Point<D>; N]],
        p: Point<D>,
        is_settled: impl Fn(Winding) -> bool,
    ) -> Winding {
        let mut last = Winding::default();
        for error in ERRORS {
            last = self.at(elements, p, error);
            if is_settled(last) {
                break;
            }
        }
        last
    }

    /// The winding number of a point, with an error of at most `error` from each group of elements.
    pub(crate) fn at(&self, elements: &[[Point<D>; N]], p: Point<D>, error: f64) -> Winding {
        wide(Sum { levels: &self.levels, elements, p, error })
    }
}

/// Elements with their tree.
#[derive(Debug)]
pub(crate) struct Groups<const N: usize, const D: usize> {
    elements: Vec<[Point<D>; N]>,
    tree: WindingTree<N, D>,
}

impl<const N: usize, const D: usize> Groups<N, D> {
    /// Of elements in any order.
    pub(crate) fn new(elements: &[[Point<D>; N]]) -> Self {
        let vertices: Vec<_> = elements.iter().flatten().copied().collect();
        let named: Vec<[u32; N]> =
            (0..elements.len()).map(|i| std::array::from_fn(|k| (N * i + k) as u32)).collect();
        let order = BallTree::new(&vertices, &named);
        let elements: Vec<_> = order.order().iter().map(|i| elements[*i as usize]).collect();
        let tree = WindingTree::new(&elements);
        Self { elements, tree }
    }

    /// Whether the winding number about a point is above one half or below minus one half.
    pub(crate) fn goes_around(&self, p: Point<D>) -> bool {
        let is_settled = |w: Winding| (w.number.abs() - 0.5).abs() > w.error;
        self.tree.settled(&self.elements, p, is_settled).number.abs() > 0.5
    }
}

/// A sum over the groups of a tree, as seen from a point: of each group as a whole, if that is exact enough, else of its
/// parts.
struct Sum<'a, const N: usize, const D: usize> {
    levels: &'a [Level<D>],
    elements: &'a [[Point<D>; N]],
    p: Point<D>,
    error: f64,
}

impl<const N: usize, const D: usize> Wide for Sum<'_, N, D> {
    type Out = Winding;

    #[inline(always)]
    fn run(self) -> Winding {
        let Self { levels, elements, p, error } = self;
        let mut sum = Winding::default();
        // Eights that are to be looked at, with their levels.
        let mut waiting = [(0, 0); MOST_WAITING];
        let mut count = 1;
        waiting[0] = (levels.len() - 1, 0);
        while count > 0 {
            count -= 1;
            let (level, eight) = waiting[count];
            let Seen { shares, remainders } = levels[level].eights[eight].from(p);
            let first = eight * FAN;
            for lane in 0..FAN.min(levels[level].count - first) {
                if remainders[lane] <= error {
                    sum.number += shares[lane];
                    sum.error += remainders[lane] + ROUNDING;
                } else if level == 0 {
                    let from = (first + lane) * FAN;
                    let Winding { number, error } =
                        of_elements(&elements[from..elements.len().min(from + FAN)], p);
                    sum.number += number;
                    sum.error += error;
                } else {
                    waiting[count] = (level - 1, first + lane);
                    count += 1;
                }
            }
        }
        sum
    }
}

/// Stack depth: 11 levels, enough for 2^32 elements, with 7 siblings each, plus 1.
const MOST_WAITING: usize = 7 * 11 + 1;

/// The winding number of at most eight elements: the unit complex numbers of their angles are multiplied, and whole
/// turns of the product counted, so that one angle is taken.
#[inline(always)]
fn of_elements<const N: usize, const D: usize>(
    elements: &[[Point<D>; N]],
    p: Point<D>,
) -> Winding {
    let mut turned = [[1.0; FAN], [0.0; FAN], [0.0; FAN]];
    for (lane, corners) in elements.iter().enumerate() {
        let [cosine, sine, size] = angle(corners, p);
        let left = (cosine * cosine + sine * sine).sqrt();
        if left > ROUNDING * size {
            turned[0][lane] = cosine / left;
            turned[1][lane] = sine / left;
            turned[2][lane] = ROUNDING * size / left;
        } else {
            // On an edge the angle may be any.
            turned[2][lane] = 1.0;
        }
    }
    let [cosines, sines, errors] = turned;
    let (mut turns, mut error) = (0.0, 0.0);
    let [mut x, mut y] = [1.0, 0.0];
    for lane in 0..FAN {
        let (cosine, sine) = (cosines[lane], sines[lane]);
        let are_up = [y, sine].map(f64::is_sign_positive);
        [x, y] = [x * cosine - y * sine, x * sine + y * cosine];
        // Two angles of the same half turn may go beyond its end.
        if are_up[0] == are_up[1] && y.is_sign_positive() != are_up[0] {
            turns += if are_up[0] { 1.0 } else { -1.0 };
        }
        error += errors[lane];
    }
    Winding { number: turns + y.atan2(x) / TAU, error }
}

/// Eight numbers of groups.
type Lanes = [f64; FAN];

/// The moments of eight groups side by side; those that are missing are empty.
#[derive(Clone, Debug)]
struct Eight<const D: usize> {
    centroid: [Lanes; D],
    radius: Lanes,
    second: Lanes,
    rounding: Lanes,
    normals: [Lanes; D],
    first: [[Lanes; D]; D],
}

/// What eight groups are as seen from a point.
struct Seen {
    shares: Lanes,
    /// Bounds of the errors of the shares; infinite in a group's own ball.
    remainders: Lanes,
}

impl<const D: usize> Eight<D> {
    fn of(groups: &[Moments<D>]) -> Self {
        let lanes = |number: &dyn Fn(&Moments<D>) -> f64| -> Lanes {
            std::array::from_fn(|lane| groups.get(lane).map_or(0.0, number))
        };
        Self {
            centroid: std::array::from_fn(|i| lanes(&|group| group.centroid[i])),
            radius: lanes(&|group| group.radius),
            second: lanes(&|group| group.second),
            rounding: lanes(&|group| group.rounding),
            normals: std::array::from_fn(|i| lanes(&|group| group.normals[i])),
            first: std::array::from_fn(|k| {
                std::array::from_fn(|i| lanes(&|group| group.first[k][i]))
            }),
        }
    }

    /// The shares of the groups by the first two terms, and bounds of the rest.
    #[inline(always)]
    fn from(&self, p: Point<D>) -> Seen {
        let mut seen = Seen { shares: [0.0; FAN], remainders: [0.0; FAN] };
        // A loop without branches over numbers side by side: LLVM treats several lanes at once.
        for lane in 0..FAN {
            let mut towards = [0.0; D];
            let mut squared = 0.0;
            for (i, towards) in towards.iter_mut().enumerate() {
                *towards = self.centroid[i][lane] - p[i];
                squared += *towards * *towards;
            }
            let (mut flux, mut along) = (0.0, 0.0);
            for k in 0..D {
                flux += self.normals[k][lane] * towards[k] + self.first[k][k][lane];
                let mut row = 0.0;
                for (i, towards) in towards.iter().enumerate() {
                    row += self.first[k][i][lane] * towards;
                }
                along += towards[k] * row;
            }
            let distance = squared.sqrt();
            let rho = self.radius[lane] / distance;
            let left = 1.0 - rho;
            let (second, rounding) = (self.second[lane], self.rounding[lane]);
            let (share, remainder) = if D == 3 {
                let sphere = 4.0 * PI * squared;
                (
                    (flux - 3.0 * along / squared) / (sphere * distance),
                    (second / squared * (3.0 - 2.0 * rho) / (left * left) + rounding) / sphere,
                )
            } else {
                (
                    (flux - 2.0 * along / squared) / (TAU * squared),
                    (second / squared / left + rounding) / (TAU * distance),
                )
            };
            // Written so that NaN, at the centroid of a point, is not accepted.
            let is_outside = rho < LARGEST_RHO;
            seen.shares[lane] = share;
            seen.remainders[lane] = if is_outside { remainder } else { f64::INFINITY };
        }
        seen
    }
}

impl<const D: usize> Moments<D> {
    fn of<const N: usize>(group: &[[Point<D>; N]]) -> Self {
        let halved = if N == 3 { 0.5 } else { 1.0 };
        let part = |corners: &[Point<D>; N]| {
            let mut middle = Vector::ZERO;
            for corner in corners {
                middle += *corner * (1.0 / N as f64);
            }
            let normal = across(corners) * halved;
            (middle, normal, normal.norm())
        };
        let (mut area, mut weighted, mut plain) = (0.0, Vector::ZERO, Vector::ZERO);
        for corners in group {
            let (middle, _, size) = part(corners);
            area += size;
            weighted += middle * size;
            plain += middle * (1.0 / group.len() as f64);
        }
        let centroid = if area > 0.0 { weighted * (1.0 / area) } else { plain };
        let (mut normals, mut first, mut second) = (Vector::ZERO, [Vector::ZERO; D], 0.0);
        for corners in group {
            let (middle, normal, size) = part(corners);
            normals += normal;
            second += size * mean_square(corners, centroid);
            for (k, row) in first.iter_mut().enumerate() {
                *row += normal * (middle - centroid)[k];
            }
        }
        let far = group.iter().flatten().map(|corner| (*corner - centroid).norm());
        let radius = far.fold(0.0, f64::max) * (1.0 + 8.0 * f64::EPSILON);
        // Sums of so many terms, of middles that are rounded as coordinates are.
        let terms = (group.len() + 64) as f64 * f64::EPSILON;
        let coordinates = centroid.norm() + radius;
        let rounding =
            if radius > 0.0 { 4.0 * terms * area * (coordinates / radius) } else { 0.0 };
        let second = (second * (1.0 + terms)) + rounding * radius * radius;
        Self { centroid, radius, second, rounding, normals, first }
    }
}

/// The mean over an element of the square of the distance to a point [m²]: of the corners and of their sum.
fn mean_square<const N: usize, const D: usize>(corners: &[Point<D>; N], p: Point<D>) -> f64 {
    let (mut sum, mut squares) = (Vector::ZERO, 0.0);
    for corner in corners {
        let away = *corner - p;
        sum += away;
        squares += away.dot(away);
    }
    (squares + sum.dot(sum)) / (N * (N + 1)) as f64
}

/// The share of one element: the angle under which a point sees it, in turns. Half a turn on the element
/// itself, at most.
pub(crate) fn share<const N: usize, const D: usize>(
    corners: &[Point<D>; N],
    p: Point<D>,
) -> f64 {
    let [cosine, sine, _] = angle(corners, p);
    sine.atan2(cosine) / TAU
}

/// The angle under which a point sees an element, half of the solid angle in space, as its cosine and sine times a
/// length, and the size of the terms that these are sums of: beside an edge they cancel. No angle if the element is not
/// one less in dimension than space.
#[inline(always)]
fn angle<const N: usize, const D: usize>(corners: &[Point<D>; N], p: Point<D>) -> [f64; 3] {
    let a = corners[0] - p;
    let b = corners[1] - p;
    match (N, D) {
        (2, 2) => {
            let size = (a.dot(a) * b.dot(b)).sqrt();
            [a.dot(b), a[0] * b[1] - a[1] * b[0], size]
        }
        (3, 3) => {
            let c = corners[2] - p;
            let (la, lb, lc) = (a.norm(), b.norm(), c.norm());
            let size = la * lb * lc;
            let volume = a.in_space().dot(b.in_space().cross(c.in_space()));
            [size + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb, volume, size]
        }
        _ => [1.0, 0.0, 1.0],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ball of radius 1 of random triangles that lie on it, of which no number is a whole one.
    fn scales() -> Vec<[Point<3>; 3]> {
        let turn = |i: u32, step: f64| (f64::from(i) * step).fract() * TAU;
        (1..=600)
            .map(|i| {
                let (a, b) = (turn(i, 0.754_877_666), 0.5 * turn(i, 0.569_840_291));
                let out = Vector([a.cos() * b.sin(), b.cos(), a.sin() * b.sin()]);
                let aside = Vector([-a.sin(), 0.0, a.cos()]);
                let along = out.cross(aside);
                [out, out + aside * 0.1, out + along * 0.1]
            })
            .collect()
    }

    #[test]
    fn the_error_of_groups_is_within_its_bound() {
        let elements = scales();
        let tree = WindingTree::new(&elements);
        for i in 1..200_u32 {
            let far = 0.02 * f64::from(i);
            let p = Vector([far, 0.3 * far, -0.7 * far]);
            let exact: f64 = elements.iter().map(|corners| share(corners, p)).sum();
            for error in ERRORS {
                let Winding { number, error: bound } = tree.at(&elements, p, error);
                assert!((number - exact).abs() <= bound, "{p:?}: {number}, {exact} ± {bound}");
            }
        }
        let outline: Vec<[Point<2>; 2]> = (0..300)
            .map(|i| [i, i + 1].map(|i| TAU * f64::from(i) / 320.0))
            .map(|ends| ends.map(|angle| Vector([angle.cos(), angle.sin()])))
            .collect();
        let tree = WindingTree::new(&outline);
        for i in 1..200_u32 {
            let p = Vector([0.02 * f64::from(i), 0.01 * f64::from(i)]);
            let exact: f64 = outline.iter().map(|corners| share(corners, p)).sum();
            let Winding { number, error: bound } = tree.at(&outline, p, 1e-2);
            assert!((number - exact).abs() <= bound, "{p:?}: {number}, {exact} ± {bound}");
        }
    }

    /// The rounding was taken for that of a face seen from afar, which is less than what is lost beside an edge.
    #[test]
    fn the_rounding_of_a_share_grows_towards_an_edge() {
        let corners = [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [1.0, 2.0, 0.0]].map(Vector);
        for i in 0..40 {
            let off = 0.5_f64.powi(i);
            // Beside the middle of an edge, a face is seen as a half plane that goes up at 135°, but for what is beyond
            // its corners, which is a few times the distance: under 3/4 of half of all directions.
            let Winding { number, error } = of_elements(&[corners], Vector([1.5, off, off]));
            assert!(
                (number.abs() - 0.375).abs() < error + 2.0 * off,
                "{off}: {number} {error}"
            );
            assert!(error < 1e3 * ROUNDING / off, "{off}: {error}");
        }
        assert_eq!(of_elements(&[corners], Vector([1.5, 0.0, 0.0])).error, 1.0);
    }

    /// Angles in any order and of any sign, with sums of several turns.
    #[test]
    fn whole_turns_of_a_product_of_angles_are_counted() {
        let ends = |turns: f64| Vector([(TAU * turns).cos(), (TAU * turns).sin()]);
        for step in [0.07, 0.3, 0.4999, -0.2, -0.45] {
            let around: Vec<[Point<2>; 2]> = (0..8)
                .map(|i| [ends(step * f64::from(i)), ends(step * f64::from(i + 1))])
                .collect();
            let Winding { number, error } = of_elements(&around, Vector::ZERO);
            assert!((number - 8.0 * step).abs() < error, "{step}: {number}");
        }
        let half = [ends(0.0), ends(0.5)].map(|end| Vector([end[0].round(), 0.0]));
        assert_eq!(of_elements(&[half, half, half, half], Vector::ZERO).number, 2.0);
    }

    #[test]
    fn an_octant_is_an_eighth_of_a_turn() {
        let corners = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Vector);
        assert!((share(&corners, Vector::ZERO) - 0.125).abs() < 1e-15);
        let quarter = [[1.0, 0.0], [0.0, 1.0]].map(Vector);
        assert!((share(&quarter, Vector::ZERO) - 0.25).abs() < 1e-15);
    }
}
