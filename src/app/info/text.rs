//! The facts as tables for people.

use std::fmt::Write as _;

use glam::DVec3;
use nurbray::geometry::trim::Kept;
use nurbray::math::{Aabb, Measured};
use nurbray::scene::ImportNote;

use super::super::table::{count, long_point, short, short_bytes, short_point, table};
use super::edges::Edge;
use super::extent::tolerance;
use super::facts::{Facts, SurfaceFacts};
use super::gaps::{Fit, FreeBorder, Gap};
use super::nearness::{NEAR, NEAR_SMALLER};
use super::turns::{Turned, Turns};

/// More gaps, pairs, free borders or collapsed edges than this are counted, not listed: `--json` has
/// them all.
const LISTED: usize = 20;

/// Gaps in trim loops that are no wider come from numbers written with seven digits.
const SEVEN_DIGITS: f64 = 1e-6;

/// The whole report.
pub(super) fn text(input: &str, facts: &Facts, fit: &Fit, notes: &[ImportNote]) -> String {
    let mut text = format!(
        "{input}: {}, {}, {}, {}, {}\nbounds: {}\n\n",
        count(facts.surfaces.len() as u64, "surface"),
        count(facts.control_points() as u64, "control point"),
        count(facts.pieces() as u64, "piece"),
        count(facts.leaves() as u64, "leaf"),
        short_bytes(facts.bytes),
        bounds(facts.bounds),
    );
    text += &surfaces(&facts.surfaces);
    text += &trimmed(&facts.surfaces);
    text += &subdivision(&facts.surfaces);
    text += &collapsed(&facts.surfaces);
    text += &approximated(&facts.surfaces);
    text += &borders(fit, facts);
    text += &not_imported(notes);
    text
}

fn surfaces(surfaces: &[SurfaceFacts]) -> String {
    let heading = [
        "#", "name", "degree", "rational", "size", "pieces", "leaves", "bytes", "u", "v", "bounds",
    ];
    let mut rows = vec![heading.map(str::to_owned).to_vec()];
    rows.extend(surfaces.iter().map(|surface| {
        let [u, v] = surface.domain.map(|[start, end]| format!("{}..{}", short(start), short(end)));
        vec![
            surface.index.to_string(),
            surface.name.clone(),
            format!("{}x{}", surface.degree[0], surface.degree[1]),
            if surface.rational { "yes" } else { "no" }.to_owned(),
            surface.size.map_or(surface.points.to_string(), |[u, v]| format!("{u}x{v}")),
            surface.pieces.to_string(),
            surface.leaves.to_string(),
            short_bytes(surface.bytes),
            u,
            v,
            bounds(surface.bounds),
        ]
    }));
    table(&rows, &[1, 3, 8, 9, 10])
}

/// The surfaces of which a part is cut off, if there are any.
fn trimmed(surfaces: &[SurfaceFacts]) -> String {
    let rows: Vec<Vec<String>> = surfaces
        .iter()
        .filter_map(|surface| {
            let trims = surface.trims?;
            let kept = match trims.kept {
                Kept::Odd => "inside",
                Kept::Even => "outside",
            };
            let mut notes = Vec::new();
            if trims.outside > 0 {
                let loops = count(trims.outside as u64, "loop");
                notes.push(format!("{loops} outside the domain only"));
            }
            if trims.widest_gap > SEVEN_DIGITS {
                notes.push(format!("gaps up to {} of a loop closed", Measured(trims.widest_gap)));
            }
            Some(vec![
                format!("  {} {}", surface.index, surface.name),
                format!("kept {kept} {}", count(trims.loops as u64, "loop")),
                format!("of {}", count(trims.segments as u64, "monotone segment")),
                short_bytes(trims.bytes),
                format!("{} of {} leaves at an edge", trims.mixed, surface.leaves),
                notes.join("; "),
            ])
        })
        .collect();
    match rows.len() {
        0 => String::new(),
        number => {
            let heading = count(number as u64, "trimmed surface");
            format!("\n{heading}:\n") + &table(&rows, &[0, 1, 2, 4, 5])
        }
    }
}

/// The limit surfaces of cages, if there are any.
fn subdivision(surfaces: &[SurfaceFacts]) -> String {
    let row = |surface: &SurfaceFacts| {
        let [all, exact] = surface.patches?;
        let name = format!("  {} {}", surface.index, surface.name);
        Some(vec![name, count(all as u64, "patch"), format!("{exact} of them exact")])
    };
    let rows: Vec<Vec<String>> = surfaces.iter().filter_map(row).collect();
    match rows.len() {
        0 => String::new(),
        number => {
            let heading = count(number as u64, "subdivision surface");
            format!("\n{heading}:\n") + &table(&rows, &[0, 1, 2])
        }
    }
}

fn collapsed(surfaces: &[SurfaceFacts]) -> String {
    let edges = surfaces.iter().flat_map(|surface| {
        surface.collapsed.iter().map(move |(border, point)| {
            let name = format!("{} {}", surface.index, surface.name);
            vec![format!("  {name}"), border.to_string(), format!("at {}", short_point(*point))]
        })
    });
    let rows: Vec<Vec<String>> = edges.collect();
    match rows.len() {
        0 => "\nno collapsed edges\n".into(),
        number => {
            format!("\n{} (poles):\n", count(number as u64, "collapsed edge"))
                + &table(&rows[..number.min(LISTED)], &[0, 1, 2])
                + &more(number)
        }
    }
}

