//! One row of HITS.npy.

use nurbray::intersect::{Answer, Hit, HitFlags};

/// The columns of a first hit: `t, surface, u, v, x, y, z, nx, ny, nz, flags`.
pub(super) const COLUMNS: usize = 11;

/// The columns of `--all`: the ray's number before those.
pub(super) const ALL_COLUMNS: usize = COLUMNS + 1;

/// The row of a ray's first hit, or of its miss.
pub(super) fn first_row(answer: &Answer) -> [f64; COLUMNS] {
    let doubt = if answer.doubtful { HitFlags::DOUBTFUL } else { HitFlags::NONE };
    match &answer.hit {
        Some(hit) => row(hit, hit.flags.with(doubt)),
        None => no_hit(doubt),
    }
}

/// The rows of all hits of ray `index`. A doubt that belongs to no hit is flagged in every row,
/// or has a row of its own if there is none.
pub(super) fn all_rows(
    index: usize,
    hits: &[Hit],
    doubtful: Doubt,
) -> impl Iterator<Item = [f64; ALL_COLUMNS]> {
    let own = hits.iter().any(|hit| hit.flags.contains(HitFlags::DOUBTFUL));
    let doubt = match doubtful {
        Doubt::Open if !own => HitFlags::DOUBTFUL,
        _ => HitFlags::NONE,
    };
    let alone = (hits.is_empty() && !doubt.is_empty()).then(|| no_hit(doubt));
    let rows = hits.iter().map(move |hit| row(hit, hit.flags.with(doubt)));
    rows.chain(alone).map(move |row| {
        let mut numbered = [index as f64; ALL_COLUMNS];
        numbered[1..].copy_from_slice(&row);
        numbered
    })
}

/// Whether a ray's answer leaves something open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Doubt {
    /// All hits were found, and none is false.
    None,
    /// Floating point could not decide.
    Open,
}

fn row(hit: &Hit, flags: HitFlags) -> [f64; COLUMNS] {
    let [u, v] = hit.uv.to_array();
    let [x, y, z] = hit.point.to_array();
    let [nx, ny, nz] = hit.normal.to_array();
    [hit.t, f64::from(hit.surface), u, v, x, y, z, nx, ny, nz, f64::from(flags.bits())]
}

fn no_hit(flags: HitFlags) -> [f64; COLUMNS] {
    let mut row = [f64::NAN; COLUMNS];
    row[COLUMNS - 1] = f64::from(flags.bits());
    row
}
