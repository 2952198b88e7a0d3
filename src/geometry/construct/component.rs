//! The surfaces that tubes, ribbons and nets consist of.

use std::fmt;

use crate::geometry::NurbsSurface;

/// One surface of several that are made together.
#[derive(Clone, Debug, PartialEq)]
pub struct Component {
    /// What it is.
    pub kind: ComponentKind,
    /// The surface.
    pub surface: NurbsSurface,
    /// A measured estimate of the largest distance of the surface from the true one, as
    /// [`Sweep::deviation`](super::Sweep::deviation); 0 where it is exact.
    pub deviation: f64,
}

impl Component {
    pub(crate) fn exact(kind: ComponentKind, surface: NurbsSurface) -> Self {
        Self { kind, surface, deviation: 0.0 }
    }
}

/// What a surface is among those that are made together. Shown, it is part of the surface's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ComponentKind {
    /// A tube around a smooth part of a curve.
    Tube,
    /// The ball where two parts of a tube meet at an angle.
    Joint,
    /// The end of a tube.
    Cap,
    /// The band along a smooth part of a curve.
    Ribbon,
    /// A line of a control net.
    Line,
    /// A control point.
    Point,
}

impl fmt::Display for ComponentKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Tube => "tube",
            Self::Joint => "joint",
            Self::Cap => "cap",
            Self::Ribbon => "ribbon",
            Self::Line => "line",
            Self::Point => "point",
        })
    }
}
