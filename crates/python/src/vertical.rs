//! Heights by pressure, the vertical error budget, and the test of an altimeter's setting.

use crate::batch::{numbers, table};
use crate::error::input_error;
use navbound_core::bound::tse::Deviation;
use navbound_core::bound::vertical::{self, Approach, Budget, Constants, FEET, METRES};
use navbound_core::geometry::barometric::{Air, VerticalPath, setting_offset};
use navbound_core::monitor::altimeter::{SettingTest, setting_line};
use navbound_core::quantity::{Metres, OutOfDomain, Radians, Risk};
use numpy::{PyArray1, PyArray2, PyReadonlyArray1};
use pyo3::prelude::*;

type Numbers<'py> = PyReadonlyArray1<'py, f64>;
type Column<'py> = PyResult<Bound<'py, PyArray1<f64>>>;
type Table<'py> = PyResult<Bound<'py, PyArray2<f64>>>;

fn m(value: f64) -> Metres {
    Metres::new(value)
}

#[pyfunction]
fn vertical_setting_offset<'py>(py: Python<'py>, setting_hpa: Numbers<'py>) -> Column<'py> {
    let q = setting_hpa.as_slice()?;
    numbers(py, q.len(), |i| Ok(setting_offset(q[i])?.m()))
}

/// Deviations from the standard atmosphere, of temperatures at stations.
#[pyfunction]
fn vertical_deviation<'py>(py: Python<'py>, station_m: Numbers<'py>, temperature_k: Numbers<'py>) -> Column<'py> {
    let (s, t) = (station_m.as_slice()?, temperature_k.as_slice()?);
    numbers(py, s.len(), |i| Ok(Air::of_station(m(s[i]), t[i])?.deviation_k()))
}

/// `which`: 0 the true height of an indicated one, 1 the reverse, 2 the correction of Doc 8168.
#[pyfunction]
fn vertical_height<'py>(
    py: Python<'py>,
    which: u8,
    height_m: Numbers<'py>,
    station_m: Numbers<'py>,
    deviation_k: Numbers<'py>,
) -> Column<'py> {
    let (h, s, d) = (height_m.as_slice()?, station_m.as_slice()?, deviation_k.as_slice()?);
    numbers(py, h.len(), |i| {
        let air = Air::new(m(s[i]), d[i])?;
        let height = match which {
            0 => air.true_height(m(h[i])),
            1 => air.indicated_height(m(h[i])),
            _ => air.correction_doc8168(m(h[i])),
        };
        Ok(height?.m())
    })
}

/// `which`: 0 altitude of the barometric path at a distance, 1 of the straight ray, 2 distance of the barometric path at an altitude.
#[pyfunction]
fn vertical_path<'py>(py: Python<'py>, which: u8, x_m: Numbers<'py>, crossing_m: Numbers<'py>, angle_rad: Numbers<'py>) -> Column<'py> {
    let (x, c, a) = (x_m.as_slice()?, crossing_m.as_slice()?, angle_rad.as_slice()?);
    numbers(py, x.len(), |i| {
        let path = VerticalPath::new(m(c[i]), Radians::new(a[i]))?;
        let along = match which {
            0 => path.barometric_altitude(m(x[i])),
            1 => path.straight_altitude(m(x[i])),
            _ => path.barometric_distance(m(x[i])),
        };
        Ok(along?.m())
    })
}

fn constants_of(id: &str) -> PyResult<&'static Constants> {
    [&FEET, &METRES]
        .into_iter()
        .find(|c| c.id == id)
        .ok_or_else(|| pyo3::exceptions::PyValueError::new_err(format!("{id}: no such constants")))
}

/// Id, source and provenance of each set of constants.
#[pyfunction]
fn vertical_constants() -> Vec<(&'static str, &'static str, &'static str, f64)> {
    [&FEET, &METRES].map(|c| (c.id, c.source, c.provenance.word(), c.body_geometry.m())).to_vec()
}

/// Six terms, their root and the budget of each place.
#[pyfunction]
fn vertical_budget<'py>(py: Python<'py>, constants: &str, at: [Numbers<'py>; 6]) -> Table<'py> {
    let constants = constants_of(constants)?;
    let [rnp, angle, altitude, threshold, body, isad] = &at;
    let (r, a, h, t) = (rnp.as_slice()?, angle.as_slice()?, altitude.as_slice()?, threshold.as_slice()?);
    let (b, d) = (body.as_slice()?, isad.as_slice()?);
    table(py, r.len(), |i| {
        let at = Approach { rnp: m(r[i]), angle: Radians::new(a[i]), altitude: m(h[i]), threshold: m(t[i]) };
        let budget = Budget::new(constants, &at, m(b[i]), m(d[i]))?;
        let terms = [budget.anpe, budget.wpr, budget.fte, budget.ase, budget.vae, budget.atis, budget.root_sum_square, budget.total];
        Ok(terms.map(Metres::m))
    })
}

#[pyfunction]
fn vertical_turn_geometry<'py>(py: Python<'py>, semispan_m: Numbers<'py>, bank_rad: Numbers<'py>) -> Column<'py> {
    let (s, b) = (semispan_m.as_slice()?, bank_rad.as_slice()?);
    numbers(py, s.len(), |i| Ok(vertical::turn_geometry(m(s[i]), Radians::new(b[i]))?.m()))
}

