//! The family's entries in the list of methods.

use super::{circle, circle_fit, circle_fit_as_printed, circle_geodesy, directional, sphere, sphere_grubbs, support};
use crate::bound::{Bounded, Method, Promises, Provenance};
use crate::frame::{Covariance, Displacement, Enu};
use crate::quantity::{Metres, Radians, Risk, Unavailable};
use crate::solution::Epoch;
use crate::special::float::sin_cos;
use nalgebra::Vector3;

const SEED: &str = "Dai et al., Three-Dimensional ANP Evaluation Method, Aerospace 9 (2022) 703";
const GAUSSIAN: &str = "the navigation error is Gaussian with the stated covariance and mean";

const EXACT: Promises =
    Promises { scales_with_length: true, ignores_north: true, monotone_in_risk: true, conservative: true, may_alert: true };
/// East and north do depend on where north is.
const EXACT_NORTH: Promises = Promises { ignores_north: false, ..EXACT };
/// An approximation may be short.
const FIT: Promises = Promises { conservative: false, ..EXACT };
/// One risk only: there is nothing to be monotone in.
const FIT_95: Promises = Promises { monotone_in_risk: false, ..FIT };
const EXHIBIT: Promises = Promises { may_alert: false, ..FIT_95 };

const CIRCLE: Method = Method {
    id: "anp-circle",
    title: "ANP circle, exact",
    source: "contour inversion of the radial law, docs/methods/anp.md section 2",
    provenance: Provenance::Ours,
    bounds: Bounded::HorizontalNse,
    assumes: GAUSSIAN,
    promises: EXACT,
    bound: |epoch, risk| {
        let (covariance, mean) = error_of(epoch, "anp-circle")?;
        Ok(circle(covariance, mean, risk)?)
    },
};

const SPHERE: Method = Method {
    id: "anp-sphere",
    title: "ANP sphere, exact",
    bounds: Bounded::SpatialNse,
    bound: |epoch, risk| {
        let (covariance, mean) = error_of(epoch, "anp-sphere")?;
        Ok(sphere(covariance, mean, risk)?)
    },
    ..CIRCLE
};

const ALONG: Method = Method {
    id: "anp-along",
    title: "ANP along track, exact",
    source: "two-sided normal quantile, docs/methods/anp.md section 3",
    bounds: Bounded::AlongNse,
    bound: |epoch, risk| half_width(epoch, "anp-along", along(epoch.course_for("anp-along")?), risk),
    ..CIRCLE
};

const CROSS: Method = Method {
    id: "anp-cross",
    title: "ANP cross track, exact",
    bounds: Bounded::CrossNse,
    bound: |epoch, risk| half_width(epoch, "anp-cross", cross(epoch.course_for("anp-cross")?), risk),
    ..ALONG
};

const VERTICAL: Method = Method {
    id: "anp-vertical",
    title: "ANP vertical, exact",
    bounds: Bounded::VerticalNse,
    bound: |epoch, risk| half_width(epoch, "anp-vertical", Vector3::z(), risk),
    ..ALONG
};

const ELLIPSOID_EAST: Method = Method {
    id: "anp-ellipsoid-east",
    title: "ANP ellipsoid, half-extent east",
    source: "Dai et al. 2022, eq. 25 to 32, its half-extent k sqrt(u'Vu) instead of a sorted semi-axis",
    provenance: Provenance::ReDerived,
    bounds: Bounded::EastNse,
    promises: EXACT_NORTH,
    bound: |epoch, risk| half_extent(epoch, "anp-ellipsoid-east", Vector3::x(), risk),
    ..CIRCLE
};

const ELLIPSOID_NORTH: Method = Method {
    id: "anp-ellipsoid-north",
    title: "ANP ellipsoid, half-extent north",
    bounds: Bounded::NorthNse,
    bound: |epoch, risk| half_extent(epoch, "anp-ellipsoid-north", Vector3::y(), risk),
    ..ELLIPSOID_EAST
};

const ELLIPSOID_UP: Method = Method {
    id: "anp-ellipsoid-up",
    title: "ANP ellipsoid, half-extent up",
    bounds: Bounded::VerticalNse,
    promises: EXACT,
    bound: |epoch, risk| half_extent(epoch, "anp-ellipsoid-up", Vector3::z(), risk),
    ..ELLIPSOID_EAST
};

const ELLIPSOID_ALONG: Method = Method {
    id: "anp-ellipsoid-along",
    title: "ANP ellipsoid, half-extent along track",
    bounds: Bounded::AlongNse,
    bound: |epoch, risk| half_extent(epoch, "anp-ellipsoid-along", along(epoch.course_for("anp-ellipsoid-along")?), risk),
    ..ELLIPSOID_UP
};

const ELLIPSOID_CROSS: Method = Method {
    id: "anp-ellipsoid-cross",
    title: "ANP ellipsoid, half-extent across track",
    bounds: Bounded::CrossNse,
    bound: |epoch, risk| half_extent(epoch, "anp-ellipsoid-cross", cross(epoch.course_for("anp-ellipsoid-cross")?), risk),
    ..ELLIPSOID_UP
};

