//! Named shapes that POV-Ray knows, too: the same sets of points, as both are exact.

use glam::{DAffine3, DVec3};

use super::vector;
use crate::scene::{NamedShape, Shape, Transform, Written};

/// A primitive in its place; `None` of a shape POV-Ray does not know.
pub(super) fn primitive(shape: &Shape, steps: &[Written<Transform>]) -> Option<String> {
    let Shape::Named(shape, _) = shape else { return None };
    let body = match *shape {
        NamedShape::Sphere { radius } | NamedShape::SphereBiquadratic { radius } => {
            format!("sphere {{ 0, {radius:?}")
        }
        NamedShape::Hemisphere { radius } => {
            format!("sphere {{ 0, {radius:?} clipped_by {{ plane {{ -y, 0 }} }}")
        }
        NamedShape::Octant { radius } => format!(
            "sphere {{ 0, {radius:?} clipped_by {{\n  intersection {{ plane {{ -x, 0 }} \
             plane {{ -y, 0 }} plane {{ -z, 0 }} }}\n}}"
        ),
        NamedShape::Cylinder { radius, height } => {
            format!("cylinder {{ 0, <0, 0, {height:?}>, {radius:?} open")
        }
        NamedShape::Cone { radius, height } => {
            format!("cone {{ 0, {radius:?}, <0, 0, {height:?}>, 0 open")
        }
        // POV-Ray's lies around the y axis.
        NamedShape::Torus { major, minor } => {
            format!("torus {{ {major:?}, {minor:?} sturm rotate 90*x")
        }
        NamedShape::Disk { radius } => format!("disc {{ 0, z, {radius:?}"),
        _ => return None,
    };
    let affine = steps
        .iter()
        .try_fold(DAffine3::IDENTITY, |before, step| Some(step.value.affine().ok()? * before))?;
    let matrix = match affine == DAffine3::IDENTITY {
        true => String::new(),
        false => format!("\n  {}", matrix(&affine)),
    };
    Some(format!("{body}{matrix}\n}}\n"))
}

/// POV-Ray multiplies rows by matrices: the images of x, y and z, then of the origin.
fn matrix(affine: &DAffine3) -> String {
    let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| affine.matrix3 * axis);
    let rows = [x, y, z, affine.translation].map(|row| vector(row).replace(['<', '>'], ""));
    format!("matrix <{}>", rows.join(",  "))
}
