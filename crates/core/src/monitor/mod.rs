//! Whether to tell the crew.
