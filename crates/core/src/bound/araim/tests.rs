use super::exclusion::{detected, monitored, predicted};
use super::modes::{Book, FaultModes, NoModes};
use super::*;
use crate::bound::NoLevels;
use crate::signal::Constellation;
use nalgebra::Vector3;

/// The published ten-satellite example (Blanch et al. 2012): unit vector, variances for integrity and for accuracy.
const PUBLISHED: [([f64; 3], f64, f64); 10] = [
    ([-0.0225, -0.9951, 0.0966], 3.8865, 3.574),
    ([-0.675, 0.69, 0.2612], 1.4377, 1.1252),
    ([-0.0723, 0.6601, 0.7477], 0.8604, 0.5479),
    ([0.9398, -0.2553, 0.2269], 1.6383, 1.3258),
    ([0.5907, 0.7539, 0.2877], 1.3229, 1.0104),
    ([0.3236, 0.0354, 0.9455], 0.8434, 0.5309),
    ([0.6748, -0.4356, 0.5957], 0.8963, 0.5838),
    ([-0.0938, 0.7004, 0.7075], 0.8669, 0.5544),
    ([-0.5571, -0.3088, 0.7709], 0.8573, 0.5448),
    ([-0.6622, -0.6958, 0.278], 1.3616, 1.0491),
];
const P_CONST: [f64; Constellation::ALL.len()] = [1e-4; Constellation::ALL.len()];

fn published(p_sat: f64) -> Vec<Sight> {
    let sight = |(i, (unit, integrity_m2, accuracy_m2)): (usize, &([f64; 3], f64, f64))| Sight {
        unit: Vector3::from(*unit),
        constellation: if i < 5 { Constellation::Gps } else { Constellation::Galileo },
        integrity_m2: *integrity_m2,
        accuracy_m2: *accuracy_m2,
        receiver_faulty_m2: *integrity_m2,
        bias: Metres::new(0.5),
        bias_continuity: Metres::new(0.0),
        p_sat,
    };
    PUBLISHED.iter().enumerate().map(sight).collect()
}

/// Works every list out anew.
struct Anew(Option<FaultModes>);

impl Book for Anew {
    fn modes(&mut self, sights: &[Sight], service: &Service) -> Result<&FaultModes, NoModes> {
        Ok(self.0.insert(service.modes(sights, &P_CONST)?))
    }
}

#[test]
fn constellations_of_the_published_example_are_met_to_the_printed_digit() {
    let (sights, service, mut monitor) = (published(1e-5), Service::LPV_200, Monitor::default());
    let modes = service.modes(&sights, &P_CONST).unwrap();
    let levels = monitor.levels(&sights, &modes, &service).unwrap();
    assert_eq!((modes.len(), levels.detail.n_monitored), (13, 13));
    let whole: Vec<_> = monitor.report(&modes, &service).filter(|r| r.mode.constellations != 0).collect();
    for (report, sigma, separation, bias) in [(whole[0], 2.576, 1.5307, 2.8935), (whole[1], 2.5577, 1.5292, 2.0875)] {
        // Half a unit of the last printed digit, and what the four digits of the printed geometry leave.
        assert!((report.sigma[2].m() - sigma).abs() <= 5e-4, "{report:?}");
        assert!((report.sigma_separation[2].m() - separation).abs() <= 5e-4, "{report:?}");
        assert!((report.bias[2].m() - bias).abs() <= 5e-4, "{report:?}");
        assert!(report.monitored);
    }
}

#[test]
fn the_variant_with_every_pair_has_57_modes() {
    let (sights, service) = (published(1e-4), Service::LPV_200);
    // 10 satellites, 45 pairs, 2 constellations; pairs inside a constellation count with it, and the rest is kept as far as needed.
    let modes = (Service { consolidation: 0.0, unmonitored: Risk::constant(1e-12), ..service }).modes(&sights, &P_CONST).unwrap();
    let pairs = modes.iter().filter(|m| m.satellites.count_ones() == 2).count();
    assert_eq!(pairs, 45);
    let total: f64 = modes.iter().map(|m| m.p).sum::<f64>() + modes.left();
    // Everything that can happen, by sums of 400 doubles.
    assert!((total - 1.0).abs() <= 1e-13, "{total}");
}

#[test]
fn pairs_and_pairs_beyond_a_constellation_agree_with_a_new_solution() {
    let (sights, service, mut monitor) = (published(1e-4), Service::LPV_200, Monitor::default());
    let every = Service { consolidation: 0.0, unmonitored: Risk::constant(1e-12), ..service };
    let modes = every.modes(&sights, &P_CONST).unwrap();
    monitor.levels(&sights, &modes, &every).unwrap();
    let mut seen = 0;
    for report in monitor.report(&modes, &every).filter(|r| r.monitored && r.mode.satellites != 0) {
        let left: Vec<_> = (0..10).filter(|i| report.mode.satellites >> i & 1 == 0).map(|i| sights[i]).collect();
        let weighted = left.iter().map(Sight::weighted);
        let anew = crate::solution::wls::covariance_of_weighted(weighted).unwrap();
        for a in 0..3 {
            let sigma = sqrt(anew.matrix()[(a, a)]);
            // Downdates lose as many digits as the satellites left are worse than all: conditions below 1e6.
            assert!((report.sigma[a].m() - sigma).abs() <= 1e-9 * sigma, "{:?}: {sigma}", report.mode);
        }
        seen += 1;
    }
    assert!(seen > 50, "{seen}");
}

