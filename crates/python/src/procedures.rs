//! Navigation databases and the paths of their procedures.

use crate::error::{format_error, input_error};
use crate::fields::fields;
use navbound_core::frame::LatLon;
use navbound_core::quantity::{Metres, OutOfDomain, Radians};
use navbound_formats::arinc424::{self, Contradiction, Database, LegRequirement, PathOfProcedure, Procedure, ProcedureLeg, Route};
use navbound_path::legs::{Follow, LegFoot, Limits, PathLeg, ProcedurePath as Legs, Tracked};
use navbound_path::{AtIndex, legs::State};
use numpy::{IntoPyArray, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A navigation database of ARINC 424.
#[pyclass(frozen, module = "navbound._core")]
struct NavigationDatabase(Database);

/// The legs of a procedure with their geometry.
#[pyclass(frozen, module = "navbound._core")]
struct ProcedurePath(Legs);

fn refused(e: OutOfDomain) -> PyErr {
    input_error(e, None)
}

fn refused_at(e: AtIndex) -> PyErr {
    input_error(e.error, Some(e.index))
}

fn missing(argument: &'static str, value: usize, domain: &'static str) -> PyErr {
    refused(OutOfDomain { argument, value: value as f64, unit: "1", domain })
}

fn gaps(route: &Route) -> Vec<(usize, u32, bool)> {
    route.gaps.iter().map(|g| (g.line, g.n_missing, g.inside)).collect()
}

fn letter(byte: u8) -> String {
    String::from_utf8_lossy(&[byte]).trim().to_owned()
}

type RouteRow = (String, String, usize, Vec<usize>, Vec<(usize, u32, bool)>);
type ProcedureRow = (String, &'static str, String, usize, Vec<RouteRow>, Vec<(usize, f64)>);

#[pymethods]
impl NavigationDatabase {
    /// Reads a file, plain or packed by gzip.
    #[staticmethod]
    fn read(py: Python<'_>, path: &str) -> PyResult<Self> {
        py.detach(|| arinc424::read_file(std::path::Path::new(path))).map(Self).map_err(|e| format_error(path, &e))
    }

    #[getter]
    fn header(&self) -> Vec<String> {
        self.0.header.clone()
    }
    #[getter]
    fn n_lines(&self) -> usize {
        self.0.n_lines
    }
    #[getter]
    fn n_refused(&self) -> usize {
        self.0.n_refused
    }
    #[getter]
    fn n_unattributed(&self) -> usize {
        self.0.n_unattributed
    }
    #[getter]
    fn refused(&self) -> Vec<(usize, String, String, String)> {
        self.0.refused.iter().map(|r| (r.line, r.field.clone(), r.reason.clone(), r.text.clone())).collect()
    }
    /// Records by kind.
    #[getter]
    fn counts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (d, c) = (PyDict::new(py), &self.0.counts);
        for (name, n) in [
            ("airports", c.airports),
            ("terminal_waypoints", c.terminal_waypoints),
            ("runways", c.runways),
            ("sids", c.sids),
            ("stars", c.stars),
            ("approaches", c.approaches),
            ("path_points", c.path_points),
            ("enroute_waypoints", c.enroute_waypoints),
            ("vhf_navaids", c.vhf_navaids),
            ("ndbs", c.ndbs),
            ("others", c.others),
        ] {
            d.set_item(name, n)?;
        }
        Ok(d)
    }

    /// Airport, kind, identifier, line, routes (type, transition, legs, refused lines, gaps) and lines of minima of every procedure.
    fn procedures(&self) -> Vec<ProcedureRow> {
        self.0.procedures().iter().map(row).collect()
    }

    /// Legs of some routes of a procedure, and their geometry.
    #[pyo3(signature = (procedure, routes, missed, selected_m, defaults))]
    fn path<'py>(
        &self,
        py: Python<'py>,
        procedure: usize,
        routes: Vec<usize>,
        missed: bool,
        selected_m: Option<f64>,
        defaults: bool,
    ) -> PyResult<(Vec<Bound<'py, PyDict>>, ProcedurePath)> {
        let p = self.0.procedures().get(procedure).ok_or_else(|| missing("procedure", procedure, "procedures of the file"))?;
        let routes: Option<Vec<_>> = routes.iter().map(|i| p.routes.get(*i)).collect();
        let routes = routes.ok_or_else(|| missing("routes", p.routes.len(), "routes of the procedure"))?;
        let PathOfProcedure { legs, path } = self.0.path_of(p, &routes, missed);
        let dicts = legs.iter().zip(path.legs()).map(|(leg, geometry)| {
            let required = LegRequirement::of(leg, &p.levels, selected_m, defaults);
            leg_dict(py, leg, geometry, &required)
        });
        Ok((dicts.collect::<PyResult<_>>()?, ProcedurePath(path)))
    }

    /// Contradictions in the published data.
    fn contradictions<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let findings = py.detach(|| self.0.contradictions());
        findings
            .iter()
            .map(|f| {
                let d = PyDict::new(py);
                d.set_item("line", f.line)?;
                d.set_item("airport", f.airport.as_str())?;
                d.set_item("procedure", f.procedure.as_str())?;
                d.set_item("transition", f.transition.as_str())?;
                d.set_item("sequence", f.sequence)?;
                d.set_item("kind", f.kind.id())?;
                d.set_item("remark", f.kind.is_remark())?;
                fields!(d, f: published, expected);
                Ok(d)
            })
            .collect()
    }

    /// Elevation of an airport; elevation of the threshold of one of its runways, and its height above the ellipsoid [m]; None where the
    /// file has none.
    fn elevations(&self, airport: &str, runway: &str) -> (Option<f64>, Option<f64>, Option<f64>) {
        let of_airport = self.0.airport(airport).and_then(|a| a.elevation_m);
        let threshold = self.0.runway(arinc424::Text::new(airport), arinc424::Text::new(runway));
        (of_airport, threshold.and_then(|r| r.elevation_m), threshold.and_then(|r| r.ellipsoid_height_m))
    }
}

