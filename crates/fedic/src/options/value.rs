//! Values of options whose type is known only at run time, and the types that are made of them.

use std::fmt;

use fedic_image::Interpolation;
use fedic_mesh::Rule;

use super::error::OptionError;
use super::range::Range;

/// Value of an option as a configuration file or a binding gives it.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum OptionValue {
    /// No value.
    None,
    /// True or false.
    Flag(bool),
    /// An integer.
    Integer(i64),
    /// A number.
    Number(f64),
    /// One of the option's names.
    Name(String),
    /// One of the option's names and a factor.
    Scaled(String, f64),
}

impl fmt::Display for OptionValue {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::None => formatter.write_str("none"),
            Self::Flag(flag) => write!(formatter, "{flag}"),
            Self::Integer(integer) => write!(formatter, "{integer}"),
            Self::Number(number) => write!(formatter, "{number}"),
            Self::Name(name) => write!(formatter, "\"{name}\""),
            Self::Scaled(name, factor) => write!(formatter, "\"{name}\" with a factor of {factor}"),
        }
    }
}

/// Kind of the values of an option.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum OptionKind {
    /// True or false.
    Flag,
    /// A non-negative integer.
    Integer,
    /// A finite number.
    Number,
    /// One of a list of names.
    Choice,
    /// One of a list of names, and a factor on the number of quadrature points.
    Quadrature,
}

/// Type of an option.
pub trait OptionType: Sized {
    /// Kind of the values.
    const KIND: OptionKind;

    /// Whether the option may be absent.
    const OPTIONAL: bool = false;

    /// Names that it takes; empty for the kinds that have none.
    #[must_use]
    fn names() -> Vec<&'static str> {
        Vec::new()
    }

    /// The typed value; `None` if `value` has another type or an unknown name.
    fn read(value: &OptionValue) -> Option<Self>;

    /// The value whose type is known at run time only.
    fn value(&self) -> OptionValue;

    /// Checks the number that the value holds.
    ///
    /// # Errors
    ///
    /// [`OptionError::Invalid`] if the number lies outside `range`.
    fn check(&self, _option: &'static str, _range: Option<Range>) -> Result<(), OptionError> {
        Ok(())
    }
}

impl OptionType for bool {
    const KIND: OptionKind = OptionKind::Flag;

    fn read(value: &OptionValue) -> Option<Self> {
        if let OptionValue::Flag(flag) = value { Some(*flag) } else { None }
    }

    fn value(&self) -> OptionValue {
        OptionValue::Flag(*self)
    }
}

impl OptionType for f64 {
    const KIND: OptionKind = OptionKind::Number;

    fn read(value: &OptionValue) -> Option<Self> {
        match value {
            OptionValue::Number(number) => Some(*number),
            OptionValue::Integer(integer) => Some(*integer as Self),
            _ => None,
        }
    }

    fn value(&self) -> OptionValue {
        OptionValue::Number(*self)
    }

    fn check(&self, option: &'static str, range: Option<Range>) -> Result<(), OptionError> {
        match range {
            Some(range) if !range.contains(*self) => Err(OptionError::invalid(option, range.words, self)),
            _ => Ok(()),
        }
    }
}

impl OptionType for usize {
    const KIND: OptionKind = OptionKind::Integer;

    fn read(value: &OptionValue) -> Option<Self> {
        if let OptionValue::Integer(integer) = value { Self::try_from(*integer).ok() } else { None }
    }

    fn value(&self) -> OptionValue {
        i64::try_from(*self).map_or(OptionValue::Number(*self as f64), OptionValue::Integer)
    }

    fn check(&self, option: &'static str, range: Option<Range>) -> Result<(), OptionError> {
        match range {
            Some(range) if !range.contains(*self as f64) => Err(OptionError::invalid(option, range.words, self)),
            _ => Ok(()),
        }
    }
}

impl<T: OptionType> OptionType for Option<T> {
    const KIND: OptionKind = T::KIND;
    const OPTIONAL: bool = true;

    fn names() -> Vec<&'static str> {
        T::names()
    }

    fn read(value: &OptionValue) -> Option<Self> {
        if matches!(value, OptionValue::None) { Some(None) } else { T::read(value).map(Some) }
    }

    fn value(&self) -> OptionValue {
        self.as_ref().map_or(OptionValue::None, T::value)
    }

    fn check(&self, option: &'static str, range: Option<Range>) -> Result<(), OptionError> {
        self.as_ref().map_or(Ok(()), |value| value.check(option, range))
    }
}

/// Implements [`OptionType`] for an enum with `ALL` and `name`. [`OptionValue::None`] is the choice named `none`.
macro_rules! choice_option {
    ($type:ty) => {
        impl $crate::options::OptionType for $type {
            const KIND: $crate::options::OptionKind = $crate::options::OptionKind::Choice;

            fn names() -> Vec<&'static str> {
                Self::ALL.iter().map(|choice| choice.name()).collect()
            }

            fn read(value: &$crate::options::OptionValue) -> Option<Self> {
                let name = match value {
                    $crate::options::OptionValue::Name(name) => name.as_str(),
                    $crate::options::OptionValue::None => "none",
                    _ => return None,
                };
                Self::ALL.iter().copied().find(|choice| choice.name() == name)
            }

            fn value(&self) -> $crate::options::OptionValue {
                $crate::options::OptionValue::Name(self.name().to_owned())
            }
        }
    };
}

pub(crate) use choice_option;

choice_option!(Interpolation);
choice_option!(Rule);
