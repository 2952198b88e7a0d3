//! Worlds for tests: spheres over a floor.

use glam::{DAffine3, DVec3};

use crate::geometry::{NurbsSurface, shapes};
use crate::intersect::SurfaceBvh;
use crate::scene::{
    Camera, Instance, Light, Material, Projection, RenderDefaults, Texture, View, World,
};

/// A sphere of this radius around the origin.
pub(super) fn sphere(radius: f64) -> NurbsSurface {
    shapes::sphere(radius).unwrap()
}

/// A square floor of this size at this height.
pub(super) fn floor(size: f64, z: f64) -> NurbsSurface {
    let plane = shapes::plane(size, size).unwrap();
    plane.transformed(&DAffine3::from_translation(DVec3::new(0.0, 0.0, z))).unwrap()
}

/// A camera at `(0, −5, 2) · scale` that looks at the origin, 40 degrees high.
pub(super) fn camera(scale: f64) -> Camera {
    let look_from = DVec3::new(0.0, -5.0, 2.0) * scale;
    let view = View { look_from, look_at: DVec3::ZERO, up: DVec3::Z };
    Camera::new(view, Projection::Perspective { fov: 40.0 }).unwrap()
}

/// Surfaces, each of one colour of its own, under these lights, seen by [`camera`].
pub(super) fn world(surfaces: Vec<NurbsSurface>, lights: Vec<Light>, scale: f64) -> World {
    let bvh = SurfaceBvh::build(&surfaces).unwrap();
    let material = |index: usize| Material {
        name: format!("material {index}"),
        texture: Texture::Constant([0.9, 0.5, 0.1 * (index + 1) as f64]),
    };
    World {
        bvh,
        materials: (0..surfaces.len()).map(material).collect(),
        surfaces: surfaces
            .into_iter()
            .enumerate()
            .map(|(material, surface)| Instance {
                name: format!("surface {material}"),
                part: [material, 0],
                surface: surface.into(),
                material,
                deviation: 0.0,
            })
            .collect(),
        lights,
        camera: camera(scale),
        background: [0.05, 0.1, 0.2],
        settings: RenderDefaults::default(),
    }
}

/// A sphere over a floor under one light of each kind.
pub(super) fn sphere_over_floor() -> World {
    sphere_over(floor(6.0, -1.0))
}

/// The same, with the floor in so many pieces that small pictures have several to a pixel.
pub(super) fn sphere_over_tiles() -> World {
    let mut tiles = floor(6.0, -1.0);
    for k in 1..150 {
        let t = f64::from(k) / 150.0;
        tiles = tiles.insert_knot_u(t, 1).unwrap().insert_knot_v(t, 1).unwrap();
    }
    sphere_over(tiles)
}

fn sphere_over(floor: NurbsSurface) -> World {
    let lights = vec![
        Light::Point { position: DVec3::new(2.0, -3.0, 4.0), intensity: [40.0; 3] },
        Light::directional(DVec3::new(-1.0, -1.0, 2.0), [0.5, 0.6, 0.7]).unwrap(),
        Light::Ambient { radiance: [0.05; 3] },
    ];
    world(vec![sphere(1.0), floor], lights, 1.0)
}
