//! Files: scenes, models and rays in, pictures and hits out; and Embree, a library opened
//! like a file.
//!
//! | file | read by | written by |
//! |---|---|---|
//! | scene or model, by its ending | [`load_input`] | |
//! | scene, TOML: [`scene_toml`] shows every key | [`read_scene`] | |
//! | model, geomdl JSON: [`geomdl`] says what is read | [`read_geomdl`] | |
//! | cage of a subdivision surface, OBJ: [`obj`] says what is read | [`read_obj_cage`] | |
//! | rays and hits, NumPy | [`read_rays`], [`read_table`] | [`write_rows`], [`write_parts`] |
//! | picture with its data, OpenEXR | | [`write_exr`] |
//! | scene for POV-Ray | | [`povray_scene`] |
//! | picture for a screen, PNG | | [`write_png`], [`write_png_bytes`] |
//!
//! Errors begin with the place: `scenes/teapot.toml:41:7: surface "lid", direction u: 12 knots, but
//! 7 points of degree 3 need 11`. A file is written under another name and moved into place when
//! complete ([`write_atomically`]), so a failure leaves the older file as it was. Files that belong
//! together are moved when all of them are complete ([`stage`], [`put_all_in_place`]). Pictures
//! that are to be no files, [`write_png_to`], [`write_png_bytes_to`] and [`write_exr_to`] give to
//! any writer.
//!
//! From a file of surfaces to their hierarchy, without a picture in mind:
//!
//! ```
//! use nurbray::intersect::SurfaceBvh;
//!
//! let instances = nurbray::io::load_input("scenes/teapot.json".as_ref())?.surfaces()?;
//! let surfaces: Vec<_> = instances.iter().map(|instance| &instance.surface).collect();
//! let bvh = SurfaceBvh::build(&surfaces)?; // a hit's index counts the instances
//! assert_eq!(bvh.surface_count(), 32);
//! assert_eq!(instances[0].name, "teapot/rim 1");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! STEP, IGES and 3dm have their place here, but are not read yet, nor are NURBS in OBJ.

mod atomic;
mod cage_offsets;
#[cfg(feature = "embree")]
mod embree;
#[cfg(feature = "embree")]
mod embree_error;
#[cfg(feature = "embree")]
mod embree_rays;
mod exr;
pub mod geomdl;
mod keyed;
mod load;
mod load_error;
#[cfg(test)]
mod mangled;
#[cfg(feature = "embree")]
pub mod mesh;
mod message;
mod nearby;
mod npy;
mod npy_error;
mod npy_header;
pub mod obj;
mod png;
mod povray;
mod quoted;
pub mod scene_toml;
mod source;

pub use atomic::{
    StagedFile, WriteError, check_writable, end_of_links, put_all_in_place, stage, write_atomically,
};
#[cfg(feature = "embree")]
pub use embree::{Embree, EmbreeScene};
#[cfg(feature = "embree")]
pub use embree_error::EmbreeError;
#[cfg(feature = "embree")]
pub use embree_rays::{EmbreeHit, EmbreePart, EmbreePrimitive, EmbreeRays, PacketWidth};
pub use exr::{ExrNotes, ExrPrecision, stage_exr, write_exr, write_exr_to};
pub use geomdl::{Model, read_geomdl};
pub use load::load_input;
pub use load_error::{LoadError, LoadFault};
pub use npy::{Table, read_rays, read_table, table_from_bytes, write_parts, write_rows};
pub use npy_error::NpyError;
pub use obj::{CageModel, read_obj_cage};
pub use png::{
    PngWarning, stage_png, stage_png_bytes, write_png, write_png_bytes, write_png_bytes_to,
    write_png_to,
};
pub use povray::{PovrayGap, PovrayScene, PovraySkip, povray_scene};
pub use quoted::Quoted;
pub use scene_toml::read_scene;
