//! probe
use palpate_devices::*;
use palpate_field::Vector;
fn run(p: &DeviceProfile, rate: f64, seed: u64) -> Result<Identified, IdentifyError> {
    let hand = Hand::resting(Vector([0.01, -0.02])).unwrap().with_mass(0.0).unwrap().with_spring(0.0,0.0).unwrap().with_inertia(0.0).unwrap().with_angular_spring(0.0,0.0).unwrap();
    let mut d = SimulatedDevice::<2>::new(p.clone(), vec![hand]).unwrap();
    let mut n = 0u64;
    identify(&mut d, IdentifyOptions::new(rate).with_seed(seed), &mut |_| { n += 1; Some(n as f64 / rate) })
}
fn truth(p: &DeviceProfile, a: DeviceAxis) -> [f64;4] { match a { DeviceAxis::Along(_) => [p.mass,p.least_damping,p.friction,p.encoder_step], _ => { let t=p.turning.as_ref().unwrap(); [t.inertia,t.least_damping,t.friction,t.encoder_step]} } }
#[test]
fn probe() {
    let rate: f64 = std::env::var("RATE").map_or(1000.0, |r| r.parse().unwrap());
    let seed: u64 = std::env::var("SEED").map_or(0, |r| r.parse().unwrap());
    let mut jobs = vec![];
    for (name, p) in &PROFILES { for fb in [0.3,1.0,3.0] { for ff in [0.3,1.0,3.0] { for fm in [0.5,2.0] { for fs in if std::env::var("ALL").is_ok() {vec![1.0,3.0]} else {vec![3.0]} {
        let mut q = p.clone().with_mass(p.mass*fm).with_least_damping(p.least_damping*fb).with_friction(p.friction*ff).with_encoder_step(p.encoder_step*fs);
        if let Some(t) = &p.turning { q = q.with_turning(t.clone().with_inertia(t.inertia*fm).with_least_damping(t.least_damping*fb).with_friction(t.friction*ff).with_encoder_step(t.encoder_step*fs)); }
        if std::env::var("LOW").is_ok() && (ff != 0.3 || fb != 0.3) { continue; }
        jobs.push((format!("{name} b{fb} f{ff} m{fm} s{fs}"), q));
    }}}}}
    let next = std::sync::atomic::AtomicUsize::new(0);
    let worst = std::sync::Mutex::new(([0.0f64;4], 0, 0, 0, 0.0f64, 0));
    let t0 = std::time::Instant::now();
    std::thread::scope(|s| for _ in 0..2 { s.spawn(|| loop {
        let i = next.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        let Some((name, q)) = jobs.get(i) else { break };
        match run(q, rate, seed) {
            Err(e) => { println!("{name}: {e}"); worst.lock().unwrap().1 += 1; }
            Ok(f) => for a in &f.axes {
                let t = truth(q, a.axis);
                let es = [a.mass, a.damping, a.friction];
                let mut w = worst.lock().unwrap();
                w.2 += 1; w.4 = w.4.max(a.misfit); w.5 = w.5.max(a.strokes);
                for k in 0..3 {
                    let rel = (es[k].value/t[k]-1.0).abs();
                    if es[k].is_seen() { w.0[k] = w.0[k].max(rel); } else { w.3 += 1; println!("{name} {}: number {k} unseen {:.3e}±{:.1e} true {:.3e} strokes {}", a.axis, es[k].value, es[k].error, t[k], a.strokes); }
                    if rel > 0.1 || rel > 2.0*es[k].error/t[k].max(1e-30) + 0.002 { println!("{name} {}: number {k} {:.4e}±{:.1e} true {:.4e} ({:.1}%) misfit {:.2}", a.axis, es[k].value, es[k].error, t[k], rel*100.0, a.misfit); }
                }
                let rs = (a.encoder_step.size()/t[3]-1.0).abs(); w.0[3]=w.0[3].max(rs);
                if rs > 0.01 { println!("{name} {} step {:?} true {}", a.axis, a.encoder_step, t[3]); }
            }
        }
    }); });
    println!("{:?} in {:.1} s of {} devices", worst.lock().unwrap(), t0.elapsed().as_secs_f64(), jobs.len());
}
#[test]
fn trace() {
    let p = profile_named("virtuose6d").unwrap();
    let q = p.clone().with_mass(2.0).with_friction(0.15).with_least_damping(1.0).with_encoder_step(1.8e-4);
    let hand = Hand::resting(Vector([0.01, -0.02])).unwrap().with_mass(0.0).unwrap().with_spring(0.0,0.0).unwrap().with_inertia(0.0).unwrap().with_angular_spring(0.0,0.0).unwrap();
    struct T(SimulatedDevice<2>, Vec<(f64,f64,f64,f64)>);
    impl Device<2> for T {
        fn points(&self) -> usize { 1 }
        fn profile(&self) -> &DeviceProfile { self.0.profile() }
        fn read(&mut self, t: f64, p: &mut [PointState<2>]) -> Result<(), DeviceLost> { self.0.read(t, p)?; let s=self.0.states().next().unwrap(); let f=self.0.forces().next().unwrap(); self.1.push((t, s.position[0]-0.01, s.velocity[0], f[0])); Ok(()) }
        fn write(&mut self, f: &[Vector<f64,2>]) -> Result<(), DeviceLost> { self.0.write(f) }
    }
    let mut d = T(SimulatedDevice::<2>::new(q, vec![hand]).unwrap(), vec![]);
    let mut n = 0u64;
    let r = identify(&mut d, IdentifyOptions::new(1000.0), &mut |_| { n += 1; Some(n as f64 / 1000.0) });
    println!("{:?}", r.map(|_| ()));
    let k = d.1.len();
    for (i,(t,x,v,f)) in d.1.iter().enumerate() { if i + 150 > k { println!("{t:.3} {:.3} mm {:.4} m/s {f:.3} N", x*1e3, v); } }
}