#[test]
fn exclusion_promises_more_than_detection_and_finds_the_fault() {
    let (sights, service, mut monitor) = (published(1e-5), Service::HORIZONTAL, Monitor::default());
    let mut book = Anew(None);
    let detection = detected(&mut monitor, &mut book, &sights, &service).unwrap();
    let exclusion = predicted(&mut monitor, &mut book, &sights, &service).unwrap();
    assert!(exclusion.hpl > detection.hpl && exclusion.vpl > detection.vpl);
    let mut residuals = [3.0; 10];
    residuals[2] += 200.0;
    let outcome = monitored(&mut monitor, &mut book, &sights, &residuals, &service).unwrap();
    assert_eq!((outcome.decision, outcome.excluded), (exclusion::Decision::Excluded, 1 << 2));
    // Residuals without the fault are equal for all: clocks take them up.
    assert!(outcome.step.iter().all(|s| s.m().abs() < 1e-9), "{:?}", outcome.step);
    assert!(outcome.worst_ratio > 1.0);
}

#[test]
fn satellites_that_cannot_be_tested_are_no_agreement() {
    // Five of one constellation: without any one of them four are left, which always agree.
    let (sights, mut monitor) = (published(1e-5)[..5].to_vec(), Monitor::default());
    let tested = monitored(&mut monitor, &mut Anew(None), &sights, &[0.0, 0.0, 1e4, 0.0, 0.0], &Service::LPV_200).unwrap();
    assert!(tested.worst_ratio > 1.0, "{tested:?}");
    assert_eq!((tested.decision, tested.excluded), (exclusion::Decision::NotExcluded, 0));
}

/// The list of fault modes is worked out with six satellites, so that only the number of sights can refuse.
#[test]
fn sixty_four_satellites_are_served_and_more_are_refused() {
    let modes = Service::LPV_200.modes(&published(1e-5)[..6], &P_CONST).unwrap();
    let one = published(1e-5)[0];
    for n in [65_usize, 66, 200] {
        let many: Vec<_> = (0..n).map(|_| one).collect();
        let refused = Monitor::default().levels(&many, &modes, &Service::LPV_200).unwrap_err();
        assert!(matches!(refused, Unavailable::Invalid { field: "n_sv", value, .. } if value == n as f64), "{n}: {refused:?}");
    }
    let most: Vec<_> = skies(11, false).flatten().take(64).collect();
    let refused = Monitor::default().levels(&most, &modes, &Service::LPV_200).err();
    assert!(!matches!(refused, Some(Unavailable::Invalid { field: "n_sv", .. })), "{refused:?}");
}

#[test]
fn what_there_is_no_room_for_is_reported() {
    let one = published(1e-5)[0];
    let many: Vec<_> = (0..65).map(|_| one).collect();
    assert_eq!(Service::LPV_200.modes(&many, &P_CONST).unwrap_err(), NoModes::TooManySatellites { have: 65 });
    let likely: Vec<_> = (0..60).map(|_| Sight { p_sat: 0.01, ..one }).collect();
    assert_eq!(Service::LPV_200.modes(&likely, &P_CONST).unwrap_err(), NoModes::TooManyModes);
    let none = detected(&mut Monitor::default(), &mut Anew(None), &[], &Service::LPV_200);
    assert_eq!(none.unwrap_err(), NoLevels::Geometry(Unavailable::TooFewSatellites { need: 4, have: 0 }));
}

/// Seeded skies of two constellations, or of one.
fn skies(seed: u64, plain: bool) -> impl Iterator<Item = Vec<Sight>> {
    let mut state = seed;
    let mut uniform = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    (0..60).map(move |k| {
        let n = 7 + k % 12;
        let sight = |i: usize| {
            let (azimuth, up) = (core::f64::consts::TAU * uniform(), 0.1 + 0.89 * uniform());
            let level = sqrt(1.0 - up * up);
            let integrity_m2 = 0.5 + 2.0 * uniform();
            Sight {
                unit: Vector3::new(level * azimuth.sin(), level * azimuth.cos(), up),
                constellation: if k % 3 == 0 || i < n / 2 { Constellation::Gps } else { Constellation::Galileo },
                integrity_m2,
                accuracy_m2: if plain { integrity_m2 } else { integrity_m2 * (0.3 + 0.6 * uniform()) },
                receiver_faulty_m2: integrity_m2,
                bias: Metres::new(if plain { 0.0 } else { 0.75 * uniform() }),
                bias_continuity: Metres::new(if plain { 0.0 } else { 0.2 * uniform() }),
                p_sat: 1e-5,
            }
        };
        (0..n).map(sight).collect()
    })
}

