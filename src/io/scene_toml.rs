//! Scenes as TOML.
//!
//! Every table except the objects may be left out; whatever is not given is chosen so that a
//! picture comes out. A complete scene:
//!
//! ```toml
//! # A sphere on a checkered floor, with a torus lying behind it.
//! background = [0.32, 0.38, 0.45]        # linear light; also 0.4, or "#9aa6b2"
//!
//! [camera]                               # without one, everything is in the picture
//! look_from = [4, -7, 3]
//! look_at = [0, 0, 0.8]                  # the middle of the scene if not given
//! up = [0, 0, 1]                         # not along the view; z if not given, y if that is
//! perspective = { fov = 30 }             # vertical, in degrees; 30 if not given
//!                                        # or: orthographic = { height = 4 }
//! [render]                               # the command line overrides these
//! size = [800, 600]
//! spp = 16                               # samples a pixel
//! integrator = "direct"                  # or normal, uv, depth, id, iterations
//! seed = 0
//! exposure = 0                           # of the PNG, in stops
//!
//! [[light]]                              # without any: a key, a fill, a little ambient
//! directional = { from = [-2, -3, 4], irradiance = 2.5 } # from: where the light comes from
//! [[light]]
//! point = { position = [3, -2, 5], intensity = [20, 18, 15] }
//! [[light]]
//! ambient = { radiance = 0.05 }          # never shadowed
//!
//! [[material]]
//! name = "clay"
//! color = "#c8664a"                      # or [r, g, b], or one number for grey
//! [[material]]
//! name = "tiles"
//! checker = { count = [8, 8], colors = [0.7, 0.3] } # the first where u and v begin
//! [[material]]
//! name = "grid"                          # lines of constant u and v, borders included
//! lines = { count = [8, 16], width = 0.06, color = 0.05, base = 0.8 }
//!
//! [[object]]
//! name = "ball"                          # without one, called after its shape
//! shape = { sphere = { radius = 1 } }
//! material = "grid"                      # without one: "default", or light grey
//! transform = [{ translate = [0, 0, 1] }]
//!
//! [[object]]
//! shape = { plane = { width = 9, height = 9 } }
//! material = "tiles"
//!
//! [[object]]
//! shape = { torus = { major = 1, minor = 0.25 } }
//! material = "clay"
//! reverse = false                        # true turns its surfaces inside out, see below
//! swap_uv = false                        # true exchanges their u and v, see below
//! transform = [                          # the first one first
//!     { scale = 0.8 },                   # or [x, y, z]
//!     { rotate = { axis = "x", degrees = 60 } },
//!     { translate = [1.5, 2, 0.9] },
//!     # { matrix = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]] },
//! ]
//! ```
//!
//! Light is in units of one's own choice, linear in red, green and blue. `irradiance` is that of a
//! surface which faces the light; a point light of `intensity` I at distance r, at an angle θ to
//! the normal, brings the irradiance I cos θ / r². A surface of colour a under the irradiance E
//! has the radiance a E / π, and a L in ambient light of `radiance` L. Materials are lit on the
//! side that is seen, whichever way the normal points. The `width` of `lines` is a share of a cell,
//! half of it on each side of a line.
//!
//! With `reverse = true` the normals of an object's surfaces point to the other side: NURBS
//! surfaces run backwards in u; in triangular patches, and in each unit square of subdivision
//! surfaces, u and v are exchanged.
//!
//! With `swap_uv = true` u and v of an object's surfaces are exchanged: what was at (u, v) is at
//! (v, u). So a control net is read as where it comes from lists it, with u along its rows. (In
//! subdivision surfaces it is done within each unit square.) As u and v make the normals, these
//! point to the other side, too; with `reverse = true` besides, they point where they pointed
//! before, as a NURBS surface then runs backwards in what has become its u. For triangular patches
//! and subdivision surfaces each of the two keys does the same, and both together nothing.
//!
//! The `trims` of an object are written in the (u, v) that its shape has without `reverse` and
//! `swap_uv`, so that either keeps the same part of the surface; everything else (textures,
//! `iso_curves`, plots, hits) refers to the (u, v) after them.
//!
//! # Shapes
//!
//! Shapes known by name, in their own coordinates. All measures may be left out, and with them the
//! table: `shape = "sphere"`. The values shown here are the defaults.
//!
//! ```toml
//! [[object]]
//! shape = { sphere = { radius = 1 } }                 # bicubic, 4 × 7 points
//! [[object]]
//! shape = { sphere_biquadratic = { radius = 1 } }     # as a surface of revolution
//! [[object]]
//! shape = { hemisphere = { radius = 1 } }             # y ≥ 0
//! [[object]]
//! shape = { octant = { radius = 1 } }                 # x, y, z ≥ 0
//! [[object]]
//! shape = { octant_quartic = { radius = 1 } }         # the same as a quartic triangle; it may
//!                                                     # have constants of its own, a = [a0, a1, a2]
//!                                                     # and b = [b0, b1, b2, b3], all b times any factor
//! [[object]]
//! shape = { cylinder = { radius = 1, height = 1 } }   # its side, on z = 0
//! [[object]]
//! shape = { cone = { radius = 1, height = 1 } }       # its side, on z = 0
//! [[object]]
//! shape = { torus = { major = 1, minor = 0.3333333333333333 } }  # around the z axis; a third
//! [[object]]
//! shape = { disk = { radius = 1 } }                   # in z = 0, facing up
//! [[object]]
//! shape = { plane = { width = 1, height = 1 } }       # in z = 0, facing up
//! [[object]]
//! shape = "lecture_patch_1"                           # a bicubic graph; _2: a hood; _3: it, pinched
//! [[object]]
//! shape = "deck_patch"                                # the bicubic net of the OpenGL books
//! ```
//!
//! Their u and v run from 0 to 1: on `sphere` and `hemisphere` u from the pole `+z` to `−z`, v
//! around, from `+x` over `+y`; on `sphere_biquadratic`, `octant`, cylinder and cone u around, v
//! up; on the torus u around the axis, v around the tube; on the disk u from the centre out, v
//! around; on the plane u along x, v along y. Normals, `S_u × S_v`, point outward, and up. Where a
//! `transform` mirrors, the normals of bodies point inward: `reverse = true` turns them back. With
//! `swap_uv = true`, hemisphere and octant have the u and v of Eberly's note, and `deck_patch` has
//! those of the OpenGL call for its net (see [errata](crate::geometry::errata)).
//!
//! A shape from a model file, relative to the scene: geomdl's JSON ([`geomdl`](super::geomdl) says
//! what is read), or a cage in an OBJ file ([`obj`](super::obj)), which stands for its
//! Catmull–Clark surface:
//!
//! ```toml
//! [[object]]
//! shape = { file = "teapot.json" }
//! ```
//!
//! A NURBS surface with a control net of its own. Points and weights are listed by rows: one row
//! for each u, along which v runs.
//!
//! ```toml
//! [[object]]
//! name = "lid"
//! [object.shape.nurbs]
//! degree = [2, 1]                        # or one number for both; the order less 1
//! knots_u = [0, 0, 0, 1, 1, 1]           # each knot; or [knot, times]: [[0, 3], [1, 3]]
//! knots_v = [[0, 2], [1, 2]]             # clamped and uniform on [0, 1] if not given; or a
//!                                        # name: "clamped", "standard" (0, 1, 2, … inside),
//!                                        # "uniform", or "periodic" (closed: each point is
//!                                        # written once; knots of its own: { periodic = […] })
//! points = [
//!     [[0, 0, 0], [0, 1, 0]],
//!     [[1, 0, 1], [1, 1, 1]],
//!     [[2, 0, 0], [2, 1, 0]],
//! ]
//! weights = [[1, 1], [0.7, 0.7], [1, 1]] # all 1 if not given
//! ```
//!
//! A patch in matrix form, `S(u, v) = [u³ u² u 1] M G Mᵀ [v³ v² v 1]ᵀ`, by the name of the form and
//! its geometry matrix G: one row for each u, along which v runs. Both u and v run from 0 to 1.
//!
//! ```toml
//! [[object]]
//! name = "cushion"
//! [object.shape.matrix_form]
//! form = "hermite"                       # or bezier, bspline, catmull_rom
//! geometry = [
//!     [[0, 0, 0], [0, 1, 0], [0, 1, 1], [0, 1, -1]], # S at (0, 0) and (0, 1), and S_v there
//!     [[1, 0, 0], [1, 1, 0], [0, 1, 1], [0, 1, -1]], # the same at u = 1
//!     [[1, 0, 1], [1, 0, 1], [0, 0, 0], [0, 0, 0]],  # S_u there, and S_uv
//!     [[1, 0, -1], [1, 0, -1], [0, 0, 0], [0, 0, 0]],
//! ]
//! ```
//!
//! In the forms `bezier` and `bspline` G has control points, as many rows as the degree in u, and
//! columns as the degree in v, and one more: two, three or four. A `bspline` patch is one piece of
//! a surface of uniform knots, and need not meet any of its points. A `catmull_rom` patch meets the
//! inner four of its 4 × 4 points.
//!
//! A patch in powers of its parameters, `S(u, v) = Σ aᵢⱼ uⁱ vʲ`, or a quotient of two such sums.
//! The coefficients are listed by rows: one for each power of u, `u⁰` first, along which the powers
//! of v rise. A row may end early: what is not written is 0. It becomes one Bézier patch, whose
//! degrees are the highest powers written. Eberly's octant:
//!
//! ```toml
//! [[object]]
//! name = "eighth"
//! [object.shape.power]
//! coefficients = [
//!     [[1, 0, 0], [0, 2, 0], [-1, 0, 0]], # ((1 − u²)(1 − v²), (1 − u²) 2v, 2u (1 + v²))
//!     [[0, 0, 2], [0, 0, 0], [0, 0, 2]],
//!     [[-1, 0, 0], [0, -2, 0], [1, 0, 0]],
//! ]
//! denominator = [[1, 0, 1], [], [1, 0, 1]] # (1 + u²)(1 + v²); [[1]] if not given
//! domain = [[0, 1], [0, 1]]              # of u, then of v; this if not given
//! ```
//!
//! A triangular Bézier patch. The control points of degree n are named by exponents
//! (i, j, k) with i + j + k = n, and listed with i slowest, then j: from the corner w = 1 to
//! v = 1, then the rows beside that, up to the corner u = 1 alone.
//! [`TrianglePatch`](crate::geometry::TrianglePatch) says more.
//!
//! ```toml
//! [[object]]
//! name = "sail"
//! [object.shape.triangle]
//! degree = 2
//! points = [
//!     [0, 0, 0], [0, 1, 1], [0, 2, 0],   # (0, 0, 2), (0, 1, 1), (0, 2, 0)
//!     [1, 0, 1], [1, 1, 1],              # (1, 0, 1), (1, 1, 0)
//!     [2, 0, 0],                         # (2, 0, 0)
//! ]
//! weights = [1, 0.7, 1, 0.7, 0.7, 1]     # all 1 if not given
//! ```
//!
//! The limit surface of a cage by one of two schemes, `catmull_clark` and `doo_sabin`:
//!
//! ```toml
//! [[object]]
//! name = "wedge"
//! [object.shape.catmull_clark]
//! points = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [0, 1, 1]]
//! faces = [                              # vertices counted from 0, counterclockwise from outside
//!     [0, 3, 2, 1], [0, 4, 5, 3], [1, 2, 5, 4], [0, 1, 4], [2, 3, 5],
//! ]
//! creases = [                            # chains of vertices; none if not given
//!     { vertices = [4, 5], sharpness = inf },  # or from 0 to 10 steps of refinement
//!     { vertices = [0, 1, 2], sharpness = 1.5 },
//! ]
//! corners = [{ vertices = [3], sharpness = 2 }]
//! boundary = "edge_only"                 # where a cage ends; "edge_and_corner" if not given; of
//!                                        # catmull_clark only
//! tolerance = 1e-5                       # in space; 1e-4 of the cage's longest side if not given
//! [[object]]
//! shape = { doo_sabin = { points = [[1, 1, 1], [-1, -1, 1], [-1, 1, -1], [1, -1, -1]], faces = [[0, 1, 3], [0, 2, 1], [0, 3, 2], [1, 2, 3]] } }
//! ```
//!
//! Catmull–Clark surfaces of an open cage end at its border. Doo–Sabin surfaces do not reach it:
//! they end in the middle of the faces along it, as uniform B-splines do, so that an open cage
//! loses half a face all around, and one without any inner vertex leaves nothing and is refused.
//!
//! A surface is within `tolerance` of the scheme's limit surface: a length in the object's own
//! units, before `transform`. If not given, it is 1e-4 of the longest side of the box around the
//! cage's points. Regular faces are exact; for the rest `nurbray info` lists a proved error bound.
//!
//! Instead of all these keys except `tolerance`, `file = "body.obj"` takes the cage from a file,
//! with the file's own tags of creases and corners. That is how an OBJ file becomes a Doo–Sabin
//! surface: `shape = { doo_sabin = { file = "body.obj" } }`. Textures are spread over each unit
//! square: a quad, or a corner of another face.
//!
#![doc = include_str!("scene_toml/from_curves.md")]
#![doc = include_str!("scene_toml/plots.md")]
//!
#![doc = include_str!("scene_toml/trims.md")]

