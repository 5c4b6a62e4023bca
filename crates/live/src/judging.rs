//! One released record under the judge of its track.

use crate::order::Arrived;
use crate::output::{EpochOut, Kind, Output, Transition, Turn};
use crate::position::{Position, TrackId};
use crate::settings::Settings;
use crate::track::Track;
use navbound_core::bound::{AlertBound, anp};
use navbound_core::frame::{Covariance, LatLon, counts_as_zero};
use navbound_core::judge::{Evaluated, Judged, Sample};
use navbound_core::monitor::balance::{At, Balance};
use navbound_core::monitor::drift::{Drift, Led};
use navbound_core::monitor::motion::{Finding, Motion, Report};
use navbound_core::monitor::neighbours::{Height, Neighbours, Place};
use navbound_core::monitor::rnp::{Acceptance, Event};
use navbound_core::quantity::{GpsTime, Metres, Radians, Reason, Status, Unavailable};
use navbound_core::solution::plausible::HEIGHT_M;
use navbound_formats::measured::DETERMINING_SATELLITES;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// What decided an alert: a time of the data, and the arrival of the input behind it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cause {
    pub(crate) event: GpsTime,
    pub(crate) arrival: Option<GpsTime>,
}

/// A record as the judge takes it. A record that is not usable says why, and one without a covariance is not.
fn sample(settings: &Settings, track: &mut Track, position: &Position) -> (Sample, Option<Reason>) {
    let point = position.lat_rad.zip(position.lon_rad).map(|(lat, lon)| LatLon::new(Radians::new(lat), Radians::new(lon)));
    let mut reason = position.reason;
    let mut refuse = |why: Reason| reason = reason.or(Some(why));
    // A direction of several turns is none.
    let stated = position.course_rad.map(|course| Radians::new(course).course().map_or(f64::NAN, Radians::rad));
    let (mut fte_m, mut course) = (position.fte_m, stated.or(position.fte_m.map(|_| 0.0)).map(Radians::new));
    // A deviation is part of the total error. A track that stated one once and states none later is not judged without it.
    let (id, path) = (position.track, settings.path_of(position.track));
    let stated_or_assigned = settings.table.path(id).is_some() || (path.is_none() && position.fte_m.is_some());
    if let Some(method) = settings.of_stated_fte.filter(|_| stated_or_assigned) {
        track.judge.judge_by(method);
    }
    // Whatever its source says, fewer satellites determine no position: something else keeps it.
    if position.status == Status::Ok && position.shown.n_sv.is_some_and(|n| n < f64::from(DETERMINING_SATELLITES)) {
        refuse(Reason::FewSatellites);
    }
    if position.h_m.is_some_and(|h| h < HEIGHT_M.0 || h > HEIGHT_M.1) {
        refuse(Reason::InvalidNumber);
    }
    let mut covariance_m2 = position.covariance_m2;
    match (path, point) {
        (_, Some(Err(_))) => refuse(Reason::InvalidNumber),
        (Some(path), Some(Ok(point))) => match path.project(&point, track.along) {
            Ok(foot) => {
                track.along = Some(foot.along);
                (fte_m, course) = (Some(foot.cross.m()), Some(foot.course));
            }
            Err(_) => refuse(Reason::InvalidNumber),
        },
        // What another path deviates from says nothing of this one.
        (Some(_), None) => (fte_m, course) = (None, None),
        // Across a path of unknown direction the error may be the largest of any.
        (None, _) if stated.is_none() && fte_m.is_some() => covariance_m2 = covariance_m2.map(in_every_direction),
        (None, _) => {}
    }
    match position.covariance_m2 {
        None => refuse(Reason::NoCovariance),
        Some([.., uu]) if uu < 0.0 && !counts_as_zero(uu) => refuse(Reason::NotACovariance),
        Some([ee, _, nn, .., uu]) if [ee, nn, uu].into_iter().any(counts_as_zero) => {
            refuse(Reason::ZeroCovariance);
            // In the plane it bounds nothing, so that no alert rests on it.
            covariance_m2 = covariance_m2.filter(|_| ![ee, nn].into_iter().any(counts_as_zero));
        }
        Some(_) => {}
    }
    // What a track stated once the settings do not stand in for later: a record without it has no limit.
    track.states_rnp |= position.rnp_m.is_some();
    let in_force = || settings.table.rnp(id, position.lat_rad.zip(position.lon_rad)).unwrap_or(settings.rnp);
    let rnp = if track.states_rnp { Metres::new(position.rnp_m.unwrap_or(f64::NAN)) } else { in_force() };
    let sample = Sample {
        time: position.time,
        status: reason.filter(|_| position.status.usable()).map_or(position.status, Reason::status),
        course,
        path_angle: None,
        fte_m,
        fte_v_m: None,
        covariance: covariance_m2.map(Covariance::from_upper),
        nse_en_m: None,
        nse_u_m: None,
        rnp: Some(rnp),
        hpl: position.hpl_m.map(Metres::new),
    };
    (sample, reason)
}

