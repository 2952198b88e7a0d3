//! The parts of objects, made and put in their places.

use glam::DAffine3;

use super::made::Made;
use super::workshop::{Others, Workshop};
use crate::geometry::construct::ControlNet;
use crate::geometry::shapes::ShapeError;
use crate::geometry::{Surface, stretch};
use crate::scene::errors::{DrawError, SceneError, SceneFault};
use crate::scene::written::{Object, Part, Scene, Shape, TrimSpec, Written, placed};

/// All steps of an object's transform, the first one first.
pub(super) fn affine(name: &str, object: &Object) -> Result<DAffine3, SceneError> {
    placed(&object.transform).map_err(|(place, error)| {
        let fault = SceneFault::Transform { object: name.to_owned(), error };
        SceneError::new(place.clone(), fault)
    })
}

/// Makes and places the parts of objects.
pub(in crate::scene) struct Placer<'a> {
    pub(in crate::scene) scene: &'a Scene,
    /// The most control points that may be drawn for one object: many times as many as are written.
    pub(in crate::scene) most_points: usize,
}

impl Placer<'_> {
    /// The surfaces of a part of the object called `name`, in their places.
    fn place(
        &self,
        name: &str,
        part: &Part,
        (object, world_from_object): (&Object, &DAffine3),
    ) -> Result<Vec<Made>, SceneError> {
        let mut made = self.make(name, part)?;
        if let Some(trims) = &part.trims {
            made = trimmed(name, trims, made)?;
        }
        if *world_from_object == DAffine3::IDENTITY {
            return Ok(made); // bit for bit as authored
        }
        for one in &mut made {
            one.surface = one.surface.transformed(world_from_object).map_err(|error| {
                let place = object.transform.first().map_or(&part.place, |step| &step.place);
                let fault = SceneFault::Placed { surface: name.to_owned(), error };
                SceneError::new(place.clone(), fault)
            })?;
            one.deviation *= stretch(world_from_object);
        }
        Ok(made)
    }

    fn make(&self, name: &str, part: &Part) -> Result<Vec<Made>, SceneError> {
        let surface: Surface = match &part.shape {
            Shape::Triangle(net) => net.patch().map(Surface::from).map_err(|(error, place)| {
                let fault = SceneFault::Triangle { surface: name.to_owned(), error };
                SceneError::new(place.clone(), fault)
            })?,
            Shape::Net(net) => net.checked().map(Surface::from).map_err(|fault| {
                let place = net.place(fault.blame).clone();
                let fault = SceneFault::Surface { surface: name.to_owned(), error: fault.error };
                SceneError::new(place, fault)
            })?,
            Shape::Surface(surface) => {
                let deviation = match &**surface {
                    Surface::Limit(limit) => limit.deviation(),
                    _ => 0.0,
                };
                return Ok(vec![Made { deviation, ..Surface::clone(surface).into() }]);
            }
            Shape::Named(shape, measures) => shape.surface().map_err(|error| {
                let named = match &error {
                    ShapeError::Length { measure, .. } => measure,
                    ShapeError::Torus { .. } => "minor radius",
                    ShapeError::Octant { .. } => "constants",
                    ShapeError::Surface(_) => "",
                };
                let place = measures.iter().find(|measure| measure.value == named);
                let place = place.map_or(&part.place, |measure| &measure.place).clone();
                SceneError::new(place, SceneFault::Shape { surface: name.to_owned(), error })
            })?,
            Shape::Subdivision(subdivision) => {
                let limit = subdivision.surface().map_err(|error| {
                    let place = subdivision.blame(&error).unwrap_or(&part.place).clone();
                    SceneError::new(place, SceneFault::Limit { surface: name.to_owned(), error })
                })?;
                let deviation = limit.deviation();
                return Ok(vec![Made { name: String::new(), surface: limit.into(), deviation }]);
            }
            Shape::Built(construction, written) => {
                let place = &part.place;
                let most_points = self.most_points;
                let shop = Workshop { surface: name, place, written, most_points, others: self };
                return shop.make(construction);
            }
        };
        Ok(vec![surface.into()])
    }

    /// All surfaces of an object, which errors call `called`: in their places, with u and v
    /// exchanged and turned if the object says so, each with the number of its part.
    pub(in crate::scene) fn surfaces(
        &self,
        called: &str,
        object: &Object,
    ) -> Result<Vec<(usize, Made)>, SceneError> {
        let world_from_object = affine(called, object)?;
        let mut surfaces = Vec::new();
        for (index, part) in object.parts.iter().enumerate() {
            // The name in errors; surfaces of a part are numbered once all are made.
            let name = match part.name.as_str() {
                "" if object.parts.len() == 1 => called.to_owned(),
                "" => format!("{called}/{index}"),
                part => format!("{called}/{part}"),
            };
            for mut made in self.place(&name, part, (object, &world_from_object))? {
                if object.swap_uv {
                    made.surface = made.surface.swapped();
                }
                if object.reverse {
                    made.surface = made.surface.reversed();
                }
                surfaces.push((index, made));
            }
        }
        Ok(surfaces)
    }

    /// The object of this name, for the object `drawn` that draws it.
    fn drawn_object(&self, drawn: &str, of: &Written<String>) -> Result<&Object, SceneError> {
        let fails = |fault| SceneError::new(of.place.clone(), fault);
        let Some(object) = self.scene.named_object(&of.value) else {
            let error = self.scene.unknown_object(&of.value);
            return Err(fails(SceneFault::Draws { object: drawn.to_owned(), error }));
        };
        let draws = |part: &Part| match &part.shape {
            Shape::Built(construction, _) => construction.draws().is_some(),
            _ => false,
        };
        if object.parts.iter().any(draws) {
            let (object, of) = (drawn.to_owned(), of.value.clone());
            return Err(fails(SceneFault::DrawsDrawn { object, of }));
        }
        Ok(object)
    }
}

