#[path = "common/model.rs"]
mod model;
#[path = "robust/models.rs"]
mod models;
#[path = "common/random.rs"]
mod random;
#[test]
fn a() {
    for m in (0..12).map(models::random_rational).chain([
        models::bezier([3, 3], true, 1),
        models::bezier([2, 2], true, 1),
        models::bezier([5, 5], true, 1),
        models::bezier([12, 11], true, 1),
        models::teapot(),
        models::sphere(),
        models::torus(),
        models::wavy_sheet(),
    ]) {
        let t = std::time::Instant::now();
        let b = m.bvh();
        println!(
            "{} pieces {} leaves {} {:?}",
            m.name,
            b.patch_count(0),
            b.leaf_count(0),
            t.elapsed()
        );
    }
}
