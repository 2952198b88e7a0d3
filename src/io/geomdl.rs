//! Models as JSON, in the layout of geomdl (NURBS-Python).
//!
//! ```json
//! {
//!   "shape": {
//!     "type": "surface",
//!     "data": [
//!       {
//!         "name": "lid",
//!         "degree_u": 1, "degree_v": 1,
//!         "knotvector_u": [0, 0, 1, 1], "knotvector_v": [0, 0, 1, 1],
//!         "size_u": 2, "size_v": 2,
//!         "control_points": {
//!           "points": [[0, 0, 0], [0, 1, 0], [1, 0, 0], [1, 1, 1]],
//!           "weights": [1, 1, 1, 1]
//!         }
//!       }
//!     ]
//!   }
//! }
//! ```
//!
//! Points are Euclidean (not multiplied by their weights), v fastest; weights may be left out, and
//! are used whatever `rational` says (a note tells if it is false though they differ). The reader
//! also takes `data` as a single object, a surface without anything around it, and the flat variant
//! `{"surfaces": [{…, "control_points": [[x, y, z], …], "weights": […]}]}`.
//!
//! What is done with the rest:
//!
//! | key | |
//! |---|---|
//! | `name` | names the surface; others are called by their index in `data` |
//! | `trims` | cut the surface, see below |
//! | `reversed` | not applied: (u, v) and `S_u × S_v` stay as written, and a note says so |
//! | `order`, of the file or of a surface | must begin with `v fastest`, else an error |
//! | `count`, and `type` of `shape` and of trim curves | not used: what is there is read, and a note says where it is not what these say |
//! | `rational` | not used: a note says where it is false though weights differ |
//! | `type` of a surface, `id`, `delta`, `dimension` | not used: what geomdl writes there changes no surface |
//! | any other | not used, and a note a key says so |
//!
//! Each entry of `trims` (`{"count": …, "data": […]}`) is a closed loop in the surface's (u, v): a
//! `spline`, a `freeform` polygon, or a `container` of such curves one after another. As in
//! geomdl, the region inside a loop is cut off, or kept if the loop is `reversed`; without reversed
//! loops the border of the domain is the outline. Loops must be nested so that holes lie in kept
//! regions, and islands in holes.
//!
//! In code, [`Net::surface`](crate::scene::Net::surface) makes a surface of the numbers that were
//! read. [`load_input`](super::load_input) reads a file, and
//! [`Scene::surfaces`](crate::scene::Scene::surfaces) makes all of its surfaces, with their trims.
//!
//! Curves, volumes, free-form point lists and points of two coordinates are not surfaces in
//! space: each is left out with a note.

mod claims;
mod points;
mod trims;
mod unknown;

use std::sync::Arc;

use serde::Deserialize;
use serde_json::value::RawValue;

use self::points::Points;
use self::unknown::{DOCUMENT, SURFACE, Unknown};
use super::LoadError;
use super::keyed::Keyed;
use super::message::explain;
use super::source::Source;
use crate::geometry::is_usable_weight;
use crate::math::Counted;
use crate::scene::{ImportNote, Knots, Net, Part, Place, Shape, Written};

/// The surfaces of a model file, and what else it holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Model {
    /// The surfaces, in the order of the file.
    pub parts: Vec<Part>,
    /// What is not shown, and why.
    pub notes: Vec<ImportNote>,
}

/// Reads a geomdl JSON model. Errors and notes call the file `label`, and a surface by `called`,
/// the name of its object, followed by its own name, as a world does.
///
/// [`World::new`](crate::scene::World::new) checks whether the numbers make surfaces.
///
/// # Errors
/// When the text is not JSON, or does not have the layout above.
pub fn read_geomdl(text: &str, label: &str, called: &str) -> Result<Model, LoadError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let source = Source::new(text, label);
    let unknown = Unknown::default();
    let mut reader = Reader { source, called, model: Model::default(), unknown };
    reader.document()?;
    reader.note_unknown();
    Ok(reader.model)
}

