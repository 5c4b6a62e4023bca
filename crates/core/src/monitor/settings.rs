//! How the monitor is set, and whether the crew would know in time.

use crate::quantity::OutOfDomain;

/// Times and ratio of the RNP monitor. Build with [`Settings::new`], which refuses a chain too slow for its time to alert.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Times from the error to the crew.
    pub chain: Chain,
    /// How long the accuracy bound must stay outside before the caution \[s\]. The warning never waits.
    pub raise_delay_s: f64,
    /// How long the bound must stay within `clear_ratio` of its limit before an alert ends \[s\].
    pub clear_delay_s: f64,
    /// Share of the limit the bound must be within for an alert to end, in (0, 1].
    pub clear_ratio: f64,
    /// Silence after which monitoring is lost \[s\].
    pub stale_after_s: f64,
}

/// What lies between an error and the crew.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chain {
    /// Time between epochs \[s\].
    pub sample_period_s: f64,
    /// Age of the measurement when it arrives \[s\].
    pub sensor_latency_s: f64,
    /// Delay of filtering \[s\].
    pub filter_s: f64,
    /// Computing \[s\].
    pub computing_s: f64,
    /// Display \[s\].
    pub display_s: f64,
    /// Time to alert: the most all of it may take \[s\]. Infinite where nobody is to be alerted (a recorded flight).
    pub time_to_alert_s: f64,
}

impl Chain {
    /// Time from an error to the crew when the monitor itself waits `delay_s`.
    pub fn total_s(&self, delay_s: f64) -> f64 {
        self.sample_period_s + self.sensor_latency_s + self.filter_s + self.computing_s + delay_s + self.display_s
    }

    /// Time from the last epoch to the crew when silence is noticed after `stale_after_s`.
    fn silence_s(&self, stale_after_s: f64) -> f64 {
        stale_after_s + self.computing_s + self.display_s
    }
}

/// The default silence: two sample periods, at least two seconds.
pub fn default_stale_after_s(sample_period_s: f64) -> f64 {
    (2.0 * sample_period_s).max(2.0)
}

impl Settings {
    /// Checked settings.
    ///
    /// # Errors
    /// [`OutOfDomain`] naming the time that is negative, not finite or, for the whole chain, above the time to alert.
    pub fn checked(self) -> Result<Self, OutOfDomain> {
        let chain = &self.chain;
        positive("sample_period_s", chain.sample_period_s)?;
        not_negative("sensor_latency_s", chain.sensor_latency_s)?;
        not_negative("filter_s", chain.filter_s)?;
        not_negative("computing_s", chain.computing_s)?;
        not_negative("display_s", chain.display_s)?;
        not_negative("raise_delay_s", self.raise_delay_s)?;
        not_negative("clear_delay_s", self.clear_delay_s)?;
        if !(self.clear_ratio > 0.0 && self.clear_ratio <= 1.0) {
            return Err(OutOfDomain { argument: "clear_ratio", value: self.clear_ratio, unit: "1", domain: "(0, 1]" });
        }
        if !(self.stale_after_s >= chain.sample_period_s && self.stale_after_s.is_finite()) {
            let domain = "[sample_period_s, inf): one period of silence is normal";
            return Err(OutOfDomain { argument: "stale_after_s", value: self.stale_after_s, unit: "s", domain });
        }
        if !(chain.time_to_alert_s > 0.0) {
            return Err(OutOfDomain { argument: "time_to_alert_s", value: chain.time_to_alert_s, unit: "s", domain: "(0, inf]" });
        }
        within(
            chain,
            "time to the crew of an exceedance",
            chain.total_s(self.raise_delay_s),
            "[0, time_to_alert_s]: sample period + sensor latency + filter + computing + raise delay + display",
        )?;
        within(
            chain,
            "time to the crew of a silence",
            chain.silence_s(self.stale_after_s),
            "[0, time_to_alert_s]: stale_after_s + computing + display",
        )?;
        Ok(self)
    }
}

fn within(chain: &Chain, argument: &'static str, value: f64, domain: &'static str) -> Result<(), OutOfDomain> {
    if !(value <= chain.time_to_alert_s) {
        return Err(OutOfDomain { argument, value, unit: "s", domain });
    }
    Ok(())
}

fn positive(argument: &'static str, value: f64) -> Result<(), OutOfDomain> {
    if !(value > 0.0 && value.is_finite()) {
        return Err(OutOfDomain { argument, value, unit: "s", domain: "(0, inf)" });
    }
    Ok(())
}

fn not_negative(argument: &'static str, value: f64) -> Result<(), OutOfDomain> {
    if !(value >= 0.0 && value.is_finite()) {
        return Err(OutOfDomain { argument, value, unit: "s", domain: "[0, inf)" });
    }
    Ok(())
}
