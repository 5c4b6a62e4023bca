//! What the judge may never do, over facts drawn at random and over every single fact taken away.

use super::*;
use proptest::prelude::*;

fn epoch() -> GpsTime {
    GpsTime::from_nanoseconds(1_000_000_000_000)
}

fn good() -> Facts {
    let (position, variance_m2) = ([0.7, 2.0, 9000.0], [1.0, 1.0, 4.0]);
    Facts {
        epoch: epoch(),
        filter: Some(FilterFacts { time: epoch(), position, variance_m2, mode: Mode::Gnss }),
        snapshot: Some(SnapshotFacts {
            time: epoch(),
            ranges_agree: RangesAgree::Yes,
            level_m: Some([10.0, 15.0]),
            distance_m: Some([2.0, 3.0]),
        }),
        carried: None,
        agreement: Some(Agreement::Agrees),
        inertial: Some(Inertial::Plausible),
        satellite_times_hold: Some(true),
        gating: Some(Gating::Usual),
        tuning: Some(Tuning::AsDeclared),
        biases: Some(Biases::AsDeclared),
        witnesses: Some(Witnesses { filters_disagree: Some(false), stations_contradict: Some(false), ..Witnesses::NONE }),
    }
}

/// The unit is declared faulty, so that the snapshot alone is the navigation.
fn by_snapshot() -> Facts {
    Facts { filter: None, inertial: Some(Inertial::Fault), gating: None, tuning: None, ..good() }
}

/// Each way to take one fact away.
const WITHOUT: [fn(&mut Facts); 9] = [
    |f| f.filter = None,
    |f| f.snapshot = None,
    |f| f.agreement = None,
    |f| f.inertial = None,
    |f| f.satellite_times_hold = None,
    |f| f.gating = None,
    |f| f.tuning = None,
    |f| f.witnesses = None,
    |f| f.biases = None,
];

#[test]
fn all_facts_good_are_ok_with_the_sum_of_distance_and_level() {
    let decision = decide(&good());
    assert_eq!((decision.status, decision.source, decision.reasons), (Status::Ok, Source::Filter, Reasons::NONE));
    assert_eq!((decision.hpl_m, decision.vpl_m), (Some(12.0), Some(18.0)));
    assert_eq!(decide(&Facts::none(epoch())).status, Status::NotAvailable);
    assert_eq!(decide(&Facts::none(epoch())).source, Source::None);
}

#[test]
fn every_fact_is_needed() {
    for (k, without) in WITHOUT.iter().enumerate() {
        let mut facts = good();
        without(&mut facts);
        assert_ne!(decide(&facts).status, Status::Ok, "fact {k}");
        assert!(!decide(&facts).reasons.is_empty(), "fact {k}");
    }
    // The snapshot given: filter, gates and tuning are those of a filter that is not believed.
    assert_eq!(decide(&by_snapshot()).status, Status::Ok);
    for k in [1, 2, 3, 4, 7] {
        let mut facts = by_snapshot();
        WITHOUT[k](&mut facts);
        assert_ne!(decide(&facts).status, Status::Ok, "fact {k} of the snapshot");
    }
}

#[test]
fn a_state_of_another_time_is_no_position() {
    for (ns, status) in [(400_000, Status::Ok), (-400_000, Status::Ok), (600_000, Status::Degraded), (-1_000_000_000, Status::Degraded)] {
        let mut facts = good();
        facts.filter.as_mut().unwrap().time = GpsTime::from_nanoseconds(epoch().nanoseconds() + ns);
        let decision = decide(&facts);
        assert_eq!(decision.status, status, "{ns}");
        assert_eq!(decision.source == Source::Snapshot, status != Status::Ok, "{ns}");
    }
}

#[test]
fn a_unit_that_is_out_leaves_the_snapshot() {
    for (inertial, status) in [
        (Inertial::Missing { for_s: 5.0 }, Status::Degraded),
        (Inertial::Refused { for_s: 10.0 }, Status::Ok),
        (Inertial::Missing { for_s: f64::NAN }, Status::Degraded),
        (Inertial::Implausible, Status::Ok),
        (Inertial::Fault, Status::Ok),
    ] {
        let decision = decide(&Facts { inertial: Some(inertial), ..good() });
        assert_eq!((decision.status, decision.source), (status, Source::Snapshot), "{inertial:?}");
        assert_eq!((decision.hpl_m, decision.vpl_m), (Some(10.0), Some(15.0)));
        let alone = decide(&Facts { inertial: Some(inertial), snapshot: None, ..good() });
        assert_eq!(alone.status, Status::NotAvailable, "{inertial:?}");
    }
}

