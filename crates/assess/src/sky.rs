//! Satellite geometry at many epochs: where the satellites stand, and what covariance follows.

use crate::parallel;
use nalgebra::Vector3;
use navbound_core::frame::{Geodetic, LatLon, ecef_from_geodetic, enu_from_ecef};
use navbound_core::geometry::{Direction, Elements, LineOfSight, Observer, Orbit};
use navbound_core::quantity::{Metres, OutOfDomain, Radians, Unavailable};
use navbound_core::signal::Constellation;
use navbound_core::solution::wls;
use navbound_path::AtIndex;

/// Epochs in one task of the pool: each takes microseconds.
const EPOCHS_PER_TASK: usize = 64;

/// Receiver positions and times as a structure of arrays of one length.
#[derive(Debug, Clone, Copy)]
pub struct Receivers<'a> {
    /// Latitude \[rad\].
    pub lat_rad: &'a [f64],
    /// Longitude \[rad\].
    pub lon_rad: &'a [f64],
    /// Height above the ellipsoid \[m\].
    pub h_m: &'a [f64],
    /// Time since the orbits' reference instant \[s\].
    pub time_s: &'a [f64],
}

/// Azimuths and elevations, one row an epoch and one column a satellite.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Sky {
    /// Azimuth \[rad\].
    pub az_rad: Vec<f64>,
    /// Elevation, negative below the horizon \[rad\].
    pub el_rad: Vec<f64>,
}

/// Satellites in many solutions, rows as in [`Sky`]; a satellite whose azimuth and elevation are NaN is not used.
#[derive(Debug, Clone, Copy)]
pub struct Sights<'a> {
    /// Azimuth \[rad\].
    pub az_rad: &'a [f64],
    /// Elevation \[rad\].
    pub el_rad: &'a [f64],
    /// Standard deviation of each range \[m\].
    pub sigma_m: &'a [f64],
    /// Constellation of each column, as [`Constellation::index`].
    pub constellation: &'a [usize],
}

/// Where every satellite stands at every epoch.
///
/// # Errors
/// [`AtIndex`] for the first orbit or epoch outside its domain.
pub fn directions(orbits: &[Elements], at: &Receivers<'_>) -> Result<Sky, AtIndex> {
    let orbits = orbits
        .iter()
        .enumerate()
        .map(|(index, e)| Orbit::new(*e).map_err(|error| AtIndex { index, error }))
        .collect::<Result<Vec<_>, _>>()?;
    let rows =
        parallel::try_map(at.time_s.len(), EPOCHS_PER_TASK, |index| row(&orbits, at, index).map_err(|error| AtIndex { index, error }))?;
    let mut sky = Sky::default();
    for direction in rows.into_iter().flatten() {
        sky.az_rad.push(direction.azimuth().rad());
        sky.el_rad.push(direction.elevation().rad());
    }
    Ok(sky)
}

/// Places at a distance from receivers along lines of sight, Earth-centred \[m\]: one row a receiver, one place a satellite; NaN where an
/// angle is.
///
/// # Errors
/// [`AtIndex`] for the first receiver outside its domain.
pub fn along_sights(at: &Receivers<'_>, sky: &Sky, distance: Metres) -> Result<Vec<[f64; 3]>, AtIndex> {
    let width = sky.az_rad.len().checked_div(at.lat_rad.len()).unwrap_or(0);
    let mut places = Vec::with_capacity(sky.az_rad.len());
    for index in 0..at.lat_rad.len() {
        let point =
            LatLon::new(Radians::new(at.lat_rad[index]), Radians::new(at.lon_rad[index])).map_err(|error| AtIndex { index, error })?;
        let origin = ecef_from_geodetic(&Geodetic { point, height: Metres::new(at.h_m[index]) });
        let ecef_from_enu = enu_from_ecef(&point).transpose();
        for k in index * width..(index + 1) * width {
            // Angles that are none make a place that is none.
            let sight = Direction::new(Radians::new(sky.az_rad[k]), Radians::new(sky.el_rad[k]));
            let unit = sight.map_or(Vector3::from_element(f64::NAN), |d| d.unit());
            places.push((origin.vector() + ecef_from_enu * unit * distance.m()).into());
        }
    }
    Ok(places)
}

