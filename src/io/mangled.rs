//! Readers given damaged text: they may refuse it, they must not panic.

use super::{Model, read_geomdl, read_scene};
use crate::math::SplitMix;
use crate::scene::{Object, Scene, World};

const SCENE: &str = r##"
camera = { look_from = [3, -4, 2], look_at = [0, 0, 0], perspective = { fov = 30 } }
render = { size = [64, 48], spp = 4, integrator = "uv", seed = 7, exposure = 0.5 }
light = [{ point = { position = [1, 2, 3], intensity = "#ff8800" } }]
material = [{ name = "m", lines = { count = [4, 8], width = 0.1, color = 0, base = 1 } }]
[[object]]
name = "lid"
material = "m"
transform = [{ scale = 2 }, { rotate = { axis = "z", degrees = 90 } }, { translate = [1, 0, 0] }]
[object.shape.nurbs]
degree = [2, 1]
knots_u = [0, 0, 0, 1, 1, 1]
knots_v = [[0, 2], [1, 2]]
points = [[[0, 0, 0], [0, 1, 0]], [[1, 0, 1], [1, 1, 1]], [[2, 0, 0], [2, 1, 0]]]
weights = [[1, 1], [0.7, 0.7], [1, 1]]
"##;

const MODEL: &str = r#"{"shape": {"type": "surface", "data": [{"name": "lid",
"degree_u": 2, "degree_v": 1, "size_u": 3, "size_v": 2,
"knotvector_u": [0, 0, 0, 1, 1, 1], "knotvector_v": [0, 0, 1, 1],
"control_points": {"points": [[0, 0, 0], [0, 1, 0], [1, 0, 1], [1, 1, 1], [2, 0, 0], [2, 1, 0]],
"weights": [1, 1, 0.7, 0.7, 1, 1]}, "trims": {"count": 1, "data": [{}]}, "reversed": true}]}}"#;

/// Pieces that do harm in the right place.
const PIECES: [&str; 16] = [
    "-", "0", "1e308", "nan", "-inf", "[", "]", "{", "}", "\"", ",", "=", "ß", "\u{0}", "99999999",
    "\n",
];

struct Dice(SplitMix);

impl Dice {
    fn below(&mut self, limit: usize) -> usize {
        (self.0.word() % limit as u64) as usize
    }
}

/// The text with a few characters dropped, doubled or replaced.
fn mangled(text: &str, dice: &mut Dice) -> String {
    let mut characters: Vec<String> = text.chars().map(String::from).collect();
    for _ in 0..=dice.below(3) {
        let at = dice.below(characters.len());
        match dice.below(4) {
            0 => characters[at].clear(),
            1 => characters[at] = PIECES[dice.below(PIECES.len())].to_owned(),
            2 => characters[at] += PIECES[dice.below(PIECES.len())],
            _ => {
                let end = (at + dice.below(20)).min(characters.len());
                characters[at..end].iter_mut().for_each(String::clear);
            }
        }
    }
    characters.concat()
}

#[test]
fn damaged_text_is_refused_not_feared() {
    let mut refused = 0;
    for seed in 0..1500 {
        let mut dice = Dice(SplitMix::new(seed));
        let scene = mangled(SCENE, &mut dice);
        match read_scene(&scene, "s", &mut |_, _, _| Ok(Model::default())) {
            Ok(scene) => _ = World::new(&scene),
            Err(error) => {
                let message = error.to_string();
                assert!(message.starts_with("s:"), "seed {seed}: {message}");
                refused += 1;
            }
        }
        let model = mangled(MODEL, &mut dice);
        match read_geomdl(&model, "m", "m") {
            Ok(model) => {
                let object = Object { parts: model.parts, ..Object::default() };
                _ = World::new(&Scene { objects: vec![object], ..Scene::default() });
            }
            Err(error) => {
                let message = error.to_string();
                assert!(message.starts_with("m:"), "seed {seed}: {message}");
                refused += 1;
            }
        }
    }
    assert!(refused > 500, "{refused} refused: the damage does too little");
}
