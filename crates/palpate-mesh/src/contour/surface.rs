// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A closed surface of triangles whose edges can be split, flipped and collapsed.

use palpate_field::Point;

use crate::mesh::{MeshError, TriangleMesh};

/// Triangles, and those around each vertex. Each edge is between two faces that pass it in opposite directions, and the
/// operations keep that.
#[derive(Clone, Debug)]
pub(super) struct Surface {
    places: Vec<Point<3>>,
    /// The corners of each face, counter-clockwise seen from outside; `None` of a face that is gone.
    faces: Vec<Option<[u32; 3]>>,
    /// The faces around each vertex; none around one that is gone.
    fans: Vec<Vec<u32>>,
    /// Faces that are not gone.
    count: usize,
}

/// An edge, the faces beside it, and their third corners. The first face passes the ends in order.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge {
    pub(super) ends: [u32; 2],
    pub(super) faces: [u32; 2],
    pub(super) apexes: [u32; 2],
}

impl Surface {
    pub(super) fn of(mesh: &TriangleMesh) -> Self {
        let places = mesh.vertices().to_vec();
        let mut fans = vec![Vec::new(); places.len()];
        for (face, corners) in mesh.elements().iter().enumerate() {
            for corner in corners {
                fans[*corner as usize].push(face as u32);
            }
        }
        let faces: Vec<_> = mesh.elements().iter().copied().map(Some).collect();
        Self { places, count: faces.len(), faces, fans }
    }

    /// The mesh of the faces that are left.
    pub(super) fn mesh(&self) -> Result<TriangleMesh, MeshError> {
        let mut names = vec![u32::MAX; self.places.len()];
        let mut places = Vec::new();
        let mut name = |vertex: u32| {
            let name = &mut names[vertex as usize];
            if *name == u32::MAX {
                *name = places.len() as u32;
                places.push(self.places[vertex as usize]);
            }
            *name
        };
        let faces = self.faces.iter().flatten().map(|face| face.map(&mut name)).collect();
        TriangleMesh::new(places, faces)
    }

    /// How many faces there are.
    pub(super) const fn count(&self) -> usize {
        self.count
    }

    /// The numbers of faces that are in use.
    pub(super) fn faces(&self) -> impl Iterator<Item = u32> {
        let numbered = self.faces.iter().enumerate();
        numbered.filter(|(_, face)| face.is_some()).map(|(number, _)| number as u32)
    }

    /// The number of vertices, those that are gone included.
    pub(super) const fn vertices(&self) -> u32 {
        self.places.len() as u32
    }

    pub(super) fn place(&self, vertex: u32) -> Point<3> {
        self.places[vertex as usize]
    }

    pub(super) fn set_place(&mut self, vertex: u32, place: Point<3>) {
        self.places[vertex as usize] = place;
    }

    /// The corners of a face; `None` if it is gone.
    pub(super) fn corners(&self, face: u32) -> Option<[u32; 3]> {
        self.faces[face as usize]
    }

    /// Where the corners of a face are [m].
    pub(super) fn triangle(&self, face: u32) -> Option<[Point<3>; 3]> {
        self.corners(face).map(|corners| corners.map(|corner| self.place(corner)))
    }

    /// The faces around a vertex.
    pub(super) fn fan(&self, vertex: u32) -> &[u32] {
        &self.fans[vertex as usize]
    }

    /// The vertices that edges join to a vertex, in no order.
    pub(super) fn beside(&self, vertex: u32) -> Vec<u32> {
        // Each face around the vertex leaves it to another neighbour.
        let corners = self.fan(vertex).iter().filter_map(|face| self.corners(*face));
        corners.map(|corners| after(corners, vertex)).collect()
    }

    /// The edge between two vertices, if there is one.
    pub(super) fn edge(&self, [a, b]: [u32; 2]) -> Option<Edge> {
        let face_from = |from: u32, to: u32| {
            self.fan(from).iter().copied().find_map(|face| {
                let corners = self.corners(face)?;
                (after(corners, from) == to).then(|| (face, after(corners, to)))
            })
        };
        let ((first, c), (second, d)) = (face_from(a, b)?, face_from(b, a)?);
        Some(Edge { ends: [a, b], faces: [first, second], apexes: [c, d] })
    }

    /// Splits an edge at a place: each face beside it becomes two. The answer is the new vertex.
    pub(super) fn split(&mut self, edge: &Edge, place: Point<3>) -> u32 {
        let Edge { ends: [a, b], faces: [f, g], apexes: [c, d] } = *edge;
        let middle = self.vertices();
        self.places.push(place);
        let [h, k] = [0, 1].map(|i| self.faces.len() as u32 + i);
        self.faces.extend([Some([middle, b, c]), Some([middle, a, d])]);
        self.faces[f as usize] = Some([a, middle, c]);
        self.faces[g as usize] = Some([b, middle, d]);
        self.replace(a, g, k);
        self.replace(b, f, h);
        self.fans[c as usize].push(h);
        self.fans[d as usize].push(k);
        self.fans.push(vec![f, g, h, k]);
        self.count += 2;
        middle
    }

