// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! What is asked of a device that renders less.

use std::fmt;

use crate::acceptance::{AS_IS_MOST, Accepted, Rule};
use crate::limits::Impedance;
use palpate_device::Short;

/// What asks a device for a stiffness and a damping. Numbers are places among the bodies, or among
/// the guides.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Requester {
    /// A material alone.
    #[default]
    Material,
    /// The material of a body; with a tool, of one that is as soft as the coupling or softer.
    Body(usize),
    /// The magnet of a body.
    Magnet(usize),
    /// The height texture of a body, by the lateral stiffness of its slopes.
    Texture(usize),
    /// The coupling of a tool, on a body that is stiffer.
    Coupling(usize),
    /// The coupling of a tool about axes.
    AngularCoupling,
    /// A guide.
    Guide(usize),
}

/// What a device renders instead of what is asked of it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Refused {
    /// The stiffness and the damping that are requested, in the world; angular about axes.
    pub requested: Impedance,
    /// The stiffness and the damping that the device renders, in the world.
    pub rendered: Impedance,
    /// Stiffness at the device over stiffness in the world, and damping likewise.
    pub scale: f64,
    /// The rule that leaves no more.
    pub rule: Rule,
    /// What asks for it.
    pub requester: Requester,
    /// Whether it was to be taken [as it is](crate::Acceptance::AsIs), and is too stiff for that.
    pub is_as_it_is: bool,
}

impl Refused {
    pub(crate) fn new(accepted: &Accepted, rule: Rule, requester: Requester) -> Self {
        Self {
            requested: accepted.requested(),
            rendered: accepted.impedance,
            scale: accepted.scale,
            rule,
            requester,
            is_as_it_is: false,
        }
    }

    /// This refusal of what `requester` asks for.
    #[must_use]
    pub fn by(self, requester: Requester) -> Self {
        Self { requester, ..self }
    }

    /// The refusal as a sentence, with the names that `name` gives to bodies.
    ///
    /// ```
    /// use palpate_device::DeviceProfile;
    /// use palpate_safety::{Accepted, Impedance, Requester};
    ///
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let device = DeviceProfile {
    ///     max_stiffness: 1000.0,
    ///     ..DeviceProfile::unlimited("example")
    /// };
    /// // Lengths in the world are twice those at the device.
    /// let accepted = Accepted::new(Impedance::new(2000.0, 0.0)?, 2.0, &device, 1000.0)?;
    /// let refused = accepted.refusal(Requester::Body(0)).ok_or("it is softer")?;
    /// assert_eq!(
    ///     refused.told(|_| "\"table\"".to_owned()),
    ///     "body \"table\": the device renders stiffness 500 N/m (asked 2000) and damping 0 N·s/m (asked \
    ///      0), which at the device, 2 times as large, are 1000 (asked 4000) and 0 (asked 0): K ≤ the \
    ///      device's largest stiffness at this rate"
    /// );
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn told(&self, name: impl Fn(usize) -> String) -> String {
        let requester = match self.requester {
            Requester::Material => String::new(),
            Requester::Body(body) => format!("body {}: ", name(body)),
            Requester::Magnet(body) => format!("magnet of body {}: ", name(body)),
            Requester::Texture(body) => {
                format!("height texture of body {}, across its waves: ", name(body))
            }
            Requester::Coupling(body) => {
                format!("coupling of the tool, which is softer than body {}: ", name(body))
            }
            Requester::AngularCoupling => "coupling of the tool about axes: ".to_owned(),
            Requester::Guide(guide) => format!("guide {guide}: "),
        };
        let (angular, [of_stiffness, of_damping]) = if self.rule.is_angular() {
            ("angular ", ["N·m/rad", "N·m·s/rad"])
        } else {
            ("", ["N/m", "N·s/m"])
        };
        let numbers = |scale: f64| {
            let [rendered, requested] = [self.rendered, self.requested];
            [
                distinct([scale * rendered.stiffness, scale * requested.stiffness]),
                distinct([scale * rendered.damping, scale * requested.damping]),
            ]
        };
        let [[stiffness, asked], [damping, asked_damping]] = numbers(1.0);
        let at_device = if self.scale == 1.0 {
            String::new()
        } else {
            let [[stiffness, asked], [damping, asked_damping]] = numbers(self.scale);
            format!(
                ", which at the device, {} times as large, are {stiffness} (asked {asked}) and \
                 {damping} (asked {asked_damping})",
                digits(self.scale, 4),
            )
        };
        let advice = if self.is_as_it_is {
            format!(
                "; as it is, at most {AS_IS_MOST} times the stiffness that it renders comes to \
                 rest: ask for less, or for what the device renders"
            )
        } else {
            String::new()
        };
        format!(
            "{requester}the device renders {angular}stiffness {stiffness} {of_stiffness} (asked \
             {asked}) and damping {damping} {of_damping} (asked {asked_damping}){at_device}: \
             {}{advice}",
            self.rule.condition()
        )
    }
}

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.told(|body| body.to_string()))
    }
}

/// All refusals in a sentence.
pub(crate) fn listed(refused: &[Refused]) -> String {
    let refused: Vec<_> = refused.iter().map(Refused::to_string).collect();
    refused.join("; ")
}

/// A number with so many significant digits.
fn digits(number: f64, count: usize) -> Short {
    Short(format!("{number:.*e}", count - 1).parse().unwrap_or(number))
}

/// Two numbers with four digits, or with as many as tell them apart. Those that rounding made
/// different are equal.
fn distinct(pair: [f64; 2]) -> [Short; 2] {
    let counts = [4, 6, 8, 10].into_iter();
    let rounded = |count| pair.map(|number| digits(number, count));
    let apart = counts.map(rounded).find(|[one, other]| one != other);
    apart.unwrap_or_else(|| rounded(4))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Impedance;
    use palpate_device::DeviceProfile;

    /// Once 199.99999999999983 N/m and 967.6131805918325 N/m were told.
    #[test]
    fn numbers_are_rounded_and_differ_where_they_are_different() {
        let told = |pair| distinct(pair).map(|number| number.to_string());
        assert_eq!(told([199.999_999_999_999_83, 200.0]), ["200", "200"]);
        assert_eq!(told([967.613_180_591_832_5; 2]), ["967.6", "967.6"]);
        assert_eq!(told([199.99, 200.0]), ["199.99", "200"]);
        assert_eq!(told([0.0, 1.0]), ["0", "1"]);
    }

    #[test]
    fn every_refusal_says_what_asks() {
        let device =
            DeviceProfile { max_stiffness: 100.0, ..DeviceProfile::unlimited("example") };
        let of = |requester| {
            let asked = Impedance::new(200.0, 0.0).unwrap();
            let accepted = Accepted::new(asked, 1.0, &device, 1000.0).unwrap();
            accepted.refusal(requester).unwrap()
        };
        let both = listed(&[of(Requester::Magnet(2)), of(Requester::Guide(1))]);
        assert!(both.starts_with("magnet of body 2: the device renders "), "{both}");
        assert!(both.contains("; guide 1: the device renders "), "{both}");
        let coupling = of(Requester::Coupling(0)).to_string();
        assert!(coupling.starts_with("coupling of the tool, which is softer than body 0: "));
        let about = of(Requester::AngularCoupling).to_string();
        assert!(about.starts_with("coupling of the tool about axes: "));
    }
}
