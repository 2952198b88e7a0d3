//! What a picture does not show, or not as it may be meant: said on stderr.

use nurbray::math::Shown;
use nurbray::render::{Aov, Film};
use nurbray::scene::{Camera, Scene, Written};

use super::super::args::RenderArguments;
use super::super::console;
use super::super::table::count;
use super::picture::{self, Format, Picture};

/// Warns of options that change nothing in any file.
pub(super) fn warn_of_what_is_lost(arguments: &RenderArguments, pictures: &[Picture<'_>]) {
    let Some(first) = pictures.first().map(|picture| picture.path.display()) else { return };
    if let Some(aovs) = arguments.aov.filter(|aovs| !aovs.is_empty())
        && picture::all(pictures, Format::Png)
    {
        console::warning(&format!(
            "{first}: a PNG holds colour only, {aovs} will be in no file; -o with an .exr holds \
             them"
        ));
    }
    if arguments.exposure.is_some() && picture::all(pictures, Format::Exr) {
        console::warning(&format!(
            "{first}: an EXR holds light as it is, --exposure is for a .png and changes nothing"
        ));
    }
}

/// Warns of materials that send back more light than falls on them: likely meant to be 0 to 1.
pub(super) fn warn_of_bright_materials(scene: &Scene) {
    for Written { value: material, place } in &scene.materials {
        let largest = material.largest_albedo();
        if largest > 1.0 {
            let place = if place.label().is_some() { format!("{place}: ") } else { String::new() };
            console::warning(&format!(
                "{place}material \"{}\" sends back {} times the light that falls on it; \
                 colours of things are from 0 to 1",
                material.name,
                Shown(largest)
            ));
        }
    }
}

/// Warns of numbers of a film that an EXR does not hold, or not as exactly as it should.
pub(super) fn warn_of_lost_numbers(film: &Film, camera: &Camera, pictures: &[Picture<'_>]) {
    let exr = pictures.iter().find(|picture| picture.format == Format::Exr);
    let Some(path) = exr.map(|picture| picture.path.display()) else { return };
    let overflows = film.overflows();
    if overflows > 0 {
        let pixels = count(overflows, "pixel");
        console::warning(&format!(
            "{path}: {pixels} with numbers beyond 3.4e38, the largest that an EXR holds: they are \
             infinite there"
        ));
    }
    let coarse = film.coarse_points(camera);
    if coarse > 0 && film.settings().aovs.contains(Aov::P) {
        let pixels = count(coarse, "pixel");
        console::warning(&format!(
            "{path}: {pixels} in which the 32 bits of P have steps of more than 1/10 of the pixel: \
             the scene is too far from the origin for them; `nurbray cast` writes points in f64"
        ));
    }
}
