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
    for (name, p) in &PROFILES { for fb in [0.3,1.0,3.0] { for ff in [0.3,1.0,3.0] { for fm in [0.5,2.0] { for fs in [1.0,3.0] {
        let mut q = p.clone().with_mass(p.mass*fm).with_least_damping(p.least_damping*fb).with_friction(p.friction*ff).with_encoder_step(p.encoder_step*fs);
        if let Some(t) = &p.turning { q = q.with_turning(t.clone().with_inertia(t.inertia*fm).with_least_damping(t.least_damping*fb).with_friction(t.friction*ff).with_encoder_step(t.encoder_step*fs)); }
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
