//! How a number or formula is held.

/// How we hold a formula or a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Provenance {
    /// We read it in the source and it is right as printed.
    Printed,
    /// Defective or lost in our copy; derived again, proof in `docs/methods/`.
    ReDerived,
    /// A standard's, clause cited.
    Standard,
    /// Our own.
    Ours,
    /// Concluded, not seen stated.
    Inferred,
}

impl Provenance {
    /// The word reports print.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Printed => "printed",
            Self::ReDerived => "re-derived",
            Self::Standard => "standard",
            Self::Ours => "ours",
            Self::Inferred => "inferred",
        }
    }
}
