//! Errors of options.

use thiserror::Error;

/// An option that does not exist, or a value that it cannot take.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum OptionError {
    /// No option has this name.
    #[error("there is no option \"{name}\"; the options are {}", known.join(", "))]
    Unknown {
        /// Name given.
        name: String,
        /// Names of the options.
        known: Vec<&'static str>,
    },
    /// The value has the wrong type or lies outside the range.
    #[error("{option} must be {expected}, got {value}")]
    Invalid {
        /// Name of the option.
        option: &'static str,
        /// Values that it takes, in words.
        expected: String,
        /// Value given.
        value: String,
    },
}

impl OptionError {
    /// The error for a `value` that `option` cannot take.
    pub fn invalid(option: &'static str, expected: impl Into<String>, value: &dyn ToString) -> Self {
        Self::Invalid { option, expected: expected.into(), value: value.to_string() }
    }
}