/// A piece of JSON not parsed yet.
type Raw<'a> = Option<&'a RawValue>;

#[derive(Deserialize)]
struct Document<'a> {
    #[serde(borrow)]
    shape: Raw<'a>,
    #[serde(borrow)]
    surfaces: Raw<'a>,
    #[serde(borrow)]
    order: Raw<'a>,
    #[serde(borrow)]
    degree_u: Raw<'a>,
}

#[derive(Deserialize)]
struct ShapeKeys<'a> {
    #[serde(borrow, rename = "type")]
    kind: Raw<'a>,
    #[serde(borrow)]
    count: Raw<'a>,
    #[serde(borrow)]
    data: Raw<'a>,
    #[serde(borrow)]
    order: Raw<'a>,
}

/// One entry of `data`: all keys optional, so that curves and volumes can be told apart.
#[derive(Deserialize)]
struct Item<'a> {
    #[serde(borrow)]
    name: Raw<'a>,
    #[serde(borrow)]
    degree: Raw<'a>,
    #[serde(borrow)]
    degree_u: Raw<'a>,
    #[serde(borrow)]
    degree_v: Raw<'a>,
    #[serde(borrow)]
    degree_w: Raw<'a>,
    #[serde(borrow)]
    knotvector_u: Raw<'a>,
    #[serde(borrow)]
    knotvector_v: Raw<'a>,
    #[serde(borrow)]
    size_u: Raw<'a>,
    #[serde(borrow)]
    size_v: Raw<'a>,
    #[serde(borrow)]
    control_points: Raw<'a>,
    #[serde(borrow)]
    points: Raw<'a>,
    #[serde(borrow)]
    weights: Raw<'a>,
    #[serde(borrow)]
    trims: Raw<'a>,
    #[serde(borrow)]
    rational: Raw<'a>,
    #[serde(borrow)]
    reversed: Raw<'a>,
    #[serde(borrow)]
    order: Raw<'a>,
}

#[derive(Deserialize)]
struct ControlPoints<'a> {
    #[serde(borrow)]
    points: Raw<'a>,
    #[serde(borrow)]
    weights: Raw<'a>,
}

struct Reader<'a> {
    source: Source<'a>,
    called: &'a str,
    model: Model,
    unknown: Unknown,
}

/// An entry of the file and what to call it.
struct Entry<'a> {
    item: Item<'a>,
    place: Place,
    label: String,
}

impl Entry<'_> {
    fn malformed(&self, place: Place, message: &str) -> LoadError {
        LoadError::malformed(place, format!("surface \"{}\": {message}", self.label))
    }
}

impl<'a> Reader<'a> {
    fn document(&mut self) -> Result<(), LoadError> {
        let text = self.source.text();
        if text.trim().is_empty() {
            return Err(LoadError::malformed(self.source.file().clone(), "the file is empty"));
        }
        let Keyed(document): Keyed<Document<'a>> = self.parse(text)?;
        self.check_order(document.order)?;
        let mut lists = Vec::new();
        if let Some(shape) = document.shape {
            let Keyed(keys): Keyed<ShapeKeys<'a>> = self.parse(shape.get())?;
            self.check_order(keys.order)?;
            let data = keys.data.ok_or_else(|| {
                LoadError::malformed(self.place(shape), "shape: missing key \"data\"")
            })?;
            lists.push((data.get(), Some(keys)));
        }
        lists.extend(document.surfaces.map(|surfaces| (surfaces.get(), None)));
        if lists.is_empty() && document.degree_u.is_some() {
            lists.push((text.trim(), None)); // a surface without anything around it
        } else {
            self.look_for_unknown(text, &DOCUMENT)?;
        }
        if lists.is_empty() {
            let message = "neither \"shape\" nor \"surfaces\" is here: \
                           it is no geomdl JSON model";
            return Err(LoadError::malformed(self.source.file().clone(), message));
        }
        for (list, shape) in lists {
            let entries = self.items(list)?;
            if let Some(keys) = shape {
                self.note_false_claims(&keys, entries); // the first list: all parts are its own
            }
        }
        Ok(())
    }

