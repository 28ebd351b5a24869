// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Triangles as plain data: made, damaged, and measured face by face.

use std::f64::consts::{PI, TAU};

use palpate_field::{Point, Rotation, Vector};

/// Triangles between vertices, of which nothing is asked.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Soup {
    /// The vertices \[m\].
    pub vertices: Vec<Point<3>>,
    /// The corners of each triangle, as indices.
    pub faces: Vec<[u32; 3]>,
}

impl Soup {
    /// A box about a point with these edges \[m\], its faces counter-clockwise seen from outside.
    #[must_use]
    pub fn cuboid(centre: [f64; 3], size: [f64; 3]) -> Self {
        let corner = |i: u32| {
            Vector(std::array::from_fn(|k| {
                centre[k] + size[k] * (f64::from((i >> k) & 1) - 0.5)
            }))
        };
        let quads = [
            [0, 4, 6, 2],
            [1, 3, 7, 5],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 2, 3, 1],
            [4, 5, 7, 6],
        ];
        let faces = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        Self { vertices: (0..8).map(corner).collect(), faces }
    }

    /// A ball about a point, of `rings` rings of triangles between its poles.
    #[must_use]
    pub fn ball(centre: [f64; 3], radius: f64, rings: u32) -> Self {
        let sectors = 2 * rings;
        let around = |ring: u32, sector: u32| {
            if ring == 0 {
                0
            } else if ring == rings {
                1
            } else {
                2 + (ring - 1) * sectors + sector % sectors
            }
        };
        let mut soup = Self::default();
        soup.vertices
            .extend([1.0, -1.0].map(|y| Vector(centre) + Vector([0.0, y * radius, 0.0])));
        for ring in 1..rings {
            for sector in 0..sectors {
                let (up, along) = (
                    PI * f64::from(ring) / f64::from(rings),
                    TAU * f64::from(sector) / f64::from(sectors),
                );
                let out = [up.sin() * along.cos(), up.cos(), up.sin() * along.sin()];
                soup.vertices.push(Vector(centre) + Vector(out) * radius);
            }
        }
        for ring in 0..rings {
            for sector in 0..sectors {
                let [a, b, c, d] = [
                    (ring, sector),
                    (ring, sector + 1),
                    (ring + 1, sector),
                    (ring + 1, sector + 1),
                ]
                .map(|(ring, sector)| around(ring, sector));
                if ring > 0 {
                    soup.faces.push([a, b, c]);
                }
                if ring + 1 < rings {
                    soup.faces.push([b, d, c]);
                }
            }
        }
        soup
    }

    /// A box about the origin with these edges \[m\], each side of which is `2·steps²` triangles. No vertex is shared
    /// between sides.
    #[must_use]
    pub fn fine_cuboid(size: [f64; 3], steps: u32) -> Self {
        let at = |i: u32| f64::from(i) / f64::from(steps) - 0.5;
        let mut soup = Self::default();
        for (axis, side) in [0, 1, 2].into_iter().flat_map(|axis| [(axis, -0.5), (axis, 0.5)]) {
            let first = soup.vertices.len() as u32;
            let name = |i: u32, k: u32| first + i * (steps + 1) + k;
            for (i, k) in (0..=steps).flat_map(|i| (0..=steps).map(move |k| (i, k))) {
                let mut p = Vector::ZERO;
                for (step, share) in [side, at(i), at(k)].into_iter().enumerate() {
                    let coordinate = (axis + step) % 3;
                    p[coordinate] = share * size[coordinate];
                }
                soup.vertices.push(p);
            }
            for (i, k) in (0..steps).flat_map(|i| (0..steps).map(move |k| (i, k))) {
                let [a, b, c, d] =
                    [name(i, k), name(i + 1, k), name(i + 1, k + 1), name(i, k + 1)];
                let [b, d] = if side > 0.0 { [b, d] } else { [d, b] };
                soup.faces.extend([[a, b, c], [a, c, d]]);
            }
        }
        soup
    }

    /// A prism over y from 0 to `height` \[m\], whose base is a regular polygon of so many corners, the first at x =
    /// `radius`.
    #[must_use]
    pub fn prism(corners: u32, radius: f64, height: f64) -> Self {
        let vertices = [0.0, height].map(|y| circle(corners, radius, y));
        let mut soup =
            Self { vertices: vertices.into_iter().flatten().collect(), faces: Vec::new() };
        for a in 0..corners {
            let b = (a + 1) % corners;
            let [c, d] = [a, b].map(|i| corners + i);
            soup.faces.extend([[a, c, d], [a, d, b]]);
            if a > 0 && b > 0 {
                soup.faces.extend([[0, a, b], [corners, d, c]]);
            }
        }
        soup
    }

    /// A prism with a hole: between regular polygons of so many corners, the first at x = `outer` and x = `inner`
    /// \[m\].
    #[must_use]
    pub fn pierced_prism(corners: u32, [outer, inner]: [f64; 2], height: f64) -> Self {
        let rims = [(outer, 0.0), (outer, height), (inner, 0.0), (inner, height)];
        let vertices = rims.map(|(radius, y)| circle(corners, radius, y));
        let mut soup =
            Self { vertices: vertices.into_iter().flatten().collect(), faces: Vec::new() };
        for i in 0..corners {
            let next = (i + 1) % corners;
            let [a, c, e, g] = [0, 1, 2, 3].map(|rim| rim * corners + i);
            let [b, d, f, h] = [0, 1, 2, 3].map(|rim| rim * corners + next);
            soup.faces.extend([[a, c, d], [a, d, b], [e, h, g], [e, f, h]]);
            soup.faces.extend([[c, g, h], [c, h, d], [a, f, e], [a, b, f]]);
        }
        soup
    }

    /// A tube of radius 1 about the axis y, open at y = ±1, whose rims have `sectors` corners each.
    #[must_use]
    pub fn tube(sectors: u32) -> Self {
        let mut tube = Self::default();
        for i in 0..sectors {
            let angle = TAU * f64::from(i) / f64::from(sectors);
            tube.vertices.extend([-1.0, 1.0].map(|y| Vector([angle.cos(), y, angle.sin()])));
            let [a, b] = [2 * i, 2 * i + 1];
            let [c, d] = [2 * ((i + 1) % sectors), 2 * ((i + 1) % sectors) + 1];
            tube.faces.extend([[a, b, c], [b, d, c]]);
        }
        tube
    }

    /// A cone of radius 1 and height 1 with its tip at (0, 1, 0), at which `sectors` faces meet; open below.
    #[must_use]
    pub fn fan(sectors: u32) -> Self {
        let mut fan = Self::default();
        fan.vertices.push(Vector([0.0, 1.0, 0.0]));
        for i in 0..sectors {
            let angle = TAU * f64::from(i) / f64::from(sectors);
            fan.vertices.push(Vector([angle.cos(), 0.0, angle.sin()]));
            fan.faces.push([0, 1 + (i + 1) % sectors, 1 + i]);
        }
        fan
    }

    /// A row of cubes with edges of 1 m along x, 0.9 m apart and each a little aside of the last.
    #[must_use]
    pub fn row(count: u32) -> Self {
        let mut row = Self::default();
        for i in 0..count {
            let aside = [0.013, -0.017, 0.011].map(|step| step * f64::from(i % 7));
            let centre = [0.9 * f64::from(i) + aside[0], aside[1], aside[2]];
            row = row.and(Self::cuboid(centre, [1.0; 3]));
        }
        row
    }

    /// A Klein bottle of `rings` rings with `sectors` corners each; it goes through itself.
    #[must_use]
    pub fn klein(rings: u32, sectors: u32) -> Self {
        let mut soup = Self::default();
        for ring in 0..rings {
            for sector in 0..sectors {
                let u = TAU * f64::from(ring) / f64::from(rings);
                let v = TAU * f64::from(sector) / f64::from(sectors);
                // A figure of eight that makes half a turn on its way around.
                let (c, s) = ((0.5 * u).cos(), (0.5 * u).sin());
                let out = 2.0 + c * v.sin() - s * (2.0 * v).sin();
                let up = s * v.sin() + c * (2.0 * v).sin();
                soup.vertices.push(Vector([out * u.cos(), up, out * u.sin()]));
            }
        }
        let at = |ring: u32, sector: u32| {
            // Past the last ring the figure is turned by half a turn: v becomes −v.
            let sector = sector % sectors;
            if ring == rings { (sectors - sector) % sectors } else { ring * sectors + sector }
        };
        for ring in 0..rings {
            for sector in 0..sectors {
                let [a, b] = [at(ring, sector), at(ring, sector + 1)];
                let [c, d] = [at(ring + 1, sector), at(ring + 1, sector + 1)];
                soup.faces.extend([[a, b, c], [b, d, c]]);
            }
        }
        soup
    }

    /// These and those of another, whose vertices stay apart.
    #[must_use]
    pub fn and(mut self, other: Self) -> Self {
        let offset = self.vertices.len() as u32;
        self.vertices.extend(other.vertices);
        self.faces.extend(other.faces.iter().map(|face| face.map(|index| index + offset)));
        self
    }

    /// With all faces turned.
    #[must_use]
    pub fn inside_out(self) -> Self {
        self.flipped(|_| true)
    }

    /// With those faces turned whose numbers are chosen.
    #[must_use]
    pub fn flipped(mut self, is_chosen: impl Fn(usize) -> bool) -> Self {
        for (i, face) in self.faces.iter_mut().enumerate() {
            if is_chosen(i) {
                face.swap(0, 1);
            }
        }
        self
    }

    /// Without those faces whose numbers are chosen.
    #[must_use]
    pub fn without(mut self, is_chosen: impl Fn(usize) -> bool) -> Self {
        let mut number = 0..;
        self.faces.retain(|_| number.next().is_none_or(|i| !is_chosen(i)));
        self
    }

    /// With copies of those faces whose numbers are chosen, turned.
    #[must_use]
    pub fn doubled_opposite(mut self, is_chosen: impl Fn(usize) -> bool) -> Self {
        for i in (0..self.faces.len()).filter(|i| is_chosen(*i)) {
            let [a, b, c] = self.faces[i];
            self.faces.push([b, a, c]);
        }
        self
    }

    /// With corners of its own for each face.
    #[must_use]
    pub fn unwelded(&self) -> Self {
        let corners = self.faces.iter().flatten();
        Self {
            vertices: corners.map(|index| self.vertices[*index as usize]).collect(),
            faces: (0..self.faces.len() as u32)
                .map(|i| [3 * i, 3 * i + 1, 3 * i + 2])
                .collect(),
        }
    }

    /// With each vertex moved by up to `most` \[m\] along each axis.
    #[must_use]
    pub fn jittered(self, most: f64) -> Self {
        let mut shifts = points(self.vertices.len() as u32, most);
        self.mapped(|p| p + shifts.next().unwrap_or(Vector::ZERO))
    }

    /// Turned about the origin.
    #[must_use]
    pub fn turned(self, rotation: &Rotation<3>) -> Self {
        self.mapped(|p| rotation.rotate(p))
    }

    /// As large, `factor` times.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        self.mapped(|p| p * factor)
    }

    fn mapped(mut self, mut to: impl FnMut(Point<3>) -> Point<3>) -> Self {
        self.vertices.iter_mut().for_each(|p| *p = to(*p));
        self
    }

    /// The corners of each face \[m\].
    pub fn corners(&self) -> impl Iterator<Item = [Point<3>; 3]> {
        self.faces.iter().map(|face| face.map(|index| self.vertices[index as usize]))
    }

    /// The largest coordinate \[m\].
    #[must_use]
    pub fn reach(&self) -> f64 {
        self.vertices.iter().flat_map(|p| p.0).fold(0.0, |most, x| x.abs().max(most))
    }

    /// The winding number about a point: the sum of the angles under which it sees the faces, over a whole turn
    /// (Van Oosterom and Strackee 1983). Each angle is rounded by a few units of the last place of 1.
    #[must_use]
    pub fn winding(&self, p: Point<3>) -> f64 {
        let angle = |corners: [Point<3>; 3]| {
            let [a, b, c] = corners.map(|corner| corner - p);
            let (la, lb, lc) = (a.norm(), b.norm(), c.norm());
            let below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
            a.dot(b.cross(c)).atan2(below) / TAU
        };
        self.corners().map(angle).sum()
    }

    /// The distance from a point to the nearest face \[m\], by the regions of each (Ericson 2005, section 5.1.5).
    #[must_use]
    pub fn distance(&self, p: Point<3>) -> f64 {
        self.corners()
            .map(|corners| (nearest(corners, p) - p).norm())
            .fold(f64::INFINITY, f64::min)
    }
}

