//! What was received, and from whom.
