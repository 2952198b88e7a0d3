//! What is made of a part of an object.

use crate::geometry::Surface;

/// A surface made, and how far it is from what was asked for.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::scene) struct Made {
    /// What it is called within its object; may be empty.
    pub(in crate::scene) name: String,
    pub(in crate::scene) surface: Surface,
    /// The distance in space, as [`Instance::deviation`](crate::scene::Instance::deviation); 0
    /// where it is exact.
    pub(in crate::scene) deviation: f64,
}

impl<S: Into<Surface>> From<S> for Made {
    /// A surface that is exactly what was asked for, the only one.
    fn from(surface: S) -> Self {
        Self { name: String::new(), surface: surface.into(), deviation: 0.0 }
    }
}
