//! Plots for scenes that ask for none: the curves surfaces are made from, and the basis functions
//! over surfaces' knots.

use nurbray::geometry::{KnotVector, RationalBasis};
use nurbray::scene::{
    CurveEntry, CurveSpec, Object, Plot, PlotKind, PlottedCurve, Scene, Shape, World,
};

use super::super::failure::{Failure, OrFail};

/// The plots that suit a scene, curves first.
///
/// # Errors
/// When the scene cannot be built as its author wrote it.
pub(super) fn plots(scene: &Scene) -> Result<Vec<Plot>, Failure> {
    // Whatever is wrong with the scene is told in the words of every other subcommand.
    let world = World::new(scene).or_bad_input()?;
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
    let mut bases: Vec<(KnotVector, Vec<String>)> = Vec::new();
    for instance in &world.surfaces {
        let Some(surface) = instance.surface.nurbs() else { continue };
        for (knots, direction) in [(surface.knots_u(), "u"), (surface.knots_v(), "v")] {
            gather(&mut bases, knots.clone(), format!("{}, {direction}", instance.name));
        }
    }
    for (knots, users) in bases {
        let title = format!("Degree {}: {}", knots.degree(), joint(&users));
        let weights = vec![1.0; knots.point_count()];
        let basis = RationalBasis::new(knots, weights).or_bad_input()?;
        let show = PlotKind::Basis { basis, support: false };
        plots.push(Plot { title: Some(title), plane: None, show });
    }
    Ok(plots)
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
        Shape::Built(construction) => Some(construction),
        _ => None,
    });
    built
        .flat_map(|construction| construction.curves())
        .map(|(role, curve)| (format!("{name}: {role}"), curve))
        .collect()
}
