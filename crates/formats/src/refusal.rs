//! What a reader could not use: one row, or the whole file.

/// A row that was not used, and why. The rest of the file stands.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Refusal {
    /// Line number, from 1.
    pub line: usize,
    /// The field's name in the file.
    pub field: String,
    /// Why.
    pub reason: String,
    /// What was found.
    pub text: String,
}

/// A file that cannot be interpreted.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{reason}")]
pub struct Unreadable {
    /// Line number, from 1; none when the file as a whole is at fault.
    pub line: Option<usize>,
    /// The field's name in the file, where one is at fault.
    pub field: Option<String>,
    /// Why, with the text found.
    pub reason: String,
}

impl Unreadable {
    /// A file at fault as a whole.
    pub fn whole(reason: impl Into<String>) -> Self {
        Self { line: None, field: None, reason: reason.into() }
    }
    /// A file at fault at one line.
    pub fn at(line: usize, reason: impl Into<String>) -> Self {
        Self { line: Some(line), field: None, reason: reason.into() }
    }
}
