//! Paths.

use crate::error::input_error;
use navbound_core::frame::LatLon;
use navbound_core::quantity::{Metres, OutOfDomain, Radians};
use navbound_path::{AtIndex, Feet, Line, Points, Route};
use numpy::{IntoPyArray, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A geodesic line or a route of legs and turns on the WGS-84 ellipsoid.
#[pyclass(frozen, module = "navbound._core")]
pub(crate) struct Path(pub(crate) Shape);

pub(crate) enum Shape {
    Line(Box<Line>),
    Route(Route),
}

fn refused(e: OutOfDomain) -> PyErr {
    input_error(e, None)
}

fn refused_at(e: AtIndex) -> PyErr {
    input_error(e.error, Some(e.index))
}

fn point(lat_rad: f64, lon_rad: f64) -> PyResult<LatLon> {
    LatLon::new(Radians::new(lat_rad), Radians::new(lon_rad)).map_err(refused)
}

/// Arrays that must have one item for each other's.
fn same_length(argument: &'static str, n: usize, expected: usize) -> PyResult<()> {
    if n == expected {
        return Ok(());
    }
    Err(refused(OutOfDomain { argument, value: n as f64, unit: "items", domain: "arrays of equal length" }))
}

#[pymethods]
impl Path {
    /// The infinite geodesic through two points.
    #[staticmethod]
    fn line(lat0_rad: f64, lon0_rad: f64, lat1_rad: f64, lon1_rad: f64) -> PyResult<Self> {
        let line = Line::through(point(lat0_rad, lon0_rad)?, point(lat1_rad, lon1_rad)?).map_err(refused)?;
        Ok(Self(Shape::Line(Box::new(line))))
    }

    /// The infinite geodesic from a point in a direction.
    #[staticmethod]
    fn from_azimuth(lat_rad: f64, lon_rad: f64, course_rad: f64) -> PyResult<Self> {
        let line = Line::from_azimuth(point(lat_rad, lon_rad)?, Radians::new(course_rad)).map_err(refused)?;
        Ok(Self(Shape::Line(Box::new(line))))
    }

    /// Legs between waypoints with a fly-by turn at each waypoint between.
    #[staticmethod]
    fn route(
        lat_rad: PyReadonlyArray1<'_, f64>,
        lon_rad: PyReadonlyArray1<'_, f64>,
        radius_m: PyReadonlyArray1<'_, f64>,
    ) -> PyResult<Self> {
        let (lat, lon, radius) = (lat_rad.as_slice()?, lon_rad.as_slice()?, radius_m.as_slice()?);
        same_length("lon_rad", lon.len(), lat.len())?;
        same_length("radius_m", radius.len(), lat.len())?;
        Ok(Self(Shape::Route(Route::from_arrays(lat, lon, radius).map_err(refused_at)?)))
    }

    /// Length from the first point to the last; infinite for a line given by a direction.
    #[getter]
    fn length_m(&self) -> f64 {
        match &self.0 {
            Shape::Line(line) => line.length().m(),
            Shape::Route(route) => route.length().m(),
        }
    }

    /// Where the waypoints lie along the path.
    #[getter]
    fn waypoints_along_m(&self) -> Vec<f64> {
        match &self.0 {
            Shape::Line(line) => vec![0.0, line.length().m()],
            Shape::Route(route) => route.waypoints_along().iter().map(|s| s.m()).collect(),
        }
    }

    /// Feet of positions, in the order flown.
    #[pyo3(signature = (lat_rad, lon_rad, near_along_m=None))]
    fn project<'py>(
        &self,
        py: Python<'py>,
        lat_rad: PyReadonlyArray1<'_, f64>,
        lon_rad: PyReadonlyArray1<'_, f64>,
        near_along_m: Option<f64>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (lat, lon) = (lat_rad.as_slice()?, lon_rad.as_slice()?);
        same_length("lon_rad", lon.len(), lat.len())?;
        let feet = py
            .detach(|| match &self.0 {
                Shape::Line(line) => line.project_all(lat, lon),
                Shape::Route(route) => route.project_all(lat, lon, near_along_m.map(Metres::new)),
            })
            .map_err(refused_at)?;
        feet_dict(py, feet)
    }

    /// The path at distances along it.
    fn at<'py>(&self, py: Python<'py>, along_m: PyReadonlyArray1<'_, f64>) -> PyResult<Bound<'py, PyDict>> {
        let along = along_m.as_slice()?;
        let points = match &self.0 {
            Shape::Line(line) => line.at_all(along),
            Shape::Route(route) => route.at_all(along),
        };
        points_dict(py, points.map_err(refused_at)?)
    }
}

fn feet_dict(py: Python<'_>, feet: Feet) -> PyResult<Bound<'_, PyDict>> {
    let d = PyDict::new(py);
    d.set_item("along_m", feet.along_m.into_pyarray(py))?;
    d.set_item("cross_m", feet.cross_m.into_pyarray(py))?;
    d.set_item("course_rad", feet.course_rad.into_pyarray(py))?;
    d.set_item("lat_rad", feet.lat_rad.into_pyarray(py))?;
    d.set_item("lon_rad", feet.lon_rad.into_pyarray(py))?;
    d.set_item("leg", feet.leg.into_pyarray(py))?;
    Ok(d)
}

fn points_dict(py: Python<'_>, points: Points) -> PyResult<Bound<'_, PyDict>> {
    let d = PyDict::new(py);
    d.set_item("lat_rad", points.lat_rad.into_pyarray(py))?;
    d.set_item("lon_rad", points.lon_rad.into_pyarray(py))?;
    d.set_item("course_rad", points.course_rad.into_pyarray(py))?;
    d.set_item("curvature_per_m", points.curvature_per_m.into_pyarray(py))?;
    d.set_item("leg", points.leg.into_pyarray(py))?;
    Ok(d)
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_class::<Path>()
}
