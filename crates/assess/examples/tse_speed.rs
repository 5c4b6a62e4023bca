use navbound_assess::tse;
use navbound_core::quantity::Risk;
use navbound_core::special::PreparedQuantile;
use std::time::Instant;
fn time(mut f: impl FnMut()) -> f64 {
    (0..15)
        .map(|_| {
            let t = Instant::now();
            f();
            t.elapsed().as_secs_f64()
        })
        .fold(f64::INFINITY, f64::min)
}
fn main() {
    let risk = Risk::ACCURACY;
    println!(
        "prepare {:.1} us",
        1e6 * time(|| {
            std::hint::black_box(PreparedQuantile::new(risk));
        })
    );
    let table = PreparedQuantile::new(risk);
    for n in [2000usize, 60_000, 1_000_000] {
        let fte: Vec<f64> = (0..n).map(|i| (i as f64 * 0.37).sin() * 20.0).collect();
        let sigma: Vec<f64> = (0..n).map(|i| 5.0 + (i as f64 * 0.11).cos().abs() * 10.0).collect();
        let reps = 1_000_000 / n;
        let a = time(|| {
            for _ in 0..reps {
                std::hint::black_box(tse::exact(&table, &fte, &sigma).unwrap());
            }
        });
        let b = time(|| {
            for _ in 0..reps {
                std::hint::black_box(tse::ltem(risk, &fte, &sigma).unwrap());
            }
        });
        println!("n {n}: exact {:.2} ns, ltem {:.2} ns, ratio {:.2}", a * 1e9 / (reps * n) as f64, b * 1e9 / (reps * n) as f64, a / b);
    }
}
