//! What is known about a scene or model, as JSON.

use std::time::Duration;

use nurbray::geometry::trim::Kept;
use nurbray::math::Aabb;
use nurbray::scene::ImportNote;
use serde_json::{Value, json};

use super::facts::{Facts, SurfaceFacts};
use super::gaps::{Fit, FreeBorder, Gap};
use super::turns::Turned;

/// All that is known, with the time it took to build the hierarchy.
pub(super) fn json(
    input: &str,
    build: Duration,
    facts: &Facts,
    fit: &Fit,
    notes: &[ImportNote],
) -> Value {
    json!({
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
            "free": fit.free.len(),
        },
        "turns": {
            "judged": fit.turns.judged,
            "opposite": fit.turns.opposite.iter().map(turned_json).collect::<Value>(),
        },
        "free_borders": fit.free.iter().map(free_json).collect::<Value>(),
        "gaps": fit.gaps.iter().map(|gap| gap_json(gap, facts.size())).collect::<Value>(),
        "not_imported": notes.iter().map(note_json).collect::<Value>(),
    })
}

fn note_json(note: &ImportNote) -> Value {
    let position = note.place.position();
    json!({
        "file": note.place.label(),
        "line": position.map(|at| at.0),
        "column": position.map(|at| at.1),
        "what": note.what,
        "why": note.why,
    })
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
        "domain": surface.domain,
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

fn free_json(border: &FreeBorder) -> Value {
    json!({
        "surface": border.edge.surface,
        "edge": border.edge.which.to_string(),
        "length": border.length,
        "at": border.at.to_array(),
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
