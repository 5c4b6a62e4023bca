//! DME/DME and VOR/DME over many epochs: positions, what a flight would have, what a network covers.

use crate::batch::Rejected;
use crate::parallel;
use navbound_core::bound::anp::circle;
use navbound_core::frame::{Covariance, Enu, Geodetic, LatLon};
use navbound_core::quantity::{GpsTime, Metres, OutOfDomain, Radians, Risk};
use navbound_core::solution::dme::{
    Admission, Altitude, Best, Checked, Figure, Fix, Horizon, NoFix, Pair, Place, Prior, Range, RangeModel, Selector, Sight, Station,
    Switching, Verdict, VorRange, all_in_view, best_pair, solve_checked, vor_dme, vor_fix,
};

/// Items a thread takes at a time: about a millisecond of work.
const CHUNK: usize = 64;

/// What the models say; the standard ones unless stated otherwise.
#[derive(Debug, Clone, Copy)]
pub struct Models {
    /// Deviations of ranges.
    pub range: RangeModel,
    /// Which pairs may be used.
    pub admission: Admission,
    /// How far radio reaches.
    pub horizon: Horizon,
    /// Standard deviation of a VOR bearing.
    pub sigma_bearing: Radians,
    /// Standard deviation of the altitude.
    pub sigma_altitude: Metres,
}

impl Models {
    /// The standard ones, with a VOR's and an altimeter's deviation.
    pub const fn standard(sigma_bearing: Radians, sigma_altitude: Metres) -> Self {
        Self { range: RangeModel::STANDARD, admission: Admission::STANDARD, horizon: Horizon::STANDARD, sigma_bearing, sigma_altitude }
    }
}

/// Positions of a place list, as arrays.
#[derive(Debug, Clone, Copy)]
pub struct Places<'a> {
    /// Latitudes \[rad\].
    pub lat: &'a [f64],
    /// Longitudes \[rad\].
    pub lon: &'a [f64],
    /// Heights above the ellipsoid \[m\].
    pub h: &'a [f64],
}

impl Places<'_> {
    /// How many.
    pub const fn len(&self) -> usize {
        self.lat.len()
    }
    /// None at all.
    pub const fn is_empty(&self) -> bool {
        self.lat.is_empty()
    }
    /// One of them.
    ///
    /// # Errors
    /// [`OutOfDomain`] for a latitude, longitude or height that is none.
    pub fn at(&self, i: usize) -> Result<Place, OutOfDomain> {
        let point = LatLon::new(Radians::new(self.lat[i]), Radians::new(self.lon[i]))?;
        Place::new(Geodetic { point, height: Metres::new(self.h[i]) })
    }
    /// All of them.
    ///
    /// # Errors
    /// The first that is none.
    pub fn all(&self) -> Result<Vec<Place>, Rejected> {
        (0..self.len()).map(|index| self.at(index).map_err(|reason| Rejected { index, reason })).collect()
    }
}

/// Measured ranges of many epochs, row after row.
#[derive(Debug, Clone, Copy)]
pub struct Ranges<'a> {
    /// Stations, one a column.
    pub stations: &'a [Place],
    /// Slant ranges, NaN where none was received \[m\].
    pub slant: &'a [f64],
    /// Their standard deviations; of the standard model where there are none \[m\].
    pub sigma: Option<&'a [f64]>,
    /// Height above the ellipsoid, by epoch \[m\].
    pub h: &'a [f64],
    /// Standard deviation of the heights \[m\].
    pub sigma_altitude: Metres,
    /// Latitude and longitude known beforehand, by epoch, NaN where none is \[rad\]; and how far off they may be.
    pub prior: Option<(&'a [f64], &'a [f64], Metres)>,
    /// Residuals that are less likely than this contradict the deviations.
    pub residual_risk: Risk,
}

/// Positions of all epochs; an excluded range is named by the column of its station.
///
/// # Errors
/// The first epoch with a number outside its domain.
pub fn fixes(job: &Ranges) -> Result<Vec<Result<Checked, NoFix>>, Rejected> {
    many(job.h.len(), |i| match one(job, i) {
        Err(NoFix::Invalid(reason)) => Err(reason),
        outcome => Ok(outcome),
    })
}

