//! Axis-parallel rectangles of parameters.

use glam::DVec2;

/// A closed rectangle of the (u, v) plane, possibly [empty](Self::EMPTY).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UvBox {
    /// The smallest parameters.
    pub min: DVec2,
    /// The largest parameters.
    pub max: DVec2,
}

impl UvBox {
    /// The rectangle that holds nothing.
    pub const EMPTY: Self = Self { min: DVec2::INFINITY, max: DVec2::NEG_INFINITY };

    /// The rectangle `[u[0], u[1]] × [v[0], v[1]]`.
    pub fn new(u: [f64; 2], v: [f64; 2]) -> Self {
        Self { min: DVec2::new(u[0], v[0]), max: DVec2::new(u[1], v[1]) }
    }

    /// The rectangle that reaches `reach` to each side of a point.
    pub fn about(center: DVec2, reach: DVec2) -> Self {
        Self { min: center - reach, max: center + reach }
    }

    /// The smallest rectangle that holds all points.
    pub fn around(points: impl IntoIterator<Item = DVec2>) -> Self {
        points.into_iter().fold(Self::EMPTY, |all, point| Self {
            min: all.min.min(point),
            max: all.max.max(point),
        })
    }

    /// The smallest rectangle that holds both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The rectangle grown by `margin` on both sides, in u and in v.
    #[must_use]
    pub fn grown(self, margin: DVec2) -> Self {
        Self { min: self.min - margin, max: self.max + margin }
    }

    /// Whether the two have a point in common; false for NaN.
    pub fn meets(&self, other: &Self) -> bool {
        self.min.x <= other.max.x
            && other.min.x <= self.max.x
            && self.min.y <= other.max.y
            && other.min.y <= self.max.y
    }

    /// Whether a point lies inside or on the border; false for NaN.
    pub fn holds(&self, point: DVec2) -> bool {
        self.meets(&Self { min: point, max: point })
    }

    /// The middle.
    pub fn center(&self) -> DVec2 {
        0.5 * self.min + 0.5 * self.max
    }

    /// The side lengths.
    pub fn size(&self) -> DVec2 {
        self.max - self.min
    }

    /// The largest absolute values of u and of v.
    pub fn magnitude(&self) -> DVec2 {
        self.min.abs().max(self.max.abs())
    }
}
