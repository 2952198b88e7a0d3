//! `nurbray info`: what a scene or model holds, how its borders fit and its surfaces are turned,
//! what is not shown.

mod around;
mod border_curve;
mod chain;
mod edges;
mod extent;
mod facts;
mod gaps;
mod json;
mod nearest;
mod nearness;
mod neighbours;
mod side;
mod source;
mod text;
mod turns;
#[cfg(test)]
mod turns_tests;
mod which;

use std::process::ExitCode;

use nurbray::math::Aabb;
use nurbray::scene::{Instance, Scene, Shape, World};

use super::args::InfoArguments;
use super::failure::Failure;
use super::progress::patiently;
use super::{console, input};
use facts::Facts;

/// Runs the subcommand.
pub(crate) fn run(arguments: &InfoArguments) -> Result<ExitCode, Failure> {
    let scene = input::read(&arguments.input)?;
    let (world, build) = input::prepare(&scene, false)?;
    let facts = patiently("measuring the surfaces ...", || Facts::new(&world));
    let surfaces: Vec<_> =
        world.surfaces().iter().map(|instance| instance.surface.clone()).collect();
    let drawings: Vec<_> =
        world.surfaces().iter().map(|instance| drawing(&scene, instance)).collect();
    let sizes = object_sizes(&world, &facts);
    let compare = || gaps::fit(&surfaces, &drawings, &sizes);
    let fit = patiently("comparing borders with each other ...", compare);
    let input = arguments.input.display().to_string();
    if arguments.json {
        console::print_json(&json::json(&input, build, &facts, &fit, &scene.notes))?;
    } else {
        console::print(&text::text(&input, &facts, &fit, &scene.notes))?;
    }
    Ok(ExitCode::SUCCESS)
}

/// The object and the part of it that a surface belongs to, if that is a drawing of others.
fn drawing(scene: &Scene, instance: &Instance) -> Option<[usize; 2]> {
    let [object, part] = instance.part;
    match &scene.objects[object].parts[part].shape {
        Shape::Built(construction, _) => construction.is_drawing().then_some(instance.part),
        _ => None,
    }
}

/// Returns for each surface the diagonal of the box around the object that it belongs to.
fn object_sizes(world: &World, facts: &Facts) -> Vec<f64> {
    let object = |instance: &Instance| instance.part[0];
    let count = world.surfaces().last().map_or(0, |last| object(last) + 1);
    let mut boxes = vec![Aabb::EMPTY; count];
    for (instance, surface) in world.surfaces().iter().zip(&facts.surfaces) {
        let around = &mut boxes[object(instance)];
        *around = around.union(surface.bounds);
    }
    world.surfaces().iter().map(|instance| boxes[object(instance)].size().length()).collect()
}
