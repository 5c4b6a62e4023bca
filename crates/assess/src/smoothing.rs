//! Pseudoranges of a recording smoothed by their carrier, channel by channel through time.

use navbound_core::quantity::Metres;
use navbound_core::signal::smoothing::{Channel, PhasePair, Smoothing, divergence_free};
use navbound_core::signal::{Carrier, Constellation, SatelliteId};
use navbound_formats::rinex::{Code, Observations};

const SYSTEMS: usize = Constellation::ALL.len();
/// Satellite numbers of a constellation.
const NUMBERS: usize = 100;
/// Loss of lock since the last epoch, bit 0 of the indicator (RINEX 3.05, table A15).
const LOST: u8 = 1;

/// Which phase goes with a code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// That of its own carrier: the ionosphere moves code and phase apart, by twice its change within the window.
    Single,
    /// That of two carriers, free of divergence; without a second carrier the code stays as it is.
    DivergenceFree,
}

/// Values of a recording with its pseudoranges smoothed.
pub struct Smoothed {
    value: Vec<f64>,
    /// Variance of the code noise that is left of each value's.
    noise_share: Vec<f32>,
    n_smoothed: usize,
    n_codes: usize,
}

impl Smoothed {
    /// Values of a satellite, as [`Observations::values`].
    pub fn values(&self, observations: &Observations, satellite: usize) -> &[f64] {
        &self.value[observations.value_range(satellite)]
    }
    /// Variance of the code noise without memory that smoothing left of each value's, 1 for one that is as measured.
    pub fn noise_shares(&self, observations: &Observations, satellite: usize) -> &[f32] {
        &self.noise_share[observations.value_range(satellite)]
    }
    /// Share of the pseudoranges that an arc of phase supports; those that begin one are as measured.
    pub fn share(&self) -> f64 {
        if self.n_codes == 0 { f64::NAN } else { self.n_smoothed as f64 / self.n_codes as f64 }
    }
}

/// A code and the phases that may go with it: columns of its constellation's values.
struct Track {
    code: usize,
    own: Vec<usize>,
    carrier: Carrier,
    second: Vec<(usize, Carrier)>,
}

/// Where a channel stands; a change of the phase used is a loss of lock.
#[derive(Clone, Copy, Default)]
struct State {
    channel: Channel,
    pair: PhasePair,
    used: Option<(usize, usize)>,
}

/// Smooth the given codes (columns of each constellation's values).
pub fn smooth(observations: &Observations, codes: &[Vec<usize>; SYSTEMS], form: Form, how: &Smoothing) -> Smoothed {
    let tracks: Vec<Vec<Track>> =
        (0..SYSTEMS).map(|system| codes[system].iter().filter_map(|c| track(observations, system, *c)).collect()).collect();
    let mut states: Vec<Vec<State>> = tracks.iter().map(|t| vec![State::default(); NUMBERS * t.len()]).collect();
    let mut smoothed =
        Smoothed { noise_share: vec![1.0; observations.value.len()], value: observations.value.clone(), n_smoothed: 0, n_codes: 0 };
    for epoch in 0..observations.n_epochs() {
        for k in observations.satellites(epoch) {
            let satellite = observations.satellite[k];
            let system = satellite.constellation.index();
            let n = tracks[system].len();
            for (j, track) in tracks[system].iter().enumerate() {
                let Some(state) = states[system].get_mut(slot(satellite) * n + j) else { continue };
                smoothed.step(observations, (epoch, k), track, state, form, how);
            }
        }
    }
    smoothed
}

fn slot(satellite: SatelliteId) -> usize {
    usize::from(satellite.number) % NUMBERS
}

fn track(observations: &Observations, system: usize, code: usize) -> Option<Track> {
    let constellation = Constellation::from_index(system)?;
    let [_, band, _] = *observations.codes[system].get(code)?;
    let own = own_phases(observations, system, code);
    let second = other_phases(observations, system, code);
    let carrier = Carrier::from_band(constellation, band)?;
    (!own.is_empty()).then_some(Track { code, own, carrier, second })
}

/// Columns of the phases of a code's own carrier: the same signal's first, then any.
pub(crate) fn own_phases(observations: &Observations, system: usize, code: usize) -> Vec<usize> {
    let codes = &observations.codes[system];
    let Some([_, band, attribute]) = codes.get(code) else { return Vec::new() };
    let of = |same: bool| {
        let serves = move |c: &Code| c[0] == b'L' && c[1] == *band && (c[2] == *attribute) == same;
        codes.iter().enumerate().filter(move |(_, c)| serves(c)).map(|(k, _)| k)
    };
    of(true).chain(of(false)).collect()
}

/// Columns of the phases of other carriers than a code's, with theirs.
pub(crate) fn other_phases(observations: &Observations, system: usize, code: usize) -> Vec<(usize, Carrier)> {
    let codes = &observations.codes[system];
    let of = Constellation::from_index(system).zip(codes.get(code));
    let Some((constellation, [_, band, _])) = of else { return Vec::new() };
    let phases = codes.iter().enumerate().filter(|(_, c)| c[0] == b'L' && c[1] != *band);
    phases.filter_map(|(k, c)| Some((k, Carrier::from_band(constellation, c[1])?))).collect()
}

/// Whether the receiver flags a loss of lock at a value, by its place among all values.
pub(crate) fn lost(observations: &Observations, place: usize) -> bool {
    (observations.indicator[place] >> 4) & LOST != 0
}

impl Smoothed {
    fn step(&mut self, o: &Observations, (epoch, k): (usize, usize), track: &Track, state: &mut State, form: Form, how: &Smoothing) {
        let at = o.value_range(k).start;
        let code = self.value[at + track.code];
        if code.is_nan() {
            return;
        }
        self.n_codes += 1;
        let there = |column: usize| !o.value[at + column].is_nan();
        let first = track.own.iter().copied().find(|c| there(*c));
        let second = track.second.iter().copied().find(|(c, _)| there(*c));
        let metres = |column: usize, carrier: Carrier| Metres::new(o.value[at + column] * carrier.wavelength_m());
        let lock = |column: usize| lost(o, at + column);
        let (phase, used, mut broken) = match (form, first, second) {
            (Form::Single, Some(f), _) => (metres(f, track.carrier), Some((f, f)), lock(f)),
            (Form::DivergenceFree, Some(f), Some((s, carrier))) => {
                let (one, two) = (metres(f, track.carrier), metres(s, carrier));
                let slipped = state.pair.slipped(o.time[epoch], Metres::new(one.m() - two.m()));
                (divergence_free((track.carrier, one), (carrier, two)), Some((f, s)), slipped || lock(f) || lock(s))
            }
            _ => (Metres::new(f64::NAN), None, true),
        };
        broken |= o.interrupted[epoch] || used != state.used;
        state.used = used;
        let smoothed = state.channel.smoothed(how, o.time[epoch], Metres::new(code), phase, broken).m();
        self.n_smoothed += usize::from(smoothed != code);
        self.value[at + track.code] = smoothed;
        self.noise_share[at + track.code] = state.channel.noise_share() as f32;
    }
}
