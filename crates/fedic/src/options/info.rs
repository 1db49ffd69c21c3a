//! Description of an option, for bindings and documents.

use super::error::OptionError;
use super::range::Range;
use super::value::{OptionKind, OptionType, OptionValue};

/// One option: its name, values, default and documentation.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct OptionInfo {
    /// Name of the field.
    pub name: &'static str,
    /// Kind of its values.
    pub kind: OptionKind,
    /// Whether it may be absent, [`OptionValue::None`].
    pub optional: bool,
    /// Names that it takes, for the kinds that have names.
    pub choices: Vec<&'static str>,
    /// Numbers that it takes, for the kinds that have numbers.
    pub range: Option<Range>,
    /// Default value.
    pub default: OptionValue,
    /// Documentation, Markdown.
    pub doc: &'static str,
}

impl OptionInfo {
    /// Values that it takes, in words, to be read after "must be".
    #[must_use]
    pub fn expected(&self) -> String {
        match (self.choices.as_slice(), self.range) {
            ([], Some(range)) => range.words.to_owned(),
            ([], None) => "true or false".to_owned(),
            (names, _) => list_names(names),
        }
    }
}

/// Quoted names, with "or" before the last one.
fn list_names(names: &[&str]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("\"{name}\"")).collect();
    match quoted.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, first)) => format!("{} or {last}", first.join(", ")),
        None => String::new(),
    }
}

/// Describes an option whose default is `default`.
pub(crate) fn describe<T: OptionType>(
    name: &'static str,
    default: &T,
    range: Option<Range>,
    doc: &'static str,
) -> OptionInfo {
    OptionInfo { name, kind: T::KIND, optional: T::OPTIONAL, choices: T::names(), range, default: default.value(), doc }
}

/// Reads the value of `option` and checks its range.
pub(crate) fn read<T: OptionType + Default>(
    option: &'static str,
    value: &OptionValue,
    range: Option<Range>,
) -> Result<T, OptionError> {
    let Some(typed) = T::read(value) else {
        let expected = describe(option, &T::default(), range, "").expected();
        return Err(OptionError::invalid(option, expected, value));
    };
    typed.check(option, range)?;
    Ok(typed)
}
