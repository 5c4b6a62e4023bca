//! Bytes to navigation records. Errors carry file, line, field and the text found.
