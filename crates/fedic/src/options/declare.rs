//! The macro that declares a struct of options.

/// Declares a struct of options: `name: type = default, in range;`, each with its documentation.
macro_rules! declare_options {
    (
        $(#[$attribute:meta])*
        pub struct $type:ident {
            $($(#[doc = $doc:literal])+ $name:ident: $value:ty = $default:expr $(, in $range:expr)?;)+
        }
    ) => {
        $(#[$attribute])*
        #[derive(Debug, Clone, PartialEq)]
        #[non_exhaustive]
        pub struct $type {
            $(
                $(#[doc = $doc])+
                #[doc = concat!("\n\nDefault: `", stringify!($default), "`.")]
                pub $name: $value,
            )+
        }

        impl Default for $type {
            fn default() -> Self {
                Self { $($name: $default),+ }
            }
        }

        impl $type {
            $(
                #[doc = concat!("The options with another `", stringify!($name), "`.")]
                #[must_use]
                pub fn $name(mut self, $name: $value) -> Self {
                    self.$name = $name;
                    self
                }
            )+

            /// Describes every option, in the order of declaration.
            #[must_use]
            pub fn info() -> Vec<$crate::options::OptionInfo> {
                let default = Self::default();
                vec![$(
                    $crate::options::describe(
                        stringify!($name),
                        &default.$name,
                        $crate::options::range!($($range)?),
                        concat!($($doc, "\n"),+),
                    )
                ),+]
            }

            /// Sets one option by its name.
            ///
            /// # Errors
            ///
            /// [`OptionError`](crate::OptionError) if no option has that name, or the value has the wrong type or lies
            /// outside the range.
            pub fn set(
                &mut self,
                name: &str,
                value: &$crate::options::OptionValue,
            ) -> Result<(), $crate::options::OptionError> {
                match name {
                    $(stringify!($name) => {
                        let range = $crate::options::range!($($range)?);
                        self.$name = $crate::options::read(stringify!($name), value, range)?;
                    })+
                    _ => {
                        let known = vec![$(stringify!($name)),+];
                        return Err($crate::options::OptionError::Unknown { name: name.to_owned(), known });
                    }
                }
                Ok(())
            }

            /// Checks every range.
            ///
            /// # Errors
            ///
            /// [`OptionError::Invalid`](crate::OptionError::Invalid) for the first option outside its range.
            pub fn check(&self) -> Result<(), $crate::options::OptionError> {
                $(
                    $crate::options::OptionType::check(
                        &self.$name,
                        stringify!($name),
                        $crate::options::range!($($range)?),
                    )?;
                )+
                Ok(())
            }
        }
    };
}

/// The range, if there is one.
macro_rules! range {
    () => {
        None
    };
    ($range:expr) => {
        Some($range)
    };
}

pub(crate) use {declare_options, range};
