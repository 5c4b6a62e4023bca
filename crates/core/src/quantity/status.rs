//! Status and reason of an epoch: the one place that knows their ids and their words.
//!
//! Tables, events and results carry ids. A sentence is made where a person reads it: report, command line, table column `reason`.
//! Nothing compares, groups by or parses a sentence.

use super::Unavailable;

/// Whether an epoch's position may be used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Status {
    /// Usable.
    Ok,
    /// Usable, with a reason to trust it less.
    Degraded,
    /// There is no position, or none that may be used.
    NotAvailable,
    /// A number of the input cannot be true.
    InvalidInput,
}

impl Status {
    /// All, in the order of their codes.
    pub const ALL: [Self; 4] = [Self::Ok, Self::Degraded, Self::NotAvailable, Self::InvalidInput];

    /// The id of tables; it never changes.
    pub const fn id(self) -> &'static str {
        match self {
            Self::Ok => "ok",
            Self::Degraded => "degraded",
            Self::NotAvailable => "not_available",
            Self::InvalidInput => "invalid_input",
        }
    }

    /// One English sentence, for people.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Ok => "the position is usable",
            Self::Degraded => "the position is usable with less trust",
            Self::NotAvailable => "no usable position",
            Self::InvalidInput => "a number of the input cannot be true",
        }
    }

    /// Whether the position may be used.
    pub const fn usable(self) -> bool {
        matches!(self, Self::Ok | Self::Degraded)
    }

    /// The status of an id.
    pub fn from_id(id: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|s| s.id() == id)
    }
}

