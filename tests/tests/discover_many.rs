//! Many random rigs, to see how often the diagnosis is right. Not part of the usual run: it takes minutes.
//! `cargo test -p tests --test discover_many -- --ignored --nocapture`

use host::diagnose::diagnose;
use shared::effect::Effect;
use std::time::Instant;
use tests::hidden::{Random, Rig};

const RATIOS: [f64; 4] = [1.5, 2.2, 3.0, 5.0];

#[derive(Default)]
struct Tally {
    n: usize,
    first: usize,
    exact: usize,
    both: usize,
    reached: usize,
    seconds: Vec<f64>,
}

fn canonical(name: &str) -> &str {
    if name == "power-law-drag" { "quadratic-drag" } else { name }
}

fn judge(label: &str, truth: &[&str], accept: &[&str], rig: &Rig, ratio: f64, tally: &mut Tally) {
    let swings = rig.swings();
    let began = Instant::now();
    let d = diagnose(&swings, &[], &rig.known());
    let seconds = began.elapsed().as_secs_f64();
    let truth: Vec<&str> = truth.iter().map(|n| canonical(n)).collect();
    let mut verdict: Vec<&str> = d.verdict.iter().map(|n| canonical(n)).collect();
    if !truth.contains(&"angle-offset") {
        verdict.retain(|n| *n != "angle-offset");
    }
    let ok = |n: &&str| truth.contains(n) || accept.contains(n);
    let first = if truth.is_empty() { verdict.is_empty() } else { truth.contains(&canonical(d.ranked[0])) };
    let all = truth.iter().all(|n| verdict.contains(n));
    let exact = all && verdict.iter().all(ok);
    let undecided_covers = truth.iter().all(|n| verdict.contains(n) || d.undecided.iter().any(|u| canonical(u) == *n));
    let after = d.rmse_after / rig.total_noise_rad();
    tally.n += 1;
    tally.first += usize::from(first);
    tally.exact += usize::from(exact);
    tally.both += usize::from(all);
    tally.reached += usize::from(after <= 1.05 || d.unexplained);
    tally.seconds.push(seconds);
    let mark = if exact {
        "ok   "
    } else if undecided_covers {
        "TIE  "
    } else if first {
        "part "
    } else {
        "MISS "
    };
    println!(
        "{mark} {label:<46} ratio {ratio:5.2} -> {:?} und {:?} rank {:?} | {:.2} -> {after:.3} noise {:.3} {seconds:.2}s {} max {:.2} off {:?}",
        d.verdict,
        d.undecided,
        &d.ranked[..d.ranked.len().min(3)],
        d.rmse_before / rig.total_noise_rad(),
        d.noise / rig.total_noise_rad(),
        d.simulations,
        rig.releases_rad.iter().fold(0.0_f64, |m, x| m.max(x.abs())),
        rig.offset_rad,
    );
    if !exact {
        println!(
            "        truth {:?}  Mc {:.2e} Ms {:.2e} DV {} fs {}",
            rig.hidden, rig.coulomb_nm, rig.stiction_nm, rig.velocity_band, rig.rate_hz
        );
        for c in d.candidates.iter().take(6) {
            let p: Vec<String> = c
                .parameters
                .iter()
                .map(|p| format!("{} {:.3e}±{:.0e}", p.symbol, p.value, p.std.unwrap_or(f64::NAN)))
                .collect();
            println!("        {:<50} {:.4} {:.1} {}", c.name, c.rmse / d.noise, c.criterion, p.join(" "));
        }
    }
}

fn summary(name: &str, t: &mut Tally) {
    if t.n == 0 {
        return;
    }
    t.seconds.sort_by(f64::total_cmp);
    println!(
        "== {name}: {} rigs, first {} exact {} all named {} reached {} median {:.2}s worst {:.2}s",
        t.n,
        t.first,
        t.exact,
        t.both,
        t.reached,
        t.seconds[t.n / 2],
        t.seconds[t.n - 1]
    );
}

/// Sizes found earlier are kept, because finding them takes longer than the diagnosis.
fn cached(key: &str, rig: Rig, ratio: f64) -> (Rig, f64) {
    let path = std::env::temp_dir().join("discover_many_sizes.txt");
    let known = std::fs::read_to_string(&path).unwrap_or_default();
    if let Some(line) = known.lines().find(|line| line.split(' ').next() == Some(key)) {
        let f: Vec<f64> = line.split(' ').skip(1).map(|x| x.parse().unwrap()).collect();
        let mut rig = rig;
        for (h, s) in rig.hidden.iter_mut().zip(&f[1..]) {
            h.size = *s;
        }
        return (rig, f[0]);
    }
    let (rig, left) = rig.scaled_to(ratio);
    let sizes: Vec<String> = rig.hidden.iter().map(|h| format!("{}", h.size)).collect();
    use std::io::Write;
    let mut file = std::fs::OpenOptions::new().create(true).append(true).open(path).unwrap();
    writeln!(file, "{key} {left} {}", sizes.join(" ")).unwrap();
    (rig, left)
}