    /// Puts the other diagonal of the two faces in place of an edge, unless there is such an edge.
    pub(super) fn flip(&mut self, edge: &Edge) -> bool {
        let Edge { ends: [a, b], faces: [f, g], apexes: [c, d] } = *edge;
        if c == d || self.edge([c, d]).is_some() {
            return false;
        }
        self.faces[f as usize] = Some([a, d, c]);
        self.faces[g as usize] = Some([d, b, c]);
        self.forget(a, g);
        self.forget(b, f);
        self.fans[c as usize].push(g);
        self.fans[d as usize].push(f);
        true
    }

    /// Whether the first end of an edge can move into the second with the surface as closed as before: the edge's ends have
    /// no neighbours in common but its apexes, and these keep three faces.
    pub(super) fn can_collapse(&self, edge: &Edge) -> bool {
        let [u, v] = edge.ends;
        let others = self.beside(v);
        let common = self.beside(u).into_iter().filter(|vertex| others.contains(vertex));
        common.count() == 2 && edge.apexes.iter().all(|apex| self.fan(*apex).len() > 3)
    }

    /// Moves the first end of an edge into the second; its two faces are gone then.
    pub(super) fn collapse(&mut self, edge: &Edge) {
        let Edge { ends: [u, v], faces, apexes } = *edge;
        for (face, apex) in faces.into_iter().zip(apexes) {
            self.faces[face as usize] = None;
            self.forget(v, face);
            self.forget(apex, face);
        }
        for face in std::mem::take(&mut self.fans[u as usize]) {
            if let Some(corners) = &mut self.faces[face as usize] {
                *corners = corners.map(|corner| if corner == u { v } else { corner });
                self.fans[v as usize].push(face);
            }
        }
        self.count -= 2;
    }

    fn replace(&mut self, vertex: u32, old: u32, new: u32) {
        if let Some(face) = self.fans[vertex as usize].iter_mut().find(|face| **face == old) {
            *face = new;
        }
    }

    fn forget(&mut self, vertex: u32, old: u32) {
        self.fans[vertex as usize].retain(|face| *face != old);
    }
}

/// The corner of a face after one of its corners.
fn after(corners: [u32; 3], corner: u32) -> u32 {
    let at = corners.iter().position(|other| *other == corner).unwrap_or(0);
    corners[(at + 1) % 3]
}

#[cfg(test)]
mod tests {
    use palpate_field::Shape;

    use super::*;
    use crate::ContourOptions;

    /// Euler's number of a closed surface stays 2, and its volume what it was, under splits, flips of flat
    /// pairs and the collapse of what was split.
    #[test]
    fn a_changed_box_stays_closed() {
        let shape = Shape::cuboid([0.4, 0.3, 0.2]).unwrap();
        let mesh = TriangleMesh::of_shape(&shape, &ContourOptions::with_cell(0.11)).unwrap();
        let mut surface = Surface::of(&mesh);
        let check = |surface: &Surface| {
            let mesh = surface.mesh().unwrap();
            let report = mesh.report();
            assert!(report.is_watertight(), "{report}");
            assert!((report.enclosed.unwrap() - 0.024).abs() < 1e-12);
            assert_eq!(surface.count(), mesh.elements().len());
            // V − E + F with 3F = 2E.
            assert_eq!(mesh.vertices().len() * 2, surface.count() + 4);
        };
        check(&surface);
        let corners = surface.corners(0).unwrap();
        let edge = surface.edge([corners[0], corners[1]]).unwrap();
        let middle = (surface.place(corners[0]) + surface.place(corners[1])) * 0.5;
        let vertex = surface.split(&edge, middle);
        check(&surface);
        // The other diagonal of a face cut in two is the edge that was split.
        let cut = surface.edge([vertex, edge.apexes[0]]).unwrap();
        assert!(surface.flip(&cut));
        check(&surface);
        assert_eq!(surface.edge(edge.ends).unwrap().apexes.len(), 2);
        let mut surface = Surface::of(&mesh);
        let vertex = surface.split(&edge, middle);
        let into = surface.edge([vertex, edge.ends[1]]).unwrap();
        assert!(surface.can_collapse(&into));
        surface.collapse(&into);
        check(&surface);
        assert!(surface.fan(vertex).is_empty());
    }
}
