//! Dilutions of precision of a grid of users over a day, from orbits, in one batch.
//!
//! Satellites are placed once an instant for all users. What differs from [`crate::sky`] is the way, not the formula: directions stay
//! vectors, so that a satellite costs some multiplications and no angle.

use crate::parallel;
use nalgebra::{Matrix3, Vector3};
use navbound_core::frame::{Geodetic, LatLon, ecef_from_geodetic, enu_from_ecef};
use navbound_core::geometry::{Elements, Orbit};
use navbound_core::quantity::{Metres, OutOfDomain, Radians};
use navbound_core::signal::Constellation;
use navbound_core::solution::wls;
use navbound_path::AtIndex;
use pulp::Arch;
use std::f64::consts::FRAC_PI_2;

/// Users at instants in one task of the pool: each takes a microsecond.
const INSTANTS_PER_TASK: usize = 4096;

/// Users as a structure of arrays of one length.
#[derive(Debug, Clone, Copy)]
pub struct Users<'a> {
    /// Latitude \[rad\].
    pub lat_rad: &'a [f64],
    /// Longitude \[rad\].
    pub lon_rad: &'a [f64],
    /// Height above the ellipsoid \[m\].
    pub h_m: &'a [f64],
}

/// Dilutions, the instants of a user together; NaN where there is no position.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Dops {
    /// Horizontal.
    pub hdop: Vec<f64>,
    /// Vertical.
    pub vdop: Vec<f64>,
    /// Position.
    pub pdop: Vec<f64>,
    /// Geometric, with every clock.
    pub gdop: Vec<f64>,
    /// Satellites above the mask.
    pub n_sv: Vec<u16>,
}

/// All satellites at one instant, Earth-fixed \[m\].
struct Instant {
    x: Vec<f64>,
    y: Vec<f64>,
    z: Vec<f64>,
}

/// What a thread keeps from user to user.
#[derive(Default)]
struct Desk {
    up: Vec<f64>,
    square: Vec<f64>,
    used: Vec<(Vector3<f64>, Constellation)>,
}

/// One user's part of the results.
struct Row<'a> {
    hdop: &'a mut [f64],
    vdop: &'a mut [f64],
    pdop: &'a mut [f64],
    gdop: &'a mut [f64],
    n_sv: &'a mut [u16],
}

/// A user's place and local axes.
struct Place {
    origin: Vector3<f64>,
    axes: Matrix3<f64>,
}

/// Dilutions of every user at every instant; orbits come with the index of their constellation.
///
/// # Errors
/// [`AtIndex`]: the first orbit, user or instant outside its domain, or a mask outside (-pi/2, pi/2).
pub fn dops(orbits: &[(Elements, usize)], users: &Users<'_>, time_s: &[f64], mask: Radians) -> Result<Dops, AtIndex> {
    if !(mask.rad().abs() < FRAC_PI_2) {
        let error = OutOfDomain { argument: "mask_rad", value: mask.rad(), unit: "rad", domain: "(-pi/2, pi/2)" };
        return Err(AtIndex { index: 0, error });
    }
    let systems = collect(orbits, |&(_, c)| {
        let domain = "indices of constellations";
        Constellation::from_index(c).ok_or(OutOfDomain { argument: "constellation", value: c as f64, unit: "1", domain })
    })?;
    let orbits = collect(orbits, |(elements, _)| Orbit::new(*elements))?;
    let instants = collect(time_s, |&time| instant(&orbits, time))?;
    let places = collect(&(0..users.lat_rad.len()).collect::<Vec<_>>(), |&i| place(users, i))?;
    Ok(fill(&places, &instants, &systems, mask))
}

fn collect<T, U>(items: &[T], each: impl Fn(&T) -> Result<U, OutOfDomain>) -> Result<Vec<U>, AtIndex> {
    items.iter().enumerate().map(|(index, item)| each(item).map_err(|error| AtIndex { index, error })).collect()
}

fn instant(orbits: &[Orbit], time: f64) -> Result<Instant, OutOfDomain> {
    if !time.is_finite() {
        return Err(OutOfDomain { argument: "time_s", value: time, unit: "s", domain: "finite times" });
    }
    let at: Vec<Vector3<f64>> = orbits.iter().map(|orbit| *orbit.position(time).vector()).collect();
    let axis = |k: usize| at.iter().map(|v| v[k]).collect();
    Ok(Instant { x: axis(0), y: axis(1), z: axis(2) })
}