/// The covariance with the largest horizontal variance of any direction in each; one that has the same in all stays as it is, to the bit.
fn in_every_direction([ee, en, nn, eu, nu, uu]: [f64; 6]) -> [f64; 6] {
    let largest = 0.5 * (ee + nn) + f64::hypot(0.5 * (ee - nn), en);
    if ee == nn && en == 0.0 { [ee, en, nn, eu, nu, uu] } else { [largest, 0.0, largest, 0.0, 0.0, uu] }
}

/// Whether a number that a bound is made of is there and is no number.
fn stated_as_none(position: &Position) -> bool {
    let horizontal = position.covariance_m2.iter().flat_map(|terms| &terms[..3]);
    horizontal.chain(&position.fte_m).any(|number| number.is_nan())
}

/// The record without its position where the track cannot have moved there, or has not moved.
fn believed(settings: &Settings, track: &mut Track, position: &Position) -> Position {
    let place = position.lat_rad.zip(position.lon_rad).filter(|_| position.status.usable());
    let Some((lat_rad, lon_rad)) = place else { return *position };
    // A source that has no position yet writes zeros; no track stands on that point to the last bit.
    if (lat_rad, lon_rad) == (0.0, 0.0) {
        return position.without(Reason::Reported);
    }
    let speed_mps = position.ground_speed_mps.unwrap_or(f64::NAN);
    let variance_m2 = position.covariance_m2.map(|[ee, _, nn, ..]| ee.max(nn));
    let up = |h_m| Height { h_m, variance_m2: position.covariance_m2.map_or(f64::NAN, |[.., uu]| uu) };
    let report = Report {
        time: position.time,
        fixed: None,
        lat_rad,
        lon_rad,
        speed_mps,
        variance_m2: variance_m2.unwrap_or(f64::NAN),
        height: position.h_m.filter(|h_m| h_m.is_finite()).map(up),
    };
    // A place off the Earth is refused where it is projected, or is no covariance's.
    let aged = Report { time: position.time.plus_seconds(position.age_s), fixed: Some(position.time), ..report };
    let finding = track.motion.see(&report, &settings.motion).map(|finding| aged.with_age(finding, &settings.motion));
    let finding = finding.map_or(Some(Reason::InvalidNumber), Finding::reason);
    let mut restless = || {
        let place = Place { time: position.time, lat_rad, lon_rad, variance_m2: variance_m2? };
        track.neighbours.contradict(place, settings.motion.stale_after_s).then_some(Reason::NeighboursContradict)
    };
    // A position that is merely late may contradict those before it all the same: the graver word counts.
    let reason = if finding == Some(Reason::PositionLate) { restless().or(finding) } else { finding.or_else(restless) };
    // What is doubted by itself is no part of the way; the time goes on over it. What is behind, or drifts, does so where it is held besides.
    if reason.is_none() {
        follow(track, position, [lat_rad, lon_rad, speed_mps]);
    }
    let reason = if reason.is_none_or(|reason| reason.status().usable()) { led_off(track).or(reason) } else { reason };
    reason.map_or(*position, |reason| position.without(reason))
}

