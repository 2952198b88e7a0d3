//! From a path to a scene.

use std::collections::HashMap;
use std::fs;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::geomdl::{Model, read_geomdl};
use super::load_error::{LoadError, LoadFault};
use super::nearby::{nearest_file, stem};
use super::obj::{CageModel, read_obj_cage};
use super::scene_toml::read_scene;
use super::source::Source;
use crate::scene::{Object, Part, Place, Scene, Scheme, Shape, Subdivision};

/// The largest file that is read: 1 GiB, ten times the largest model ever met. Its text,
/// its numbers and the surfaces made of them are in memory together for a while.
const MAX_BYTES: u64 = 1 << 30;

/// The endings of files that are read.
const READ: [&str; 3] = ["toml", "json", "obj"];

/// Files known by their endings but not read, or not yet.
const NOT_READ: [(&str, &str); 15] = [
    ("step", "STEP is not read yet"),
    ("stp", "STEP is not read yet"),
    ("iges", "IGES is not read yet"),
    ("igs", "IGES is not read yet"),
    ("3dm", "3dm is not read yet"),
    ("brep", "BREP is not read yet"),
    ("rib", "RIB is not read"),
    ("bpt", "BPT is not read yet"),
    ("stl", "a mesh has no surfaces to trace"),
    ("ply", "a mesh has no surfaces to trace"),
    ("npy", "it holds rays or hits, not surfaces"),
    ("png", "a picture has no surfaces to trace"),
    ("exr", "a picture has no surfaces to trace"),
    ("gz", "it is compressed: unpack it first"),
    ("zip", "it is compressed: unpack it first"),
];

/// Reads a scene (`.toml`) or a bare model, which is then framed and lit by default: geomdl
/// JSON (`.json`), or a cage (`.obj`), whose Catmull–Clark surface is shown. A file with an
/// unknown ending is a geomdl model if it begins with a brace.
///
/// # Errors
/// When the file, or one that the scene mentions, cannot be read or understood.
pub fn load_input(path: &Path) -> Result<Scene, LoadError> {
    let label = path.display().to_string();
    let nowhere = Place::default();
    match file_type(path, &nowhere)? {
        FileType::Scene => {
            let text = read_text(path, &nowhere)?;
            let mut models = HashMap::new();
            let folder = path.parent().unwrap_or(Path::new(""));
            let mut scene = read_scene(&text, &label, &mut |file, called, place| {
                let path = folder.join(file);
                cached_model(&mut models, path, (called, place))
            })?;
            scene.files = models.into_keys().collect();
            Ok(scene)
        }
        FileType::Model => {
            let model = read_geomdl(&read_text(path, &nowhere)?, &label, &stem(path))?;
            Ok(scene_of(model, path))
        }
        FileType::Cage => Ok(scene_of(read_cage(&read_text(path, &nowhere)?, &label)?, path)),
    }
}

/// The scene of a bare model.
fn scene_of(model: Model, path: &Path) -> Scene {
    let default_name = stem(path);
    let object = Object { default_name, parts: model.parts, ..Object::default() };
    let place = Place::file(&path.display().to_string());
    Scene { place, objects: vec![object], notes: model.notes, ..Scene::default() }
}

/// A cage as a model: its Catmull–Clark surface.
fn read_cage(text: &str, label: &str) -> Result<Model, LoadError> {
    let CageModel { cage, notes } = read_obj_cage(text, label)?;
    let scheme = Scheme::CatmullClark;
    let shape = Subdivision { cage: Arc::new(cage), scheme, tolerance: None };
    let shape = Shape::Subdivision(Arc::new(shape));
    let part = Part { name: String::new(), place: Place::file(label), shape, trims: None };
    Ok(Model { parts: vec![part], notes })
}