    /// Whether a key holds text, if it is there.
    fn is_text(&self, written: Raw<'a>) -> bool {
        written.is_none_or(|raw| raw.get().starts_with('"'))
    }

    /// Points are read v fastest: an `order` that says otherwise is refused.
    fn check_order(&self, written: Raw<'a>) -> Result<(), LoadError> {
        let Some(raw) = written else { return Ok(()) };
        let order: String = self.parse(raw.get())?;
        if order.starts_with("v fastest") {
            return Ok(());
        }
        let message = format!("order \"{order}\": only points written v fastest can be read");
        Err(LoadError::malformed(self.place(raw), message))
    }

    /// Reads a list of entries, or a single one; returns how many they are.
    fn items(&mut self, list: &'a str) -> Result<usize, LoadError> {
        if !list.starts_with('[') {
            self.entry(list, None)?;
            return Ok(1);
        }
        let items: Vec<&'a RawValue> = self.parse(list)?;
        let count = items.len();
        for (index, raw) in items.into_iter().enumerate() {
            self.entry(raw.get(), if count == 1 { None } else { Some(index) })?;
        }
        Ok(count)
    }

    fn entry(&mut self, raw: &'a str, index: Option<usize>) -> Result<(), LoadError> {
        let Keyed(item): Keyed<Item<'a>> = self.parse(raw)?;
        let place = self.source.place(self.source.offset_of(raw));
        let name = item.name.and_then(|raw| serde_json::from_str::<String>(raw.get()).ok());
        // A name stays on its line, whatever a program has put into it.
        let name = name.map(|name| name.replace(char::is_control, "\u{fffd}"));
        let name = name.filter(|name| !name.is_empty());
        let part_name = name.or_else(|| index.map(|index| index.to_string())).unwrap_or_default();
        let label = match part_name.as_str() {
            "" => self.called.to_owned(),
            part => format!("{}/{part}", self.called),
        };
        let entry = Entry { item, place, label };

        if let Some((what, why)) = no_surface(&entry.item) {
            self.note(&entry, what, why.to_owned());
            return Ok(());
        }
        if self.is_text(entry.item.order) {
            self.check_order(entry.item.order)?;
        } else {
            self.note(
                &entry,
                "surface",
                "\"order\" left out: it does not say what runs fastest".to_owned(),
            );
        }
        let Some(net) = self.net(&entry)? else { return Ok(()) };
        self.note_ignored(&entry);
        let trims = self.trims(&entry)?;
        self.look_for_unknown(raw, &SURFACE)?;
        let shape = Shape::Net(Arc::new(net));
        self.model.parts.push(Part { name: part_name, place: entry.place, shape, trims });
        Ok(())
    }

