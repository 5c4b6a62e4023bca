//! What an aircraft does between two positions, for guards that predict one from the other.

/// Standard deviation of the acceleration that nobody measures \[m/s²\]. Provenance: inferred.
pub(super) const ACCELERATION_MPS2: f64 = 3.0;
/// Longest time over which one position predicts the next \[s\]. Provenance: inferred.
pub(super) const STEP_MOST_S: f64 = 2.5;