fn row(p: &Procedure) -> ProcedureRow {
    let routes = p.routes.iter().map(|r| (letter(r.route_type), r.transition.to_string(), r.legs.len(), r.refused.clone(), gaps(r)));
    let levels = p.levels.iter().map(|l| (l.line, l.rnp_m)).collect();
    (p.name.airport.to_string(), p.name.kind.name(), p.name.ident.to_string(), p.line, routes.collect(), levels)
}

fn leg_dict<'py>(py: Python<'py>, l: &ProcedureLeg, geometry: &PathLeg, required: &LegRequirement) -> PyResult<Bound<'py, PyDict>> {
    let (d, leg) = (PyDict::new(py), &l.leg);
    fields!(d, leg: line, sequence);
    d.set_item("route_type", letter(l.route_type))?;
    d.set_item("transition", l.transition.as_str())?;
    d.set_item("part", l.part.id())?;
    d.set_item("fix", leg.fix.ident.as_str())?;
    d.set_item("fix_region", leg.fix.region.as_str())?;
    d.set_item("fix_section", leg.fix.section.as_str())?;
    d.set_item("lat_rad", l.fix.map(|p| p.lat().rad()))?;
    d.set_item("lon_rad", l.fix.map(|p| p.lon().rad()))?;
    d.set_item("description", leg.description.as_str())?;
    d.set_item("fly_over", leg.fly_over())?;
    d.set_item("role", letter(leg.role()))?;
    d.set_item("turn", letter(leg.turn))?;
    d.set_item("terminator", leg.terminator.as_str())?;
    d.set_item("rnp_coded_m", leg.rnp_m)?;
    d.set_item("rnp_m", required.rnp_m)?;
    d.set_item("rnp_origin", required.origin.id())?;
    d.set_item("rnp_differs", required.differs)?;
    d.set_item("navaid", leg.navaid.ident.as_str())?;
    d.set_item("radius_coded_m", leg.radius_m)?;
    fields!(d, leg: theta_rad, rho_m);
    d.set_item("course_field", leg.course_text.as_str())?;
    d.set_item("distance_field", leg.extent_text.as_str())?;
    d.set_item("altitude_description", letter(leg.altitude_description))?;
    d.set_item("altitude_fields", leg.altitude_text.map(|t| t.to_string()))?;
    d.set_item("altitude_m", leg.altitude_m)?;
    d.set_item("transition_altitude", leg.transition_altitude_text.as_str())?;
    d.set_item("speed_kt", leg.speed_kt)?;
    d.set_item("speed_description", letter(leg.speed_description))?;
    d.set_item("vertical_angle_rad", leg.vertical_angle_rad)?;
    d.set_item("centre_fix", leg.centre.ident.as_str())?;
    d.set_item("state", geometry.state.id())?;
    d.set_item("begin_m", geometry.begin.m())?;
    d.set_item("length_m", geometry.length.m())?;
    d.set_item("turn_rad", geometry.turn().rad())?;
    d.set_item("radius_m", geometry.radius().map(Metres::m))?;
    let r = geometry.residuals;
    d.set_item("start_to_centre_m", r.map(|r| r.start_to_centre.m()))?;
    d.set_item("end_to_centre_m", r.map(|r| r.end_to_centre.m()))?;
    d.set_item("centre_moved_m", r.map(|r| r.centre_moved.m()))?;
    d.set_item("course_begin_rad", r.map(|r| r.course_begin.rad()))?;
    d.set_item("course_end_rad", r.map(|r| r.course_end.rad()))?;
    Ok(d)
}