const CIRCLE_FIT: Method = Method {
    id: "anp-circle-fit",
    title: "ANP circle, published cubic (corrected)",
    source: "Dai et al. 2022, eq. 11 to 13, with the ratio the right way up",
    provenance: Provenance::ReDerived,
    assumes: "as the exact circle, zero mean, 95 % only; up to 0.87 % short",
    promises: FIT_95,
    bound: |epoch, risk| Ok(circle_fit(centred(epoch, "anp-circle-fit")?, risk)?),
    ..CIRCLE
};

const CIRCLE_GEODESY: Method = Method {
    id: "anp-circle-geodesy",
    title: "ANP circle, geodesy's cubic",
    source: "cubic of geodetic practice for the 95 % circular uncertainty, as GeodePy states it; the original was not read",
    provenance: Provenance::Printed,
    assumes: "as the exact circle, zero mean, 95 % only; from 0.42 % of sigma short to 0.34 % long",
    bound: |epoch, risk| Ok(circle_geodesy(centred(epoch, "anp-circle-geodesy")?, risk)?),
    ..CIRCLE_FIT
};

const SPHERE_GRUBBS: Method = Method {
    id: "anp-sphere-grubbs",
    title: "ANP sphere, Grubbs / Wilson-Hilferty (corrected)",
    source: "Dai et al. 2022, eq. 17, with the normal factor on its own term",
    provenance: Provenance::ReDerived,
    bounds: Bounded::SpatialNse,
    assumes: "as the exact sphere; at 95 % up to 1.24 % short",
    promises: FIT,
    bound: |epoch, risk| {
        let (covariance, mean) = error_of(epoch, "anp-sphere-grubbs")?;
        Ok(sphere_grubbs(covariance, mean, risk)?)
    },
};

const CIRCLE_FIT_AS_PRINTED: Method = Method {
    id: "anp-circle-fit-as-printed",
    title: "ANP circle, published cubic as printed (exhibit)",
    source: SEED,
    provenance: Provenance::Printed,
    assumes: "nothing that holds: the axis ratio is upside down, the radius grows without bound for a thin ellipse",
    promises: EXHIBIT,
    bound: |epoch, risk| Ok(circle_fit_as_printed(centred(epoch, "anp-circle-fit-as-printed")?, risk)?),
    ..CIRCLE_FIT
};

const SPHERE_GRUBBS_AS_PRINTED: Method = Method {
    id: "anp-sphere-grubbs-as-printed",
    title: "ANP sphere, eq. 17 as printed (exhibit)",
    bounds: Bounded::SpatialNse,
    assumes: "nothing that holds: the normal factor multiplies the whole bracket, 17.5 to 34.1 % too long",
    bound: |epoch, risk| {
        let covariance = centred(epoch, "anp-sphere-grubbs-as-printed")?;
        Ok(super::sphere_grubbs_as_printed(covariance, risk)?)
    },
    ..CIRCLE_FIT_AS_PRINTED
};

/// The methods of this family.
pub const METHODS: &[Method] = &[
    CIRCLE,
    SPHERE,
    ALONG,
    CROSS,
    VERTICAL,
    ELLIPSOID_EAST,
    ELLIPSOID_NORTH,
    ELLIPSOID_UP,
    ELLIPSOID_ALONG,
    ELLIPSOID_CROSS,
    CIRCLE_FIT,
    CIRCLE_GEODESY,
    SPHERE_GRUBBS,
    CIRCLE_FIT_AS_PRINTED,
    SPHERE_GRUBBS_AS_PRINTED,
];

type Error<'a> = (&'a Covariance<Enu>, Option<&'a Displacement<Enu>>);

fn error_of<'a>(epoch: &'a Epoch, method: &'static str) -> Result<Error<'a>, Unavailable> {
    Ok((epoch.covariance_for(method)?, epoch.mean.as_ref()))
}

/// The covariance of an epoch whose mean is zero; the fits know no other.
fn centred<'a>(epoch: &'a Epoch, method: &'static str) -> Result<&'a Covariance<Enu>, Unavailable> {
    if let Some(mean) = &epoch.mean
        && let Some(value) = mean.vector().iter().find(|m| !(**m == 0.0))
    {
        return Err(Unavailable::Invalid { field: "mean", value: *value, unit: "m", domain: "{0}: the fit has no mean" });
    }
    epoch.covariance_for(method)
}

/// Unit vector along a course.
fn along(course: Radians) -> Vector3<f64> {
    let (sin, cos) = sin_cos(course.rad());
    Vector3::new(sin, cos, 0.0)
}

/// Unit vector to the right of a course.
fn cross(course: Radians) -> Vector3<f64> {
    let (sin, cos) = sin_cos(course.rad());
    Vector3::new(cos, -sin, 0.0)
}

fn half_width(epoch: &Epoch, method: &'static str, direction: Vector3<f64>, risk: Risk) -> Result<Metres, Unavailable> {
    let (covariance, mean) = error_of(epoch, method)?;
    Ok(directional(covariance, &direction, mean, risk)?.half_width)
}

/// The ellipsoid stands around the mean, so its half-extent is counted from there.
fn half_extent(epoch: &Epoch, method: &'static str, direction: Vector3<f64>, risk: Risk) -> Result<Metres, Unavailable> {
    let (covariance, mean) = error_of(epoch, method)?;
    let offset = mean.map_or(0.0, |m| direction.dot(m.vector()).abs());
    Ok(Metres::new(offset + support(covariance, &direction, risk)?.m()))
}
