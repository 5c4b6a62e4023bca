//! The fault modes of advanced RAIM: those of [`crate::bound::faults`] under a service's budgets.

use super::service::Service;
use crate::bound::Sight;
pub use crate::bound::faults::{FaultMode, FaultModes, MOST_MODES, MOST_SATELLITES, NoModes};
use crate::bound::faults::{First, Prior, Watch};
use crate::quantity::OutOfDomain;
use crate::signal::Constellation;

/// Where the modes of satellites are looked up, or worked out.
pub trait Book {
    /// The modes of these satellites.
    ///
    /// # Errors
    /// [`NoModes`].
    fn modes(&mut self, sights: &[Sight], service: &Service) -> Result<&FaultModes, NoModes>;
}

impl Service {
    /// The modes of these satellites, with the priors of their constellations in the order of [`Constellation::index`], under this service's
    /// budgets. Every satellite and every constellation in use may fail: a prior of zero is refused.
    ///
    /// # Errors
    /// [`NoModes`].
    pub fn modes(&self, sights: &[Sight], p_const: &[f64; Constellation::ALL.len()]) -> Result<FaultModes, NoModes> {
        for sight in sights {
            let priors = [("p_sat", sight.p_sat), ("p_const", p_const[sight.constellation.index()])];
            if let Some((argument, value)) = priors.into_iter().find(|(_, p)| !(*p > 0.0 && *p < 1.0)) {
                return Err(OutOfDomain { argument, value, unit: "1", domain: "(0, 1)" }.into());
            }
        }
        let watch = Watch {
            always: self.integrity(),
            unmonitored: self.unmonitored.q(),
            consolidation: self.consolidation,
            most_at_once: usize::MAX,
            first: First::Smallest,
        };
        with_priors(sights, |satellites| FaultModes::of(satellites, p_const, &watch))
    }
}

/// No fault, and each satellite alone.
///
/// # Errors
/// [`NoModes::TooManySatellites`].
#[inline(always)]
pub(super) fn single(sights: &[Sight]) -> Result<FaultModes, NoModes> {
    with_priors(sights, FaultModes::single)
}

#[inline(always)]
fn with_priors(sights: &[Sight], make: impl FnOnce(&[Prior]) -> Result<FaultModes, NoModes>) -> Result<FaultModes, NoModes> {
    let mut priors = [(Constellation::Gps, 0.0); MOST_SATELLITES];
    let room = priors.get_mut(..sights.len()).ok_or(NoModes::TooManySatellites { have: sights.len() })?;
    for (slot, sight) in room.iter_mut().zip(sights) {
        *slot = (sight.constellation, sight.p_sat);
    }
    make(room)
}
