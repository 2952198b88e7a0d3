//! The same rays of every class, for us and for each library.

use nurbray::math::Ray;

use crate::compare::{Tally, compare};
use crate::model::Model;
use crate::models;
use crate::program::{Library, OPENCASCADE, SISL};
use crate::random::Random;
use crate::rays::{Class, Rays};

/// The number of rays of each class for each model; `NURBRAY_INDEPENDENT_RAYS` asks for more.
const RAYS: usize = 40;

/// The classes that both libraries can be asked about: not rays that begin on a surface or far
/// away, where the libraries' tolerances of 1e-7 are lengths somebody chose.
const CLASSES: [Class; 14] = [
    Class::Random,
    Class::Aimed,
    Class::Lines,
    Class::Corners,
    Class::Borders,
    Class::SeamPlanes,
    Class::Axes,
    Class::Entering(1),
    Class::Entering(3),
    Class::Entering(6),
    Class::Entering(9),
    Class::Passing(3),
    Class::Passing(6),
    Class::Tangents,
];

fn all_models() -> Vec<Model> {
    let mut all = vec![
        models::sphere(),
        models::sphere_biquadratic(),
        models::torus(),
        models::cone(),
        models::wavy_sheet(),
        models::bezier([5, 5], true, 1),
        models::teapot(),
    ];
    all.extend(models::lecture());
    all
}

fn count() -> usize {
    let asked = std::env::var("NURBRAY_INDEPENDENT_RAYS");
    asked.map_or(RAYS, |count| count.parse().expect("NURBRAY_INDEPENDENT_RAYS is a number"))
}

/// Asks a library about all models and classes. `least` is the smallest share of our hits on random
/// and aimed rays that the library must find, too: else the comparison itself is wrong.
fn check(library: &'static Library, least: f64) {
    let Some(program) = library.program() else { return };
    for model in all_models() {
        let bvh = model.bvh();
        let rays = Rays::new(&model);
        println!("{} on {}", library.name, model.name);
        for (class, seed) in CLASSES.into_iter().zip(1..) {
            let mut random = Random::new(seed);
            // The teapot's surfaces are asked one by one.
            let count = count().div_ceil(if model.surfaces.len() > 1 { 4 } else { 1 });
            let rays: Vec<Ray> = (0..count).map(|_| rays.shot(class, &mut random).ray).collect();
            let tally = compare(&model, &bvh, &rays, &program.ask(&model, &rays));
            tally.print(&class.to_string());
            judge(&tally, class, &model, least);
        }
    }
}

fn judge(tally: &Tally, class: Class, model: &Model, least: f64) {
    let faults = tally.faults.join("\n");
    assert!(tally.faults.is_empty(), "{} {class}:\n{faults}", model.name);
    if matches!(class, Class::Random | Class::Aimed) && tally.ours > 20 {
        let share = tally.confirmed as f64 / tally.ours as f64;
        assert!(share >= least, "{} {class}: {share} of our hits are confirmed", model.name);
    }
}

#[test]
fn sisl() {
    check(&SISL, 0.95);
}

#[test]
fn opencascade() {
    check(&OPENCASCADE, 0.95);
}