mod cages;
mod constructions;
mod curves;
mod forms;
mod keys;
mod kinds;
mod knot_list;
mod objects;
mod patches;
mod plots;
mod slips;
mod transforms;
mod trims;
mod values;

use std::path::Path;

use toml::Spanned;

use self::keys::{CameraKeys, LightKeys, MaterialKeys, RenderKeys, SceneKeys};
use self::kinds::OneOf;
use self::slips::slip;
use self::values::{Number, Vector};
use super::LoadError;
use super::geomdl::Model;
use super::keyed::Keyed;
use super::message::{explain, with_example};
use super::source::Source;
use crate::math::Shown;
use crate::scene::{
    CameraSpec, ImportNote, Lens, Light, Material, Place, RenderDefaults, Scene, SceneError,
    SceneFault, Texture, UnknownName, Written,
};

/// Reads a model file that a scene mentions. The arguments are the path as written, the name of the
/// object it is for, and the place where the path was written.
pub type ReadModel<'a> = dyn FnMut(&Path, &str, &Place) -> Result<Model, LoadError> + 'a;

/// Reads a scene; errors call its file `label`, and model files come from `read_model`.
/// (To read both from disk, use [`load_input`](super::load_input).)
///
/// # Errors
/// When the text is not TOML, or has an unknown key or an impossible value.
pub fn read_scene(
    text: &str,
    label: &str,
    read_model: &mut ReadModel<'_>,
) -> Result<Scene, LoadError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let source = Source::new(text, label);
    let Keyed(keys): Keyed<SceneKeys> = toml::from_str(text).map_err(|error| {
        let Some(span) = error.span() else {
            // As where keys are nested too deeply.
            let message = format!("it cannot be read as TOML: {}", error.message());
            return LoadError::malformed(source.file().clone(), message);
        };
        let message = slip(error.message(), &source, span.start)
            .unwrap_or_else(|| explain(error.message(), source.slice(span.clone())));
        let message = with_example(message, source.slice(0..span.start));
        LoadError::malformed(source.place(span.start), message)
    })?;
    let mut reader = Reader { source, notes: Vec::new(), read_model };
    reader.scene(keys)
}