fn row(orbits: &[Orbit], at: &Receivers<'_>, i: usize) -> Result<Vec<Direction>, OutOfDomain> {
    let point = LatLon::new(Radians::new(at.lat_rad[i]), Radians::new(at.lon_rad[i]))?;
    let receiver = Geodetic { point, height: Metres::new(at.h_m[i]) };
    let time = at.time_s[i];
    if !time.is_finite() {
        return Err(OutOfDomain { argument: "time_s", value: time, unit: "s", domain: "finite times" });
    }
    // A height that is not finite shows in the direction; said here it is named.
    if !receiver.height.m().is_finite() {
        return Err(OutOfDomain { argument: "h_m", value: at.h_m[i], unit: "m", domain: "finite heights" });
    }
    let observer = Observer::new(&receiver);
    orbits.iter().map(|orbit| observer.direction(&orbit.position(time))).collect()
}

/// Number of satellites and one result for each epoch.
pub type Solved<T> = Vec<(usize, Result<T, Unavailable>)>;

/// One result for each epoch of satellites in rows: the covariance, a dilution, whatever `solve` makes of the satellites used.
///
/// # Errors
/// [`AtIndex`] for the first satellite with an angle or sigma outside its domain, counted through all rows.
pub fn solve<T: Send>(sights: &Sights<'_>, solve: impl Fn(&[LineOfSight]) -> Result<T, Unavailable> + Sync) -> Result<Solved<T>, AtIndex> {
    let width = sights.constellation.len();
    let constellations = sights
        .constellation
        .iter()
        .enumerate()
        .map(|(index, &c)| Constellation::from_index(c).ok_or_else(|| AtIndex { index, error: unknown(c) }))
        .collect::<Result<Vec<_>, _>>()?;
    parallel::try_map(sights.az_rad.len().checked_div(width).unwrap_or(0), EPOCHS_PER_TASK, |epoch| {
        let used = used(sights, &constellations, epoch * width)?;
        Ok((used.len(), solve(&used)))
    })
}

/// Covariances, see [`wls::covariance`].
///
/// # Errors
/// As [`solve`].
pub fn covariances(sights: &Sights<'_>) -> Result<Solved<navbound_core::frame::Covariance<navbound_core::frame::Enu>>, AtIndex> {
    solve(sights, |used| wls::covariance(used.iter()))
}

/// Metres of position, east, north, up, for a metre in each range, a column each, see [`wls::responses`]; NaN for one that is not used.
///
/// # Errors
/// As [`solve`].
pub fn responses(sights: &Sights<'_>) -> Result<Solved<Vec<Vector3<f64>>>, AtIndex> {
    let width = sights.constellation.len();
    let mut solved = solve(sights, |used| Ok(wls::responses(used.iter())?.collect::<Vec<_>>()))?;
    for (epoch, (_, responses)) in solved.iter_mut().enumerate() {
        let Ok(responses) = responses else { continue };
        let mut own = std::mem::take(responses).into_iter();
        let none = Vector3::from_element(f64::NAN);
        let of = |az: &f64| if az.is_nan() { none } else { own.next().unwrap_or(none) };
        *responses = sights.az_rad[epoch * width..][..width].iter().map(of).collect();
    }
    Ok(solved)
}

/// Dilutions of precision, see [`wls::dilution`].
///
/// # Errors
/// As [`solve`].
pub fn dilutions(sights: &Sights<'_>) -> Result<Solved<wls::Dilution>, AtIndex> {
    solve(sights, |used| wls::dilution(used.iter()))
}

fn used(sights: &Sights<'_>, constellations: &[Constellation], start: usize) -> Result<Vec<LineOfSight>, AtIndex> {
    let mut used = Vec::with_capacity(constellations.len());
    for (column, &constellation) in constellations.iter().enumerate() {
        let index = start + column;
        let (az, el) = (sights.az_rad[index], sights.el_rad[index]);
        if az.is_nan() && el.is_nan() {
            continue;
        }
        let sight = Direction::new(Radians::new(az), Radians::new(el))
            .and_then(|d| LineOfSight::new(d, Metres::new(sights.sigma_m[index]), constellation))
            .map_err(|error| AtIndex { index, error })?;
        used.push(sight);
    }
    Ok(used)
}

fn unknown(index: usize) -> OutOfDomain {
    OutOfDomain { argument: "constellation", value: index as f64, unit: "1", domain: "indices of constellations" }
}
