//! Plots for scenes that ask for none: the curves surfaces are made from, their trims, the basis
//! functions over their knots, and surfaces without knots, or with too many, as lines in space.

use std::collections::HashMap;

use nurbray::geometry::{KnotVector, Surface};
use nurbray::scene::{
    CurveEntry, CurveSpec, ImportNote, Instance, Object, Plot, PlotKind, PlottedCurve,
    PlottedSurface, Scene, SceneError, SceneFault, Shape,
};

use super::super::console;
use super::super::failure::{Failure, OrFail};
use super::super::table::count;

/// Cages with more faces than this show only the faces' borders: more lines would make one dark
/// spot.
const MOST_FACES: usize = 200;

/// The plots that suit a scene, curves first.
///
/// # Errors
/// When the scene cannot be built as its author wrote it.
pub(super) fn plots(scene: &Scene) -> Result<Vec<Plot>, Failure> {
    // Errors in the scene are worded as by every other subcommand.
    let surfaces = scene.surfaces().map_err(|error| match error.fault() {
        SceneFault::Empty { notes } if !notes.is_empty() => nothing_imported(&error, notes),
        _ => Failure::Input(error.into()),
    })?;
    let mut shown: Vec<(PlottedCurve, Vec<String>)> = Vec::new();
    for (name, spec) in scene.objects.iter().flat_map(curves) {
        let curve = spec.plotted(&name).or_bad_input()?;
        gather(&mut shown, curve, name);
    }
    let entry = |curve| CurveEntry { curve, label: None, polygon: true, knots: true };
    let mut plots: Vec<Plot> = shown
        .into_iter()
        .map(|(curve, users)| Plot {
            title: Some(joint(&users)),
            plane: None,
            show: PlotKind::Curves(vec![entry(curve)]),
        })
        .collect();
    for instance in &surfaces {
        if instance.surface.trimmed().is_some() {
            let title = Some(format!("Trims of {}", instance.name));
            let show = PlotKind::Trims(vec![plotted(scene, instance)?]);
            plots.push(Plot { title, plane: None, show });
        }
    }
    plots.extend(in_space(scene, &surfaces)?);
    plots.extend(bases(scene, &surfaces));
    Ok(plots)
}

/// The basis functions over the knots of surfaces, each kind once. Where there are more of them
/// than can be drawn, a warning says so.
fn bases(scene: &Scene, surfaces: &[Instance]) -> Vec<Plot> {
    let mut bases: Vec<(&KnotVector, Vec<String>)> = Vec::new();
    let mut known: HashMap<(usize, Vec<u64>), usize> = HashMap::new();
    let mut too_many: Vec<String> = Vec::new();
    for instance in surfaces {
        let [object, part] = instance.part;
        // A drawing of another object has no functions of its own.
        let draws = match &scene.objects[object].parts[part].shape {
            Shape::Built(construction, _) => construction.draws().is_some(),
            _ => false,
        };
        let Some(surface) = instance.surface.nurbs().filter(|_| !draws) else { continue };
        for (knots, direction) in [(surface.knots_u(), "u"), (surface.knots_v(), "v")] {
            let user = format!("{}, {direction}", instance.name);
            if knots.point_count() > Plot::MAX_FUNCTIONS {
                too_many.push(user);
                continue;
            }
            let values = knots.values().iter().map(|knot| knot.to_bits()).collect();
            let number = *known.entry((knots.degree(), values)).or_insert_with(|| {
                bases.push((knots, Vec::new()));
                bases.len() - 1
            });
            bases[number].1.push(user);
        }
    }
    if !too_many.is_empty() {
        console::warning(&format!(
            "basis functions of {} are not plotted: more than {}",
            joint(&too_many),
            count(Plot::MAX_FUNCTIONS as u64, "function"),
        ));
    }
    let plot = |(knots, users): (&KnotVector, Vec<String>)| {
        let title = Some(format!("Degree {}: {}", knots.degree(), joint(&users)));
        Plot { title, plane: None, show: PlotKind::Basis(knots.into()) }
    };
    bases.into_iter().map(plot).collect()
}

