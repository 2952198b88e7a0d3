//! `nurbray info`: what a scene or model holds, how its borders fit and its surfaces are turned,
//! what is not shown.

mod around;
mod border_curve;
mod chain;
mod edges;
mod extent;
mod facts;
mod gaps;
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

use nurbray::geometry::trim::Kept;
use serde_json::{Value, json};

use nurbray::math::Aabb;
use nurbray::scene::{Instance, Shape, World};

use super::args::InfoArguments;
use super::failure::Failure;
use super::{console, input};
use facts::{Facts, SurfaceFacts};
use gaps::Gap;
use turns::Turned;

/// Runs the subcommand.
pub(crate) fn run(arguments: &InfoArguments) -> Result<ExitCode, Failure> {
    let scene = input::read(&arguments.input)?;
    let (world, build) = input::prepare(&scene, false)?;
    let facts = Facts::new(&world);
    let surfaces: Vec<_> =
        world.surfaces().iter().map(|instance| instance.surface.clone()).collect();
    let drawing = |instance: &Instance| {
        let [object, part] = instance.part;
        match &scene.objects[object].parts[part].shape {
            Shape::Built(construction, _) => construction.is_drawing().then_some(instance.part),
            _ => None,
        }
    };
    let drawings: Vec<_> = world.surfaces().iter().map(drawing).collect();
    let fit = gaps::fit(&surfaces, &drawings, &object_sizes(&world, &facts));
    let input = arguments.input.display().to_string();
    if arguments.json {
        let not_imported = scene.notes.iter().map(|note| {
            let position = note.place.position();
            json!({
                "file": note.place.label(),
                "line": position.map(|at| at.0),
                "column": position.map(|at| at.1),
                "what": note.what,
                "why": note.why,
            })
        });
        console::print_json(&json!({
            "input": input,
            "build_seconds": build.as_secs_f64(),
            "surfaces": facts.surfaces.iter().map(surface_json).collect::<Value>(),
            "total": {
                "surfaces": facts.surfaces.len(),
                "control_points": facts.control_points(),
                "pieces": facts.pieces(),
                "leaves": facts.leaves(),
                "bytes": facts.bytes,
                "bounds": bounds_json(facts.bounds),
            },
            "borders": {
                "total": fit.borders,
                "trim_edges": fit.trim_edges,
                "collapsed": fit.collapsed,
                "meeting": fit.meeting,
                "nearly_meeting": fit.nearly,
                "free": fit.free,
            },
            "edges_left_out": fit.left_out.iter().map(|(surface, error)| {
                json!({ "surface": surface, "why": error.to_string() })
            }).collect::<Value>(),
            "turns": {
                "judged": fit.turns.judged,
                "opposite": fit.turns.opposite.iter().map(turned_json).collect::<Value>(),
            },
            "gaps": fit.gaps.iter().map(|gap| gap_json(gap, facts.size())).collect::<Value>(),
            "not_imported": not_imported.collect::<Value>(),
        }))?;
    } else {
        console::print(&text::text(&input, &facts, &fit, &scene.notes))?;
    }
    Ok(ExitCode::SUCCESS)
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

fn surface_json(surface: &SurfaceFacts) -> Value {
    let collapsed = surface
        .collapsed
        .iter()
        .map(|(border, point)| json!({ "edge": border.to_string(), "point": point.to_array() }));
    json!({
        "index": surface.index,
        "name": surface.name,
        "material": surface.material,
        "degree": surface.degree,
        "rational": surface.rational,
        "size": surface.size,
        "domain": surface.domain.map(|(start, end)| [start, end]),
        "pieces": surface.pieces,
        "leaves": surface.leaves,
        "bytes": surface.bytes,
        "bounds": bounds_json(surface.bounds),
        "collapsed_edges": collapsed.collect::<Value>(),
        "deviation": surface.deviation,
        "patches": surface.patches.map(|[all, exact]| json!({ "all": all, "exact": exact })),
        "trims": surface.trims.map(|trims| json!({
            "keep": match trims.kept {
                Kept::Odd => "inside",
                Kept::Even => "outside",
            },
            "loops": trims.loops,
            "loops_outside": trims.outside,
            "segments": trims.segments,
            "widest_gap": trims.widest_gap,
            "bytes": trims.bytes,
            "mixed_leaves": trims.mixed,
        })),
    })
}

fn bounds_json(bounds: Aabb) -> Value {
    json!([bounds.min.to_array(), bounds.max.to_array()])
}

fn turned_json(pair: &Turned) -> Value {
    json!({
        "surfaces": pair.edges.map(|edge| edge.surface),
        "edges": pair.edges.map(|edge| edge.which.to_string()),
        "at": pair.at.to_array(),
    })
}

fn gap_json(gap: &Gap, size: f64) -> Value {
    json!({
        "surfaces": gap.edges.map(|edge| edge.surface),
        "edges": gap.edges.map(|edge| edge.which.to_string()),
        "width": gap.width,
        "relative": gap.width / size,
        "at": gap.at.to_array(),
    })
}