struct Reader<'a, 'b> {
    source: Source<'a>,
    notes: Vec<ImportNote>,
    read_model: &'a mut ReadModel<'b>,
}

impl Reader<'_, '_> {
    fn scene(&mut self, keys: SceneKeys) -> Result<Scene, LoadError> {
        let camera = match keys.camera {
            Some(camera) => self.camera(camera)?,
            None => CameraSpec { place: self.source.file().clone(), ..CameraSpec::default() },
        };
        let settings = self.settings(keys.render)?;
        let lights =
            keys.light.into_iter().map(|keys| self.light(keys)).collect::<Result<_, _>>()?;
        let materials =
            keys.material.into_iter().map(|keys| self.material(keys)).collect::<Result<_, _>>()?;
        let objects =
            keys.object.into_iter().map(|keys| self.object(keys)).collect::<Result<_, _>>()?;
        let plots = keys.plot.into_iter().map(|keys| self.plot(keys)).collect::<Result<_, _>>()?;
        let figure = self.figure(keys.figure)?;
        Ok(Scene {
            place: self.source.file().clone(),
            files: Vec::new(), // known to who reads them
            camera,
            lights,
            materials,
            objects,
            background: keys.background.map(|color| color.0),
            settings,
            plots,
            figure,
            notes: std::mem::take(&mut self.notes),
        })
    }

