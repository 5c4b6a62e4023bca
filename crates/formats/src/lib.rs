//! Bytes to navigation records. Errors carry line, field and the text found; the caller knows the file.

pub mod packed;
pub mod refusal;
pub mod rinex;
pub mod rtklib;
pub mod sbas;
pub mod time;

pub use refusal::{Refusal, Unreadable};
