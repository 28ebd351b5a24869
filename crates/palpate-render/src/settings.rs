// SPDX-FileCopyrightText: The palpate authors
// SPDX-License-Identifier: MIT OR Apache-2.0

//! How a picture is rendered.

use crate::error::RenderError;
use crate::subject::Cut;

/// The most pixels of a picture: their light fills a gigabyte of memory.
pub(crate) const MOST_PIXELS: u64 = 40_000_000;

/// The most samples along a pixel's side: those of a pixel are painted together, so they must fit
/// into a block of 64.
pub(crate) const MOST_SAMPLES: u32 = 8;

/// The shadows of the key light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shadows {
    /// None.
    None,
    /// Of a light as small as a point.
    Hard,
    /// Of a disc of 6°.
    Soft,
}

/// How a picture is rendered.
///
/// ```
/// use palpate_render::{Settings, Shadows};
///
/// let settings = Settings {
///     shadows: Shadows::Hard,
///     ground: Some(0.0),
///     ..Settings::new(320, 240)
/// };
/// assert_eq!((settings.width, settings.ground), (320, Some(0.0)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// The width [pixels].
    pub width: u32,
    /// The height [pixels].
    pub height: u32,
    /// Samples along the side of a pixel at an edge.
    pub samples: u32,
    /// The shadows.
    pub shadows: Shadows,
    /// The height of a level ground on which shadows fall [m]; none if left out.
    pub ground: Option<f64>,
    /// A plane that cuts bodies.
    pub cut: Option<Cut>,
    /// The distance between the isolines of a cut face [m]; chosen if left out.
    pub spacing: Option<f64>,
    /// The most evaluations for each ray.
    pub budget: u32,
}

impl Settings {
    /// The budget unless another is given: hundreds of times what a grazing ray needs.
    pub const BUDGET: u32 = 50_000;

    /// A picture of this size [pixels], with soft shadows and edges of 4 × 4 samples, without
    /// ground.
    #[must_use]
    pub const fn new(width: u32, height: u32) -> Self {
        Self {
            width,
            height,
            samples: 4,
            shadows: Shadows::Soft,
            ground: None,
            cut: None,
            spacing: None,
            budget: Self::BUDGET,
        }
    }

    /// Refuses what cannot be rendered, as [`render`](crate::render) does.
    ///
    /// # Errors
    ///
    /// If the picture has no pixels or too many, the samples are not from 1 to 8, the spacing is
    /// not positive, or the ground not finite.
    pub fn check(&self) -> Result<(), RenderError> {
        let Self { width, height, samples, .. } = *self;
        let pixels = u64::from(width) * u64::from(height);
        if pixels == 0 || pixels > MOST_PIXELS {
            return Err(RenderError::Size { width, height });
        }
        if samples == 0 || samples > MOST_SAMPLES {
            return Err(RenderError::Samples { samples });
        }
        if let Some(spacing) = self.spacing {
            RenderError::check_positive("the spacing of isolines", spacing, " m")?;
        }
        match self.ground {
            Some(value) if !value.is_finite() => {
                let (what, rule) = ("the height of the ground", "finite");
                Err(RenderError::Number { what, rule, value, unit: " m" })
            }
            _ => Ok(()),
        }
    }
}
