//! The sets of rays that are timed, and how they are asked.

use std::fmt;

use nurbray::intersect::Coherence;

/// A set of rays, by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RaySet {
    /// The camera's rays, in packets.
    Primary,
    /// The camera's rays, one at a time.
    Single,
    /// Chords of a sphere around the model, in batches.
    Incoherent,
    /// The same chords, one at a time.
    IncoherentSingle,
    /// Short rays in all directions from what the camera sees.
    AmbientOcclusion,
    /// Rays to a light from what the camera sees.
    Shadow,
}

/// What is asked of each ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Question {
    /// The first hit.
    FirstHit,
    /// Whether there is any hit.
    AnyHit,
}

/// How rays are handed over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Calls {
    /// Many at a time: the competitor may use packets.
    Batch(Coherence),
    /// One call a ray.
    OneByOne,
}

impl RaySet {
    /// Every set, in the order to list them.
    pub(crate) const ALL: [Self; 6] = [
        Self::Primary,
        Self::Single,
        Self::Incoherent,
        Self::IncoherentSingle,
        Self::AmbientOcclusion,
        Self::Shadow,
    ];

    /// The sets that are measured by default.
    pub(crate) const DEFAULT: &str = "primary,single,incoherent,ao";

    /// Its name on the command line and in results.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Primary => "primary",
            Self::Single => "single",
            Self::Incoherent => "incoherent",
            Self::IncoherentSingle => "incoherent-single",
            Self::AmbientOcclusion => "ao",
            Self::Shadow => "shadow",
        }
    }

    /// The set of this name.
    pub(crate) fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|set| set.name() == name)
    }

    /// What is asked of its rays.
    pub(crate) fn question(self) -> Question {
        match self {
            Self::AmbientOcclusion | Self::Shadow => Question::AnyHit,
            _ => Question::FirstHit,
        }
    }

    /// How its rays are handed over.
    pub(crate) fn calls(self) -> Calls {
        match self {
            Self::Primary | Self::Shadow => Calls::Batch(Coherence::Coherent),
            Self::Incoherent | Self::AmbientOcclusion => Calls::Batch(Coherence::Incoherent),
            Self::Single | Self::IncoherentSingle => Calls::OneByOne,
        }
    }
}

impl fmt::Display for RaySet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
