//! What a file says of its own contents: `count` and `type`. What is there is read either way; where
//! it is not what the file says, somebody has lost or mixed up a part of it, and a note says so.

use serde_json::value::RawValue;

use super::{Raw, Reader, ShapeKeys};
use crate::math::Counted;
use crate::scene::ImportNote;

impl<'a> Reader<'a> {
    /// Notes what `shape` says that is not so; its `data`, read by now, has this many entries.
    pub(super) fn note_false_claims(&mut self, keys: &ShapeKeys<'a>, entries: usize) {
        if let Some(count) = keys.count.filter(|count| !counts(count, entries)) {
            let said = count.get();
            let said = if said.parse::<f64>().is_ok() { said } else { "no number" };
            let entries = match entries {
                1 => "1 entry".to_owned(),
                _ => format!("{entries} entries"),
            };
            self.note_claim("count", count, format!("it is {said}, but \"data\" has {entries}"));
        }
        let surfaces = self.model.parts.len();
        if let Some(kind) = keys.kind.filter(|kind| !is_text(kind, "surface") && surfaces > 0) {
            let said = serde_json::from_str::<String>(kind.get())
                .map_or_else(|_| "no text".to_owned(), |said| format!("{said:?}"));
            let surfaces = Counted(surfaces, "surface");
            self.note_claim("type", kind, format!("it is {said}, but \"data\" has {surfaces}"));
        }
    }

    fn note_claim(&mut self, key: &str, value: &'a RawValue, why: String) {
        let what = format!("key \"{key}\"");
        self.model.notes.push(ImportNote { place: self.place(value), what, why });
    }
}

/// Whether a count, if there is one, is not this number.
pub(super) fn miscounts(count: Raw<'_>, entries: usize) -> bool {
    count.is_some_and(|count| !counts(count, entries))
}

/// Whether a type, if there is one, is not this one.
pub(super) fn mistypes(kind: Raw<'_>, wanted: &str) -> bool {
    kind.is_some_and(|kind| !is_text(kind, wanted))
}

fn counts(count: &RawValue, entries: usize) -> bool {
    count.get().parse::<f64>().is_ok_and(|count| count == entries as f64)
}

fn is_text(value: &RawValue, wanted: &str) -> bool {
    serde_json::from_str::<String>(value.get()).is_ok_and(|text| text == wanted)
}