fn place(users: &Users<'_>, i: usize) -> Result<Place, OutOfDomain> {
    let point = LatLon::new(Radians::new(users.lat_rad[i]), Radians::new(users.lon_rad[i]))?;
    if !users.h_m[i].is_finite() {
        return Err(OutOfDomain { argument: "h_m", value: users.h_m[i], unit: "m", domain: "finite heights" });
    }
    let origin = *ecef_from_geodetic(&Geodetic { point, height: Metres::new(users.h_m[i]) }).vector();
    Ok(Place { origin, axes: enu_from_ecef(&point) })
}

fn fill(places: &[Place], instants: &[Instant], systems: &[Constellation], mask: Radians) -> Dops {
    let (n, width) = (places.len() * instants.len(), instants.len().max(1));
    let column = || vec![f64::NAN; n];
    let mut out = Dops { hdop: column(), vdop: column(), pdop: column(), gdop: column(), n_sv: vec![0; n] };
    let arch = Arch::new();
    let sine = mask.rad().sin();
    let dops = out.hdop.chunks_mut(width).zip(out.vdop.chunks_mut(width)).zip(out.pdop.chunks_mut(width)).zip(out.gdop.chunks_mut(width));
    let rows = dops.zip(out.n_sv.chunks_mut(width)).map(|((((hdop, vdop), pdop), gdop), n_sv)| Row { hdop, vdop, pdop, gdop, n_sv });
    let mut rows: Vec<Row<'_>> = rows.collect();
    let size = INSTANTS_PER_TASK.div_ceil(width);
    parallel::fill(&mut rows, size, |first, rows| {
        let mut desk = Desk::default();
        for (place, row) in places[first..].iter().zip(rows) {
            for (t, instant) in instants.iter().enumerate() {
                arch.dispatch(
                    #[inline(always)]
                    || epoch(&mut desk, place, instant, systems, sine * sine.abs()),
                );
                row.put(t, &desk);
            }
        }
    });
    drop(rows);
    out
}

/// Puts the unit vectors of the satellites above the mask on the desk. `threshold` is the sine of the mask times its size: comparing
/// squares that keep their sign spares the root of the satellites below.
#[inline(always)]
fn epoch(desk: &mut Desk, place: &Place, instant: &Instant, systems: &[Constellation], threshold: f64) {
    let (o, a) = (&place.origin, &place.axes);
    let (upx, upy, upz) = (a[(2, 0)], a[(2, 1)], a[(2, 2)]);
    let n = systems.len();
    desk.up.resize(n, 0.0);
    desk.square.resize(n, 0.0);
    let (xs, ys, zs) = (&instant.x[..n], &instant.y[..n], &instant.z[..n]);
    let (up, square) = (&mut desk.up[..n], &mut desk.square[..n]);
    for s in 0..n {
        let (x, y, z) = (xs[s] - o.x, ys[s] - o.y, zs[s] - o.z);
        up[s] = upx * x + upy * y + upz * z;
        square[s] = x * x + y * y + z * z;
    }
    desk.used.clear();
    for s in (0..n).filter(|&s| up[s] * up[s].abs() >= threshold * square[s]) {
        let scale = 1.0 / square[s].sqrt();
        let (x, y, z) = (xs[s] - o.x, ys[s] - o.y, zs[s] - o.z);
        let east = a[(0, 0)] * x + a[(0, 1)] * y + a[(0, 2)] * z;
        let north = a[(1, 0)] * x + a[(1, 1)] * y + a[(1, 2)] * z;
        desk.used.push((Vector3::new(east * scale, north * scale, up[s] * scale), systems[s]));
    }
}

