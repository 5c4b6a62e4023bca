//! Error Extraction over whole series: the filter and its bound, epoch after epoch; series on all cores.

use crate::batch::Rejected;
use crate::parallel;
use crate::sky::{Sights, Solved, solve};
use navbound_core::bound::ee::noise::{self, Meter};
use navbound_core::bound::ee::{Both, NotIntegrity, bias};
use navbound_core::frame::Displacement;
use navbound_core::quantity::{GpsTime, Metres, OutOfDomain};
use navbound_core::solution::extraction::{self, Extracted, Filter, Reset, Sample, gain};
use navbound_core::solution::wls::{dilution, responses};
use navbound_path::AtIndex;

/// Series of equal length, one after the other; `xyz` arrays hold three numbers an epoch, east, north, up.
#[derive(Debug, Clone, Copy)]
pub struct Series<'a> {
    /// Epochs of one series.
    pub epochs: usize,
    /// GPS time \[ns\].
    pub time_ns: &'a [i64],
    /// Position from a fixed local origin \[m\]; NaN where there is none.
    pub position_xyz: &'a [[f64; 3]],
    /// Velocity \[m/s\]; NaN where there is none.
    pub velocity_xyz: &'a [[f64; 3]],
    /// Changes when the set of satellites does; empty where that is not known.
    pub satellites: &'a [u64],
    /// Horizontal and vertical bias part of the bound \[m\]; NaN where there is none.
    pub bias: &'a [[f64; 2]],
}

/// How.
#[derive(Debug, Clone, Copy)]
pub struct Settings {
    /// The filter.
    pub filter: extraction::Settings,
    /// The bound.
    pub noise: noise::Settings,
}

/// One epoch. Lengths are NaN where they do not exist: without a solution all, the sums and bounds also until the window is full.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// Extracted error u \[m\].
    pub error: [f64; 3],
    /// Size E of the error \[m\].
    pub size: [f64; 2],
    /// Sum S over the window \[m\].
    pub sum: [f64; 2],
    /// Noise part of the bound \[m\].
    pub noise: [f64; 2],
    /// The bound \[m\]; NaN also without a bias part.
    pub bound: [f64; 2],
    /// Samples since the last reset; `None` without a solution.
    pub age: Option<u32>,
    /// Whether and why the filter began anew.
    pub reset: Option<Reset>,
    /// Whether the set of satellites is another than at the solution before.
    pub new_satellites: bool,
}

const ABSENT: Row = Row {
    error: [f64::NAN; 3],
    size: [f64::NAN; 2],
    sum: [f64::NAN; 2],
    noise: [f64::NAN; 2],
    bound: [f64::NAN; 2],
    age: None,
    reset: None,
    new_satellites: false,
};

/// Filter and bound of every epoch.
///
/// An epoch whose position or velocity holds a NaN is one that is missing: the next one sees a longer step.
///
/// # Errors
/// [`Rejected`] for the first epoch, counted through all series, whose time is not after the one before or whose number is infinite.
pub fn extract(series: &Series<'_>, settings: &Settings) -> Result<Vec<Row>, Rejected> {
    let n = series.time_ns.len();
    let starts: Vec<usize> = (0..n).step_by(series.epochs.max(1)).collect();
    Ok(parallel::try_map(starts.len(), 1, |track| one(series, starts[track], settings))?.concat())
}

fn one(series: &Series<'_>, start: usize, settings: &Settings) -> Result<Vec<Row>, Rejected> {
    let mut filter = Filter::new(settings.filter);
    let mut meter = Meter::new(settings.noise);
    let mut last_ns = None;
    let mut rows = Vec::with_capacity(series.epochs);
    for index in start..start + series.epochs {
        let time_ns = series.time_ns[index];
        if last_ns.is_some_and(|last| time_ns <= last) {
            let reason = OutOfDomain { argument: "time_ns", value: time_ns as f64, unit: "ns", domain: "times that increase" };
            return Err(Rejected { index, reason });
        }
        last_ns = Some(time_ns);
        rows.push(match sample(series, index) {
            Some(sample) => {
                let extracted = filter.step(&sample).map_err(|reason| Rejected { index, reason })?;
                row(&extracted, &meter.step(&extracted), series.bias[index])
            }
            None => ABSENT,
        });
    }
    Ok(rows)
}

fn sample(series: &Series<'_>, index: usize) -> Option<Sample> {
    let (position, velocity) = (series.position_xyz[index], series.velocity_xyz[index]);
    if position.iter().chain(&velocity).any(|v| v.is_nan()) {
        return None;
    }
    Some(Sample {
        time: GpsTime::from_nanoseconds(series.time_ns[index]),
        position: Displacement::new(Metres::new(position[0]), Metres::new(position[1]), Metres::new(position[2])),
        velocity_mps: velocity,
        satellites: series.satellites.get(index).copied(),
    })
}

fn row(extracted: &Extracted, noise: &noise::Noise, bias: [f64; 2]) -> Row {
    let pair = |both: Option<Both>| both.map_or([f64::NAN; 2], metres);
    let [noise_h, noise_v] = pair(noise.bound);
    Row {
        error: (*extracted.error.vector()).into(),
        size: metres(noise.size),
        sum: pair(noise.sum),
        noise: [noise_h, noise_v],
        bound: [noise_h + bias[0], noise_v + bias[1]],
        age: Some(extracted.age),
        reset: extracted.reset,
        new_satellites: extracted.new_satellites,
    }
}

