//! Relative RAIM: a fix of before, carried on by time-differenced carrier phase.
//!
//! In the order of the flow: [`coast`] (what the phase says and how the old error travels), [`single`] (one fault while coasting),
//! [`modes`] (which faults together), [`multiple`] (levels over all of them).

pub mod coast;
pub mod modes;
pub mod multiple;
pub mod single;

/// Document of the system; our copy has no equations, tables or figures.
pub const SOURCE: &str = "Song, Milner and No 2024, NAVIGATION 71(4), navi.673, rebuilt: equations 11 to 17, the single-fault form after \
                          Lee and McLaughlin 2008 (inferred), the multi-fault one after Blanch et al. 2015 (standard)";
