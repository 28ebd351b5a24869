// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! Angles, in degrees or in radians.

/// An angle, or an angle for each metre, in the unit that a file gives.
///
/// Files written by hand give degrees. A file written from a shape gives radians where no
/// number of degrees stands for the same bits.
///
/// ```
/// use palpate_scene::Angle;
///
/// assert_eq!(Angle::from_radians(std::f64::consts::FRAC_PI_2), Angle::Degrees(90.0));
/// assert_eq!(Angle::from_radians(0.1).radians(), 0.1);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Angle {
    /// In degrees.
    Degrees(f64),
    /// In radians.
    Radians(f64),
}

impl Angle {
    /// The angle of so many radians: in degrees if they are the same angle to the bit.
    #[must_use]
    pub fn from_radians(angle: f64) -> Self {
        let same = |degrees: &f64| degrees.to_radians().to_bits() == angle.to_bits();
        degrees_near(angle).into_iter().find(same).map_or(Self::Radians(angle), Self::Degrees)
    }

    /// The angle in radians.
    #[must_use]
    pub fn radians(self) -> f64 {
        match self {
            Self::Degrees(angle) => angle.to_radians(),
            Self::Radians(angle) => angle,
        }
    }

    /// The one of two keys that goes with the unit.
    pub(crate) fn key<'k>(self, degrees: &'k str, radians: &'k str) -> &'k str {
        match self {
            Self::Degrees(_) => degrees,
            Self::Radians(_) => radians,
        }
    }

    /// The number in the unit that a file gives.
    pub(crate) fn number(self) -> f64 {
        match self {
            Self::Degrees(angle) | Self::Radians(angle) => angle,
        }
    }
}

/// Numbers of degrees that may stand for an angle [rad]: rounded to 14 digits, as people write
/// them, then the nearest numbers.
pub(crate) fn degrees_near(angle: f64) -> [f64; 4] {
    let near = angle.to_degrees();
    let rounded = format!("{near:.13e}").parse().unwrap_or(near);
    [rounded, near, near.next_up(), near.next_down()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_angle_keeps_its_bits() {
        let (mut degrees, mut radians) = (0, 0);
        for i in 0..10_000 {
            let angle = (f64::from(i) * 0.618_034).fract() * 8.0 - 4.0;
            let written = Angle::from_radians(angle);
            assert_eq!(written.radians().to_bits(), angle.to_bits());
            match written {
                Angle::Degrees(_) => degrees += 1,
                Angle::Radians(_) => radians += 1,
            }
        }
        assert!(degrees > 5000 && radians > 500, "{degrees} in degrees, {radians} in radians");
        for angle in [0.0, -0.0, 1e300, 5e-324, f64::MAX] {
            assert_eq!(Angle::from_radians(angle).radians().to_bits(), angle.to_bits());
        }
    }

    #[test]
    fn whole_degrees_stay_whole() {
        for degrees in -720..=720 {
            let degrees = f64::from(degrees);
            assert_eq!(Angle::from_radians(degrees.to_radians()), Angle::Degrees(degrees));
        }
    }
}