/// Columns of feet, NaN and -1 where there is none.
#[derive(Default)]
struct Columns {
    leg: Vec<i64>,
    along_m: Vec<f64>,
    along_leg_m: Vec<f64>,
    cross_m: Vec<f64>,
    course_rad: Vec<f64>,
    foot_lat_rad: Vec<f64>,
    foot_lon_rad: Vec<f64>,
}

impl Columns {
    fn push(&mut self, foot: Option<LegFoot>) {
        self.leg.push(foot.map_or(-1, |f| f.foot.leg as i64));
        self.along_m.push(foot.map_or(f64::NAN, |f| f.along.m()));
        self.along_leg_m.push(foot.map_or(f64::NAN, |f| f.foot.along.m()));
        self.cross_m.push(foot.map_or(f64::NAN, |f| f.foot.cross.m()));
        self.course_rad.push(foot.map_or(f64::NAN, |f| f.foot.course.rad()));
        self.foot_lat_rad.push(foot.map_or(f64::NAN, |f| f.foot.point.lat().rad()));
        self.foot_lon_rad.push(foot.map_or(f64::NAN, |f| f.foot.point.lon().rad()));
    }
    fn dict(self, py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
        let d = PyDict::new(py);
        d.set_item("leg", self.leg.into_pyarray(py))?;
        d.set_item("along_m", self.along_m.into_pyarray(py))?;
        d.set_item("along_leg_m", self.along_leg_m.into_pyarray(py))?;
        d.set_item("cross_m", self.cross_m.into_pyarray(py))?;
        d.set_item("course_rad", self.course_rad.into_pyarray(py))?;
        d.set_item("foot_lat_rad", self.foot_lat_rad.into_pyarray(py))?;
        d.set_item("foot_lon_rad", self.foot_lon_rad.into_pyarray(py))?;
        Ok(d)
    }
}

#[pymethods]
impl ProcedurePath {
    /// Length from the begin of the first leg to the end of the last.
    #[getter]
    fn length_m(&self) -> f64 {
        self.0.length().m()
    }

