// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The buttons of a device.

/// The buttons of a device that are held down, by their index. The names, where a device has some,
/// are in [`DeviceProfile::buttons`](crate::DeviceProfile::buttons).
///
/// ```
/// use palpate_device::Buttons;
///
/// let held = Buttons::NONE.with(0).with(3);
/// assert!(held.is_down(3) && !held.is_down(1));
/// assert_eq!(held.iter().collect::<Vec<_>>(), [0, 3]);
/// assert_eq!(held.changed(Buttons::NONE.with(3)), Buttons::NONE.with(0));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Buttons(u32);

impl Buttons {
    /// The most buttons of a device.
    pub const MOST: u8 = 32;

    /// No button is held down.
    pub const NONE: Self = Self(0);

    /// Bit `i` stands for button `i`, as most drivers tell it.
    #[must_use]
    pub const fn from_bits(bits: u32) -> Self {
        Self(bits)
    }

    /// Bit `i` stands for button `i`.
    #[must_use]
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// These buttons and one more; those of an index of [`MOST`](Self::MOST) and above do not exist.
    #[must_use]
    pub const fn with(self, button: u8) -> Self {
        match 1_u32.checked_shl(button as u32) {
            Some(bit) => Self(self.0 | bit),
            None => self,
        }
    }

    /// Whether a button is held down.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub const fn is_down(self, button: u8) -> bool {
        Self::NONE.with(button).0 & self.0 != 0
    }

    /// The buttons that are down in one of both and up in the other.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    #[must_use]
    pub const fn changed(self, other: Self) -> Self {
        Self(self.0 ^ other.0)
    }

    /// The indices of the buttons that are down, rising.
    ///
    /// Real-time: allocates nothing, takes no lock, cannot panic.
    pub fn iter(self) -> impl Iterator<Item = u8> {
        (0..Self::MOST).filter(move |button| self.is_down(*button))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_button_beyond_the_last_is_never_down() {
        let all = Buttons::from_bits(u32::MAX);
        assert!(all.is_down(31) && !all.is_down(32) && !all.is_down(255));
        assert_eq!(Buttons::NONE.with(32), Buttons::NONE);
        assert_eq!((all.iter().count(), Buttons::NONE.with(31).bits()), (32, 0x8000_0000));
    }
}
