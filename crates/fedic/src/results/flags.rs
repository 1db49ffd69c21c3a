//! Flags of cells and nodes, each one bit with a name and a reason.

/// Declares flags as an enum with names and reasons.
macro_rules! flags {
    ($(#[$doc:meta])* $name:ident { $($variant:ident = $text:literal, $reason:literal;)+ }) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        #[non_exhaustive]
        pub enum $name {
            $(#[doc = $reason] $variant,)+
        }

        impl $name {
            /// All flags, in the order of their bits.
            pub const ALL: &'static [Self] = &[$(Self::$variant),+];

            /// Bit of the flag.
            #[must_use]
            pub const fn bit(self) -> u8 {
                1 << self as u8
            }

            /// Name of the flag.
            #[must_use]
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $text,)+
                }
            }

            /// Reason for the flag, in words.
            #[must_use]
            pub fn reason(self) -> &'static str {
                match self {
                    $(Self::$variant => $reason,)+
                }
            }
        }
    };
}

flags! {
    /// Flags of a cell.
    CellFlag {
        FewPoints = "few-points", "Too few points lie inside both images and are neither masked nor saturated.";
        Uncorrelated = "uncorrelated", "The two images do not show the same texture.";
        WeakTexture = "weak-texture", "The gradient of the grey levels is hardly more than that of the noise.";
        Folded = "folded", "The area of the cell has changed sign, or by more than a factor of ten.";
        Misfit = "misfit", "The residual is larger than that of the noise, and that of a node wrong by 0.3 px.";
        Light = "light", "The brightness has changed otherwise than in the rest of the mesh; a correction for each element allows for it.";
        Damaged = "damaged", "Much of the cell is outliers of the residual: lost paint, a crack, a reflection or the edge of a shadow.";
    }
}

impl CellFlag {
    /// Flags of a cell that is not valid; those with another flag are doubtful.
    pub const INVALID: &'static [Self] =
        &[Self::FewPoints, Self::Uncorrelated, Self::WeakTexture, Self::Folded, Self::Damaged];

    /// Whether a cell with these bits is not valid.
    #[must_use]
    pub fn is_invalid(bits: u8) -> bool {
        Self::INVALID.iter().any(|flag| bits & flag.bit() != 0)
    }
}

flags! {
    /// Flags of a node.
    NodeFlag {
        NotMeasured = "not-measured", "No cell of the node is valid: its displacement is a NaN.";
        BesideFlagged = "beside-flagged", "Some cells of the node are flagged.";
        Uncertain = "uncertain", "The predicted standard deviation exceeds 0.1 px: the texture is too weak for the noise.";
        Unconverged = "unconverged", "The iterations did not converge, and any node may be wrong.";
        Periodic = "periodic", "The texture repeats itself, and the displacement may be wrong by one of its periods.";
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_flag_has_a_bit_and_a_name_of_its_own() {
        let bits = CellFlag::ALL.iter().fold(0, |bits, flag| bits | flag.bit());
        assert_eq!(bits.count_ones() as usize, CellFlag::ALL.len());
        let mut names: Vec<&str> = NodeFlag::ALL.iter().map(|flag| flag.name()).collect();
        names.dedup();
        assert_eq!(names.len(), NodeFlag::ALL.len());
    }
}