#[test]
fn a_contradiction_is_bounded_for_both_readings_and_never_ok() {
    let agreement = Some(Agreement::Contradicted { bound_m: [400.0, 20.0] });
    let decision = decide(&Facts { agreement, ..good() });
    assert_eq!((decision.status, decision.source), (Status::Degraded, Source::Snapshot));
    assert_eq!((decision.hpl_m, decision.vpl_m), (Some(400.0), Some(20.0)));
    // The evidence is in the unit: its own level.
    let decision = decide(&Facts { agreement, inertial: Some(Inertial::Implausible), ..good() });
    assert_eq!((decision.status, decision.hpl_m), (Status::Ok, Some(10.0)));
    // Agreed again without a cause: the filter is given, and neither reading is dropped.
    let open = Some(Agreement::Open { bound_m: [400.0, 20.0] });
    let decision = decide(&Facts { agreement: open, ..good() });
    assert_eq!((decision.status, decision.source, decision.hpl_m), (Status::Degraded, Source::Filter, Some(402.0)));
    // Nobody to turn to.
    assert_eq!(decide(&Facts { agreement, snapshot: None, ..good() }).status, Status::NotAvailable);
    for bound_m in [[f64::NAN; 2], [f64::INFINITY; 2]] {
        let decision = decide(&Facts { agreement: Some(Agreement::Contradicted { bound_m }), ..good() });
        assert_eq!((decision.status, decision.hpl_m), (Status::NotAvailable, None), "{bound_m:?}");
    }
}

/// The filter without satellites has the same unit.
#[test]
fn filters_that_fall_out_are_explained_by_a_unit_that_is_wrong_and_by_nothing_else() {
    let witnesses = Some(Witnesses { filters_disagree: Some(true), stations_contradict: Some(true), ..Witnesses::NONE });
    assert_eq!(decide(&Facts { witnesses, ..good() }).status, Status::NotAvailable);
    assert_eq!(decide(&Facts { witnesses, ..by_snapshot() }).status, Status::Ok);
    let missing = Some(Inertial::Missing { for_s: 20.0 });
    assert_eq!(decide(&Facts { witnesses, inertial: missing, ..good() }).status, Status::NotAvailable);
}

/// The level is that of the positions that have led the filter there.
#[test]
fn biases_that_the_unit_does_not_have_leave_no_level_until_the_unit_is_the_cause() {
    let biases = Some(Biases::Beyond);
    let decision = decide(&Facts { biases, ..good() });
    assert_eq!((decision.status, decision.source, decision.leading()), (Status::Degraded, Source::Filter, Some(Reason::ImuBias)));
    assert_eq!((decision.hpl_m, decision.vpl_m), (None, None));
    // Nothing checks it any more.
    let carried = Some(CarriedFacts { age_s: 5.0, level_m: [14.0, 20.0] });
    assert_eq!(decide(&Facts { biases, snapshot: None, carried, ..good() }).status, Status::NotAvailable);
    // A unit that has gone explains nothing, one that is wrong explains its biases.
    for (inertial, status, hpl_m) in [
        (Inertial::Missing { for_s: 20.0 }, Status::Degraded, None),
        (Inertial::Fault, Status::Ok, Some(10.0)),
        (Inertial::Implausible, Status::Ok, Some(10.0)),
    ] {
        let decision = decide(&Facts { biases, inertial: Some(inertial), ..good() });
        assert_eq!((decision.status, decision.source, decision.hpl_m), (status, Source::Snapshot, hpl_m), "{inertial:?}");
    }
}

#[test]
fn what_a_witness_says_against_the_snapshot_no_unit_explains() {
    for spoken in [Testimony::Doubts.then(Testimony::Contradicts), Testimony::Contradicts.then(Testimony::Doubts)] {
        for (stations, altimeter) in [(spoken, Testimony::Agrees), (Testimony::Silent, spoken)] {
            let witnesses = Some(Witnesses { stations, altimeter, ..good().witnesses.unwrap() });
            for facts in [by_snapshot(), Facts { inertial: Some(Inertial::Missing { for_s: 20.0 }), ..good() }] {
                let decision = decide(&Facts { witnesses, ..facts });
                assert_eq!(
                    (decision.status, decision.hpl_m, decision.vpl_m),
                    (Status::NotAvailable, None, None),
                    "{stations:?} {altimeter:?}"
                );
            }
            // A unit that came back learnt from the satellites that were in question.
            let agreement = Some(Agreement::Open { bound_m: [20.0, 20.0] });
            assert_eq!(decide(&Facts { witnesses, agreement, ..good() }).status, Status::NotAvailable);
        }
    }
    // Beside a unit and a filter that agree with the snapshot a station is outvoted; of the height nothing is claimed.
    let of = |stations, altimeter| Facts { witnesses: Some(Witnesses { stations, altimeter, ..good().witnesses.unwrap() }), ..good() };
    assert_eq!(decide(&of(Testimony::Contradicts, Testimony::Agrees)).status, Status::Ok);
    let decision = decide(&of(Testimony::Agrees, Testimony::Contradicts));
    assert_eq!((decision.status, decision.hpl_m, decision.vpl_m), (Status::Degraded, Some(12.0), None));
    // A contradiction from before the unit failed.
    let agreement = Some(Agreement::Unexplained { bound_m: [f64::INFINITY; 2] });
    assert_eq!(decide(&Facts { agreement, ..by_snapshot() }).status, Status::NotAvailable);
}

