//! One position report, whatever format it came in.

use crate::claims::{Bounds, Claim};
use crate::codec::{Damaged, Reader, Writer};
use navbound_core::quantity::{GpsTime, Reason, Status};

/// Name of a track: 1 to 32 bytes of printable ASCII, without blanks and `/`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct TrackId {
    length: u8,
    bytes: [u8; 32],
}

impl TrackId {
    /// A name; `None` for one that no track may have. Text from the air becomes part of keys and pages, so the alphabet is small.
    pub fn new(name: &str) -> Option<Self> {
        let allowed = (1..=32).contains(&name.len()) && name.bytes().all(|b| b.is_ascii_graphic() && b != b'/');
        let mut bytes = [0; 32];
        bytes.get_mut(..name.len()).filter(|_| allowed)?.copy_from_slice(name.as_bytes());
        Some(Self { length: name.len() as u8, bytes })
    }

    /// The name.
    pub fn name(&self) -> &str {
        self.bytes.get(..usize::from(self.length)).and_then(|bytes| core::str::from_utf8(bytes).ok()).unwrap_or("")
    }

    pub(crate) fn write(&self, to: &mut Writer) {
        to.bytes(self.name().as_bytes());
    }

    pub(crate) fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        let name = core::str::from_utf8(from.bytes()?).ok();
        name.and_then(Self::new).ok_or(Damaged("not the name of a track"))
    }
}

/// A position report; what it does not state is `None`, and a number that it states as none is NaN.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Position {
    /// Whose.
    pub track: TrackId,
    /// Time of applicability.
    pub time: GpsTime,
    /// How old the position was when its source reported it \[s\]; 0 where it does not say so.
    pub age_s: f64,
    /// Whether the position may be used.
    pub status: Status,
    /// Why it has this status, where that is not the source's own word.
    pub reason: Option<Reason>,
    /// Latitude \[rad\].
    pub lat_rad: Option<f64>,
    /// Longitude \[rad\].
    pub lon_rad: Option<f64>,
    /// Height above the ellipsoid \[m\].
    pub h_m: Option<f64>,
    /// Flight technical error, positive right of the path \[m\].
    pub fte_m: Option<f64>,
    /// Course of the path \[rad\].
    pub course_rad: Option<f64>,
    /// Speed over the ground, by which the motion of the positions is judged \[m/s\].
    pub ground_speed_mps: Option<f64>,
    /// Track over the ground from true north, by which the direction of that motion is judged \[rad\].
    pub ground_track_rad: Option<f64>,
    /// Covariance ee, en, nn, eu, nu, uu \[m²\].
    pub covariance_m2: Option<[f64; 6]>,
    /// Horizontal protection level \[m\].
    pub hpl_m: Option<f64>,
    /// RNP value in force \[m\].
    pub rnp_m: Option<f64>,
    /// What is shown beside the judgement.
    pub shown: Shown,
}

/// What the source states and nothing is judged by: it goes to the journal out as it came.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Shown {
    /// Flight technical error above the path \[m\].
    pub fte_v_m: Option<f64>,
    /// Vertical protection level \[m\].
    pub vpl_m: Option<f64>,
    /// Horizontal alert limit \[m\].
    pub hal_m: Option<f64>,
    /// Vertical alert limit \[m\].
    pub val_m: Option<f64>,
    /// Satellites used.
    pub n_sv: Option<f64>,
    /// What keeps the position, in a word of the alphabet of tracks.
    pub nav_mode: Option<TrackId>,
    /// Categories that the aircraft claims.
    pub claim: Claim,
}

impl Shown {
    fn write(&self, to: &mut Writer) {
        for number in [self.fte_v_m, self.vpl_m, self.hal_m, self.val_m, self.n_sv] {
            to.option(number, Writer::f64);
        }
        to.option(self.nav_mode, |to, mode| mode.write(to));
        [self.claim.nic, self.claim.nac_p, self.claim.sil].into_iter().for_each(|category| to.option(category, Writer::u8));
    }

    fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        let mut number = || from.option(Reader::f64);
        let (fte_v_m, vpl_m, hal_m, val_m, n_sv) = (number()?, number()?, number()?, number()?, number()?);
        let nav_mode = from.option(TrackId::read)?;
        let claim = Claim { nic: from.option(Reader::u8)?, nac_p: from.option(Reader::u8)?, sil: from.option(Reader::u8)? };
        Ok(Self { fte_v_m, vpl_m, hal_m, val_m, n_sv, nav_mode, claim })
    }
}

impl Position {
    /// A report of nothing but its time.
    pub const fn new(track: TrackId, time: GpsTime) -> Self {
        Self {
            track,
            time,
            age_s: 0.0,
            status: Status::Ok,
            reason: None,
            lat_rad: None,
            lon_rad: None,
            h_m: None,
            fte_m: None,
            course_rad: None,
            ground_speed_mps: None,
            ground_track_rad: None,
            covariance_m2: None,
            hpl_m: None,
            rnp_m: None,
            shown: Shown {
                fte_v_m: None,
                vpl_m: None,
                hal_m: None,
                val_m: None,
                n_sv: None,
                nav_mode: None,
                claim: Claim { nic: None, nac_p: None, sil: None },
            },
        }
    }

    /// What it says is not usable, and why.
    #[must_use]
    pub const fn without(self, reason: Reason) -> Self {
        Self { status: reason.status(), reason: Some(reason), ..self }
    }

    /// With the bounds that its aircraft claims, or without a use for what it does not claim.
    #[must_use]
    pub(crate) fn bounded(self, bounds: Result<Bounds, Reason>) -> Self {
        match bounds {
            Ok(bounds) => Self { covariance_m2: Some(bounds.covariance_m2()), hpl_m: Some(bounds.containment_m), ..self },
            Err(reason) => self.without(reason),
        }
    }

    /// Whether it repeats another to the last bit.
    pub(crate) fn same_as(&self, other: &Self) -> bool {
        let bytes = |p: &Self| {
            let mut to = Writer::default();
            p.write(&mut to);
            to.0
        };
        self.time == other.time && bytes(self) == bytes(other)
    }

    pub(crate) fn write(&self, to: &mut Writer) {
        self.track.write(to);
        to.i64(self.time.nanoseconds());
        to.f64(self.age_s);
        to.u8(self.status as u8);
        to.option(self.reason, |to, reason| to.u8(reason as u8));
        let of_motion = [self.lat_rad, self.lon_rad, self.h_m, self.fte_m, self.course_rad, self.ground_speed_mps, self.ground_track_rad];
        of_motion.into_iter().chain([self.hpl_m, self.rnp_m]).for_each(|number| to.option(number, Writer::f64));
        to.option(self.covariance_m2, |to, covariance| covariance.into_iter().for_each(|term| to.f64(term)));
        self.shown.write(to);
    }

    pub(crate) fn read(from: &mut Reader<'_>) -> Result<Self, Damaged> {
        let (track, time, age_s) = (TrackId::read(from)?, GpsTime::from_nanoseconds(from.i64()?), from.f64()?);
        let status = status(from)?;
        let reason = from.option(reason)?;
        let mut number = || from.option(Reader::f64);
        let (lat_rad, lon_rad, h_m, fte_m) = (number()?, number()?, number()?, number()?);
        let (course_rad, ground_speed_mps, ground_track_rad, hpl_m, rnp_m) = (number()?, number()?, number()?, number()?, number()?);
        let covariance_m2 = from.option(|from| {
            let mut terms = [0.0; 6];
            for term in &mut terms {
                *term = from.f64()?;
            }
            Ok(terms)
        })?;
        let shown = Shown::read(from)?;
        Ok(Self {
            track,
            time,
            age_s,
            status,
            reason,
            lat_rad,
            lon_rad,
            h_m,
            fte_m,
            course_rad,
            ground_speed_mps,
            ground_track_rad,
            covariance_m2,
            hpl_m,
            rnp_m,
            shown,
        })
    }
}

pub(crate) fn status(from: &mut Reader<'_>) -> Result<Status, Damaged> {
    Status::ALL.get(usize::from(from.u8()?)).copied().ok_or(Damaged("no such status"))
}

pub(crate) fn reason(from: &mut Reader<'_>) -> Result<Reason, Damaged> {
    Reason::ALL.get(usize::from(from.u8()?)).copied().ok_or(Damaged("no such reason"))
}