    /// The control net of an entry; `None`, with a note, for points in the plane.
    fn net(&mut self, entry: &Entry<'a>) -> Result<Option<Net>, LoadError> {
        let item = &entry.item;
        let degree = [
            self.needed(entry, "degree_u", item.degree_u)?,
            self.needed(entry, "degree_v", item.degree_v)?,
        ];
        let size: [usize; 2] = [
            self.needed(entry, "size_u", item.size_u)?.value,
            self.needed(entry, "size_v", item.size_v)?.value,
        ];
        let knots = [
            self.needed(entry, "knotvector_u", item.knotvector_u)?,
            self.needed(entry, "knotvector_v", item.knotvector_v)?,
        ];
        let knots = knots.map(|knots| Written::new(Knots::Values(knots.value), knots.place));

        let control: Written<&RawValue> =
            self.needed(entry, "control_points", item.control_points)?;
        let (points, weights, unused) = self.control(control.value, item.weights)?;
        if let Some(unused) = unused {
            self.note(entry, "surface", unused.to_owned());
        }
        let points: Written<Points> = self.needed(entry, "points", points)?;
        if let (Some(first), Some((index, dimension))) = (points.value.dimension, points.value.odd)
        {
            let coordinates = Counted(dimension, "coordinate");
            let message = format!("point {index} has {coordinates}, but point 0 has {first}");
            return Err(entry.malformed(points.place, &message));
        }
        match points.value.dimension {
            Some(2) => {
                let why = "its points have 2 coordinates, surfaces in space need 3".to_owned();
                self.note(entry, "surface", why);
                return Ok(None);
            }
            None | Some(3) => {} // an empty list has too few points, which is reported elsewhere
            Some(other) => {
                let weighted = ": weights stand in a list of their own, \"weights\", and points are \
                                not multiplied by them";
                let hint = if other == 4 { weighted } else { "" };
                let coordinates = Counted(other, "coordinate");
                let message = format!("its points have {coordinates}, needed are 3{hint}");
                return Err(entry.malformed(points.place, &message));
            }
        }
        let ([nu, nv], given) = (size, points.value.points.len());
        if nu.checked_mul(nv) != Some(given) {
            let given = Counted(given, "point");
            let message = format!("size_u × size_v is {nu} × {nv}, but the list has {given}");
            return Err(entry.malformed(points.place, &message));
        }
        let points = Written::new(points.value.points, points.place);
        let weights = weights.map(|raw| self.weights(raw)).transpose()?;
        let differ = |weights: &[f64]| weights.iter().any(|weight| *weight != weights[0]);
        let is_weighted = weights.as_ref().is_some_and(|weights| differ(&weights.value));
        if is_weighted && item.rational.is_some() && !is_set(item.rational) {
            let why = "\"rational\" is false, but its weights differ: they are used";
            self.note(entry, "surface", why.to_owned());
        }
        Ok(Some(Net { degree, knots, size, points, weights }))
    }

    /// The weights; their place is that of the first unusable one, if there is one.
    fn weights(&self, raw: &'a RawValue) -> Result<Written<Vec<f64>>, LoadError> {
        let weights: Vec<f64> = self.parse(raw.get())?;
        let unusable = weights.iter().position(|&weight| !is_usable_weight(weight));
        let place = match unusable {
            None => self.place(raw),
            Some(index) => {
                let each: Vec<&RawValue> = self.parse(raw.get())?;
                self.place(each.get(index).copied().unwrap_or(raw))
            }
        };
        Ok(Written::new(weights, place))
    }

    /// Points and weights: either `{"points": …, "weights": …}`, or the points themselves and
    /// weights beside them. The last item is the note for weights given in both places.
    fn control(
        &self,
        control: &'a RawValue,
        beside: Raw<'a>,
    ) -> Result<(Raw<'a>, Raw<'a>, Option<&'static str>), LoadError> {
        if !control.get().starts_with('{') {
            return Ok((Some(control), beside, None));
        }
        let Keyed(keys): Keyed<ControlPoints<'a>> = self.parse(control.get())?;
        let twice = keys.weights.is_some() && beside.is_some();
        let unused = twice.then_some("\"weights\" left out: those of \"control_points\" are used");
        Ok((keys.points, keys.weights.or(beside), unused))
    }

    /// Notes what the file asks for a surface but is not done.
    fn note_ignored(&mut self, entry: &Entry<'a>) {
        if is_set(entry.item.reversed) {
            let why = "\"reversed\" left out: (u, v) and the normal stay as written; \
                       reverse = true in a scene turns all surfaces of the file";
            self.note(entry, "surface", why.to_owned());
        }
    }

    fn note(&mut self, entry: &Entry<'a>, what: &str, why: String) {
        let what = format!("{what} \"{}\"", entry.label);
        self.model.notes.push(ImportNote { place: entry.place.clone(), what, why });
    }