/// The way of the track goes on to a place that is believed.
fn follow(track: &mut Track, position: &Position, [lat_rad, lon_rad, speed_mps]: [f64; 3]) {
    let at = At { time_ns: position.time.nanoseconds(), lat_rad, lon_rad, speed_mps };
    track.balance.see(at);
    let track_rad = position.ground_track_rad.unwrap_or(f64::NAN);
    let sigma_m = position.covariance_m2.map_or(0.0, |[ee, _, nn, ..]| (ee + nn).sqrt());
    let sigma_m = if sigma_m.is_finite() { sigma_m } else { 0.0 };
    track.drift.see(Led { at, track_rad, sigma_m });
}

/// Why nothing of the track is believed any more.
fn led_off(track: &Track) -> Option<Reason> {
    let behind = track.balance.behind_m().map(|_| Reason::PositionStale);
    behind.or_else(|| track.drift.drifted().map(|_| Reason::DirectionContradicts))
}

/// Judges a record and says what became of it. A fault of ours makes this epoch of this track unusable, and nothing else; whether one happened.
pub(crate) fn judge(settings: &Settings, id: TrackId, track: &mut Track, arrived: &Arrived, out: &mut Vec<Output>, fault: bool) -> bool {
    let position = settings.assumed.map_or(arrived.position, |assumed| assumed.completed(&arrived.position, &mut track.stated));
    let position = &believed(settings, track, &position);
    let (seen, mut reason) = sample(settings, track, position);
    let before = track.judge;
    let attempt = catch_unwind(AssertUnwindSafe(|| {
        assert!(!fault, "a fault that a test injects");
        let evaluated = track.judge.settings().evaluate(&seen);
        // A source that calls an epoch usable and states a number of it as none contradicts itself: nothing is within a limit then.
        let status = if stated_as_none(position) { seen.status } else { evaluated.status };
        track.judge.follow(&seen, Evaluated { status, ..evaluated })
    }));
    let failed = attempt.is_err();
    let (seen, judged) = match attempt {
        Ok(judged) => (seen, judged),
        Err(_) => {
            track.judge = before;
            reason = Some(Reason::FilterStopped);
            let unusable = Sample { status: Status::NotAvailable, covariance: None, hpl: None, ..seen };
            (unusable, track.judge.step(&unusable))
        }
    };
    if judged.step.acceptance == Acceptance::Duplicate && !judged.evaluated.status.usable() {
        track.motion.dispute(position.time);
    }
    if judged.step.acceptance == Acceptance::ClockSetBack {
        track.incarnation = track.incarnation.saturating_add(1);
        (track.motion, track.neighbours) = (Motion::default(), Neighbours::default());
        (track.balance, track.drift) = (Balance::default(), Drift::default());
    }
    if matches!(judged.step.acceptance, Acceptance::Accepted | Acceptance::ClockSetBack) {
        let next = track.last.map(|last| last.plus_seconds(settings.judge.monitor.chain.sample_period_s));
        (track.stepped, track.last) = (next == Some(position.time), Some(position.time));
        track.silent = false;
    }
    let caution_in_s = track.judge.monitor().caution_in_s();
    out.push(Output::Epoch(epoch(settings, arrived, &seen, &Ended { judged, reason, caution_in_s })));
    let cause = Cause { event: position.time, arrival: arrived.arrival };
    let [caution, warning, lost] = judged.step.began;
    begin(id, track, lost, cause, out);
    judged.step.ended.iter().for_each(|event| end(id, track, event.as_ref(), Turn::Cleared, cause, out));
    begin(id, track, caution, cause, out);
    begin(id, track, warning, cause, out);
    failed
}

/// What became of a record.
struct Ended {
    judged: Judged,
    reason: Option<Reason>,
    caution_in_s: Option<f64>,
}

/// Bounds of the navigation error at the accuracy risk across the path, in the plane and upwards \[m\]; NaN where there is none.
const ANP: [&str; 3] = ["anp-cross", "anp-circle", "anp-vertical"];