#[test]
fn without_a_snapshot_ok_and_level_last_one_and_a_half_seconds() {
    for (age_s, status) in
        [(1.0, Status::Ok), (1.5, Status::Ok), (2.0, Status::Degraded), (-1.0, Status::Degraded), (f64::NAN, Status::Degraded)]
    {
        let decision = decide(&Facts { snapshot: None, carried: Some(CarriedFacts { age_s, level_m: [14.0, 20.0] }), ..good() });
        assert_eq!((decision.status, decision.hpl_m.is_some()), (status, status == Status::Ok), "{age_s}");
    }
    let solved = SnapshotFacts { level_m: None, ..good().snapshot.unwrap() };
    let decision = decide(&Facts { snapshot: Some(solved), ..good() });
    assert_eq!((decision.status, decision.leading()), (Status::Degraded, Some(Reason::LevelMissing)));
}

#[test]
fn ids_and_numbers_of_reasons_are_each_once() {
    for (k, reason) in Reason::ALL.into_iter().enumerate() {
        assert_eq!(reason as usize, k);
        assert_eq!(Reason::ALL.iter().filter(|r| r.id() == reason.id()).count(), 1);
        let only = Reasons::NONE.with(reason);
        assert_eq!(only.iter().collect::<Vec<_>>(), [reason]);
        // A reason alone is the leading one.
        let decision =
            Decision { status: Status::Degraded, reasons: only, source: Source::None, hpl_m: None, vpl_m: None, disputed: false };
        assert_eq!(decision.leading(), Some(reason));
    }
}