    fn camera(&self, keys: Spanned<Keyed<CameraKeys>>) -> Result<CameraSpec, LoadError> {
        let place = self.source.place(keys.span().start);
        let Keyed(keys) = keys.into_inner();
        let number = |number: Spanned<Number>| self.written(number, |number| number.0);
        let vector = |vector: Spanned<Vector>| self.written(vector, |vector| vector.0);
        let lens = match (keys.perspective, keys.orthographic) {
            (Some(_), Some(other)) => {
                let place = self.source.place(other.span().start);
                let message = "camera: needed is perspective or orthographic, not both";
                return Err(LoadError::malformed(place, message));
            }
            (None, Some(keys)) => {
                let Keyed(keys) = keys.into_inner();
                Lens::Orthographic { height: keys.height.map(number) }
            }
            (Some(Keyed(keys)), None) => Lens::Perspective { fov: keys.fov.map(number) },
            (None, None) => Lens::default(),
        };
        Ok(CameraSpec {
            place,
            look_from: keys.look_from.map(vector),
            look_at: keys.look_at.map(vector),
            up: keys.up.map(vector),
            lens,
        })
    }

    /// Returns the meaning of a value, with its place.
    fn written<V, T>(&self, value: Spanned<V>, meant: impl FnOnce(V) -> T) -> Written<T> {
        let place = self.source.place(value.span().start);
        Written::new(meant(value.into_inner()), place)
    }