/// Levels after each exclusion, all of them worked out.
fn each_exclusion(sights: &[Sight], service: &Service) -> (f64, Vec<(u64, Option<Levels>)>) {
    let modes = service.modes(sights, &P_CONST).unwrap();
    let likely: Vec<_> = modes.iter().skip(1).filter(|m| m.p > service.integrity()).map(|m| m.satellites).collect();
    let share = 1.0 / (1 + likely.len()) as f64;
    let mut monitor = Monitor::default();
    let mut without = |out: u64| {
        let left: Vec<_> = (0..sights.len()).filter(|i| out >> i & 1 == 0).map(|i| sights[i]).collect();
        let modes = service.modes(&left, &P_CONST).ok().filter(|_| !left.is_empty())?;
        monitor.solver.levels(&mut monitor.rest, &left, &[], &Terms { modes: &modes, service, share }).ok()
    };
    (share, core::iter::once(0).chain(likely).map(|out| (out, without(out))).collect())
}

#[test]
fn the_promise_with_exclusion_is_the_largest_of_all_decisions() {
    for service in Service::ALL {
        for (k, sights) in skies(7, false).chain(skies(8, true)).enumerate() {
            let prediction = predicted(&mut Monitor::default(), &mut Anew(None), &sights, &service);
            let (_, decisions) = each_exclusion(&sights, &service);
            if decisions[0].1.is_none() {
                assert!(prediction.is_err(), "sky {k}");
                continue;
            }
            let prediction = prediction.unwrap();
            let largest =
                |of: fn(&Levels) -> f64| decisions.iter().map(|d| d.1.as_ref().map_or(f64::INFINITY, of)).fold(0.0, f64::max).to_bits();
            // The same numbers compared, so the same bits.
            assert_eq!(prediction.hpl.m().to_bits(), largest(|l| l.hpl.m()), "sky {k}");
            assert_eq!(prediction.vpl_m().to_bits(), largest(|l| l.vpl_m()), "sky {k}");
            assert_eq!(
                prediction.detail.axes.map(|x| x.m().to_bits()),
                [largest(|l| l.detail.axes[0].m()), largest(|l| l.detail.axes[1].m())],
                "sky {k}"
            );
        }
    }
}

/// Whether the ceiling of a decision is below the levels times a factor, axis by axis, and whether it is below on all.
fn below(sights: &[Sight], out: u64, levels: &Levels, share: f64, factor: f64) -> ([bool; 3], bool) {
    let (service, mut monitor) = (&Service::LPV_200, Monitor::default());
    let modes = service.modes(sights, &P_CONST).unwrap();
    monitor.levels(sights, &modes, service).unwrap();
    monitor.ceiling.fill(&monitor.every);
    let left: Vec<_> = (0..sights.len()).filter(|i| out >> i & 1 == 0).map(|i| sights[i]).collect();
    let modes = service.modes(&left, &P_CONST).unwrap();
    let terms = Terms { modes: &modes, service, share };
    let limits = [levels.detail.axes[0].m(), levels.detail.axes[1].m(), levels.vpl_m()].map(|x| factor * x);
    let mut holds = |limits| monitor.ceiling.holds(&mut monitor.every, &mut monitor.solver, out, &terms, &limits);
    let alone = |a: usize| core::array::from_fn(|b| if a == b { limits[b] } else { f64::INFINITY });
    ([holds(alone(0)), holds(alone(1)), holds(alone(2))], holds(limits))
}

#[test]
fn a_ceiling_is_above_the_level_and_meets_it_where_variances_tell_all() {
    let (mut tight, mut near, mut seen) = (0, 0, 0);
    for (plain, sights) in skies(3, true).map(|s| (true, s)).chain(skies(4, false).map(|s| (false, s))) {
        let (share, decisions) = each_exclusion(&sights, &Service::LPV_200);
        for (out, levels) in decisions.iter().filter(|d| d.0.count_ones() == 1) {
            let Some(levels) = levels.as_ref().filter(|l| l.finite()) else { continue };
            // Rounding of subsets is below 1e-9, and 1e-6 of the risk are less than 1e-7 of a level.
            assert_eq!(below(&sights, *out, levels, share, 1.0 - 1e-6).0, [false; 3], "{out:b}");
            seen += 1;
            tight += usize::from(plain && below(&sights, *out, levels, share, 1.0 + 1e-6).1);
            near += usize::from(!plain && below(&sights, *out, levels, share, 1.5).1);
        }
    }
    assert!(seen > 500 && 10 * (tight + near) > 9 * seen, "{tight} and {near} of {seen}");
}