/// One line a reason: variant, id, status of the epoch, sentence.
macro_rules! reasons {
    ($($(#[doc = $doc:literal])+ $variant:ident, $id:literal, $status:ident, $words:literal;)+) => {
        /// Why an epoch has the status that it has, or no level.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        #[non_exhaustive]
        #[repr(u8)]
        pub enum Reason {
            $($(#[doc = $doc])+ $variant,)+
        }

        impl Reason {
            /// All, in the order of their codes.
            pub const ALL: &'static [Self] = &[$(Self::$variant,)+];

            /// The id of tables; it never changes.
            pub const fn id(self) -> &'static str {
                match self { $(Self::$variant => $id,)+ }
            }

            /// What the reason makes of the epoch's position. `Ok` means that the position stands and only its level does not exist.
            pub const fn status(self) -> Status {
                match self { $(Self::$variant => Status::$status,)+ }
            }

            /// One English sentence, for people.
            pub const fn words(self) -> &'static str {
                match self { $(Self::$variant => $words,)+ }
            }
        }
    };
}

reasons! {
    /// A method lacks a field.
    MissingField, "missing_field", NotAvailable, "a field that the method needs is missing";
    /// Fewer satellites than unknowns.
    TooFewSatellites, "too_few_satellites", NotAvailable, "fewer usable satellites than unknowns";
    /// The satellites do not determine the position.
    Singular, "singular", NotAvailable, "the geometry does not determine the position";
    /// A solution that cannot be true.
    NoPlausibleSolution, "no_plausible_solution", NotAvailable, "the solution cannot be true";
    /// A number outside its domain.
    InvalidNumber, "invalid_number", InvalidInput, "a number is outside its domain";
    /// More satellites or fault modes than there is room for.
    TooMany, "too_many", NotAvailable, "more satellites or fault modes than there is room for";
    /// The integrity risk is spent on faults that have no monitor.
    NotMonitored, "not_monitored", Ok, "the integrity risk is spent on faults that cannot be monitored";
    /// No redundancy to detect a fault with.
    FaultNotDetectable, "fault_not_detectable", Ok, "a fault could not be detected";
    /// A detected fault that no exclusion removes.
    FaultNotExcluded, "fault_not_excluded", NotAvailable, "a fault that cannot be excluded";
    /// A detected fault whose satellites are left out.
    FaultExcluded, "fault_excluded", Degraded, "excluded";
    /// Residuals of this epoch.
    ResidualsContradict, "residuals_contradict", Degraded, "the residuals contradict the weights";
    /// Residuals of the last minute.
    RecentResidualsContradict, "recent_residuals_contradict", Degraded,
        "the ranges of the last minute contradict the weights: reflections or obstruction";
    /// As many satellites as unknowns.
    NoRedundancy, "no_redundancy", Degraded, "no satellite to spare: the residuals cannot be tested";
    /// Ranges to spare that check one clock each.
    ClockUnchecked, "clock_unchecked", Degraded, "too few satellites to spare: a second constellation checks nothing but its own clock";
    /// An exclusion among several that fit.
    ExclusionUnconfirmed, "exclusion_unconfirmed", Degraded, "an exclusion that the remaining ranges cannot confirm";
    /// Nothing excluded, and another reading fits as well.
    ReadingUnconfirmed, "reading_unconfirmed", Degraded, "too few satellites to spare: a fault of one could not be seen";
    /// A position that is hardly known.
    WideCircle, "wide_circle", Degraded, "the declared 95 % circle is wider than 185.2 m (0.1 NM)";
    /// Single frequencies without a message.
    IonosphereUndescribed, "ionosphere_undescribed", Degraded, "no message describes the ionosphere: heights can be wrong by metres";
    /// A height that no receiver has.
    ImplausibleHeight, "implausible_height", NotAvailable, "the height is none that a receiver has: outside -1 to 100 km";
    /// A geometry that hardly determines the position.
    ImplausibleDilution, "implausible_dilution", NotAvailable, "the satellites hardly determine the position: dilution above 30";
    /// Farther from the last position than a receiver moves.
    ImplausibleJump, "implausible_jump", NotAvailable,
        "the position jumps farther than a receiver moves: more than 600 m/s, and Doppler does not support it";
    /// Residuals against an augmentation service's error model.
    ServiceResidualsContradict, "service_residuals_contradict", Degraded, "the residuals contradict the service's error model";
    /// Message 0 of an augmentation service.
    ServiceDoNotUse, "service_do_not_use", NotAvailable, "the service says \"do not use\" (message 0)";
    /// No PRN mask of an augmentation service.
    NoPrnMask, "no_prn_mask", NotAvailable, "no PRN mask is in force";
    /// Silence of an augmentation service's signal.
    MessageLoss, "message_loss", NotAvailable,
        "four seconds without a message took the UDRE indicators: satellites wait for new ones";
    /// A signal that transmits message 0 as a test.
    TestSignal, "test_signal", Degraded, "a test signal: its levels promise nothing";
    /// The faults without a monitor are likelier than what is allotted.
    RiskBudgetSpent, "risk_budget_spent", NotAvailable, "faults that cannot be monitored are likelier than the allotted risk";
    /// The level equation has no root.
    NoRoot, "no_root", NotAvailable, "the level equation holds a number that is not finite";
    /// A receiver repeats its last position.
    PositionHeld, "position_held", Degraded, "position held";
    /// A receiver repeats its last position for too long.
    PositionStale, "position_stale", NotAvailable, "position held too long";
    /// A step that only an old position explains.
    PositionLate, "position_late", Degraded,
        "a step that can be flown only if the position before was older than a held one may be";
    /// A step that no aircraft flies.
    PositionJump, "position_jump", InvalidInput, "position jump that cannot be flown";
    /// Small steps that add up to what no aircraft flies at its speed.
    PositionAhead, "position_ahead", InvalidInput, "position further on than the reported speeds lead";
    /// Shortly after such a step.
    PositionNotSettled, "position_not_settled", InvalidInput, "not settled after a position jump";
    /// No covariance at all.
    NoCovariance, "no_covariance", NotAvailable, "no covariance";
    /// Numbers that are no covariance.
    NotACovariance, "not_a_covariance", InvalidInput, "not a covariance";
    /// A covariance without an inverse.
    SingularCovariance, "singular_covariance", Ok, "the covariance is singular: the axis pierces no surface";
    /// A covariance of zeros.
    ZeroCovariance, "zero_covariance", Degraded, "the covariance is zero along an axis";
    /// Navigation by DME ranges.
    KeptByDme, "kept_by_dme", Degraded, "without satellites: ranges to DME keep the position";
    /// Navigation by a VOR and a DME.
    KeptByVor, "kept_by_vor", Degraded, "without satellites: a VOR and a DME keep the position";
    /// Inertial navigation alone.
    Coasting, "coasting", Degraded, "without satellites and stations: inertial navigation alone";
    /// The attitude of an inertial unit is not settled.
    Aligning, "aligning", Degraded, "the attitude settles after a hole in the inertial samples";
    /// Two filters that cannot both be right.
    FiltersDisagree, "filters_disagree", NotAvailable,
        "the filters with and without satellites disagree: nobody knows which of them is right";
    /// Stations that a filter rejects.
    StationsContradict, "stations_contradict", NotAvailable,
        "several stations contradict the filter: they or the inertial unit are wrong";
    /// An altimeter that cannot be right together with the satellites.
    AltimeterContradicts, "altimeter_contradicts", Degraded,
        "the altimeter contradicts the height by satellites: nobody knows which of them is right";
    /// Of a filtered position.
    StateStale, "state_stale", NotAvailable, "the filter has no state of this time";
    /// Of a filtered position.
    ImuMissing, "imu_missing", Degraded, "the inertial unit delivers nothing";
    /// Of a filtered position.
    ImuRefused, "imu_refused", Degraded, "the inertial unit delivers samples that cannot be used";
    /// Of a filtered position.
    ImuImplausible, "imu_implausible", Degraded, "the inertial unit delivers what the vehicle cannot do";
    /// Of a filtered position.
    ImuClock, "imu_clock", Degraded, "the times of the inertial samples contradict the clock";
    /// Of a filtered position.
    ImuFault, "imu_fault", Degraded, "the inertial unit is wrong: the ranges of the instant alone give the position";
    /// Of a filtered position.
    GnssTime, "gnss_time", Degraded, "the times of the satellite measurements are out of their latency";
    /// Of a filtered position.
    SnapshotMissing, "snapshot_missing", Degraded, "no snapshot of the ranges checks the filter";
    /// Of a filtered position.
    LevelMissing, "level_missing", Degraded, "the position has a covariance and no level";
    /// Of a filtered position.
    SatellitesInconsistent, "satellites_inconsistent", Degraded, "the ranges contradict each other and no exclusion resolves it";
    /// Of a filtered position.
    FilterContradicted, "filter_contradicted", Degraded, "the filter and the snapshot of the ranges contradict each other";
    /// Of a filtered position.
    ContradictionOpen, "contradiction_open", Degraded,
        "the filter and the snapshot contradicted each other, and which of them was wrong is not known";
    /// Of a filtered position.
    GatingExcess, "gating_excess", NotAvailable, "the filter rejects too many measurements";
    /// Of a filtered position.
    TuningForeign, "tuning_foreign", NotAvailable, "the innovations are larger than the declared errors";
    /// Of a filtered position.
    FactMissing, "fact_missing", NotAvailable, "a fact that the status needs was not reported";
    /// A filter that ended.
    FilterStopped, "filter_stopped", NotAvailable, "the navigation filter has stopped";
    /// Carrier phase that disagrees.
    CarrierExcluded, "carrier_excluded", Degraded, "left out: carrier phase disagrees";
    /// Two ranges at least.
    TooFewRanges, "too_few_ranges", NotAvailable, "two ranges are needed";
    /// Stations and aircraft in one line.
    StationsInLine, "stations_in_line", NotAvailable, "the stations and the aircraft lie in one line";
    /// Ranges that do not meet.
    RangesApart, "ranges_apart", NotAvailable, "the ranges do not meet at the altitude";
    /// Two positions fit alike.
    Ambiguous, "ambiguous", NotAvailable, "the position and its mirror across the line of the stations fit alike";
    /// No position near the prior.
    FarFromPrior, "far_from_prior", NotAvailable, "no solution lies within the distance of the prior position";
    /// No convergence.
    NotConverged, "not_converged", NotAvailable, "the iteration did not settle";
    /// Overhead of a VOR.
    OverheadVor, "overhead_vor", NotAvailable, "the aircraft is in the cone above the VOR";
    /// One range of several is left out.
    RangeExcluded, "range_excluded", Ok, "one range contradicts the others and is left out";
    /// Three ranges contradict each other.
    RangesContradict, "ranges_contradict", Degraded, "the residuals contradict the deviations of the ranges, and three do not tell which";
    /// More ranges contradict each other.
    RangesContradictStill, "ranges_contradict_still", Degraded,
        "the residuals contradict the deviations of the ranges, and leaving out one does not mend it";
    /// No pair of stations serves.
    NoStationPair, "no_station_pair", NotAvailable, "no station or no admissible pair";
    /// A text of the input that is no id of this list.
    Reported, "reported", NotAvailable, "reported by the input";
    /// Of a live position.
    NeighboursContradict, "neighbours_contradict", NotAvailable,
        "the position and the two before it contradict each other: no manoeuvre and no covariance explains them";
    /// Of a live record.
    RecordOld, "record_old", NotAvailable,
        "the record was older than the stale time when it arrived: the data are not of now, or a clock is wrong";
    /// Two constellations, two positions.
    ConstellationsContradict, "constellations_contradict", Degraded,
        "two constellations contradict each other, and nothing says which of them is wrong";
    /// Of a recorded position.
    FewSatellites, "few_satellites", Degraded, "the recording counts fewer satellites than determine a position";
    /// Of an aircraft's own claim.
    NoAccuracyCategory, "no_accuracy_category", NotAvailable, "the aircraft states no accuracy category (NACp)";
    /// Of an aircraft's own claim.
    NoIntegrityClaim, "no_integrity_claim", NotAvailable,
        "the aircraft states no containment radius (NIC) at the integrity risk (SIL)";
    /// Of a surveillance report.
    ForeignPosition, "foreign_position", NotAvailable,
        "the position is not the aircraft's own: others measured or repeated it, and it carries no claim";
    /// Of a filtered position.
    ImuBias, "imu_bias", Degraded,
        "the filter has found biases that its unit does not have as declared: the unit or the positions are wrong";
    /// Of positions from observations.
    CodesLedOff, "codes_led_off", Degraded, "the codes of the satellites moved together as their carrier phases did not";
    /// Of live positions.
    DirectionContradicts, "direction_contradicts", NotAvailable,
        "the positions do not go where the reported track leads: they are wrong, or it is a heading, magnetic, or another direction";
}

impl Reason {
    /// The reason of an id.
    pub fn from_id(id: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|r| r.id() == id)
    }
}

impl Unavailable {
    /// Its entry in the list.
    pub const fn reason(&self) -> Reason {
        match self {
            Self::Missing { .. } => Reason::MissingField,
            Self::TooFewSatellites { .. } => Reason::TooFewSatellites,
            Self::Singular { .. } => Reason::Singular,
            Self::Invalid { .. } => Reason::InvalidNumber,
        }
    }

    /// The same of a solution: a number outside its domain came out of it, the input may well be right.
    pub const fn reason_of_solution(&self) -> Reason {
        match self.reason() {
            Reason::InvalidNumber => Reason::NoPlausibleSolution,
            other => other,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn snake(id: &str) -> bool {
        !id.is_empty() && id.chars().all(|c| c.is_ascii_lowercase() || c == '_')
    }

    #[test]
    fn every_id_is_snake_case_names_one_entry_and_has_words() {
        for (place, reason) in Reason::ALL.iter().enumerate() {
            assert!(snake(reason.id()) && !reason.words().is_empty(), "{reason:?}");
            assert_eq!(Reason::from_id(reason.id()), Some(*reason), "{} twice", reason.id());
            assert_eq!(*reason as usize, place);
        }
        for (place, status) in Status::ALL.into_iter().enumerate() {
            assert!(snake(status.id()) && !status.words().is_empty());
            assert_eq!((Status::from_id(status.id()), status as usize), (Some(status), place));
        }
        assert_eq!((Reason::from_id("a fault that cannot be excluded"), Status::from_id("fine")), (None, None));
    }

    #[test]
    fn a_wrong_number_is_invalid_input_and_a_poor_geometry_is_not() {
        let invalid = Unavailable::Invalid { field: "sigma_m", value: -1.0, unit: "m", domain: "[0, inf)" };
        assert_eq!(invalid.reason().status(), Status::InvalidInput);
        assert_eq!(Unavailable::TooFewSatellites { need: 4, have: 3 }.reason().status(), Status::NotAvailable);
        assert!(!Status::InvalidInput.usable() && !Status::NotAvailable.usable() && Status::Degraded.usable());
    }
}
