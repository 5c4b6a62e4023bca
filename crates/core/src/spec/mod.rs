//! Navigation specifications and requirement tables, as data with their source word.
