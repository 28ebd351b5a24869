// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Signed distances of a mesh, and the building of what finds them, beside parry's.

use std::error::Error;

use palpate::field::Shape;
use palpate::mesh::{Solid, TriangleMesh};
use parry3d_f64::math::Vector as ParryVector;
use parry3d_f64::query::PointQuery;
use parry3d_f64::shape::{TriMesh, TriMeshFlags};

use super::compare;
use super::places::places;
use crate::fields::Rows;
use crate::reference::Reference;
use crate::rounds::{self, Subject};

/// Points at which both are compared before anything is timed may differ by so much [m].
const SAME: f64 = 1e-12;

pub(super) fn measure(
    mesh: &TriangleMesh,
    reference: &Reference,
    rows: &mut Rows,
) -> Result<(), Box<dyn Error>> {
    let (solid, _) = Solid::from_mesh(mesh)?;
    let ours: Shape<3> = solid.into();
    let (corners, faces) = parts(mesh);
    let theirs = TriMesh::with_flags(corners.clone(), faces.clone(), TriMeshFlags::ORIENTED)?;
    let places = places(mesh);
    let mut subjects = Vec::new();
    for (name, points) in &places {
        let asked: Vec<_> = points.iter().map(|p| ParryVector::new(p[0], p[1], p[2])).collect();
        for (p, asked) in points.iter().zip(&asked) {
            let (our, their) =
                (ours.distance(*p), theirs.distance_to_local_point(*asked, false));
            if (our.abs() - their.abs()).abs() > SAME {
                return Err(
                    format!("parry's distance is {their} m, ours {our} m, at {p:?}").into()
                );
            }
        }
        let (ours, theirs) = (&ours, &theirs);
        subjects.push(Subject::new(format!("mesh.{name}.ours"), points.len(), || {
            points.iter().map(|p| ours.distance(*p)).sum()
        }));
        subjects.push(Subject::new(format!("mesh.{name}.parry"), points.len(), move || {
            asked.iter().map(|p| theirs.distance_to_local_point(*p, false)).sum()
        }));
    }
    // Ours has the nearest point's sign wherever parry's has, and looks for faces that cross.
    subjects.push(Subject::new("mesh.tree.ours", 1, || {
        let made = TriangleMesh::new(mesh.vertices().to_vec(), mesh.elements().to_vec());
        made.map_or(0.0, |made| made.bounds().max[0])
    }));
    subjects.push(Subject::new("mesh.solid.ours", 1, || {
        Solid::from_mesh(mesh).map_or(0.0, |(_, found)| found.faces as f64)
    }));
    for (name, flags) in [("tree", TriMeshFlags::empty()), ("solid", TriMeshFlags::ORIENTED)] {
        let (corners, faces) = (&corners, &faces);
        subjects.push(Subject::new(format!("mesh.{name}.parry"), 1, move || {
            let made = TriMesh::with_flags(corners.clone(), faces.clone(), flags);
            made.map_or(0.0, |made| made.indices().len() as f64)
        }));
    }
    for measured in rounds::measure(&mut subjects, reference) {
        measured.insert(rows);
    }
    for name in ["near", "box", "touching", "path", "tree", "solid"] {
        let [ours, parry] = ["ours", "parry"].map(|whose| format!("mesh.{name}.{whose}.ns"));
        compare(rows, [&ours, &parry], &format!("mesh.{name}.ours_over_parry"));
    }
    Ok(())
}

fn parts(mesh: &TriangleMesh) -> (Vec<ParryVector>, Vec<[u32; 3]>) {
    let corners = mesh.vertices().iter().map(|p| ParryVector::new(p[0], p[1], p[2])).collect();
    (corners, mesh.elements().to_vec())
}