impl Row<'_> {
    #[inline(always)]
    fn put(&mut self, t: usize, desk: &Desk) {
        self.n_sv[t] = desk.used.len() as u16;
        if let Ok(dilution) = wls::dilution_of_units(desk.used.iter().copied()) {
            self.hdop[t] = dilution.dilution.horizontal;
            self.vdop[t] = dilution.dilution.vertical;
            self.pdop[t] = dilution.dilution.position;
            self.gdop[t] = dilution.geometric;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sky::{Receivers, Sights, dilutions, directions};
    use navbound_core::geometry::{GALILEO, GPS};

    fn orbits() -> Vec<(Elements, usize)> {
        let gps = GPS.iter().map(|s| (s.elements, Constellation::Gps.index()));
        gps.chain(GALILEO.iter().map(|s| (s.elements, Constellation::Galileo.index()))).collect()
    }

    /// The way through angles is another one: azimuth and elevation of every satellite, then the sines of both. 1e-9: a dozen roundings
    /// times a condition below 1e5.
    #[test]
    fn dilutions_are_those_of_the_way_through_angles() {
        let mask = 0.1;
        let (lat, lon, time) = ([0.7, -1.2, 0.0], [2.0, -3.0, 0.5], [0.0, 3000.0, 41_000.0, 86_000.0]);
        let map = dops(&orbits(), &Users { lat_rad: &lat, lon_rad: &lon, h_m: &[9000.0; 3] }, &time, Radians::new(mask)).unwrap();
        for user in 0..3 {
            let elements: Vec<Elements> = orbits().iter().map(|o| o.0).collect();
            let at = Receivers { lat_rad: &[lat[user]; 4], lon_rad: &[lon[user]; 4], h_m: &[9000.0; 4], time_s: &time };
            let mut sky = directions(&elements, &at).unwrap();
            for k in 0..sky.el_rad.len() {
                if sky.el_rad[k] < mask {
                    (sky.az_rad[k], sky.el_rad[k]) = (f64::NAN, f64::NAN);
                }
            }
            let constellation: Vec<usize> = orbits().iter().map(|o| o.1).collect();
            let sigma = vec![1.0; sky.el_rad.len()];
            let sights = Sights { az_rad: &sky.az_rad, el_rad: &sky.el_rad, sigma_m: &sigma, constellation: &constellation };
            for (t, (n_sv, dilution)) in dilutions(&sights).unwrap().into_iter().enumerate() {
                let (k, expected) = (user * 4 + t, dilution.unwrap());
                assert_eq!(usize::from(map.n_sv[k]), n_sv);
                for (got, reference) in
                    [(map.hdop[k], expected.horizontal), (map.vdop[k], expected.vertical), (map.pdop[k], expected.position)]
                {
                    assert!((got - reference).abs() < 1e-9 * reference, "{got} {reference}");
                }
                assert!(map.gdop[k] > map.pdop[k]);
            }
        }
    }

    #[test]
    fn a_user_s_numbers_do_not_depend_on_who_stands_beside() {
        let (lat, lon): (Vec<f64>, Vec<f64>) = (0..9).map(|i| (0.15 * f64::from(i), 0.3 * f64::from(i))).unzip();
        let h = [0.0; 9];
        let time = [0.0, 900.0, 1800.0];
        let all = dops(&orbits(), &Users { lat_rad: &lat, lon_rad: &lon, h_m: &h }, &time, Radians::new(0.09)).unwrap();
        let last = dops(&orbits(), &Users { lat_rad: &lat[8..], lon_rad: &lon[8..], h_m: &h[8..] }, &time, Radians::new(0.09)).unwrap();
        assert_eq!(all.gdop[24..], last.gdop[..]);
    }

    #[test]
    fn too_few_satellites_leave_no_number() {
        let few = &orbits()[..3];
        let dilutions = dops(few, &Users { lat_rad: &[0.0], lon_rad: &[0.0], h_m: &[0.0] }, &[0.0], Radians::new(0.0)).unwrap();
        assert!(dilutions.hdop[0].is_nan() && dilutions.n_sv[0] <= 3);
    }

    #[test]
    fn what_is_no_user_no_time_and_no_mask_is_named() {
        let refused = |lat: f64, h: f64, t: f64, mask: f64| {
            dops(&orbits(), &Users { lat_rad: &[lat], lon_rad: &[0.0], h_m: &[h] }, &[t], Radians::new(mask)).unwrap_err().error.argument
        };
        assert_eq!(refused(2.0, 0.0, 0.0, 0.1), "lat_rad");
        assert_eq!(refused(0.0, f64::NAN, 0.0, 0.1), "h_m");
        assert_eq!(refused(0.0, 0.0, f64::INFINITY, 0.1), "time_s");
        assert_eq!(refused(0.0, 0.0, 0.0, f64::NAN), "mask_rad");
        assert_eq!(
            dops(&[(GPS[0].elements, 9)], &Users { lat_rad: &[], lon_rad: &[], h_m: &[] }, &[], Radians::new(0.0))
                .unwrap_err()
                .error
                .argument,
            "constellation"
        );
    }
}
