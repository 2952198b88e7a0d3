//! Knot vectors.

/// The knot vector of a B-spline.
#[derive(Clone, Debug, PartialEq)]
pub struct KnotVector {
    degree: usize,
    values: Vec<f64>,
}

impl KnotVector {
    /// The degree `p`.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// All knots, in order.
    pub fn values(&self) -> &[f64] {
        &self.values
    }
}
