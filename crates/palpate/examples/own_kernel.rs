// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! A kernel of one's own: one formula, from which distances, gradients, blocks and
//! bounds over cells follow.

use palpate::field::scalar::{Model, Scalar};
use palpate::field::{BLOCK, Block, Bounds, Column, Kernel, Promise, Shape, Vector};

/// A lens: the points within `radius` of both (±`offset`, 0, 0).
#[derive(Clone, Debug)]
struct Lens {
    radius: f64,
    offset: f64,
}

impl Kernel<3> for Lens {
    #[inline(always)]
    fn distance<S: Scalar>(&self, p: Vector<S, 3>) -> S {
        // The farther of the two balls is the one on the other side.
        let x = p.0[0].abs() + S::constant(self.offset);
        S::norm([x, p.0[1], p.0[2]]) - S::constant(self.radius)
    }

    fn promise(&self) -> Promise<3> {
        // An intersection: exact inside, a bound outside.
        let rim = (self.radius * self.radius - self.offset * self.offset).sqrt();
        let half = Vector([self.radius - self.offset, rim, rim]);
        let exact = Promise::exact_convex(Some(Bounds::centred(half, rim)), 5.0, self.radius);
        Promise { inside: exact.inside, above_bounds: false, ..exact.bound() }.symmetric()
    }
}

fn main() {
    let lens = Shape::from_kernel(Lens { radius: 0.05, offset: 0.03 });
    let (distance, gradient) = lens.distance_gradient(Vector([0.04, 0.0, 0.0]));
    println!("in front: {distance:.4} m, gradient {:?}", gradient.0);

    // Bounds over the cell [0.01, 0.03]³, which hold for all of its points.
    let mut cells = Block::<Model, 3, BLOCK>::zero();
    let mut models = Column::zero();
    cells.set(0, Vector(Model::cell([0.02; 3], [0.01; 3])));
    lens.block_distances(&cells, 1, &mut models);
    let model = models.get(0);
    println!("over the cell: between {:.4} m and {:.4} m", model.minimum(), model.maximum());
}
