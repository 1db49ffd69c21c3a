//! Enums whose variants have names.

/// Declares an enum with a name for each variant, and makes it the type of an option.
///
/// The enum gets `ALL`, `name`, `Display`, and `FromStr`, whose error names the option in brackets.
macro_rules! choices {
    (
        $(#[$attribute:meta])*
        pub enum $type:ident($option:literal) {
            $($(#[$variant_attribute:meta])* $variant:ident = $name:literal,)+
        }
    ) => {
        $(#[$attribute])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
        #[non_exhaustive]
        pub enum $type {
            $($(#[$variant_attribute])* $variant,)+
        }

        impl $type {
            /// Every choice.
            pub const ALL: &'static [Self] = &[$(Self::$variant),+];

            /// Name of the choice.
            #[must_use]
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name,)+
                }
            }
        }

        impl ::std::fmt::Display for $type {
            fn fmt(&self, formatter: &mut ::std::fmt::Formatter<'_>) -> ::std::fmt::Result {
                formatter.pad(self.name())
            }
        }

        impl ::std::str::FromStr for $type {
            type Err = $crate::options::OptionError;

            fn from_str(name: &str) -> Result<Self, Self::Err> {
                $crate::options::read($option, &$crate::options::OptionValue::Name(name.to_owned()), None)
            }
        }

        $crate::options::choice_option!($type);
    };
}

pub(crate) use choices;