impl Others for Placer<'_> {
    fn surfaces_of(&self, drawn: &str, of: &Written<String>) -> Result<Vec<Surface>, SceneError> {
        let object = self.drawn_object(drawn, of)?;
        let made = self.surfaces(&of.value, object)?;
        Ok(made.into_iter().map(|(_, made)| made.surface).collect())
    }

    fn nets_of(
        &self,
        drawn: &str,
        of: &Written<String>,
        steps: usize,
        blamed: &dyn Fn(DrawError) -> SceneError,
    ) -> Result<Vec<ControlNet>, SceneError> {
        let object = self.drawn_object(drawn, of)?;
        let world_from_object = affine(&of.value, object)?;
        let mut nets = Vec::new();
        for part in &object.parts {
            if let Shape::Subdivision(subdivision) = &part.shape {
                let cage = subdivision.cage_after(steps).map_err(blamed)?;
                nets.push(cage.control_net().transformed(&world_from_object));
                continue;
            }
            if steps > 0 {
                return Err(blamed(DrawError::NoSteps));
            }
            let made = self.place(&of.value, part, (object, &world_from_object))?;
            nets.extend(made.iter().map(|made| made.surface.control_net()));
        }
        Ok(nets)
    }
}

/// Trims what was made, which must be one NURBS surface.
fn trimmed(name: &str, trims: &TrimSpec, made: Vec<Made>) -> Result<Vec<Made>, SceneError> {
    let count = made.len();
    let mut trimmed = Vec::new();
    for one in made {
        match (count, one.surface) {
            (1, Surface::Nurbs(surface)) => {
                let surface = trims.trimmed(name, surface)?.into();
                trimmed.push(Made { surface, ..one });
            }
            (_, surface) => {
                let object = name.to_owned();
                let fault = match surface {
                    _ if count > 1 => SceneFault::TrimsOfSeveral { object, count },
                    Surface::Nurbs(_) | Surface::Trimmed(_) => SceneFault::TrimmedTwice { object },
                    Surface::Triangle(_) => {
                        SceneFault::NotTrimmed { object, kind: "a triangular patch" }
                    }
                    Surface::Limit(_) => {
                        SceneFault::NotTrimmed { object, kind: "a subdivision surface" }
                    }
                };
                return Err(SceneError::new(trims.place.clone(), fault));
            }
        }
    }
    Ok(trimmed)
}