/// The surfaces that are not exactly what the scene asks for, if there are any.
fn approximated(surfaces: &[SurfaceFacts]) -> String {
    let off = surfaces.iter().filter(|surface| surface.deviation > 0.0);
    let row = |surface: &SurfaceFacts| {
        let name = format!("  {} {}", surface.index, surface.name);
        vec![name, format!("off by up to {:.2e}", surface.deviation)]
    };
    let rows: Vec<Vec<String>> = off.map(row).collect();
    match rows.len() {
        0 => String::new(),
        number => {
            let surfaces = count(number as u64, "approximated surface");
            format!("\n{surfaces}, in units of the scene, measured or proved when made:\n")
                + &table(&rows, &[0, 1])
        }
    }
}

fn borders(fit: &Fit, facts: &Facts) -> String {
    let mut text = format!(
        "\n{}{}: {} collapsed, {} meeting another to within rounding, {} nearly meeting, {} free\n",
        count(fit.borders as u64, "border"),
        match fit.trim_edges {
            0 => String::new(),
            1 => ", 1 of them a trim edge".into(),
            edges => format!(", {edges} of them trim edges"),
        },
        fit.collapsed,
        fit.meeting,
        fit.nearly,
        fit.free.len()
    );
    text += &turned(fit, facts);
    text += &gaps(fit, facts);
    text + &free(fit, facts)
}

/// The free borders of a model that has others, too: where it is open.
fn free(fit: &Fit, facts: &Facts) -> String {
    if fit.free.is_empty() || fit.meeting + fit.nearly == 0 {
        return String::new();
    }
    let mut text = format!("{}, longest first:\n", count(fit.free.len() as u64, "free border"));
    let row = |border: &FreeBorder| {
        vec![
            format!("  {}", edge(&border.edge, facts)),
            format!("{} long", short(border.length)),
            format!("at {}", short_point(border.at)),
        ]
    };
    let rows: Vec<Vec<String>> = fit.free.iter().take(LISTED).map(row).collect();
    text += &table(&rows, &[0, 1, 2]);
    text + &more(fit.free.len())
}

/// The pairs of borders that meet, or nearly, with surfaces turned opposite ways.
fn turned(fit: &Fit, facts: &Facts) -> String {
    let Turns { judged, opposite } = &fit.turns;
    if *judged == 0 {
        return String::new();
    }
    let judged = count(*judged as u64, "pair");
    if opposite.is_empty() {
        return format!(
            "{judged} of borders that meet, or nearly, with surfaces turned alike, none opposite ways\n"
        );
    }
    let mut text = format!(
        "{} of {judged} of borders that meet, or nearly, with surfaces turned opposite ways:\n",
        opposite.len()
    );
    let row = |pair: &Turned| {
        let [a, b] = pair.edges;
        let with_itself = if a.surface == b.surface { "  (of one surface)" } else { "" };
        vec![
            format!("  {}", edge(&a, facts)),
            format!("| {}", edge(&b, facts)),
            format!("at {}{with_itself}", short_point(pair.at)),
        ]
    };
    let rows: Vec<Vec<String>> = opposite.iter().take(LISTED).map(row).collect();
    text += &table(&rows, &[0, 1, 2]);
    text += &more(opposite.len());
    text + "  there, `cast --all` may miscount; `reverse = true` turns all surfaces of an object\n"
}

fn gaps(fit: &Fit, facts: &Facts) -> String {
    if fit.gaps.is_empty() {
        return format!(
            "no gaps up to {NEAR:e} of the size of the objects (between two, of the larger \
             one's, and {NEAR_SMALLER:e} of the smaller one's)\n"
        );
    }
    let mut text = format!("{}, widest first:\n", count(fit.gaps.len() as u64, "gap"));
    let row = |gap: &Gap| {
        let relative = gap.width / facts.size();
        vec![
            format!("  {}", edge(&gap.edges[0], facts)),
            format!("| {}", edge(&gap.edges[1], facts)),
            format!("{:.2e} ({relative:.1e} of the size)", gap.width),
            format!("at {}", short_point(gap.at)),
        ]
    };
    let rows: Vec<Vec<String>> = fit.gaps.iter().take(LISTED).map(row).collect();
    text += &table(&rows, &[0, 1, 2, 3]);
    text + &more(fit.gaps.len())
}

/// Names a border and its surface.
fn edge(edge: &Edge, facts: &Facts) -> String {
    format!("{} {}, {}", edge.surface, facts.surfaces[edge.surface].name, edge.which)
}

/// Says how many of a list are not shown, if any.
fn more(all: usize) -> String {
    match all.checked_sub(LISTED) {
        None | Some(0) => String::new(),
        Some(more) => format!("  and {more} more (--json lists all)\n"),
    }
}

fn not_imported(notes: &[ImportNote]) -> String {
    if notes.is_empty() {
        return "\neverything in the file was imported\n".into();
    }
    let mut text = format!("\n{} not imported:\n", count(notes.len() as u64, "thing"));
    for note in notes {
        let _ = writeln!(text, "  {note}");
    }
    text
}

/// Formats a box. Coordinates within the error bound of its sides are shown as 0.
fn bounds(bounds: Aabb) -> String {
    let padding = tolerance(bounds);
    let shown = |corner: DVec3| {
        long_point(DVec3::select(corner.abs().cmple(DVec3::splat(padding)), DVec3::ZERO, corner))
    };
    format!("{} to {}", shown(bounds.min), shown(bounds.max))
}
