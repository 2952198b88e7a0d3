//! A million hard rays: the fast path (one by one, in packets and in batches) against the exact
//! solver, against points the rays were aimed at, and against the parity of closed models.

use glam::DVec3;

use crate::model::Model;
use crate::models;
use crate::rays::Class;
use crate::survey::{Plan, Survey, Tally};

/// How many rays a class gets. Rays along a surface cost a hundred times as much as others.
fn plan(class: Class, share: u64) -> Plan {
    let (rays, thorough) = match class {
        Class::Tangents | Class::Rulings | Class::SeamPlanes | Class::Axes => (250, 5),
        Class::Entering(k) | Class::Passing(k) if k > 5 => (250, 5),
        Class::Entering(_) | Class::Passing(_) | Class::Origins => (750, 10),
        _ => (6000, 30),
    };
    Plan { rays: rays * share / 100, thorough }
}

/// The largest share of doubtful first hits, on surfaces that are curved in all directions.
///
/// Steep rays are decided, except those that happen to graze a silhouette. A ray in a tangent
/// plane cannot be decided, nor can one that begins on a surface; rays in planes of symmetry
/// and along axes graze by design. From 1e6 sizes away, rounding grows to 1e-9.
fn most_doubtful(class: Class) -> f64 {
    match class {
        Class::Origins => 1.0,
        Class::Tangents => 0.9,
        Class::Axes | Class::Rulings | Class::SeamPlanes => 0.12,
        Class::Entering(k) | Class::Passing(k) if k >= 9 => 0.01,
        Class::Entering(_) | Class::Passing(_) => 0.003,
        Class::Far => 0.005,
        _ => 0.0003,
    }
}

/// Surfaces that no straight line runs along.
fn curved() -> Vec<(Model, u64)> {
    let mut all = vec![
        (models::sphere(), 100),
        (models::sphere_biquadratic(), 100),
        (models::torus(), 100),
        (models::wavy_sheet(), 100),
        (models::periodic_tube(), 100),
        (models::teapot(), 100),
        (models::bezier([5, 5], true, 1), 50),
        (models::bezier([12, 11], true, 2), 10),
        (models::bezier([24, 3], true, 3), 10),
    ];
    all.push((models::octants(), 50));
    all.extend(models::limits().into_iter().map(|model| (model, 25)));
    all.extend(models::lecture().into_iter().map(|model| (model, 50)));
    all.push((models::trimmed(models::torus()), 50));
    all.push((models::trimmed(models::sphere_biquadratic()), 50));
    all.push((models::trimmed(models::wavy_sheet()), 50));
    all.push((models::trimmed(models::random_rational(5)), 50));
    all.extend((0..12).map(|seed| (models::random_rational(seed), 50)));
    all
}

/// Surfaces with planes or rulings in them: rays inside them are rightly doubtful.
fn ruled() -> Vec<(Model, u64)> {
    let all = [
        models::cylinder(),
        models::cone(),
        models::disk(),
        models::plane(),
        models::saddle(),
        models::twisted(),
        models::trimmed(models::plane()),
        models::trimmed(models::cylinder()),
    ];
    all.map(|model| (model, 50)).into()
}

/// Models that are very small, very large, or far from the origin for their size.
fn placed() -> Vec<(Model, u64)> {
    let some =
        || [models::sphere(), models::torus(), models::wavy_sheet(), models::random_rational(3)];
    let shift = DVec3::new(1e6, -1e6, 1e6);
    let mut all: Vec<_> = some().map(|model| (model.placed(1e-8, DVec3::ZERO), 25)).into();
    all.extend(some().map(|model| (model.placed(1e8, DVec3::ZERO), 25)));
    all.extend(some().map(|model| (model.placed(1.0, shift), 25)));
    all
}

fn ask(models: &[(Model, u64)], seed: u64) -> Vec<(Class, Tally)> {
    let surveys: Vec<_> = models.iter().map(|(model, share)| (Survey::new(model), share)).collect();
    let mut tallies = Vec::new();
    for class in Class::all() {
        let mut sum = Tally::default();
        for (k, (survey, share)) in surveys.iter().enumerate() {
            sum.add(survey.class(class, plan(class, **share), seed + ((k as u64) << 16)));
        }
        sum.print(&class.to_string());
        tallies.push((class, sum));
    }
    tallies
}

fn without_faults(tallies: &[(Class, Tally)]) {
    let faults: Vec<&str> =
        tallies.iter().flat_map(|(_, tally)| &tally.faults).map(String::as_str).collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn hard_rays_on_curved_surfaces() {
    let tallies = ask(&curved(), 71);
    without_faults(&tallies);
    for (class, tally) in tallies {
        let share = tally.doubt();
        assert!(share <= most_doubtful(class), "{class}: {share} of first hits are doubtful");
    }
}

#[test]
fn hard_rays_on_ruled_surfaces() {
    let tallies = ask(&ruled(), 72);
    without_faults(&tallies);
    for (class, tally) in tallies {
        // All rays at a plane lie along it, except those that are aimed at it from outside.
        let decided = [Class::Aimed, Class::Lengths, Class::Lines, Class::Corners, Class::Borders];
        if decided.contains(&class) {
            assert!(tally.doubt() <= 0.0005, "{class}: {} doubtful", tally.doubt());
        }
    }
}

#[test]
fn hard_rays_on_small_large_and_distant_surfaces() {
    let tallies = ask(&placed(), 73);
    without_faults(&tallies);
    for (class, tally) in tallies {
        // A third of the models stand at a million times their size, where rounding is 1e-9.
        let steep = [Class::Random, Class::Aimed, Class::Lengths, Class::Far];
        if steep.contains(&class) {
            assert!(tally.doubt() <= 0.002, "{class}: {} doubtful", tally.doubt());
        }
    }
}

#[test]
fn there_are_a_million_rays() {
    let shares = [curved(), ruled(), placed()].into_iter().flatten().map(|(_, share)| share);
    let classes = Class::all();
    let rays = |share| classes.iter().map(|&class| plan(class, share).rays).sum::<u64>();
    let count: u64 = shares.map(rays).sum();
    assert!(count >= 1_000_000, "{count} rays");
}
