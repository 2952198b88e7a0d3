//! Lines of constant parameter against the patches they run through.

use super::*;
use crate::geometry::{Direction, NurbsCurve};

#[test]
fn lines_run_where_there_are_patches_and_nowhere_else() {
    let mut gaps = 0;
    for (name, parts) in zoo() {
        let cage = cage(&parts);
        let made = [cage.catmull_clark(1e-2), cage.doo_sabin(1e-2)];
        for limit in made.into_iter().flatten() {
            let probe = Probe::new(limit);
            for unit in 0..probe.limit.unit_count() {
                for (direction, at) in Direction::BOTH
                    .into_iter()
                    .flat_map(|direction| [0.0, 0.3, 0.5, 0.9, 1.0].map(|at| (direction, at)))
                {
                    let curves = probe.limit.unit_curves(unit, direction, at);
                    for k in 0..=20 {
                        let along = f64::from(k) / 20.0;
                        let (place, t) = match direction {
                            Direction::U => ([at, along], along),
                            Direction::V => ([along, at], unit as f64 + along),
                        };
                        let on = |curve: &&NurbsCurve| {
                            (curve.domain()[0]..=curve.domain()[1]).contains(&t)
                        };
                        let ours = curves.iter().find(on).map(|curve| curve.point_at(t));
                        let theirs = probe.point(unit, place).map(|(point, _)| point);
                        let context = format!("{name}, {unit}, {direction} = {at}, {along}");
                        gaps += usize::from(theirs.is_none());
                        match (ours, theirs) {
                            (Some(ours), Some(theirs)) => {
                                // Adjacent patches agree within the tolerance.
                                assert!(
                                    ours.distance(theirs) <= 1e-2,
                                    "{context}: {ours} {theirs}"
                                );
                                let within = at != 0.5 && k % 5 != 0;
                                let exact = !within || ours.distance(theirs) < 1e-13;
                                assert!(exact, "{context}: {ours} {theirs}");
                            }
                            (None, None) => {}
                            other => panic!("{context}: {other:?}"),
                        }
                    }
                }
            }
        }
    }
    assert!(gaps > 100, "open cages leave out parts of their faces: {gaps}");
}
