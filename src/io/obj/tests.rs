use super::*;

const SQUARES: &str = "\
# two squares
mtllib none.mtl
o roof
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
vt 0 0
vn 0 0 1
g left
f 1/1/1 2/1/1 3//1 4
v 2 0 0.5 1
v 2 1 .5 1 0 0
f -2 \\
  -1 3/1 2
";

fn error(text: &str) -> String {
    read_obj_cage(text, "x.obj").unwrap_err().to_string()
}

/// Lines end as on any system, even with comments.
#[test]
fn line_ends_of_all_kinds() {
    let model = read_obj_cage(SQUARES, "roof.obj").unwrap();
    for end in ["\r\n", "\r", "\r\r\n"] {
        let other = read_obj_cage(&SQUARES.replace('\n', end), "roof.obj").unwrap();
        assert_eq!((&other.cage, &other.notes), (&model.cage, &model.notes), "{end:?}");
    }
    let mixed = "# by x\rv 0 0 0\nv 1 0 0\r\nv 1 1 0\rf 1 2 3\nf 1 2\r";
    assert!(error(mixed).starts_with("x.obj:6:1: "), "{}", error(mixed));
}

#[test]
fn faces_of_all_forms() {
    let model = read_obj_cage(SQUARES, "roof.obj").unwrap();
    let cage = &model.cage;
    assert_eq!((cage.face_count(), cage.positions().len(), cage.edge_count()), (2, 6, 7));
    assert_eq!(cage.face(0), Some(&[0, 1, 2, 3][..]));
    assert_eq!(cage.face(1), Some(&[4, 5, 2, 1][..]));
    assert_eq!(cage.positions()[5], DVec3::new(2.0, 1.0, 0.5));
    let notes: Vec<String> = model.notes.iter().map(ToString::to_string).collect();
    assert_eq!(
        notes,
        [
            "roof.obj:2:1: statement \"mtllib\", once: materials come from the scene",
            "roof.obj:3:1: statement \"o\", once: all objects of the file are one cage",
            "roof.obj:8:1: statement \"vt\", once: texture coordinates are not used",
            "roof.obj:9:1: statement \"vn\", once: the surface has its own normals",
            "roof.obj:10:1: statement \"g\", once: groups are not used",
            "roof.obj:13:1: statement \"v\", once: colours of vertices are not used",
        ]
    );
}

#[test]
fn tags_sharpen_edges_and_vertices() {
    let tagged = format!(
        "{SQUARES}t crease 2/1/0 1 2 2.5\nt corner 2/1/0 0 4 10.0\n\
         t interpolateboundary 1/0/0 2\nt creasemethod 0/0/1 normal\n"
    );
    let cage = read_obj_cage(&tagged, "x").unwrap().cage;
    let sharp: Vec<([u32; 2], f64)> =
        cage.edges().zip(cage.edge_sharpness().iter().copied()).collect();
    assert!(sharp.contains(&([1, 2], 2.5)));
    assert_eq!(sharp.iter().filter(|(_, s)| *s == f64::INFINITY).count(), 6);
    let inf = f64::INFINITY;
    assert_eq!(cage.vertex_sharpness(), [inf, 0.0, 0.0, 0.0, inf, 0.0]);
    let chain = format!("{SQUARES}t crease 3/2/0 0 1 2 3 10\n");
    assert!(read_obj_cage(&chain, "x").unwrap().cage.edge_sharpness().contains(&inf));
}

