//! Keys that the reader does not know: nothing in a file is left out without a note.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::fmt;

use serde::de::{DeserializeSeed, Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde_json::value::RawValue;

use super::{LoadError, Reader};
use crate::scene::{ImportNote, nearest};

/// The keys of an object, or of each object of a list.
pub(super) struct Keys {
    /// Keys that are read, and those that change no surface.
    known: &'static [&'static [&'static str]],
    /// Keys that hold objects to look into, and the keys of these.
    inner: &'static [(&'static str, &'static Keys)],
}

/// The outermost object of a file. Its surfaces are looked into one by one.
pub(super) const DOCUMENT: Keys =
    Keys { known: &[&["shape", "surfaces", "order"]], inner: &[("shape", &SHAPE)] };

const SHAPE: Keys = Keys { known: &[&["type", "count", "data", "order"]], inner: &[] };

/// A surface within a file.
pub(super) const SURFACE: Keys = Keys { known: &[SPLINE, NET, &["order"]], inner: SURFACE_INNER };

const SURFACE_INNER: &[(&str, &Keys)] = &[("control_points", &CONTROL_POINTS), ("trims", &TRIMS)];

/// What surfaces and curves have in common.
const SPLINE: &[&str] = &[
    "type",
    "name",
    "id",
    "rational",
    "dimension",
    "delta",
    "count",
    "reversed",
    "control_points",
    "weights",
];

const NET: &[&str] =
    &["degree_u", "degree_v", "knotvector_u", "knotvector_v", "size_u", "size_v", "trims"];

const CONTROL_POINTS: Keys = Keys { known: &[&["points", "weights"]], inner: &[] };

/// `{"count": …, "data": […]}` with loops, or a loop of the list alone.
const TRIMS: Keys = Keys {
    known: &[SPLINE, CURVE_OR_LOOP],
    inner: &[("control_points", &CONTROL_POINTS), ("data", &LOOP)],
};

const LOOP: Keys = Keys {
    known: &[SPLINE, CURVE_OR_LOOP],
    inner: &[("control_points", &CONTROL_POINTS), ("data", &CURVE)],
};

const CURVE: Keys = Keys {
    known: &[SPLINE, &["degree", "knotvector", "points"]],
    inner: &[("control_points", &CONTROL_POINTS)],
};

const CURVE_OR_LOOP: &[&str] = &["degree", "knotvector", "points", "data"];

impl Keys {
    fn knows(&self, key: &str) -> bool {
        self.known.iter().any(|list| list.contains(&key))
    }

    /// The known key that was perhaps meant.
    fn nearest(&self, key: &str) -> Option<&'static str> {
        nearest(key, &self.known.concat())
    }
}

/// Unknown keys: the offset of the first value of each, how often it occurs, and the key meant.
pub(super) type Unknown = BTreeMap<String, (usize, usize, Option<&'static str>)>;

impl<'a> Reader<'a> {
    /// Remembers the keys within an object that are not known there.
    pub(super) fn look_for_unknown(
        &mut self,
        object: &'a str,
        keys: &'static Keys,
    ) -> Result<(), LoadError> {
        let mut found = Vec::new();
        let mut json = serde_json::Deserializer::from_str(object);
        let walked = Walk { keys, found: &mut found }.deserialize(&mut json);
        walked.map_err(|error| self.unreadable(object, &error))?;
        for (key, value, keys) in found {
            let first = match self.unknown.entry(key) {
                Entry::Occupied(known) => known.into_mut(),
                Entry::Vacant(new) => {
                    let meant = keys.nearest(new.key());
                    new.insert((self.source.offset_of(value), 0, meant))
                }
            };
            first.1 += 1;
        }
        Ok(())
    }

    /// One note for each unknown key, in the order of the file.
    pub(super) fn note_unknown(&mut self) {
        let mut unknown: Vec<_> = std::mem::take(&mut self.unknown).into_iter().collect();
        unknown.sort_by_key(|(_, (offset, ..))| *offset);
        for (key, (offset, count, meant)) in unknown {
            let times = if count == 1 { "once" } else { &format!("{count} times") };
            let meant = meant.map(|meant| format!("; did you mean \"{meant}\"?"));
            self.model.notes.push(ImportNote {
                place: self.source.place(offset),
                what: format!("key \"{}\", {times}", key.escape_debug()),
                why: format!("no such key is known here{}", meant.unwrap_or_default()),
            });
        }
    }
}

/// A walk through objects and lists.
struct Walk<'f, 'a> {
    keys: &'static Keys,
    /// Unknown keys, their values, and the keys known there.
    found: &'f mut Vec<(String, &'a str, &'static Keys)>,
}

impl<'de> DeserializeSeed<'de> for Walk<'_, 'de> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Walk<'_, 'de> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object or a list")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        while let Some(key) = map.next_key::<String>()? {
            if let Some((_, keys)) = self.keys.inner.iter().find(|(known, _)| *known == key) {
                map.next_value_seed(Walk { keys, found: self.found })?;
            } else if self.keys.knows(&key) {
                map.next_value::<IgnoredAny>()?;
            } else {
                self.found.push((key, map.next_value::<&RawValue>()?.get(), self.keys));
            }
        }
        Ok(())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<(), A::Error> {
        while list.next_element_seed(Walk { keys: self.keys, found: self.found })?.is_some() {}
        Ok(())
    }

    // Numbers, words and the like hold no keys.

    fn visit_unit<E>(self) -> Result<(), E> {
        Ok(())
    }

    fn visit_bool<E>(self, _: bool) -> Result<(), E> {
        Ok(())
    }

    fn visit_f64<E>(self, _: f64) -> Result<(), E> {
        Ok(())
    }

    fn visit_u64<E>(self, _: u64) -> Result<(), E> {
        Ok(())
    }

    fn visit_i64<E>(self, _: i64) -> Result<(), E> {
        Ok(())
    }

    fn visit_str<E>(self, _: &str) -> Result<(), E> {
        Ok(())
    }
}
