//! Total system error across and above the path.

use super::Method;

/// The methods of this family.
pub const METHODS: &[Method] = &[];