    /// Feet of positions, each on the leg nearest to it.
    fn nearest<'py>(
        &self,
        py: Python<'py>,
        lat_rad: PyReadonlyArray1<'py, f64>,
        lon_rad: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (lat, lon) = (lat_rad.as_slice()?, lon_rad.as_slice()?);
        let mut columns = Columns::default();
        for (index, (&lat, &lon)) in lat.iter().zip(lon).enumerate() {
            let at = |error| refused_at(AtIndex { index, error });
            let foot = match (lat.is_nan() && lon.is_nan(), LatLon::new(Radians::new(lat), Radians::new(lon))) {
                (true, _) => None,
                (false, place) => Some(self.0.nearest(&place.map_err(at)?).map_err(at)?),
            };
            columns.push(foot);
        }
        columns.dict(py)
    }

    /// Feet of a flight's positions on its active legs, with a status each; `legs` are RNP and whether the fix is flown over.
    #[pyo3(signature = (time_s, lat_rad, lon_rad, legs, limits))]
    fn follow<'py>(
        &self,
        py: Python<'py>,
        time_s: PyReadonlyArray1<'py, f64>,
        lat_rad: PyReadonlyArray1<'py, f64>,
        lon_rad: PyReadonlyArray1<'py, f64>,
        legs: Vec<(f64, bool)>,
        limits: [f64; 6],
    ) -> PyResult<Bound<'py, PyDict>> {
        let [sigma_along_m, gap_s, nearer_s, established_s, established_rad, bank_rad] = limits;
        let limits = Limits { sigma_along_m, gap_s, nearer_s, established_s, established_rad, bank_rad };
        let (time, lat, lon) = (time_s.as_slice()?, lat_rad.as_slice()?, lon_rad.as_slice()?);
        let (rnp_m, fly_over): (Vec<f64>, Vec<bool>) = legs.into_iter().unzip();
        let follow = Follow::new(&self.0, &rnp_m, &fly_over, limits).map_err(refused)?;
        let followed = py.detach(|| follow.all(time, lat, lon)).map_err(refused_at)?;
        let mut columns = Columns::default();
        followed.iter().for_each(|f| columns.push(f.foot));
        let d = columns.dict(py)?;
        let status: Vec<u8> = followed.iter().map(|f| f.status as u8).collect();
        d.set_item("status", status.into_pyarray(py))?;
        Ok(d)
    }

    /// Positions and courses of one leg at distances from its begin.
    fn at<'py>(&self, py: Python<'py>, leg: usize, along_m: PyReadonlyArray1<'py, f64>) -> PyResult<Bound<'py, PyDict>> {
        let leg = self.0.legs().get(leg).ok_or_else(|| missing("leg", leg, "legs of the procedure"))?;
        let (mut lat, mut lon, mut course) = (Vec::new(), Vec::new(), Vec::new());
        for (index, along) in along_m.as_slice()?.iter().enumerate() {
            let place = leg.at(Metres::new(*along)).map_err(|error| refused_at(AtIndex { index, error }))?;
            lat.push(place.point.lat().rad());
            lon.push(place.point.lon().rad());
            course.push(place.course.rad());
        }
        let d = PyDict::new(py);
        d.set_item("lat_rad", lat.into_pyarray(py))?;
        d.set_item("lon_rad", lon.into_pyarray(py))?;
        d.set_item("course_rad", course.into_pyarray(py))?;
        Ok(d)
    }
}

/// Stable ids: states of legs, of positions along them, and kinds of contradictions.
#[pyfunction]
fn procedure_words() -> (Vec<&'static str>, Vec<&'static str>, Vec<&'static str>) {
    (
        State::ALL.iter().map(|s| s.id()).collect(),
        Tracked::ALL.iter().map(|s| s.id()).collect(),
        Contradiction::ALL.iter().map(|s| s.id()).collect(),
    )
}

pub fn register(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add_class::<NavigationDatabase>()?;
    m.add_class::<ProcedurePath>()?;
    m.add_function(wrap_pyfunction!(procedure_words, m)?)
}