    fn settings(&self, Keyed(keys): Keyed<RenderKeys>) -> Result<RenderDefaults, LoadError> {
        let mut settings = RenderDefaults::default();
        if let Some(size) = keys.size {
            settings.size = size.get_ref().0.map(|side| side.0);
            self.check(&settings, size.span().start)?;
        }
        if let Some(spp) = keys.spp {
            settings.spp = spp.get_ref().0;
            self.check(&settings, spp.span().start)?;
        }
        if let Some(name) = keys.integrator {
            settings.integrator = name.get_ref().parse().map_err(|error: UnknownName| {
                LoadError::malformed(self.source.place(name.span().start), error.to_string())
            })?;
        }
        settings.seed = keys.seed.unwrap_or(settings.seed);
        settings.exposure = keys.exposure.map_or(settings.exposure, |stops| stops.0);
        Ok(settings)
    }

    fn check(&self, settings: &RenderDefaults, offset: usize) -> Result<(), LoadError> {
        settings.check().map_err(|error| {
            SceneError::new(self.source.place(offset), SceneFault::Picture(error)).into()
        })
    }

    fn light(&self, OneOf(keys): OneOf<LightKeys>) -> Result<Light, LoadError> {
        match keys {
            LightKeys::Point(Keyed(keys)) => {
                Ok(Light::Point { position: keys.position.0, intensity: keys.intensity.0 })
            }
            LightKeys::Ambient(Keyed(keys)) => Ok(Light::Ambient { radiance: keys.radiance.0 }),
            LightKeys::Directional(Keyed(keys)) => {
                let offset = keys.from.span().start;
                Light::directional(keys.from.into_inner().0, keys.irradiance.0).ok_or_else(|| {
                    let message = "directional: from (0, 0, 0) is no direction";
                    LoadError::malformed(self.source.place(offset), message)
                })
            }
        }
    }

    /// Returns a name, which must be a single line, and not blank.
    fn name(&self, name: Spanned<String>) -> Result<Written<String>, LoadError> {
        let name = self.written(name, |name| name);
        if name.value.trim().is_empty() {
            let message = "a name needs a character that is not blank";
            return Err(LoadError::malformed(name.place, message));
        }
        if name.value.contains(char::is_control) {
            let message = "a name is a single line, without control characters";
            return Err(LoadError::malformed(name.place, message));
        }
        Ok(name)
    }

    fn material(&self, Keyed(keys): Keyed<MaterialKeys>) -> Result<Written<Material>, LoadError> {
        let Written { value: name, place } = self.name(keys.name)?;
        let mut textures = Vec::new();
        if let Some(color) = keys.color {
            textures.push((color.span().start, Texture::Constant(color.into_inner().0)));
        }
        if let Some(checker) = keys.checker {
            let offset = checker.span().start;
            let Keyed(checker) = checker.into_inner();
            let colors = checker.colors.0.map(|color| color.0);
            let count = checker.count.get_ref().0;
            if count.contains(&0) {
                let place = self.source.place(checker.count.span().start);
                return Err(LoadError::malformed(place, "found 0, needed counts from 1 on"));
            }
            textures.push((offset, Texture::Checker { count, colors }));
        }
        if let Some(lines) = keys.lines {
            let offset = lines.span().start;
            let Keyed(lines) = lines.into_inner();
            let width = lines.width.get_ref().0;
            if !(0.0..=1.0).contains(&width) {
                let place = self.source.place(lines.width.span().start);
                let message =
                    format!("found {}, needed a share of a cell from 0 to 1", Shown(width));
                return Err(LoadError::malformed(place, message));
            }
            let (line, base) = (lines.color.0, lines.base.0);
            let count = lines.count.into_inner().0;
            textures.push((offset, Texture::IsoLines { count, width, line, base }));
        }
        match textures.as_slice() {
            [(_, texture)] => Ok(Written::new(Material { name, texture: *texture }, place)),
            [] => {
                let message =
                    format!("material \"{name}\": needed is one of color, checker, lines");
                Err(LoadError::malformed(place, message))
            }
            [.., (offset, _)] => {
                let message =
                    format!("material \"{name}\": needed is only one of color, checker, lines");
                Err(LoadError::malformed(self.source.place(*offset), message))
            }
        }
    }
}

#[cfg(test)]
mod form_tests;
#[cfg(test)]
mod object_tests;
#[cfg(test)]
mod patch_tests;
#[cfg(test)]
mod slip_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod trims_tests;
#[cfg(test)]
mod value_tests;