#[test]
fn errors_name_line_and_column() {
    let lines = [
        ("v 1 2", "x.obj:16:1: a vertex has 2 numbers: it needs 3 (x y z)"),
        ("v 1 2 x", "x.obj:16:7: \"x\" is not a number"),
        ("v 1 nan 3", "x.obj:16:5: \"nan\": numbers must be finite"),
        ("v 1 1e999 3", "x.obj:16:5: \"1e999\": numbers must be finite"),
        ("v 1 2 3 0.5\nf 1 2 7", "x.obj:16:9: weight \"0.5\": vertices of a cage have weight 1"),
        ("f 1 2", "x.obj:16:1: a face has 2 corners: it needs 3 or more"),
        ("f 1 2 0", "x.obj:16:7: index 0: indices count from 1"),
        ("f 1 2 -9", "x.obj:16:7: vertex -9: only 6 vertices come before"),
        ("f 1 2 99", "x.obj:16:7: vertex 99: the file has only 6"),
        ("f 1 2 /3", "x.obj:16:7: \"/3\" is not a corner: v, v/vt, v//vn or v/vt/vn"),
        ("f 1 2 3/1/1/1", "x.obj:16:7: \"3/1/1/1\" has 4 indices: at most 3"),
        (
            "f 1 2 99999999999999999999",
            "x.obj:16:7: vertex 99999999999999999999: the file has only 6",
        ),
        (
            "f 1 2 -99999999999999999999//1",
            "x.obj:16:7: vertex -99999999999999999999: only 6 vertices come before",
        ),
        ("f 1 7 2\nf 1 8/9 7\nv 0 0 0", "x.obj:17:5: vertex 8: the file has only 7"),
        ("f 1 2 3.5", "x.obj:16:7: \"3.5\" is not a corner: v, v/vt, v//vn or v/vt/vn"),
        (
            "f 1 2 1 4",
            "x.obj:16:1: face 2 names vertex 0 twice: its corners must differ (counted from 0)",
        ),
        (
            "f 1 2 6",
            "x.obj:16:1: faces 0 and 2 both run from vertex 0 to vertex 1: one of them is inside out (counted from 0)",
        ),
        (
            "f 4 3 2 1",
            "x.obj:16:1: faces 0 and 2 have the same vertices: they would cover each other (counted from 0)",
        ),
        ("t corner 1/1/0 6 1\nv 7 7 7", "x.obj:17:1: vertex 6 belongs to no face (counted from 0)"),
        ("hello", "x.obj:16:1: unknown statement \"hello\""),
        ("t crease", "x.obj:16:1: a tag needs a name and counts, as in t crease 2/1/0 0 1 2.5"),
        ("t crease 2/1 0 1 1", "x.obj:16:10: \"2/1\" is no count of values like 2/1/0"),
        ("t crease 2/1/0 0 1", "x.obj:16:10: 2 values follow the counts \"2/1/0\", which need 3"),
        (
            "t crease 2/1/0 0 9 1",
            "x.obj:16:16: crease 0: there is no edge between vertices 0 and 9 (counted from 0)",
        ),
        ("t crease 2/1/0 0 1 -1", "x.obj:16:20: \"-1\" is not a sharpness from 0 on"),
        (
            "t corner 1/1/0 77 1",
            "x.obj:16:16: corner 0 names vertex 77, but there are only 6 vertices (counted from 0)",
        ),
        (
            "t interpolateboundary 1/0/0 0",
            "x.obj:16:29: interpolateboundary \"0\": 1 (edges and corners) or 2 (edges only) is needed",
        ),
        (
            "t wave 0/0/0",
            "x.obj:16:3: tag \"wave\" is not understood: crease, corner, interpolateboundary and creasemethod are",
        ),
        (
            "t creasemethod 0/0/1 chaikin",
            "x.obj:16:22: creasemethod \"chaikin\": normal or uniform is needed",
        ),
    ];
    for (line, message) in lines {
        assert_eq!(error(&format!("{SQUARES}{line}\n")), message, "{line}");
    }
    let long = error(&"\u{7}".repeat(1000));
    assert!(long.starts_with("x.obj:1:1: unknown statement \"\\u{7}") && long.len() < 300);
    assert_eq!(error(""), "x.obj: the file has no faces: it is no cage");
}

#[test]
fn free_form_surfaces_are_named_where_they_begin() {
    let unread = "free-form (NURBS) curves and surfaces in OBJ are not read yet";
    let surface = "v 0 0 0\nv 1 0 0 W\nv 0 1 0\nv 1 1 1\ncstype bspline\ndeg 1 1\n\
        surf 0 1 0 1 1 2 3 4\nparm u 0 0 1 1\nparm v 0 0 1 1\nend\n";
    for weight in ["7.6", ""] {
        // Alone it is an error; beside a sound cage the cage is shown.
        let surface = surface.replace('W', weight);
        assert_eq!(
            error(&surface),
            format!("x.obj:5:1: statement \"cstype\": {unread}; cages, made of faces, are")
        );
        let model = read_obj_cage(&format!("{SQUARES}{surface}"), "x").unwrap();
        assert_eq!((model.cage.face_count(), model.cage.positions().len()), (2, 6));
        let notes: Vec<String> = model.notes.iter().map(ToString::to_string).collect();
        let unused = "x:16:1: statement \"v\", 4 times: a vertex of no face is not used";
        assert_eq!(notes[6..8], [unused, &format!("x:20:1: statement \"cstype\", once: {unread}")]);
    }
    for old in ["bsp", "bzp", "cdc", "cdp", "res"] {
        let said = error(&format!("v 0 0 0\n{old} 1 2 3\n"));
        assert!(said.starts_with(&format!("x.obj:2:1: statement \"{old}\": {unread}")), "{said}");
    }
    let curve = "vp 0 1\ncstype rat bezier\ndeg 1\ncurv2 -1 -1\nend\n";
    assert!(error(curve).starts_with(&format!("x.obj:1:1: statement \"vp\": {unread}")));
    // A sound cage is shown, and the statements beside it are noted.
    let model = read_obj_cage(&format!("{SQUARES}{curve}"), "x").unwrap();
    let notes: Vec<String> = model.notes.iter().map(ToString::to_string).collect();
    assert_eq!(notes.len(), 6 + 5);
    assert_eq!(notes[6], format!("x:16:1: statement \"vp\", once: {unread}"));
    // What is wrong with a cage is not hidden.
    assert!(error(&format!("{SQUARES}{curve}f 1 2 99\n")).contains("vertex 99"));
}

