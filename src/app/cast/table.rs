//! One row of HITS.npy.

use nurbray::intersect::{Answer, Hit, HitFlags};

/// The columns of a first hit: `t, surface, u, v, x, y, z, nx, ny, nz, flags`.
pub(super) const COLUMNS: usize = 11;

/// The columns of `--all`: the ray's number before those.
pub(super) const ALL_COLUMNS: usize = COLUMNS + 1;

/// The row of a ray's first hit, or of its miss.
pub(super) fn first_row(answer: &Answer) -> [f64; COLUMNS] {
    match &answer.hit {
        Some(hit) => row(hit, hit.flags), // flagged if the answer is doubtful
        None if answer.doubtful => no_hit(HitFlags::DOUBTFUL),
        None => no_hit(HitFlags::NONE),
    }
}

/// The rows of all hits of ray `index`. A doubt that belongs to no hit is flagged in every row,
/// or has a row of its own if there is none.
pub(super) fn all_rows(
    index: usize,
    hits: &[Hit],
    doubtful: bool,
) -> impl Iterator<Item = [f64; ALL_COLUMNS]> {
    let own = hits.iter().any(|hit| hit.flags.contains(HitFlags::DOUBTFUL));
    let doubt = if doubtful && !own { HitFlags::DOUBTFUL } else { HitFlags::NONE };
    let alone = (hits.is_empty() && !doubt.is_empty()).then(|| no_hit(doubt));
    let rows = hits.iter().map(move |hit| row(hit, hit.flags.with(doubt)));
    rows.chain(alone).map(move |row| {
        let mut numbered = [index as f64; ALL_COLUMNS];
        numbered[1..].copy_from_slice(&row);
        numbered
    })
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
