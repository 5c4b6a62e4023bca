//! Guard against a filter.
