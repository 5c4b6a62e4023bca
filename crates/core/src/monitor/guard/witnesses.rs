//! Stations and altimeter as witnesses of the snapshot.

use super::Guard;
use super::stations::Reading;
use crate::frame::{Covariance, Enu, enu_from_ecef};
use crate::monitor::judgement::RangesAgree;
use crate::signal::{Aiding, TimedAiding};
use crate::solution::ins::Fusion;

impl Guard {
    /// Stations and altimeter of one instant: witnesses of the snapshot of the same instant, alone and against the filter without satellites.
    pub fn hear(&mut self, filter: &mut Fusion, together: &[TimedAiding]) {
        let Some(time) = together.first().map(|t| t.time) else { return };
        let Some(looked) = self.looked.as_ref().filter(|l| l.snapshot.time == time && l.ranges_agree != RangesAgree::No) else { return };
        let ecef = enu_from_ecef(&looked.snapshot.position.point).transpose();
        let turned = |v: &Covariance<Enu>| ecef * v.matrix() * ecef.transpose();
        let snapshot = Reading { ecef: *looked.snapshot.ecef.vector(), covariance: turned(&looked.snapshot.covariance) };
        let beside = filter.without_satellites(time).filter(|_| looked.ranges_agree == RangesAgree::Yes);
        let other = beside.and_then(|b| Some(Reading { ecef: *filter.antenna_of(&b)?.vector(), covariance: turned(&b.covariance) }));
        for timed in together.iter().filter(|t| t.time == time) {
            match &timed.aiding {
                Aiding::Dme(m) => {
                    self.alone.hear(time, m, &[snapshot]);
                    if let Some(other) = other {
                        self.stations.hear(time, m, &[snapshot, other]);
                    }
                }
                Aiding::Vor(m) => self.alone.hear_bearing(time, m, &[snapshot]),
                Aiding::Baro(m) => self.testimony[1] = self.testimony[1].then(self.height.hear(m, &looked.snapshot)),
                _ => {}
            }
        }
        self.testimony[0] = self.testimony[0].then(self.alone.testimony(time));
        if self.stations.rule_out_the_second(time) {
            self.contradiction.rule_out_the_unit();
        }
    }
}