/// A model file may hold curves, but none of them is imported, and so nothing is plotted.
fn nothing_imported(error: &SceneError, notes: &[ImportNote]) -> Failure {
    const SHOWN: usize = 3;
    let mut what: Vec<&str> = notes.iter().take(SHOWN).map(|note| note.what.as_str()).collect();
    let more = format!("{} more", notes.len().saturating_sub(SHOWN));
    if notes.len() > SHOWN {
        what.push(&more);
    }
    let place = error.place();
    let place = if place.label().is_some() { format!("{place}: ") } else { String::new() };
    Failure::input(format!(
        "{place}there is nothing to plot: of model files only surfaces are imported, not {}; a \
         scene draws a curve that its [[plot]] gives",
        what.join(", ")
    ))
}

/// Whether basis functions of a surface are drawn, in one direction at least.
fn has_basis(surface: &Surface) -> bool {
    let few = |knots: &KnotVector| knots.point_count() <= Plot::MAX_FUNCTIONS;
    surface.nurbs().is_some_and(|surface| few(surface.knots_u()) || few(surface.knots_v()))
}

/// Plots in space of the objects with surfaces of which no basis is drawn. Objects that differ
/// only in their places share one plot.
fn in_space(scene: &Scene, surfaces: &[Instance]) -> Result<Vec<Plot>, Failure> {
    type Same<'a> = (Vec<&'a Shape>, Vec<String>, Vec<PlottedSurface>);
    let mut found: Vec<Same<'_>> = Vec::new();
    let mut of_objects = vec![Vec::new(); scene.objects.len()];
    for one in surfaces.iter().filter(|one| !has_basis(&one.surface)) {
        of_objects[one.part[0]].push(one);
    }
    for (object, own) in scene.objects.iter().zip(of_objects) {
        let Some(first) = own.first() else { continue };
        let name = object.name.as_ref().map_or(&first.name, |name| &name.value).clone();
        let shapes: Vec<&Shape> = object.parts.iter().map(|part| &part.shape).collect();
        if let Some((_, users, _)) = found.iter_mut().find(|(other, ..)| *other == shapes) {
            users.push(name);
            continue;
        }
        let own = own.into_iter().map(|instance| plotted(scene, instance));
        found.push((shapes, vec![name], own.collect::<Result<_, _>>()?));
    }
    let plot = |(_, users, of): Same<'_>| {
        let large = of.iter().any(|one| match &one.surface {
            Surface::Limit(surface) => surface.unit_count() > MOST_FACES,
            _ => false,
        });
        let dense = of.iter().any(|one| one.surface.nurbs().is_some());
        let lines = if large { 0 } else { PlottedSurface::LINES };
        let title = Some(format!("{} in space", joint(&users)));
        Plot { title, plane: None, show: PlotKind::Surfaces { of, lines, net: !large && !dense } }
    };
    Ok(found.into_iter().map(plot).collect())
}

/// A surface of a scene, with its loops as written.
fn plotted(scene: &Scene, instance: &Instance) -> Result<PlottedSurface, Failure> {
    let [object, part] = instance.part;
    let object = &scene.objects[object];
    let surface = instance.surface.clone();
    PlottedSurface::of(&instance.name, surface, &object.parts[part], object).or_bad_input()
}

/// Adds a user of a thing that others may use, too.
fn gather<T: PartialEq>(known: &mut Vec<(T, Vec<String>)>, thing: T, user: String) {
    match known.iter_mut().find(|(other, _)| *other == thing) {
        Some((_, users)) => users.push(user),
        None => known.push((thing, vec![user])),
    }
}

/// What to call a thing with these users.
fn joint(users: &[String]) -> String {
    match users {
        [] => String::new(),
        [only] => only.clone(),
        [first, others @ ..] => format!("{first} and {} more", others.len()),
    }
}

/// The curves an object's surfaces are made from, with what to call them.
fn curves(object: &Object) -> Vec<(String, &CurveSpec)> {
    let name = object.name.as_ref().map_or(object.default_name.as_str(), |name| &name.value);
    let built = object.parts.iter().filter_map(|part| match &part.shape {
        Shape::Built(construction, _) => Some(construction),
        _ => None,
    });
    built
        .flat_map(|construction| construction.curves())
        .map(|(role, curve)| (format!("{name}: {role}"), curve))
        .collect()
}