fn one(job: &Ranges, i: usize) -> Result<Checked, NoFix> {
    let width = job.stations.len();
    let row = i * width..(i + 1) * width;
    let (mut ranges, mut columns) = (Vec::with_capacity(width), Vec::with_capacity(width));
    for (k, (station, slant)) in job.stations.iter().zip(&job.slant[row.clone()]).enumerate().filter(|(_, (_, s))| !s.is_nan()) {
        let slant = Metres::new(*slant);
        let sigma = match job.sigma {
            Some(course) => Metres::new(course[row.start + k]),
            None => RangeModel::STANDARD.sigma(slant)?,
        };
        ranges.push(Range { station: *station.ecef(), slant, sigma });
        columns.push(k);
    }
    let altitude = Altitude { height: Metres::new(job.h[i]), sigma: job.sigma_altitude };
    let prior = match job.prior {
        Some((lat, lon, within)) if !(lat[i].is_nan() && lon[i].is_nan()) => {
            let point = LatLon::new(Radians::new(lat[i]), Radians::new(lon[i]))?;
            Some(Prior { position: Geodetic { point, height: altitude.height }, within })
        }
        _ => None,
    };
    let mut solution = solve_checked(&mut ranges, &altitude, prior.as_ref(), job.residual_risk)?;
    if let Verdict::Excluded(place) = &mut solution.verdict {
        *place = columns[*place];
    }
    Ok(solution)
}

/// Bearings and ranges of many epochs.
#[derive(Debug, Clone, Copy)]
pub struct Bearings<'a> {
    /// The station of each epoch.
    pub stations: Places<'a>,
    /// Slant ranges \[m\].
    pub slant: &'a [f64],
    /// Bearings of the aircraft from the station, clockwise from true north \[rad\].
    pub bearing: &'a [f64],
    /// Heights above the ellipsoid \[m\].
    pub h: &'a [f64],
}

/// VOR/DME positions of all epochs.
///
/// # Errors
/// The first epoch with a number outside its domain.
pub fn vor_fixes(job: &Bearings, models: &Models) -> Result<Vec<Result<Fix, NoFix>>, Rejected> {
    many(job.h.len(), |i| {
        let slant = Metres::new(job.slant[i]);
        let (sigma, bearing) = (models.range.sigma(slant)?, Radians::new(job.bearing[i]));
        let measured = VorRange { slant, sigma, bearing, sigma_bearing: models.sigma_bearing };
        let altitude = Altitude { height: Metres::new(job.h[i]), sigma: models.sigma_altitude };
        match vor_fix(&job.stations.at(i)?, &measured, &altitude) {
            Err(NoFix::Invalid(reason)) => Err(reason),
            outcome => Ok(outcome),
        }
    })
}

/// Every station seen from every point: slant range \[m\], elevation of the aircraft and its bearing from the station \[rad\], and 1 where
/// the station may be used; NaN and 0 where both are in one place.
///
/// # Errors
/// The first point that is no place.
pub fn sights(points: &Places, stations: &[Station], models: &Models) -> Result<Vec<[f64; 4]>, Rejected> {
    let rows = many(points.len(), |i| {
        let place = points.at(i)?;
        let one = |s: &Station| match Sight::between(&place, &s.place) {
            None => [f64::NAN, f64::NAN, f64::NAN, 0.0],
            Some(sight) => {
                let usable = s.usable(&place, &models.admission, &models.horizon).is_some();
                [sight.slant.m(), sight.elevation.rad(), s.place.bearing_of(&place).rad(), f64::from(u8::from(usable))]
            }
        };
        Ok(stations.iter().map(one).collect::<Vec<_>>())
    })?;
    Ok(rows.concat())
}

/// What a network gives at one place.
#[derive(Debug, Clone, Copy, Default)]
pub struct Offer {
    /// Stations that may be used.
    pub n_stations: usize,
    /// The optimal pair of this instant.
    pub best: Option<Best>,
    /// The pair in use, which waits before it changes.
    pub used: Option<Best>,
    /// All stations together: three or more, or an admissible pair.
    pub all: Option<Covariance<Enu>>,
    /// The best VOR/DME: its place in the list and its covariance.
    pub vor: Option<(usize, Covariance<Enu>)>,
}

/// What a flight has, epoch by epoch in the order of time: `course` chooses by the deviation across it (NaN: by drms).
///
/// # Errors
/// The first epoch that is no place, or a setting outside its domain (index 0).
pub fn along(
    track: &Places,
    time_ns: &[i64],
    course: &[f64],
    stations: &[Station],
    models: &Models,
    switching: Switching,
) -> Result<Vec<Offer>, Rejected> {
    let mut selector = Selector::new(switching).map_err(|reason| Rejected { index: 0, reason })?;
    let mut offers = Vec::with_capacity(track.len());
    for index in 0..track.len() {
        let figure = if course[index].is_nan() { Figure::Drms } else { Figure::Across(Radians::new(course[index])) };
        let offer = track.at(index).and_then(|place| {
            let sights: Vec<_> = stations.iter().map(|s| s.usable(&place, &models.admission, &models.horizon)).collect();
            let mut offer = offered(&sights, stations, figure, models)?;
            offer.used = selector.step(GpsTime::from_nanoseconds(time_ns[index]), offer.best, |pair| look(&sights, pair, figure, models));
            Ok(offer)
        });
        offers.push(offer.map_err(|reason| Rejected { index, reason })?);
    }
    Ok(offers)
}

