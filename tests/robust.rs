//! Rays that are hard to answer: no unflagged miss, no wrong root, no false hit.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "tests, and the functions they share"
)]

#[path = "robust/inside.rs"]
mod inside;
#[path = "robust/judge.rs"]
mod judge;
#[path = "robust/leaving.rs"]
mod leaving;
#[path = "common/model.rs"]
mod model;
#[path = "robust/models.rs"]
mod models;
#[path = "robust/near.rs"]
mod near;
#[path = "common/random.rs"]
mod random;
#[path = "robust/ranges.rs"]
mod ranges;
#[path = "common/rays.rs"]
mod rays;
#[path = "robust/same.rs"]
mod same;
#[path = "robust/survey.rs"]
mod survey;
#[path = "robust/traps.rs"]
mod traps;

use rays::Class;

#[test]
fn scratch() {
    let count: u64 = std::env::var("N").map_or(500, |n| n.parse().unwrap());
    let only = std::env::var("M").unwrap_or_default();
    let mut models = vec![
        models::sphere(),
        models::sphere_biquadratic(),
        models::torus(),
        models::cylinder(),
        models::cone(),
        models::disk(),
        models::plane(),
        models::wavy_sheet(),
        models::saddle(),
        models::twisted(),
        models::periodic_tube(),
        models::bezier([5, 5], true, 1),
        models::bezier([12, 11], true, 2),
        models::bezier([24, 3], true, 3),
        models::teapot(),
    ];
    models.extend(models::lecture());
    models.extend((0..6).map(models::random_rational));
    for model in models.iter().filter(|m| m.name.contains(&only)) {
        println!("{}", model.name);
        let mut sum = survey::Tally::default();
        for class in Class::all() {
            let tally = survey::survey(model, class, count, 1);
            tally.print(&format!("  {class}"));
            sum.add(survey::Tally { faults: vec![], ..tally });
        }
        sum.print(&model.name);
    }
}
