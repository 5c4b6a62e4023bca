//! Actual navigation performance: circle, sphere, ellipsoid, directions.

use super::Method;

/// The methods of this family.
pub const METHODS: &[Method] = &[];
