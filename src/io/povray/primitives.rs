//! Named shapes that POV-Ray knows, too: the same sets of points, as both are exact.

use glam::{DAffine3, DVec3};

use super::vector;
use crate::math::rounding;
use crate::patch::ScaledFrame;
use crate::scene::{NamedShape, Shape, Transform, Written, placed};

/// A primitive in its place, in the coordinates of a frame; `None` for a shape POV-Ray does not
/// know.
///
/// The primitive itself, too, has a size of about 1, as POV-Ray intersects it in its own
/// coordinates.
pub(super) fn primitive(
    shape: &Shape,
    steps: &[Written<Transform>],
    frame: &ScaledFrame,
) -> Option<String> {
    let Shape::Named(shape, _) = shape else { return None };
    let size = size(shape)?;
    let unit = rounding::power_of_two_below(1.0 / size);
    let body = match *shape {
        NamedShape::Sphere { .. } | NamedShape::SphereBiquadratic { .. } => {
            format!("sphere {{ 0, {:?}", unit * size)
        }
        NamedShape::Hemisphere { .. } => {
            format!("sphere {{ 0, {:?} clipped_by {{ plane {{ -y, 0 }} }}", unit * size)
        }
        NamedShape::Octant { .. } => format!(
            "sphere {{ 0, {:?} clipped_by {{\n  intersection {{ plane {{ -x, 0 }} \
             plane {{ -y, 0 }} plane {{ -z, 0 }} }}\n}}",
            unit * size
        ),
        NamedShape::Cylinder { radius, height } => {
            format!("cylinder {{ 0, <0, 0, {:?}>, {:?} open", unit * height, unit * radius)
        }
        NamedShape::Cone { radius, height } => {
            format!("cone {{ 0, {:?}, <0, 0, {:?}>, 0 open", unit * radius, unit * height)
        }
        // POV-Ray's torus lies around the y axis.
        NamedShape::Torus { major, minor } => {
            format!("torus {{ {:?}, {:?} sturm rotate 90*x", unit * major, unit * minor)
        }
        NamedShape::Disk { .. } => format!("disc {{ 0, z, {:?}", unit * size),
        _ => return None,
    };
    let placed = placed(steps).ok()?;
    let affine = DAffine3 {
        matrix3: frame.scale * placed.matrix3 * (1.0 / unit),
        translation: frame.scaled(placed.translation),
    };
    let matrix = match affine == DAffine3::IDENTITY {
        true => String::new(),
        false => format!("\n  {}", matrix(&affine)),
    };
    Some(format!("{body}{matrix}\n}}\n"))
}

/// The largest of the lengths that describe a shape POV-Ray knows.
fn size(shape: &NamedShape) -> Option<f64> {
    match *shape {
        NamedShape::Sphere { radius }
        | NamedShape::SphereBiquadratic { radius }
        | NamedShape::Hemisphere { radius }
        | NamedShape::Octant { radius }
        | NamedShape::Disk { radius } => Some(radius),
        NamedShape::Cylinder { radius, height } | NamedShape::Cone { radius, height } => {
            Some(radius.max(height.abs()))
        }
        NamedShape::Torus { major, .. } => Some(major),
        _ => None,
    }
}

/// POV-Ray multiplies rows by matrices: the images of x, y and z, then of the origin.
fn matrix(affine: &DAffine3) -> String {
    let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| affine.matrix3 * axis);
    let rows = [x, y, z, affine.translation].map(|row| vector(row).replace(['<', '>'], ""));
    format!("matrix <{}>", rows.join(",  "))
}