    fn place(&self, raw: &'a RawValue) -> Place {
        self.source.place(self.source.offset_of(raw.get()))
    }

    /// The value of a key that must be there.
    fn needed<T: Deserialize<'a>>(
        &self,
        entry: &Entry<'a>,
        key: &str,
        raw: Raw<'a>,
    ) -> Result<Written<T>, LoadError> {
        let raw = raw.ok_or_else(|| {
            entry.malformed(entry.place.clone(), &format!("missing key \"{key}\""))
        })?;
        Ok(Written::new(self.parse(raw.get())?, self.place(raw)))
    }

    /// Reads a part of the text; errors name their place in the whole.
    fn parse<T: Deserialize<'a>>(&self, part: &'a str) -> Result<T, LoadError> {
        serde_json::from_str(part).map_err(|error| self.unreadable(part, &error))
    }

    fn unreadable(&self, part: &str, error: &serde_json::Error) -> LoadError {
        // A value that is neither a list nor an object is wrong as a whole: the place is its
        // beginning.
        let inside = if part.starts_with(['[', '{']) { offset_of(error, part) } else { 0 };
        let offset = self.source.offset_of(part) + inside;
        let text = self.source.text();
        // The complaint is about the byte there or, within a number, the one before.
        let around = [1, 0].map(|back| text.get(offset.saturating_sub(back)..).unwrap_or(""));
        LoadError::malformed(self.source.place(offset), message(error, around))
    }
}

/// Returns what an entry is and why it is not shown, if it is not a surface.
fn no_surface(item: &Item<'_>) -> Option<(&'static str, &'static str)> {
    if item.degree_w.is_some() {
        return Some(("volume", "volumes are not supported"));
    }
    if item.degree_u.is_some() || item.degree_v.is_some() {
        return None;
    }
    let is_net = item.size_u.is_some() || item.knotvector_u.is_some();
    if item.degree.is_some() && !is_net {
        return Some(("curve", "a curve has no surface to show"));
    }
    let free_form = item.points.is_some() && item.control_points.is_none();
    free_form.then_some(("free-form points", "points alone are no surface"))
}

/// Whether a mark is present and not false.
fn is_set(mark: Raw<'_>) -> bool {
    mark.is_some_and(|mark| !["false", "0", "0.0"].contains(&mark.get()))
}

/// The byte at which an error was noticed.
fn offset_of(error: &serde_json::Error, text: &str) -> usize {
    let lines = text.split_inclusive('\n').take(error.line().saturating_sub(1));
    lines.map(str::len).sum::<usize>() + error.column().saturating_sub(1)
}

/// The message of serde_json without its place, which is counted within a part of the file.
fn message(error: &serde_json::Error, around: [&str; 2]) -> String {
    let whole = error.to_string();
    let said = whole.rsplit_once(" at line ").map_or(whole.as_str(), |(said, _)| said);
    if let Some(inside) = said.strip_prefix("EOF while parsing ") {
        return format!("the file ends inside {inside}: it is not complete");
    }
    for word in ["-Infinity", "Infinity", "NaN"] {
        if around.iter().any(|text| text.starts_with(word)) {
            return format!("{word} is not a number JSON knows: numbers must be finite");
        }
    }
    // Depending on what is read, one more comma in a list is a value that is missing.
    let [_, here] = around;
    if said == "trailing comma" || (said == "expected value" && here.starts_with([']', '}'])) {
        return "found a closing bracket, needed a value before it: a comma too many?".to_owned();
    }
    match said {
        "expected value" | "expected ident" => "this is no JSON".to_owned(),
        "key must be a string" => "a key must be in double quotes".to_owned(),
        "trailing characters" => "the model ends before this".to_owned(),
        "number out of range" => "the number is too large: numbers must be finite".to_owned(),
        _ => explain(said, "").replace("a table", "an object"),
    }
}

#[cfg(test)]
mod tests;
