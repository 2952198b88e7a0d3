//! What a scene says about its picture; the command line may say otherwise.

use std::fmt;
use std::str::FromStr;

/// How radiance is found, by name; the render floor gives each its meaning.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum IntegratorKind {
    /// Lights, shadows and materials.
    #[default]
    Direct,
    /// The normal as a colour.
    Normal,
    /// The surface's (u, v) as a colour.
    Uv,
    /// The distance along the view.
    Depth,
    /// A colour for each surface.
    Id,
    /// How much work the hit took.
    Iterations,
}

impl IntegratorKind {
    /// Every integrator, in the order to list them.
    pub const ALL: &'static [Self] =
        &[Self::Direct, Self::Normal, Self::Uv, Self::Depth, Self::Id, Self::Iterations];

    /// Its name in scenes and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Direct => "direct",
            Self::Normal => "normal",
            Self::Uv => "uv",
            Self::Depth => "depth",
            Self::Id => "id",
            Self::Iterations => "iterations",
        }
    }
}

impl fmt::Display for IntegratorKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for IntegratorKind {
    type Err = super::UnknownName;

    fn from_str(name: &str) -> Result<Self, super::UnknownName> {
        let known: Vec<_> = Self::ALL.iter().map(|kind| kind.name()).collect();
        Self::ALL
            .iter()
            .copied()
            .find(|kind| kind.name() == name)
            .ok_or_else(|| super::UnknownName::new("integrator", name, &known))
    }
}

/// The picture a scene asks for.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderDefaults {
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// Samples a pixel.
    pub spp: u32,
    /// How radiance is found.
    pub integrator: IntegratorKind,
    /// The seed of every sample.
    pub seed: u64,
    /// Exposure of the PNG, in stops: radiance is multiplied by `2^exposure`.
    pub exposure: f64,
}

impl Default for RenderDefaults {
    fn default() -> Self {
        Self {
            size: (800, 600),
            spp: 16,
            integrator: IntegratorKind::default(),
            seed: 0,
            exposure: 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_come_back() {
        for &kind in IntegratorKind::ALL {
            assert_eq!(kind.to_string().parse(), Ok(kind));
        }
    }

    #[test]
    fn unknown_names_get_the_nearest() {
        assert_eq!(
            "normals".parse::<IntegratorKind>().unwrap_err().to_string(),
            "unknown integrator \"normals\"; did you mean \"normal\"?"
        );
    }
}
