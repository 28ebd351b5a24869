use palpate_field::kernel::*; use palpate_field::operator::Smooth; use palpate_field::{Shape, Vector, Rotation};
use palpate_haptics::*;
type R<T>=Result<T,Box<dyn std::error::Error>>;
fn star()->R<Shape<2>>{ let s=Shape::from_kernel(RegularStar::new(12,0.3,0.21213203435596423)?).translated(Vector([1.0,0.53]))?;
 Ok(Shape::smooth_union([s,Shape::from_kernel(Ball::new(0.2)?).translated(Vector([0.75,0.68]))?],Smooth::Quadratic,0.00025)?)}
fn cup()->R<Shape<3>>{ let a=Shape::from_kernel(RoundedCylinder::new(0.04,0.09,0.004)?); let b=Shape::from_kernel(Cylinder::new(0.034,0.09)?).translated(Vector([0.0,0.01,0.0]))?;
 Ok(a.difference([b])?.translated(Vector([0.0,0.045,0.0]))?)}
fn gallery()->R<Shape<3>>{
 let cu=|s:f64|Cuboid::new(Vector([s;3])).map(Shape::<3>::from_kernel); let cone=|r,h|Cone::new(r,h).map(Shape::from_kernel);
 let ry=|a:f64|Rotation::from_axis_angle(Vector([0.0,1.0,0.0]),a.to_radians()); let _=&ry;
 let b=vec![(Shape::from_kernel(Ball::new(0.035)?),-0.2975,0.035),(cu(0.06)?.rotated(ry(30.0)?)?,-0.2125,0.03),
 (Shape::from_kernel(Cylinder::new(0.025,0.08)?).rotated(Rotation::from_axis_angle(Vector([0.0,0.0,1.0]),(-20f64).to_radians())?)?,-0.1275,0.046138),
 (cone(0.035,0.08)?,-0.0425,0.04),(Shape::from_kernel(Pyramid::new(0.06,0.07)?).rotated(ry(20.0)?)?,0.0425,0.035),
 (Shape::union([cone(0.035,0.09)?,cu(0.05)?])?,0.1275,0.045),(Shape::intersection([cone(0.035,0.09)?,cu(0.05)?])?,0.2125,0.025),(cu(0.05)?.difference([cone(0.035,0.09)?])?,0.2975,0.025)];
 let v:Result<Vec<_>,_>=b.into_iter().map(|(s,x,y)|s.translated(Vector([x,y,0.0]))).collect(); Ok(Shape::union(v?)?)}
fn m<const D:usize>(n:&str,s:&Shape<D>,r:f64)->R<()>{ let b=s.promise().bounds.unwrap(); let t0=std::time::Instant::now();
 let t=Tour::new(b.aabb,10.0)?.with_probe_radius(r)?; let path=t.over(s)?; let made=t0.elapsed();
 let size=b.aabb.half_extents().0.into_iter().fold(0.0,f64::max)*2.0; let speed=0.3*size.sqrt();
 let mut low=f64::INFINITY; let mut fast=0f64; let mut jerk=0f64; let mut last=path.state_at(0.0).velocity; let mut wj=0;
 for k in 0..100000{ let st=path.state_at(k as f64*1e-4); low=low.min(s.distance(st.position)-r); fast=fast.max(st.velocity.norm()/speed); let j=(st.velocity-last).norm()/speed; if j>jerk{jerk=j;wj=k;} last=st.velocity;}
 let mut dev=SimulatedDevice::new(vec![path.clone()])?; let mut servo=Servo::new(s.clone(),1,ServoOptions{probe:Probe::new(r)?,max_force:f64::INFINITY,..Default::default()})?;
 let rep=run(&mut servo,&mut dev,RunOptions{pace:Pace::AsFastAsPossible,..RunOptions::new(10.0)})?;
 println!("{n}: share {:.2} depth {:.3}mm path-depth {:.3}mm speed {:.2} jerk {:.4}@{wj} n {} in {:?} spent {}",rep.contact_time/rep.duration,rep.largest_depth*1e3,-low*1e3,fast,jerk,path.times().len(),made,rep.evaluations.budget_spent); Ok(())}
fn main()->R<()>{ if std::env::args().count()>1 { dump(&Shape::from_kernel(Torus::new(0.05,0.02)?),0.002,2.6922)?; return dump(&gallery()?,0.002,1.0443); } for r in [0.002,0.003]{ m("star",&star()?,r)?; m("cup",&cup()?,r)?; m("gallery",&gallery()?,r)?;
 m("ball",&Shape::<3>::from_kernel(Ball::new(0.05)?),r)?; m("box",&Shape::<3>::from_kernel(Cuboid::new(Vector([0.1;3]))?),r)?; m("box2",&Shape::<2>::from_kernel(Cuboid::new(Vector([0.1,0.06]))?),r)?;
 m("torus",&Shape::from_kernel(Torus::new(0.05,0.02)?),r)?; m("flat",&Shape::from_kernel(Cuboid::new(Vector([0.4,0.1,0.2]))?),r)?;} Ok(()) }
#[allow(dead_code)] pub fn dump<const D:usize>(s:&Shape<D>,r:f64,n:f64)->R<()>{ let b=s.promise().bounds.unwrap(); let path=Tour::new(b.aabb,10.0)?.with_probe_radius(r)?.over(s)?;
 let i=path.times().partition_point(|t|*t<n); for k in i-8..i+8{ let p=path.positions()[k]; println!("{:.5} {:?} f {:.6} chord {:.6}",path.times()[k],p.0,s.distance(p),(path.positions()[k+1]-p).norm()); } Ok(()) }