fn metres(both: Both) -> [f64; 2] {
    [both.horizontal, both.vertical].map(NotIntegrity::m)
}

/// Worst biases of one solution \[m\], horizontal and vertical.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bias {
    /// From the dilutions, as published.
    pub from_dop: [f64; 2],
    /// The worst of the weighted solution itself.
    pub exact: [f64; 2],
}

/// Both readings of the bias part for many solutions.
///
/// # Errors
/// As [`solve`]; the bias itself is refused as the first item.
pub fn biases(sights: &Sights<'_>, mu: Metres, alpha: f64) -> Result<Solved<Bias>, AtIndex> {
    bias::dop(0.0, 0.0, 4, mu, alpha).map_err(|error| AtIndex { index: 0, error })?;
    solve(sights, |used| {
        let d = dilution(used.iter())?;
        let from_dop = bias::dop(d.horizontal, d.vertical, used.len(), mu, alpha)?;
        Ok(Bias { from_dop: metres(from_dop), exact: metres(bias::exact(responses(used.iter())?, mu)?) })
    })
}

/// Share beta of a Gauss-Markov error that passes the filter, and the deviation that is left of it after the correction, of one before.
///
/// # Errors
/// As [`gain::gauss_markov`].
pub fn gauss_markov_gains(rho: f64, period_s: f64, tau_s: f64) -> Result<[f64; 2], OutOfDomain> {
    let passed = gain::gauss_markov(rho, period_s, tau_s)?;
    let left = gain::corrected_gauss_markov(rho, period_s, tau_s)?;
    Ok([gain::beta(passed), left.sqrt()])
}

#[cfg(test)]
mod tests {
    use super::*;
    use navbound_core::bound::ee::noise::{Form, HorizontalBeta, Shape};
    use navbound_core::quantity::Risk;

    const SECOND_NS: i64 = 1_000_000_000;

    fn settings() -> Settings {
        let risk = Risk::new(1e-7).unwrap();
        let noise = noise::Settings::new(Shape::new(4, 0.5).unwrap(), 1.2, (HorizontalBeta::Outside, Form::CfarSum), (risk, risk)).unwrap();
        Settings { filter: extraction::Settings::new(0.98, 1.0, 3.0, false).unwrap(), noise }
    }

    fn times(n: usize) -> Vec<i64> {
        (0..n as i64).map(|i| i * SECOND_NS).collect()
    }

    /// Two series stand beside each other as they would alone; a missing epoch is a longer step, whatever it holds.
    #[test]
    fn series_do_not_touch_and_missing_epochs_are_longer_steps() {
        let n = 20;
        let up = |i: usize| [0.3 * (i as f64).sin(), 0.1 * i as f64, (0.7 * i as f64).cos()];
        let position: Vec<[f64; 3]> = (0..2 * n).map(|i| if i == 7 { [0.0, f64::NAN, 5.0] } else { up(i) }).collect();
        let time_ns = [times(n), times(n)].concat();
        let (velocity_xyz, bias) = (vec![[0.0; 3]; 2 * n], vec![[6.0, 7.0]; 2 * n]);
        let both =
            Series { epochs: n, time_ns: &time_ns, position_xyz: &position, velocity_xyz: &velocity_xyz, satellites: &[], bias: &bias };
        let extraction = extract(&both, &settings()).unwrap();
        let kept: Vec<usize> = (0..n).filter(|i| *i != 7).collect();
        let pick = |s: &[[f64; 3]]| kept.iter().map(|i| s[*i]).collect::<Vec<_>>();
        let without = Series {
            epochs: kept.len(),
            time_ns: &kept.iter().map(|i| time_ns[*i]).collect::<Vec<_>>(),
            position_xyz: &pick(&position),
            velocity_xyz: &pick(&velocity_xyz),
            ..both
        };
        let alone = extract(&without, &settings()).unwrap();
        assert!(extraction[7].age.is_none() && extraction[7].error[0].is_nan() && extraction[7].bound[0].is_nan());
        for (row, i) in alone.iter().zip(kept) {
            assert_eq!(format!("{row:?}"), format!("{:?}", extraction[i]));
        }
        let second = Series { time_ns: &times(n), position_xyz: &position[n..], ..both };
        assert_eq!(format!("{:?}", extract(&second, &settings()).unwrap()), format!("{:?}", &extraction[n..]));
        assert_eq!(extraction[3].bound[1], extraction[3].noise[1] + 7.0);
    }

    #[test]
    fn the_first_wrong_epoch_is_named() {
        let (velocity_xyz, bias) = (vec![[0.0; 3]; 6], vec![[0.0; 2]; 6]);
        let (times, still) = ([times(3), times(3)].concat(), [0, SECOND_NS, 2 * SECOND_NS, 0, 0, SECOND_NS]);
        // A time that stands still is refused also where the solution is missing.
        for (time_ns, value, argument) in [(&times[..], f64::INFINITY, "position_enu_m"), (&still[..], f64::NAN, "time_ns")] {
            let mut position = vec![[0.0; 3]; 6];
            position[4][1] = value;
            let series = Series { epochs: 3, time_ns, position_xyz: &position, velocity_xyz: &velocity_xyz, satellites: &[], bias: &bias };
            let refused = extract(&series, &settings()).unwrap_err();
            assert_eq!((refused.index, refused.reason.argument), (4, argument));
        }
    }
}