/// Returns a model that several objects may use; only the first of them gets its notes.
fn cached_model(
    models: &mut HashMap<PathBuf, Model>,
    path: PathBuf,
    (called, place): (&str, &Place),
) -> Result<Model, LoadError> {
    if let Some(model) = models.get(&path) {
        return Ok(Model { parts: model.parts.clone(), notes: Vec::new() });
    }
    let label = path.display().to_string();
    let model = match file_type(&path, place)? {
        FileType::Scene => {
            return Err(LoadError::new(place.clone(), LoadFault::NotAShape { path }));
        }
        FileType::Model => read_geomdl(&read_text(&path, place)?, &label, called)?,
        FileType::Cage => read_cage(&read_text(&path, place)?, &label)?,
    };
    models.insert(path, model.clone());
    Ok(model)
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum FileType {
    Scene,
    Model,
    Cage,
}

/// Recognises the type of a file by its ending, else by its beginning. `mentioned` is the place
/// where a scene names the file.
fn file_type(path: &Path, mentioned: &Place) -> Result<FileType, LoadError> {
    let ending = file_ending(path);
    match ending.as_str() {
        "toml" => return Ok(FileType::Scene),
        "json" => return Ok(FileType::Model),
        "obj" => return Ok(FileType::Cage),
        _ => {}
    }
    let known = NOT_READ.iter().find(|(other, _)| *other == ending);
    let what = match known {
        Some((_, what)) => what,
        None => {
            // A missing file is reported as missing, not as of unknown type.
            let bytes = read_bytes(path, mentioned)?;
            let begin = bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(&bytes);
            if begin.trim_ascii_start().starts_with(b"{") {
                return Ok(FileType::Model);
            }
            "its ending tells no known type"
        }
    };
    let fault = LoadFault::UnknownType { path: path.to_owned(), what };
    Err(LoadError::new(mentioned.clone(), fault))
}

/// The ending of a file's name, in lower case.
fn file_ending(path: &Path) -> String {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    ending.unwrap_or_default()
}

/// The bytes of a file; devices, pipes and absurdly large files are refused unread.
fn read_bytes(path: &Path, mentioned: &Place) -> Result<Vec<u8>, LoadError> {
    let fail = |fault| LoadError::new(mentioned.clone(), fault);
    let cannot = |error: io::Error| {
        let path = path.to_owned();
        // A file that exists but must not be read is the one that was meant.
        let is_meant = error.kind() == io::ErrorKind::PermissionDenied;
        let nearest = if is_meant { None } else { nearest_file(&path, &READ) };
        fail(LoadFault::Read { nearest, path, error })
    };
    let metadata = fs::metadata(path).map_err(cannot)?;
    if metadata.is_dir() {
        return Err(cannot(io::ErrorKind::IsADirectory.into()));
    }
    if !metadata.is_file() {
        return Err(fail(LoadFault::NotAFile { path: path.to_owned() }));
    }
    if metadata.len() > MAX_BYTES {
        let (path, bytes) = (path.to_owned(), metadata.len());
        return Err(fail(LoadFault::TooLarge { path, bytes, limit: MAX_BYTES }));
    }
    let mut bytes = Vec::new();
    let file = fs::File::open(path).map_err(cannot)?;
    file.take(MAX_BYTES).read_to_end(&mut bytes).map_err(cannot)?; // it may be growing
    Ok(bytes)
}

/// The text of a file.
fn read_text(path: &Path, mentioned: &Place) -> Result<String, LoadError> {
    let bytes = read_bytes(path, mentioned)?;
    if file_ending(path) == "obj" && !bytes.contains(&0) {
        // Names and comments may be in any encoding; they are not used.
        return Ok(String::from_utf8_lossy(&bytes).into_owned());
    }
    String::from_utf8(bytes).map_err(|error| {
        if is_utf16(error.as_bytes()) {
            let place = Place::file(&path.display().to_string());
            return LoadError::new(place, LoadFault::Utf16 { path: path.to_owned() });
        }
        let valid = error.utf8_error().valid_up_to();
        let text = String::from_utf8_lossy(&error.as_bytes()[..valid]);
        // The readers do not count a byte order mark either.
        let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
        let place = Source::new(text, &path.display().to_string()).place(text.len());
        LoadError::new(place, LoadFault::NotText { path: path.to_owned(), valid })
    })
}

/// Whether the byte order mark is that of UTF-16; that of UTF-32 may begin with the same bytes.
fn is_utf16(bytes: &[u8]) -> bool {
    match bytes {
        [0xff, 0xfe, rest @ ..] => !rest.starts_with(&[0, 0]),
        [0xfe, 0xff, ..] => true,
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::World;

    const SURFACE: &str = r#"{"degree_u": 1, "degree_v": 1, "size_u": 2, "size_v": 2,
        "knotvector_u": [0, 0, 1, 1], "knotvector_v": [0, 0, 1, 1],
        "control_points": {"points": [[0, 0, 0], [0, 1, 0], [1, 0, 0], [1, 1, 1]]}}"#;

    /// A folder with these files, and the result of loading the first of them.
    fn load(files: &[(&str, &[u8])]) -> (tempfile::TempDir, Result<Scene, String>) {
        let folder = tempfile::tempdir().unwrap();
        for (name, content) in files {
            fs::write(folder.path().join(name), content).unwrap();
        }
        let here = format!("{}/", folder.path().display());
        let loaded = load_input(&folder.path().join(files[0].0))
            .map_err(|error| error.to_string().replace(&here, ""));
        (folder, loaded)
    }

    fn error(files: &[(&str, &[u8])]) -> String {
        load(files).1.unwrap_err()
    }

    #[test]
    fn a_bare_model_is_framed_lit_and_named_after_its_file() {
        for name in ["roof.json", "roof.JSON", "roof"] {
            let scene = load(&[(name, SURFACE.as_bytes())]).1.unwrap();
            let world = World::new(&scene).unwrap();
            assert_eq!(world.surfaces[0].name, "roof");
            assert!(!world.lights.is_empty());
        }
    }

    #[test]
    fn objects_share_a_side_file_and_its_notes_come_once() {
        let curve = r#"{"degree": 1}"#;
        let model = format!("{{\"surfaces\": [{SURFACE}, {curve}, {SURFACE}]}}");
        let object = "[[object]]\nshape = { file = 'roof.json' }\n";
        let scene = object.repeat(2);
        let files = [("s.toml", scene.as_bytes()), ("roof.json", model.as_bytes())];
        let scene = load(&files).1.unwrap();
        assert_eq!(scene.notes.len(), 1);
        let [file] = scene.files.as_slice() else { panic!("{:?}", scene.files) };
        assert!(file.ends_with("roof.json"));
        let world = World::new(&scene).unwrap();
        let names: Vec<_> = world.surfaces.iter().map(|s| s.name.as_str()).collect();
        assert_eq!(names, ["roof/0", "roof/2", "roof 2/0", "roof 2/2"]);
    }

    #[test]
    fn our_own_scenes_are_short_and_say_what_to_look_at() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
        let paths = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        let mut scenes = 0;
        for path in paths.filter(|path| path.extension().is_some_and(|e| e == "toml")) {
            let text = fs::read_to_string(&path).unwrap();
            let comment: Vec<&str> =
                text.lines().take_while(|line| line.starts_with('#')).collect();
            let comment = comment.join(" ").replace("# ", "");
            assert!(comment.contains("ook at"), "{}: {comment}", path.display());
            // A page; nets written out in full are the longest.
            assert!(text.lines().count() <= 80, "{}", path.display());
            let scene = load_input(&path).unwrap_or_else(|error| panic!("{error}"));
            assert!(scene.notes.is_empty(), "{}", path.display());
            for (index, plot) in scene.plots.iter().enumerate() {
                plot.checked(index, &scene).unwrap_or_else(|error| panic!("{error}"));
            }
            if !scene.objects.is_empty() || scene.plots.is_empty() {
                World::new(&scene).unwrap_or_else(|error| panic!("{error}"));
            }
            scenes += 1;
        }
        assert!(scenes >= 8, "{scenes} scenes");
    }

    #[test]
    fn the_teapot_has_its_patches_where_newell_put_them() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/teapot.json");
        let world = World::new(&load_input(&path).unwrap()).unwrap();
        assert_eq!(world.surfaces.len(), 32);
        assert_eq!(world.surfaces[0].name, "teapot/rim 1");
        // Tip of the spout, corner of the first rim patch, middle of the bottom.
        let corner =
            |k: usize, u, v| world.surfaces[k].surface.point_at(glam::DVec2::new(u, v)).to_array();
        assert_eq!(corner(18, 0.0, 0.0), [2.7, 0.0, 2.4]);
        assert_eq!(corner(0, 0.0, 0.0), [1.4, 0.0, 2.4]);
        assert_eq!(corner(28, 0.0, 0.0), [0.0, 0.0, 0.0]);
    }

    #[test]
    fn missing_files_and_who_mentions_them() {
        let scene = b"[[object]]\nshape = { file = 'rof.json' }\n";
        assert_eq!(
            error(&[("s.toml", scene), ("roof.json", b"{}")]),
            "s.toml:2:18: cannot read \"rof.json\": there is no such file; \
             did you mean \"roof.json\"?"
        );
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.toml");
        assert_eq!(
            load_input(&path).unwrap_err().to_string(),
            format!("cannot read \"{}\": there is no such file", path.display())
        );
        assert_eq!(
            load_input(folder.path()).unwrap_err().to_string(),
            format!("cannot read \"{}\": it is a folder", folder.path().display())
        );
        #[cfg(unix)]
        assert_eq!(
            load_input(Path::new("/dev/null")).unwrap_err().to_string(),
            "cannot read \"/dev/null\": it is a pipe or a device, not a file"
        );
    }

    #[test]
    fn a_bare_cage_shows_its_catmull_clark_surface_a_scene_either() {
        let cage = b"v 1 1 1\nv -1 -1 1\nv -1 1 -1\nv 1 -1 -1\n\
            f 1 2 4\nf 1 3 2\nf 1 4 3\nf 2 3 4\nusemtl red\n";
        let scene = load(&[("box.obj", cage)]).1.unwrap();
        assert_eq!(scene.notes.len(), 1);
        let world = World::new(&scene).unwrap();
        assert_eq!((world.surfaces.len(), world.surfaces[0].name.as_str()), (1, "box"));
        assert_eq!(world.surfaces[0].surface.degree(), [3, 3]);
        let both = b"[[object]]\nshape = { file = 'box.obj' }\n\
            [[object]]\nname = 'round'\nshape = { doo_sabin = { file = 'box.obj' } }\n";
        let scene = load(&[("s.toml", both), ("box.obj", cage)]).1.unwrap();
        assert_eq!(scene.notes.len(), 1);
        let world = World::new(&scene).unwrap();
        let found: Vec<_> =
            world.surfaces.iter().map(|one| (one.name.as_str(), one.surface.degree()[0])).collect();
        assert_eq!(found, [("box", 3), ("round", 2)]);
        let other = b"[[object]]\nshape = { doo_sabin = { file = 'roof.json' } }\n";
        assert_eq!(
            error(&[("s.toml", other), ("roof.json", SURFACE.as_bytes())]),
            "s.toml:2:32: doo_sabin needs a cage (.obj): this file has surfaces"
        );
    }

    #[test]
    fn other_types_are_refused_by_name() {
        let known = "; what can be read are scenes (.toml), geomdl JSON models (.json) \
             and cages (.obj)";
        assert_eq!(
            error(&[("part.STP", b"ISO-10303-21;")]),
            format!("cannot read \"part.STP\": STEP is not read yet{known}")
        );
        assert_eq!(
            error(&[("notes.txt", b"hello")]),
            format!("cannot read \"notes.txt\": its ending tells no known type{known}")
        );
        assert_eq!(
            error(&[("s.toml", b"[[object]]\nshape = { file = 's.toml' }")]),
            "s.toml:2:18: \"s.toml\" is a scene, which cannot be the shape of an object; models (.json) and cages \
             (.obj) can"
        );
        assert_eq!(
            error(&[("m.json", b"{\"a\": \"\xff\"}")]),
            "m.json:1:8: from here on the file is not UTF-8 text: byte 7 cannot be read"
        );
        // Columns count characters, not bytes, and leave out the byte order mark.
        let scene = b"\xef\xbb\xbf# caf\xc3\xa9 \xe9\n";
        assert_eq!(
            error(&[("s.toml", scene)]),
            "s.toml:1:8: from here on the file is not UTF-8 text: byte 11 cannot be read"
        );
        let scene = b"# a\n[[object]]\nname = '\xe9'\n";
        assert!(error(&[("s.toml", scene)]).starts_with("s.toml:3:9: from here on "));
    }

    #[test]
    fn bytes_of_unknown_endings_are_refused_by_their_endings() {
        let known = "; what can be read are scenes (.toml), geomdl JSON models (.json) \
             and cages (.obj)";
        for (name, what) in [
            ("a.blend", "its ending tells no known type"),
            ("a.png", "a picture has no surfaces to trace"),
            ("a.EXR", "a picture has no surfaces to trace"),
            ("a.obj.gz", "it is compressed: unpack it first"),
        ] {
            let expected = format!("cannot read \"{name}\": {what}{known}");
            assert_eq!(error(&[(name, b"\x1f\x8b\xff\xfe")]), expected);
            assert_eq!(error(&[(name, b"\xff\xfea\0")]), expected);
        }
        // A file that begins as a model is a damaged model.
        assert_eq!(
            error(&[("model", b" {\"a\": \"\xff\"}")]),
            "model:1:9: from here on the file is not UTF-8 text: byte 8 cannot be read"
        );
    }

    #[test]
    fn utf_16_is_called_so() {
        let said = "found UTF-16 text, by its first two bytes: save the file as UTF-8";
        for bytes in [b"\xff\xfe[\0", b"\xfe\xff\0["] {
            for name in ["s.toml", "m.json", "m.obj"] {
                assert_eq!(error(&[(name, bytes)]), format!("{name}: {said}"));
            }
        }
        assert_eq!(
            error(&[("s.toml", b"\xff\xfe\0\0[\0\0\0")]),
            "s.toml:1:1: from here on the file is not UTF-8 text: byte 0 cannot be read"
        );
    }

    #[test]
    fn names_and_comments_of_cages_may_be_in_any_encoding() {
        let cage = b"# caf\xe9\no W\xfcrfel\nv 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n";
        assert!(load(&[("m.obj", cage)]).1.is_ok());
        // The name of this object ends with the byte of a backslash, in Shift JIS.
        let cage = b"o \x83\x5c\nv 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n";
        assert!(load(&[("m.obj", cage)]).1.is_ok());
        assert_eq!(
            error(&[("m.obj", b"\xff\0v\0 \x000\0")]),
            "m.obj:1:1: from here on the file is not UTF-8 text: byte 0 cannot be read"
        );
        assert_eq!(error(&[("m.obj", b"v 0 0 \xe9\n")]), "m.obj:1:7: \"\u{fffd}\" is not a number");
    }

    #[test]
    fn errors_in_a_side_file_name_the_side_file() {
        let scene = b"[[object]]\nname = 'lid'\nshape = { file = 'roof.json' }\n";
        assert_eq!(
            error(&[("s.toml", scene), ("roof.json", b"{\n\"surfaces\": [")]),
            "roof.json:2:13: the file ends inside a list: it is not complete"
        );
        let model =
            SURFACE.replace("[0, 0, 1, 1], \"knotvector_v\"", "[0, 0, 1], \"knotvector_v\"");
        let (folder, scene) = load(&[("s.toml", scene), ("roof.json", model.as_bytes())]);
        assert_eq!(
            World::new(&scene.unwrap()).unwrap_err().to_string(),
            format!(
                "{}/roof.json:2:25: surface \"lid\", direction u: 3 knots, but 2 points of \
                 degree 1 need 4",
                folder.path().display()
            )
        );
    }
}
