//! s
use palpate_field::{Shape, kernel::*};
use palpate_haptics::*;
fn main() {
    let s = Shape::<3>::from_kernel(Ball::new(0.05).unwrap());
    let p = Tour::new(s.promise().bounds.unwrap().aabb, 20.0).unwrap().over(&s).unwrap();
    let i = p.times().partition_point(|t| *t < 1.7784);
    for k in i - 6..i + 6 { println!("{:.6} {:?} {:.6} {:.6}", p.times()[k], p.positions()[k], (p.positions()[k+1]-p.positions()[k]).norm(), p.times()[k+1]-p.times()[k]); }
}