/// The point of a triangle nearest to another.
fn nearest([a, b, c]: [Point<3>; 3], p: Point<3>) -> Point<3> {
    let on = |from: Point<3>, to: Point<3>| {
        let along = to - from;
        let squared = along.dot(along);
        let share = if squared > 0.0 { (p - from).dot(along) / squared } else { 0.0 };
        from + along * share.clamp(0.0, 1.0)
    };
    let normal = (b - a).cross(c - a);
    // Beside no edge the foot is on the face; slivers have their edges alone.
    let is_over = |from: Point<3>, to: Point<3>| (to - from).cross(p - from).dot(normal) >= 0.0;
    let longest =
        [b - a, c - b, a - c].map(|edge| edge.dot(edge)).into_iter().fold(0.0, f64::max);
    let height = normal.norm() / longest.sqrt();
    if height > 1e-9 * longest.sqrt() && is_over(a, b) && is_over(b, c) && is_over(c, a) {
        let unit = normal * (1.0 / normal.norm());
        return p - unit * (p - a).dot(unit);
    }
    let feet = [on(a, b), on(b, c), on(c, a)];
    feet.into_iter().fold(feet[0], |best, foot| {
        if (foot - p).norm() < (best - p).norm() { foot } else { best }
    })
}

/// The corners of a regular polygon at a height y, the first at x = `radius` \[m\].
fn circle(corners: u32, radius: f64, y: f64) -> impl Iterator<Item = Point<3>> {
    (0..corners).map(move |i| {
        let angle = TAU * f64::from(i) / f64::from(corners);
        Vector([radius * angle.cos(), y, radius * angle.sin()])
    })
}

/// Points in a cube about the origin with half edges of `reach` \[m\], from a sequence without period: the same
/// at each call.
pub fn points(count: u32, reach: f64) -> impl Iterator<Item = Point<3>> {
    (1..=count).map(move |i| {
        let share = |step: f64| 2.0 * (f64::from(i) * step).fract() - 1.0;
        Vector([share(0.819_172_513_4), share(0.671_043_606_7), share(0.549_700_477_9)]) * reach
    })
}