fn look(sights: &[Option<Sight>], stations: [usize; 2], figure: Figure, models: &Models) -> Option<Best> {
    let [a, b] = stations.map(|k| sights[k]);
    let pair = Pair::of([&a?, &b?], &models.range, &models.admission, models.sigma_altitude).ok()?;
    figure.of(&pair).map(|figure| Best { stations, pair, figure })
}

fn offered(sights: &[Option<Sight>], stations: &[Station], figure: Figure, models: &Models) -> Result<Offer, OutOfDomain> {
    let mut vor: Option<(usize, Metres, Covariance<Enu>)> = None;
    for (k, sight) in sights.iter().enumerate().filter(|(k, _)| stations[*k].bearing) {
        let Some(sight) = sight else { continue };
        // At the edges of the cone the level part of a unit vector rounds: a ground distance never exceeds the slant range.
        let ground = Metres::new((sight.slant.m() * sight.unit.xy().norm()).min(sight.slant.m()));
        if let Some(bearing) = vor_dme(ground, sight.slant, models.sigma_bearing, models.range.sigma(sight.slant)?)?
            && vor.is_none_or(|(_, drms, _)| bearing.drms < drms)
        {
            vor = Some((k, bearing.drms, bearing.covariance(sight, models.sigma_altitude)));
        }
    }
    let n_stations = sights.iter().flatten().count();
    let best = best_pair(sights, figure, &models.range, &models.admission, models.sigma_altitude)?;
    let all = all_in_view(sights.iter().flatten(), &models.range, models.sigma_altitude)?;
    Ok(Offer {
        n_stations,
        best,
        used: None,
        // Two alone are a pair, and must be an admissible one: outside its angles the mirror is near.
        all: all.filter(|_| n_stations > 2 || best.is_some()),
        vor: vor.map(|(k, _, covariance)| (k, covariance)),
    })
}

/// What a network gives at one point of a map.
#[derive(Debug, Clone, Copy)]
pub struct Cell {
    /// The offer there.
    pub offer: Offer,
    /// Horizontal navigation error with the optimal pair, all in view, and VOR/DME, at the risk; `None` without.
    pub nse: [Option<Metres>; 3],
}

/// The offer at many places, each for itself.
///
/// # Errors
/// The first point that is no place, or a model outside its domain.
pub fn coverage(points: &Places, stations: &[Station], models: &Models, risk: Risk) -> Result<Vec<Cell>, Rejected> {
    many(points.len(), |i| {
        let place = points.at(i)?;
        // Only those in view are kept: pairs are then sought among tens, not thousands.
        let (near, sights): (Vec<usize>, Vec<Option<Sight>>) = stations
            .iter()
            .enumerate()
            .filter_map(|(k, s)| s.usable(&place, &models.admission, &models.horizon).map(|sight| (k, Some(sight))))
            .unzip();
        let seen: Vec<Station> = near.iter().map(|k| stations[*k]).collect();
        let mut offer = offered(&sights, &seen, Figure::Drms, models)?;
        offer.best = offer.best.map(|b| Best { stations: b.stations.map(|k| near[k]), ..b });
        offer.vor = offer.vor.map(|(k, covariance)| (near[k], covariance));
        let pair = offer.best.and_then(|b| b.pair.covariance).map(|c| Covariance::from_upper([c.m11, c.m12, c.m22, 0.0, 0.0, 0.0]));
        let radius = |c: Option<Covariance<Enu>>| c.map(|c| circle(&c, None, risk)).transpose();
        Ok(Cell { nse: [radius(pair)?, radius(offer.all)?, radius(offer.vor.map(|v| v.1))?], offer })
    })
}

/// Items on all cores, results in order, the first refusal named.
fn many<T: Send>(n: usize, item: impl Fn(usize) -> Result<T, OutOfDomain> + Sync) -> Result<Vec<T>, Rejected> {
    let outcomes: Vec<_> = parallel::map(n, CHUNK, item);
    outcomes.into_iter().enumerate().map(|(index, outcome)| outcome.map_err(|reason| Rejected { index, reason })).collect()
}
