//! Solution separation as entries of the list of algorithms.

use super::modes::{Book, FaultModes, NoModes};
use super::service::{Service, SupportMessage};
use super::single::{self, Requirement};
use super::{Detail, Levels, Monitor, exclusion};
use crate::bound::{Algorithm, NoLevels, Protection, Ranges, Sight};
use crate::quantity::Metres;
use crate::signal::Constellation;

const COLUMNS: &[&str] =
    &["hpl_e_m", "hpl_n_m", "emt_m", "sigma_acc_e_m", "sigma_acc_n_m", "sigma_acc_u_m", "p_unmonitored", "n_modes", "n_monitored"];

fn number(detail: &Detail, column: usize) -> f64 {
    let ([hpl_e, hpl_n], [e, n, u]) = (detail.axes.map(Metres::m), detail.sigma_accuracy.map(Metres::m));
    let (modes, monitored) = (detail.n_modes as f64, detail.n_monitored as f64);
    let numbers = [hpl_e, hpl_n, detail.emt.m(), e, n, u, detail.p_unmonitored, modes, monitored];
    numbers.get(column).copied().unwrap_or(f64::NAN)
}

/// What the levels of [`Araim`] are requested under.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// The service.
    pub service: Service,
    /// Prior of each constellation, in the order of [`Constellation::index`].
    pub p_const: [f64; Constellation::ALL.len()],
    /// Whether the levels hold after an exclusion too.
    pub exclusion: bool,
}

/// Fault modes with priors: satellites and constellations.
#[derive(Debug, Clone)]
pub struct Araim {
    monitor: Monitor,
    settings: Settings,
    modes: Modes,
}

/// Works the modes of every epoch out anew.
#[derive(Debug, Clone)]
struct Modes {
    p_const: [f64; Constellation::ALL.len()],
    at_hand: Option<FaultModes>,
}

impl Book for Modes {
    fn modes(&mut self, sights: &[Sight], service: &Service) -> Result<&FaultModes, NoModes> {
        Ok(self.at_hand.insert(service.modes(sights, &self.p_const)?))
    }
}

impl Algorithm for Araim {
    const PROTECTION: Protection = super::PROTECTION;
    const RANGES: Ranges = Ranges::Receiver;
    const COLUMNS: &'static [&'static str] = COLUMNS;
    type Settings = Settings;
    type Detail = Detail;

    fn usual() -> Settings {
        Settings { service: Service::LPV_200, p_const: SupportMessage::STUDY.support.map(|s| s.p_const), exclusion: false }
    }

    fn new(settings: &Settings) -> Self {
        Self { monitor: Monitor::default(), settings: *settings, modes: Modes { p_const: settings.p_const, at_hand: None } }
    }

    #[inline(always)]
    fn levels(&mut self, sights: &[Sight]) -> Result<Levels, NoLevels> {
        let Self { monitor, settings, modes } = self;
        if settings.exclusion {
            exclusion::predicted(monitor, modes, sights, &settings.service)
        } else {
            exclusion::detected(monitor, modes, sights, &settings.service)
        }
    }

    fn number(detail: &Detail, column: usize) -> f64 {
        number(detail, column)
    }
}

/// One satellite at a time, no priors.
#[derive(Debug, Clone)]
pub struct Separation {
    monitor: Monitor,
    requirement: Requirement,
    exclusion: bool,
}

impl Algorithm for Separation {
    const PROTECTION: Protection = single::PROTECTION;
    const RANGES: Ranges = Ranges::Receiver;
    const COLUMNS: &'static [&'static str] = COLUMNS;
    /// The requirement, and whether the levels hold after an exclusion too.
    type Settings = (Requirement, bool);
    type Detail = Detail;

    fn usual() -> Self::Settings {
        (Requirement::RAIM, false)
    }

    fn new((requirement, exclusion): &Self::Settings) -> Self {
        Self { monitor: Monitor::default(), requirement: *requirement, exclusion: *exclusion }
    }

    #[inline(always)]
    fn levels(&mut self, sights: &[Sight]) -> Result<Levels, NoLevels> {
        if self.exclusion {
            self.monitor.single_levels_after_exclusion(sights, &self.requirement)
        } else {
            self.monitor.single_levels(sights, &self.requirement)
        }
    }

    fn number(detail: &Detail, column: usize) -> f64 {
        number(detail, column)
    }
}