fn performance(settings: &Settings, seen: &Sample) -> [f64; 3] {
    let epoch = seen.epoch();
    ANP.map(|id| {
        let method = anp::METHODS.iter().find(|method| method.id == id);
        method.and_then(|method| (method.bound)(&epoch, settings.judge.accuracy).ok()).map_or(f64::NAN, Metres::m)
    })
}

fn epoch(settings: &Settings, arrived: &Arrived, seen: &Sample, ended: &Ended) -> EpochOut {
    let Ended { judged, reason, caution_in_s } = ended;
    let of = &judged.evaluated;
    let bound = |bound: &Option<Result<AlertBound, Unavailable>>| bound.and_then(Result::ok).map_or(f64::NAN, |b| b.length().m());
    let none = of.accuracy.and_then(Result::err).map(|why| why.reason());
    let known = |number: Option<f64>| number.unwrap_or(f64::NAN);
    let category = |stated: Option<u8>| stated.map_or(f64::NAN, f64::from);
    let (position, shown) = (&arrived.position, &arrived.position.shown);
    let [ee, en, nn] = seen.covariance.map_or([f64::NAN; 3], |c| [(0, 0), (0, 1), (1, 1)].map(|at| c.matrix()[at]));
    let [across, circle, upwards] = performance(settings, seen);
    EpochOut {
        track: position.track,
        time: position.time,
        arrival: arrived.arrival,
        status: of.status,
        reason: (*reason).or(none),
        acceptance: judged.step.acceptance,
        alert: judged.step.alert,
        numbers: [
            bound(&of.accuracy),
            bound(&of.integrity),
            judged.integrity_compared.m(),
            known(seen.rnp.map(Metres::m)),
            known(seen.fte_m),
            known(of.errors.sigma_cross_m),
            known(position.hpl_m),
            known(position.lat_rad),
            known(position.lon_rad),
            known(position.h_m),
            // Height above another path says nothing of this one.
            known(shown.fte_v_m.filter(|_| settings.path_of(position.track).is_none())),
            known(seen.course.map(Radians::rad)),
            ee,
            en,
            nn,
            across,
            circle,
            upwards,
            known(shown.vpl_m),
            known(shown.hal_m),
            known(shown.val_m),
            known(shown.n_sv),
            known(*caution_in_s),
            category(shown.claim.nic),
            category(shown.claim.nac_p),
            category(shown.claim.sil),
        ],
        nav_mode: shown.nav_mode,
    }
}

/// An alert that was raised.
pub(crate) fn begin(id: TrackId, track: &mut Track, event: Option<Event>, cause: Cause, out: &mut Vec<Output>) {
    let Some(event) = event else { return };
    let (kind, incarnation) = (Kind::of(event.kind), track.incarnation);
    if let Some(open) = track.open_mut(kind) {
        *open = Some((incarnation, event.annunciation));
    }
    out.push(transition(id, incarnation, Turn::Raised, event.annunciation, &event, cause));
}

/// An alert that is over; its key is that of its raise, whatever the clock of the track did since.
pub(crate) fn end(id: TrackId, track: &mut Track, event: Option<&Event>, turn: Turn, cause: Cause, out: &mut Vec<Output>) {
    let Some(event) = event else { return };
    let own = (track.incarnation, event.annunciation);
    let (incarnation, annunciation) = track.open_mut(Kind::of(event.kind)).and_then(Option::take).unwrap_or(own);
    out.push(transition(id, incarnation, turn, annunciation, event, cause));
}

fn transition(id: TrackId, incarnation: u32, turn: Turn, annunciation: GpsTime, event: &Event, cause: Cause) -> Output {
    let blank = Transition {
        track: Some(id),
        incarnation,
        kind: Kind::of(event.kind),
        turn,
        annunciation,
        onset: event.onset,
        clear: None,
        peak_m: f64::NAN,
        limit_m: f64::NAN,
        min_margin_m: f64::NAN,
        event: cause.event,
        arrival: cause.arrival,
    };
    Output::Transition(blank.with_event(event))
}
