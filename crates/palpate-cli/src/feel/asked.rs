// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The stiffness that materials ask for.

use palpate::device::DeviceProfile;
use palpate::haptics::Material;
use palpate::safety::{Acceptance, Accepted, DeviceLimits};

use palpate::scene::text::rounded;

/// The part of what the device renders that a material asks for; `None` if it asks for a stiffness
/// in N/m, or the device has no largest.
pub(super) fn part(material: &Material, device: &DeviceProfile) -> Option<f64> {
    // Whether there is a largest depends on no rate.
    let most =
        Accepted::most_stiffness(&DeviceLimits::along(device), Acceptance::Device, 1000.0);
    let is_limited = device.max_force > 0.0 && most.is_ok_and(f64::is_finite);
    material.relative_stiffness.filter(|_| is_limited)
}

/// The stiffness that materials ask for [N/m], and the part of the device's that others do.
pub(super) fn stiffness<'a>(
    materials: impl Iterator<Item = &'a Material> + Clone,
    device: &DeviceProfile,
) -> String {
    let parts = materials.clone().filter_map(|material| part(material, device));
    let own = materials.filter(|material| part(material, device).is_none());
    let own = own.map(|material| material.stiffness);
    let of_device = || format!("{} of what the device renders", range(parts.clone()));
    match (own.clone().next(), parts.clone().next()) {
        (_, None) => range(own),
        (None, Some(_)) => of_device(),
        (Some(_), Some(_)) => format!("{}, and {}", range(own), of_device()),
    }
}

/// The numbers of all bodies: one number if they are equal, else their range.
pub(super) fn range(numbers: impl Iterator<Item = f64> + Clone) -> String {
    let least = numbers.clone().fold(f64::INFINITY, f64::min);
    let largest = numbers.fold(f64::NEG_INFINITY, f64::max);
    if least < largest {
        format!("{} to {}", rounded(least), rounded(largest))
    } else {
        rounded(least)
    }
}
