//! Bounds of navigation error, one epoch at a time. No operating system, no files, no clock, no threads, no heap, no `unsafe`:
//! what an aircraft could carry.
//!
//! The modules are the stages of the flow, each using only those before it (`tests/architecture.rs` enforces it):
//!
//! - [`quantity`]: lengths, angles, risks and GPS time, and the three kinds of "no".
//! - [`special`]: the tails of the normal law and its relatives, with full relative accuracy where they are small.
//! - [`frame`]: ECEF, east-north-up and track frames; covariances that know their frame.
//! - [`signal`]: which satellite, from which constellation.
//! - [`geometry`]: nominal orbits, lines of sight, dilution of precision.
//! - [`solution`]: weighted least squares, inertial navigation and its filter, and the one record of an instant, [`solution::Epoch`].
//! - [`spec`]: navigation specifications and requirement tables, as data.
//! - [`bound`]: how wrong the position may be: total system error and actual navigation performance; the list [`bound::METHODS`].
//! - [`monitor`]: whether to tell the crew: the RNP monitor and the RNP-state classifier.
#![cfg_attr(not(any(feature = "std", test)), no_std)]
#![forbid(unsafe_code)]

#[cfg(feature = "alloc")]
extern crate alloc;

pub mod bound;
pub mod frame;
pub mod geometry;
pub mod judge;
pub mod monitor;
pub mod quantity;
pub mod signal;
pub mod solution;
pub mod spec;
pub mod special;

/// The Rust examples of CONTRIBUTING.md, run as documentation tests.
#[cfg(doctest)]
#[doc = include_str!("../../../CONTRIBUTING.md")]
struct Contributing;