#[test]
fn what_other_programs_leave_behind_is_noted() {
    // Vertices of no face before, between and after the others: faces and tags still name the same
    // vertices.
    let loose =
        "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 8 8 8\nv 1 1 0\nv 0 1 0\nv 7 7 7 0.5\nv 2 0 0\nv 2 1 0\n";
    let tags = "t crease 2/1/0 2 4 2\nt corner 1/1/0 7 3\n";
    let two = format!("{loose}f 2 3 5 6\nf 3 8 9 5\n{tags}t interpolateboundary 1/0/0 2\n");
    let cage = read_obj_cage(&two, "x").unwrap().cage;
    let place = |vertex: u32| cage.positions()[vertex as usize];
    let at = |x: f64, y: f64| DVec3::new(x, y, 0.0);
    let corners: Vec<DVec3> = cage.face(1).unwrap().iter().map(|&vertex| place(vertex)).collect();
    assert_eq!(corners, [at(1.0, 0.0), at(2.0, 0.0), at(2.0, 1.0), at(1.0, 1.0)]);
    let sharp = cage.edges().zip(cage.edge_sharpness()).find(|(_, sharp)| **sharp == 2.0);
    assert_eq!(sharp.unwrap().0.map(place), [at(1.0, 0.0), at(1.0, 1.0)]);
    let corner = cage.vertex_sharpness().iter().position(|sharp| *sharp == 3.0);
    assert_eq!(place(corner.unwrap() as u32), at(2.0, 0.0));
    let note = |text: &str| {
        let notes = read_obj_cage(text, "x").unwrap().notes;
        notes.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
    };
    let unused = "a vertex of no face is not used";
    assert_eq!(
        note(&format!("{loose}f 2 3 5 6\n")),
        format!("x:1:1: statement \"v\", 5 times: {unused}")
    );
    // Errors tell vertices and faces by the numbers they have in the file.
    for (rest, message) in [
        (
            "f 2 2 3\nf 2 3 5 6\nf 2 3 6\n",
            "x.obj:12:1: faces 1 and 2 both run from vertex 1 to vertex 2: one of them is inside out (counted from 0)",
        ),
        (
            "f 2 3 5 6\nt corner 1/1/0 99 1\n",
            "x.obj:11:16: corner 0 names vertex 99, but there are only 9 vertices (counted from 0)",
        ),
        ("f 2 3 5 99\n", "x.obj:10:9: vertex 99: the file has only 9"),
        ("f 2 3 5 6\nf 2 2 99\n", "x.obj:11:7: vertex 99: the file has only 9"),
    ] {
        assert_eq!(error(&format!("{loose}{rest}")), message, "{rest}");
    }

    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    assert_eq!(
        note(&format!("{square}f 1 2 3\nf 1/ 3// 4/ 4/ 1/\nf 1 1 2 2\nfo 2 2 3\n")),
        "x:6:1: statement \"f\", once: a corner repeated in a row counts once\n\
         x:7:1: statement \"f\", 2 times: a face of fewer than three corners is not used"
    );
    // Two squares with corners of their own, one of them at −0.
    let twice = format!("{square}f 1 2 3 4\nv 1 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 -0.0\nf 5 6 7 8\n");
    assert_eq!(
        note(&twice),
        "x:6:1: statement \"v\", 2 times: another vertex lies at the same place: the surface ends there, or has a \
         seam of its own"
    );
    assert_eq!(
        error(&format!("{square}f 1 1 2 2\n")),
        "x.obj: no face of the file has three different corners: it is no cage"
    );
    assert!(
        note(&format!("{square}f 1 2 3 4\ncall other.obj\n")).contains("no other file is read")
    );
}

#[test]
fn mangled_files_are_read_or_refused_with_a_place() {
    let tagged = format!("{SQUARES}t crease 2/1/0 1 2 2.5\n");
    let mut refused = 0;
    for cut in 0..tagged.len() {
        for other in ["-", "9", "/", "\\", "e", "\n"] {
            let mangled = format!("{}{other}{}", &tagged[..cut], &tagged[cut + 1..]);
            for text in [&tagged[..cut], &mangled] {
                let Err(error) = read_obj_cage(text, "mangled") else { continue };
                let message = error.to_string();
                assert!(message.starts_with("mangled:"), "{message}");
                refused += 1;
            }
        }
    }
    assert!(refused > tagged.len(), "{refused}");
}

#[test]
fn a_cage_from_a_file_has_a_surface() {
    let cage = read_obj_cage(SQUARES, "x").unwrap().cage;
    let limit = cage.catmull_clark(1e-3).unwrap();
    assert_eq!((limit.patches().len(), limit.exact_count()), (2, 2));
    // The border interpolates the corner of a single face.
    assert_eq!(limit.control(0).unwrap()[0], DVec3::ZERO);
}