#[test]
#[ignore = "takes minutes"]
fn many_rigs() {
    let pick = std::env::var("PICK").unwrap_or_default();
    let from: u64 = std::env::var("FROM").ok().and_then(|s| s.parse().ok()).unwrap_or(0);
    let rounds: u64 = std::env::var("ROUNDS").ok().and_then(|s| s.parse().ok()).unwrap_or(2);
    let wanted = |label: &str| pick.is_empty() || pick.split(',').any(|p| label.contains(p));
    let (mut none, mut one, mut two) = (Tally::default(), Tally::default(), Tally::default());
    for round in from..from + rounds {
        if wanted("innocent") {
            for (k, kind) in ["none", "none", "band", "band", "band", "clock", "buoyancy", "mass"].iter().enumerate() {
                let label = format!("innocent-{kind}-{round}-{k}");
                let seed = 1000 * round + k as u64;
                let mut rig = Rig::random(seed);
                let mut random = Random::new(seed + 77);
                match *kind {
                    "band" => rig.velocity_band = random.log_between(0.01, 0.05),
                    "clock" => rig.clock = 1.0 + 0.01 * random.sign(),
                    "buoyancy" => rig.gravity_m_s2 *= 0.99,
                    "mass" => rig.inertia_kg_m2 *= 1.3,
                    _ => {}
                }
                let ratio = f64::NAN;
                judge(&label, &[], &[], &rig, ratio, &mut none);
            }
        }
        for (k, effect) in Effect::<f64>::ALL.iter().filter(|e| !e.is_base()).enumerate() {
            let label = format!("one-{}-{round}", effect.name);
            if !wanted(&label) {
                continue;
            }
            let seed = 1000 * round + 100 + k as u64;
            let ratio = RATIOS[(round as usize + k) % 4];
            let (rig, left) = cached(&label, Rig::random(seed).with(effect.name), ratio);
            let accept: &[&str] = if effect.name == "sensor-nonlinearity" { &["sensor-gain"] } else { &[] };
            judge(&label, &[effect.name], accept, &rig, left, &mut one);
        }
        let pairs = [
            ("quadratic-drag", "torsional-spring"),
            ("quadratic-drag", "sensor-gain"),
            ("stribeck", "backlash"),
            ("drifting-friction", "torsional-spring"),
            ("sensor-nonlinearity", "quadratic-drag"),
            ("asymmetric-coulomb", "quadratic-drag"),
            ("detent", "stribeck"),
            ("angle-offset", "quadratic-drag"),
            ("eddy-brake", "sensor-lag"),
            ("load-dependent-coulomb", "torsional-spring"),
            ("quadratic-drag", "backlash"),
            ("detent", "drifting-friction"),
        ];
        for (k, (a, b)) in pairs.iter().enumerate() {
            if !(k as u64 + round).is_multiple_of(2) {
                continue;
            }
            let label = format!("two-{a}+{b}-{round}");
            if !wanted(&label) {
                continue;
            }
            let seed = 1000 * round + 200 + k as u64;
            let rig = Rig::random(seed);
            let target = [2.5, 4.0][(round as usize / 2 + k) % 2];
            // Each is as large as it has to be for the base model to leave so much of it alone.
            let alone = [a, b].map(|name| cached(&format!("{label}-{name}"), rig.clone().with(name), target));
            let mut both = rig.with(a).with(b);
            for (hidden, (alone, _)) in both.hidden.iter_mut().zip(&alone) {
                hidden.size = alone.hidden[0].size;
            }
            let accept: &[&str] = if *a == "sensor-nonlinearity" { &["sensor-gain"] } else { &[] };
            println!("{label}: alone {:.2} and {:.2} noises", alone[0].1, alone[1].1);
            judge(&label, &[a, b], accept, &both, both.base_ratio(), &mut two);
        }
        if wanted("bandplus") {
            for (k, name) in ["quadratic-drag", "torsional-spring"].iter().enumerate() {
                let label = format!("bandplus-{name}-{round}");
                let seed = 1000 * round + 300 + k as u64;
                let mut rig = Rig::random(seed);
                rig.velocity_band = Random::new(seed).log_between(0.01, 0.05);
                let (rig, left) = cached(&label, rig.with(name), 3.0);
                judge(&label, &[name], &[], &rig, left, &mut one);
            }
        }
    }
    summary("innocent", &mut none);
    summary("one", &mut one);
    summary("two", &mut two);
}
