//! The parts of objects, made and put in their places.

use glam::DAffine3;

use super::construction::{Made, Workshop};
use super::{Part, SceneError, SceneFault, Shape};
use crate::geometry::NurbsSurface;

/// The surfaces of a part of the object called `name`, in their places.
pub(super) fn place_part(
    name: &str,
    part: &Part,
    world_from_object: &DAffine3,
) -> Result<Vec<Made>, SceneError> {
    let mut made = make(name, part)?;
    if *world_from_object == DAffine3::IDENTITY {
        return Ok(made); // bit for bit as authored
    }
    for one in &mut made {
        one.surface = one.surface.transformed(world_from_object).map_err(|error| {
            let fault = SceneFault::Placed { surface: name.to_owned(), error };
            SceneError::new(part.place.clone(), fault)
        })?;
        one.deviation *= stretch(world_from_object);
    }
    Ok(made)
}

fn make(name: &str, part: &Part) -> Result<Vec<Made>, SceneError> {
    let surface: NurbsSurface = match &part.shape {
        Shape::Net(net) => net.surface().map_err(|fault| {
            let place = net.place(fault.blame).clone();
            let fault = SceneFault::Surface { surface: name.to_owned(), error: fault.error };
            SceneError::new(place, fault)
        })?,
        Shape::Named(shape) => shape.surface().map_err(|error| {
            let fault = SceneFault::Shape { surface: name.to_owned(), error };
            SceneError::new(part.place.clone(), fault)
        })?,
        Shape::Built(construction) => {
            return construction.make(&Workshop { surface: name, place: &part.place });
        }
    };
    Ok(vec![surface.into()])
}

/// By how much a map lengthens distances at most: the root of the sum of its squares is a
/// bound of the largest singular value, and no more than √3 times it.
fn stretch(map: &DAffine3) -> f64 {
    map.matrix3.to_cols_array().iter().map(|entry| entry * entry).sum::<f64>().sqrt()
}
