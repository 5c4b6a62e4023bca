//! A bound that knows which method made it, and the kind of bound that may alert.

use super::{Method, method, methods};
use crate::quantity::{Metres, Risk, Unavailable};
use crate::solution::Epoch;

/// A bound of one epoch and the method that made it.
#[derive(Debug, Clone, Copy)]
pub struct Bound {
    length: Metres,
    method: &'static Method,
}

impl Bound {
    /// The bound of one epoch by any method of the list, exhibits included.
    ///
    /// # Errors
    /// [`Unavailable`] of the method.
    pub fn of(method: &'static Method, epoch: &Epoch, risk: Risk) -> Result<Self, Unavailable> {
        if epoch.covariance.is_some_and(|covariance| !covariance.vertical_belongs()) {
            return Err(Unavailable::Invalid {
                field: "covariance",
                value: epoch.covariance.map_or(f64::NAN, |covariance| covariance.matrix()[(2, 2)]),
                unit: "m²",
                domain: "a vertical that can belong to the horizontal",
            });
        }
        Ok(Self { length: (method.bound)(epoch, risk)?, method })
    }

    /// The length. It may be NaN where the bound is not known.
    pub const fn length(&self) -> Metres {
        self.length
    }

    /// The method that made it.
    pub const fn method(&self) -> &'static Method {
        self.method
    }
}

/// A bound that may feed an alert. Only [`Alerting`] makes one, so only an entry of [`super::METHODS`] that promises `may_alert`.
///
/// The RNP monitor takes nothing else: a bare length, or the bound of an exhibit, does not compile.
///
/// ```compile_fail,E0308
/// # use navbound_core::{bound::Alerting, monitor::rnp::Observation, quantity::{GpsTime, Metres}};
/// let exact = Alerting::of("tse-exact").unwrap().claim_evaluated(Metres::new(100.0));
/// let time = GpsTime::from_nanoseconds(0);
/// Observation { time, accuracy: exact, integrity: Metres::new(300.0), rnp: Metres::new(555.6), usable: true };
/// ```
///
/// ```compile_fail,E0308
/// # use navbound_core::{bound::{Alerting, Bound, method}, monitor::rnp::Observation, quantity::{GpsTime, Metres, Risk}};
/// # fn offered(epoch: &navbound_core::solution::Epoch) {
/// let exhibit = Bound::of(method("tse-ltem-as-printed").unwrap(), epoch, Risk::ACCURACY).unwrap();
/// let exact = Alerting::of("tse-exact").unwrap().claim_evaluated(Metres::new(100.0));
/// let time = GpsTime::from_nanoseconds(0);
/// Observation { time, accuracy: exhibit, integrity: exact, rnp: Metres::new(555.6), usable: true };
/// # }
/// ```
///
/// Nor can one be put together by hand, from parts or from an entry of the caller's own:
///
/// ```compile_fail,E0423
/// # use navbound_core::{bound::{AlertBound, Bound}};
/// # fn dressed(exhibit: Bound) -> AlertBound {
/// AlertBound(exhibit)
/// # }
/// ```
///
/// ```compile_fail,E0451
/// # use navbound_core::{bound::{Alerting, method}};
/// Alerting { method: method("tse-ltem-as-printed").unwrap() };
/// ```
#[derive(Debug, Clone, Copy)]
pub struct AlertBound(Bound);

impl AlertBound {
    /// The length. It may be NaN where the bound is not known; that alerts.
    pub const fn length(&self) -> Metres {
        self.0.length
    }

    /// The method that made it.
    pub const fn method(&self) -> &'static Method {
        self.0.method
    }

    /// The same bound with another length, for comparisons of this stage that only ever make it larger.
    pub(super) const fn with_length(self, length: Metres) -> Self {
        Self(Bound { length, ..self.0 })
    }
}

/// A method that may feed an alert: the one place where [`super::Promises::may_alert`] decides.
///
/// ```
/// # use navbound_core::bound::Alerting;
/// assert!(Alerting::of("tse-exact").is_ok());
/// assert!(Alerting::of("tse-ltem-as-printed").is_err(), "an exhibit of a misprint");
/// assert!(Alerting::of("ee_bound_h_m").is_err(), "no method, whatever the column is called");
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Alerting {
    method: &'static Method,
}

/// No method of this id may feed an alert: it is unknown, experimental or an exhibit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MayNotAlert;

impl Alerting {
    /// The method with this id.
    ///
    /// # Errors
    /// [`MayNotAlert`] unless the list has an entry with this id that promises `may_alert`.
    pub fn of(id: &str) -> Result<Self, MayNotAlert> {
        method(id).filter(|m| m.promises.may_alert).map(|method| Self { method }).ok_or(MayNotAlert)
    }

    /// Every method that may feed an alert, in the order of the list.
    pub fn all() -> impl Iterator<Item = Self> {
        methods().filter(|m| m.promises.may_alert).map(|method| Self { method })
    }

    /// The entry of the list.
    pub const fn method(self) -> &'static Method {
        self.method
    }

    /// The bound of one epoch.
    ///
    /// # Errors
    /// [`Unavailable`] of the method.
    pub fn bound(self, epoch: &Epoch, risk: Risk) -> Result<AlertBound, Unavailable> {
        Bound::of(self.method, epoch, risk).map(AlertBound)
    }

    /// A length that the caller claims this method to have given earlier, such as a column of an epoch table. A type cannot check the
    /// claim, so the name is at the call.
    pub const fn claim_evaluated(self, length: Metres) -> AlertBound {
        AlertBound(Bound { length, method: self.method })
    }
}
