//! Bytes to navigation records. Errors carry line, field and the text found; the caller knows the file.

pub mod almanac;
pub mod arinc424;
pub mod measured;
pub mod mode_s;
mod order;
pub mod packed;
pub mod place;
pub mod precise;
pub mod receiver;
pub mod refusal;
pub mod registry;
pub mod rinex;
pub mod rtklib;
pub mod sbas;
pub mod sp3;
pub mod stream;
pub mod time;

pub use refusal::{Refusal, Unreadable};