fn number() -> BoxedStrategy<f64> {
    prop_oneof![
        4 => 0.0..1e3f64,
        1 => Just(f64::NAN),
        1 => Just(f64::INFINITY),
        1 => Just(-1.0),
        1 => Just(0.0),
        1 => Just(1e300),
    ]
    .boxed()
}
fn time() -> impl Strategy<Value = GpsTime> {
    let ns = prop_oneof![3 => Just(0i64), 1 => -2_000_000_000..2_000_000_000i64, 1 => Just(i64::MAX / 2), 1 => Just(499_999), 1 => Just(500_001)];
    ns.prop_map(|ns| GpsTime::from_nanoseconds(epoch().nanoseconds() + ns))
}
fn mode() -> impl Strategy<Value = Mode> {
    prop_oneof![3 => Just(Mode::Gnss), 1 => Just(Mode::DmeDme), 1 => Just(Mode::VorDme), 1 => Just(Mode::Coasting), 1 => Just(Mode::Aligning)]
}
fn pair() -> BoxedStrategy<[f64; 2]> {
    [number(), number()].boxed()
}
/// Present most of the time.
fn maybe<T: core::fmt::Debug + Clone + 'static>(of: impl Strategy<Value = T> + 'static) -> BoxedStrategy<Option<T>> {
    proptest::option::weighted(0.85, of).boxed()
}
fn inertial() -> impl Strategy<Value = Inertial> {
    prop_oneof![
        3 => Just(Inertial::Plausible),
        1 => number().prop_map(|for_s| Inertial::Missing { for_s }),
        1 => number().prop_map(|for_s| Inertial::Refused { for_s }),
        1 => Just(Inertial::Clock),
        1 => Just(Inertial::Implausible),
        1 => Just(Inertial::Fault),
    ]
}
fn agreement() -> impl Strategy<Value = Agreement> {
    prop_oneof![
        3 => Just(Agreement::Agrees),
        1 => Just(Agreement::NotCompared),
        1 => pair().prop_map(|bound_m| Agreement::Open { bound_m }),
        1 => pair().prop_map(|bound_m| Agreement::Contradicted { bound_m }),
        1 => pair().prop_map(|bound_m| Agreement::Unexplained { bound_m }),
    ]
}
fn testimony() -> impl Strategy<Value = Testimony> {
    prop_oneof![3 => Just(Testimony::Silent), 3 => Just(Testimony::Agrees), 1 => Just(Testimony::Doubts), 1 => Just(Testimony::Contradicts)]
}
prop_compose! {
    fn filter()(time in time(), position in [number(), number(), number()], variance_m2 in [number(), number(), number()], mode in mode()) -> FilterFacts {
        FilterFacts { time, position, variance_m2, mode }
    }
}
prop_compose! {
    fn snapshot()(
        time in time(),
        ranges_agree in prop_oneof![3 => Just(RangesAgree::Yes), 1 => Just(RangesAgree::No), 1 => Just(RangesAgree::Untestable)],
        level_m in maybe(pair()),
        distance_m in maybe(pair()),
    ) -> SnapshotFacts {
        SnapshotFacts { time, ranges_agree, level_m, distance_m }
    }
}
prop_compose! {
    fn facts()(
        filter in maybe(filter()),
        snapshot in maybe(snapshot()),
        carried in maybe((number(), pair()).prop_map(|(age_s, level_m)| CarriedFacts { age_s, level_m })),
        agreement in maybe(agreement()),
        inertial in maybe(inertial()),
        satellite_times_hold in maybe(proptest::bool::weighted(0.8)),
        gating in maybe(prop_oneof![2 => Just(Gating::Usual), 1 => number().prop_map(|for_s| Gating::Excess { for_s })]),
        tuning in maybe(prop_oneof![3 => Just(Tuning::AsDeclared), 1 => Just(Tuning::Foreign)]),
        biases in maybe(prop_oneof![3 => Just(Biases::AsDeclared), 1 => Just(Biases::Beyond)]),
        witnesses in maybe((maybe(proptest::bool::weighted(0.2)), maybe(proptest::bool::weighted(0.2)), testimony(), testimony()).prop_map(
            |(filters_disagree, stations_contradict, stations, altimeter)| {
                Witnesses { filters_disagree, stations_contradict, stations, altimeter }
            })),
    ) -> Facts {
        Facts { epoch: epoch(), filter, snapshot, carried, agreement, inertial, satellite_times_hold, gating, tuning, biases, witnesses }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1_000, ..ProptestConfig::default() })]

    #[test]
    fn ok_is_granted_and_never_left_over(facts in facts()) {
        let decision = decide(&facts);
        let level = [decision.hpl_m, decision.vpl_m];
        prop_assert!(level.iter().flatten().all(|l| l.is_finite() && *l >= 0.0), "a level is a number: {decision:?}");
        prop_assert_eq!(decision.reasons.is_empty() && decision.source == Source::Filter, decision.status == Status::Ok && decision.source == Source::Filter);
        if decision.source == Source::Filter {
            // Whatever the status: no position of another time, none made of numbers that are none.
            let filter = facts.filter.unwrap();
            prop_assert!((filter.time.nanoseconds() - facts.epoch.nanoseconds()).abs() <= 500_000);
            prop_assert!(filter.position.iter().chain(&filter.variance_m2).all(|x| x.is_finite()));
        }
        if decision.source == Source::Snapshot {
            prop_assert!((facts.snapshot.unwrap().time.nanoseconds() - facts.epoch.nanoseconds()).abs() <= 500_000);
        }
        if decision.status == Status::Ok {
            prop_assert!(level.iter().all(Option::is_some));
            prop_assert_eq!(facts.satellite_times_hold, Some(true));
            let explained = matches!(facts.inertial, Some(Inertial::Fault | Inertial::Implausible)) && decision.source == Source::Snapshot;
            prop_assert!(explained || facts.witnesses.unwrap().filters_disagree != Some(true));
            let checked = facts.snapshot.is_some_and(|s| s.ranges_agree == RangesAgree::Yes) || facts.carried.is_some_and(|c| c.age_s <= CARRIED_MOST_S);
            prop_assert!(checked);
        }
        if decision.status != Status::Ok {
            prop_assert!(!decision.reasons.is_empty(), "what is not ok says why");
        }
    }

    /// A witness or a snapshot more may take `ok` away; it cannot give it where the filter was refused for another reason.
    #[test]
    fn a_witness_more_never_makes_ok(facts in facts(), disagree: bool, contradict: bool, stations in testimony(), altimeter in testimony()) {
        let mut fewer = facts;
        if let Some(w) = &mut fewer.witnesses {
            *w = Witnesses::NONE;
        }
        let mut more = fewer;
        if let Some(w) = &mut more.witnesses {
            *w = Witnesses { filters_disagree: Some(disagree), stations_contradict: Some(contradict), stations, altimeter };
        }
        prop_assert!(decide(&more).status <= decide(&fewer).status);
    }

    /// A fact that nobody reports any more never makes `ok`.
    #[test]
    fn a_fact_less_never_makes_ok(facts in facts(), which in 0..WITHOUT.len()) {
        let mut fewer = facts;
        WITHOUT[which](&mut fewer);
        let (before, after) = (decide(&facts), decide(&fewer));
        // Without filter or unit the snapshot may stand in, by its own test.
        prop_assert!(after.status < Status::Ok || before.status == Status::Ok || after.source == Source::Snapshot, "{before:?} {after:?}");
    }
}
