// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! The profiles of devices.

use palpate::device::PROFILES;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::answers::read;

/// The profiles of known devices by their names, as `device=` of `Servo` and `feel` takes them: dicts with the limits
/// and the dynamics of each, in SI units.
///
/// >>> import palpate as pp
/// >>> pp.device_profiles()["omega"]["max_force"]
/// 12.0
#[pyfunction]
pub(crate) fn device_profiles(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let all = PyDict::new(py);
    for (name, profile) in &PROFILES {
        all.set_item(name, read(py, profile)?)?;
    }
    Ok(all)
}