#[pyfunction]
fn vertical_requirement<'py>(
    py: Python<'py>,
    constants: &str,
    rnp_m: Numbers<'py>,
    angle_rad: Numbers<'py>,
    altitude_m: Numbers<'py>,
) -> Column<'py> {
    let constants = constants_of(constants)?;
    let (r, a, h) = (rnp_m.as_slice()?, angle_rad.as_slice()?, altitude_m.as_slice()?);
    numbers(py, r.len(), |i| Ok(vertical::requirement(constants, m(r[i]), Radians::new(a[i]), m(h[i]))?.m()))
}

#[pyfunction]
fn vertical_off_path_sigma<'py>(
    py: Python<'py>,
    along_m: Numbers<'py>,
    up_m: Numbers<'py>,
    correlation: Numbers<'py>,
    angle_rad: Numbers<'py>,
) -> Column<'py> {
    let (a, u, r, g) = (along_m.as_slice()?, up_m.as_slice()?, correlation.as_slice()?, angle_rad.as_slice()?);
    numbers(py, a.len(), |i| Ok(vertical::off_path_sigma(m(a[i]), m(u[i]), r[i], Radians::new(g[i]))?.m()))
}

#[pyfunction]
fn vertical_risk_below<'py>(py: Python<'py>, fte_m: Numbers<'py>, sigma_m: Numbers<'py>, limit_m: Numbers<'py>) -> Column<'py> {
    let (f, s, l) = (fte_m.as_slice()?, sigma_m.as_slice()?, limit_m.as_slice()?);
    numbers(py, f.len(), |i| vertical::risk_below(Deviation::new(m(f[i]), m(s[i]))?, m(l[i])))
}

/// Points, intercept, slope and standard deviation of the residuals.
#[pyfunction]
fn vertical_setting_line<'py>(height_m: Numbers<'py>, difference_m: Numbers<'py>) -> PyResult<(usize, f64, f64, f64)> {
    let (x, y) = (height_m.as_slice()?, difference_m.as_slice()?);
    let line = setting_line(x.iter().copied().zip(y.iter().copied())).map_err(|e| input_error(e, None))?;
    Ok((line.n, line.intercept.m(), line.slope, line.residual_sigma.m()))
}

/// Threshold, power at an error, and the error found with a probability.
#[pyfunction]
fn vertical_setting_test<'py>(
    py: Python<'py>,
    sigma_m: Numbers<'py>,
    risk: Numbers<'py>,
    error_m: Numbers<'py>,
    probability: Numbers<'py>,
) -> Table<'py> {
    let (s, q, d, p) = (sigma_m.as_slice()?, risk.as_slice()?, error_m.as_slice()?, probability.as_slice()?);
    table(py, s.len(), |i| {
        let test = SettingTest::new(m(s[i]), Risk::new(q[i]).map_err(|e| OutOfDomain { argument: "false_alarm", ..e })?)?;
        if !d[i].is_finite() {
            return Err(OutOfDomain { argument: "error_m", value: d[i], unit: "m", domain: "(-inf, inf)" });
        }
        Ok([test.threshold().m(), test.power(m(d[i])), test.detectable(p[i])?.m()])
    })
}

pub fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(vertical_setting_offset, module)?)?;
    module.add_function(wrap_pyfunction!(vertical_deviation, module)?)?;
    module.add_function(wrap_pyfunction!(vertical_height, module)?)?;
    module.add_function(wrap_pyfunction!(vertical_path, module)?)?;
    module.add_function(wrap_pyfunction!(vertical_constants, module)?)?;
    module.add_function(wrap_pyfunction!(vertical_budget, module)?)?;
    module.add_function(wrap_pyfunction!(vertical_turn_geometry, module)?)?;
    module.add_function(wrap_pyfunction!(vertical_requirement, module)?)?;
    module.add_function(wrap_pyfunction!(vertical_off_path_sigma, module)?)?;
    module.add_function(wrap_pyfunction!(vertical_risk_below, module)?)?;
    module.add_function(wrap_pyfunction!(vertical_setting_line, module)?)?;
    module.add_function(wrap_pyfunction!(vertical_setting_test, module)?)
}
