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
pub(super) const P_CONST: [f64; Constellation::ALL.len()] = [1e-4; Constellation::ALL.len()];

pub(super) fn published(p_sat: f64) -> Vec<Sight> {
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

/// Lists every satellite, and the constellations too where one satellite has left: what is not monitored beforehand is there after an exclusion.
struct Wary(Option<FaultModes>, usize);

impl Book for Wary {
    fn modes(&mut self, sights: &[Sight], service: &Service) -> Result<&FaultModes, NoModes> {
        let p_const = if sights.len() < self.1 { P_CONST } else { P_CONST.map(|_| 1e-20) };
        Ok(self.0.insert(service.modes(sights, &p_const)?))
    }
}

/// A decision's modes may be others than those of the epoch: the levels are those of every decision worked out, whatever the book lists.
#[test]
fn the_promise_holds_where_a_decision_has_modes_that_the_epoch_has_not() {
    let service = Service::HORIZONTAL;
    let mut seen = 0;
    for sights in skies(21, false).filter(|s| s.len() >= 12) {
        let n = sights.len();
        let prediction = predicted(&mut Monitor::default(), &mut Wary(None, n), &sights, &service).unwrap();
        let mut book = Wary(None, n);
        let likely: Vec<_> =
            book.modes(&sights, &service).unwrap().iter().skip(1).filter(|m| m.p > service.integrity()).map(|m| m.satellites).collect();
        assert!(likely.iter().all(|m| m.count_ones() == 1));
        let share = 1.0 / (1 + likely.len()) as f64;
        let mut largest = [0.0_f64; 2];
        for out in core::iter::once(0).chain(likely) {
            let left: Vec<_> = (0..n).filter(|i| out >> i & 1 == 0).map(|i| sights[i]).collect();
            let modes = book.modes(&left, &service).unwrap();
            let levels = Solver::default().levels(&mut Separation::default(), &left, &[], &Terms { modes, service: &service, share });
            let levels = levels.map_or([f64::INFINITY; 2], |l| [l.hpl.m(), l.vpl_m()]);
            largest = [0, 1].map(|k| largest[k].max(levels[k]));
        }
        // The same numbers compared, so the same bits.
        assert_eq!([prediction.hpl.m(), prediction.vpl_m()], largest);
        seen += usize::from(largest[0].is_finite());
    }
    assert!(seen > 10, "{seen}");
}

/// A monitor that has served other requirements, and one as new: thresholds are of the service that is requested.
#[test]
fn what_a_monitor_has_served_before_changes_nothing() {
    let sights = published(1e-5);
    let strict = Service { false_alarm_v: Risk::constant(1e-9), false_alarm_h: Risk::constant(2e-9), ..Service::LPV_200 };
    let modes = strict.modes(&sights, &P_CONST).unwrap();
    let mut used = Monitor::default();
    for service in [&strict, &Service::LPV_200, &Service::HORIZONTAL, &strict, &Service::LPV_200] {
        let anew = Monitor::default().levels(&sights, &modes, service).unwrap();
        assert_eq!(used.levels(&sights, &modes, service).unwrap(), anew);
        // K = Q^-1(P_FA / (4 N)) and Q^-1(P_FA / (2 N)), N faults; this example has no bias for continuity.
        let faults = (modes.len() - 1) as f64;
        let k = [0.25 * service.false_alarm_h.q() / faults, 0.5 * service.false_alarm_v.q() / faults].map(one_sided_factor);
        for report in used.report(&modes, service).skip(1) {
            for (a, k) in [k[0], k[0], k[1]].into_iter().enumerate() {
                assert!((report.threshold[a].m() - k * report.sigma_separation[a].m()).abs() <= 1e-12 * report.threshold[a].m());
            }
        }
    }
}

/// Every column of both entries is the number of its name, and there is none beyond them.
#[test]
fn a_column_is_the_number_of_its_name() {
    use crate::bound::Algorithm;
    let m = Metres::new;
    let detail = Detail {
        axes: [m(1.5), m(2.5)],
        emt: m(3.5),
        sigma_accuracy: [m(4.5), m(5.5), m(6.5)],
        n_modes: 17,
        n_monitored: 13,
        p_unmonitored: 1e-9,
    };
    let named = [
        ("hpl_e_m", 1.5),
        ("hpl_n_m", 2.5),
        ("emt_m", 3.5),
        ("sigma_acc_e_m", 4.5),
        ("sigma_acc_n_m", 5.5),
        ("sigma_acc_u_m", 6.5),
        ("p_unmonitored", 1e-9),
        ("n_modes", 17.0),
        ("n_monitored", 13.0),
    ];
    fn columns<A: Algorithm<Detail = Detail>>(detail: &Detail) -> Vec<(&'static str, f64)> {
        A::COLUMNS.iter().enumerate().map(|(k, name)| (*name, A::number(detail, k))).collect()
    }
    assert_eq!(columns::<listed::Araim>(&detail), named);
    assert_eq!(columns::<listed::Separation>(&detail), named);
    assert!(listed::Araim::number(&detail, named.len()).is_nan() && listed::Separation::number(&detail, named.len()).is_nan());
}

/// Largest separation of each monitored mode against its threshold, and the solution with all: normal equations with a column for each clock.
fn separations(sights: &[Sight], residuals: &[f64], service: &Service) -> (Vec<(u64, f64)>, Vector3<f64>) {
    let solve = |out: u64| {
        let mut normal = nalgebra::SMatrix::<f64, 5, 5>::zeros();
        let mut right = nalgebra::SVector::<f64, 5>::zeros();
        for (i, s) in sights.iter().enumerate().filter(|(i, _)| out >> i & 1 == 0) {
            let mut row = nalgebra::SVector::<f64, 5>::zeros();
            row.fixed_rows_mut::<3>(0).copy_from(&-s.unit);
            row[if s.constellation == Constellation::Gps { 3 } else { 4 }] = 1.0;
            normal += row * row.transpose() / s.integrity_m2;
            right += row * residuals[i] / s.integrity_m2;
        }
        // A constellation without satellites has no clock.
        (3..5).filter(|k| normal[(*k, *k)] == 0.0).collect::<Vec<_>>().into_iter().for_each(|k| normal[(k, k)] = 1.0);
        normal.lu().solve(&right).unwrap().fixed_rows::<3>(0).into_owned()
    };
    let mut monitor = Monitor::default();
    let modes = service.modes(sights, &P_CONST).unwrap();
    monitor.levels(sights, &modes, service).unwrap();
    let all = solve(0);
    let ratio = |r: &ModeReport| {
        let moved = solve(r.mode.satellites) - all;
        (0..3).map(|a| if moved[a].abs() > 1e-6 { moved[a].abs() / r.threshold[a].m() } else { 0.0 }).fold(0.0, f64::max)
    };
    (monitor.report(&modes, service).skip(1).filter(|r| r.monitored).map(|r| (r.mode.satellites, ratio(&r))).collect(), all)
}

/// Every decision by its words: nothing where all agree, else the likely modes in the order of their separations, the first that leaves agreement.
#[test]
fn the_fault_that_is_excluded_is_the_first_after_which_all_agree() {
    let service = Service::LPV_200;
    let mut seen = [0; 3];
    for (k, sights) in skies(31, false).enumerate() {
        // A fault of no, one or two satellites, of a size from nothing to a hundred metres; clocks of 3 m and 8 m.
        let mut residuals: Vec<_> = sights.iter().map(|s| if s.constellation == Constellation::Gps { 3.0 } else { 8.0 }).collect();
        residuals[k % sights.len()] += [0.0, 15.0, 40.0, 100.0][k % 4];
        residuals[(k * 5 + 1) % sights.len()] += [0.0, 0.0, -60.0][k % 3];
        let outcome = monitored(&mut Monitor::default(), &mut Anew(None), &sights, &residuals, &service).unwrap();
        let (mut ratios, step) = separations(&sights, &residuals, &service);
        ratios.sort_by(|a, b| b.1.total_cmp(&a.1));
        assert!((outcome.worst_ratio - ratios[0].1).abs() <= 1e-9 * ratios[0].1, "{k}: {} {:?}", outcome.worst_ratio, ratios[0]);
        let (share, decisions) = each_exclusion(&sights, &service);
        assert!(decisions.len() > 1 && share == 1.0 / decisions.len() as f64);
        let without = |out: u64| -> (Vec<Sight>, Vec<f64>) {
            (0..sights.len()).filter(|i| out >> i & 1 == 0).map(|i| (sights[i], residuals[i])).unzip()
        };
        let agrees = |out: u64| {
            let levels = decisions.iter().find(|d| d.0 == out)?.1.as_ref().filter(|l| l.finite())?;
            let (left, residuals) = without(out);
            separations(&left, &residuals, &service).0.iter().all(|r| r.1 <= 1.0).then_some(*levels)
        };
        let first = ratios.iter().take(16).find_map(|(out, _)| Some((*out, agrees(*out)?)));
        let (decision, out, levels) = match first {
            _ if ratios[0].1 <= 1.0 => (exclusion::Decision::Nothing, 0, decisions[0].1.unwrap()),
            Some((out, levels)) => (exclusion::Decision::Excluded, out, levels),
            None => (exclusion::Decision::NotExcluded, 0, decisions[0].1.unwrap()),
        };
        assert_eq!((outcome.decision, outcome.excluded, outcome.levels), (decision, out, levels), "{k}");
        let step = if out == 0 { step } else { separations(&without(out).0, &without(out).1, &service).1 };
        (0..3).for_each(|a| assert!((outcome.step[a].m() - step[a]).abs() < 1e-8 * (1.0 + step.norm()), "{k}"));
        seen[decision as usize] += 1;
    }
    assert!(seen.iter().all(|n| *n > 3), "{seen:?}");
}
