//! Knots, listed or by name.

use std::fmt;

use serde::Deserialize;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Deserializer, Error, MapAccess, SeqAccess, Visitor};

use super::values::{Loose, Number, loosely};
use crate::math::Shown;
use crate::scene::Knots;

/// `[0, 0, 1, 1]`; `[[0, 2], [1, 2]]` as value and multiplicity; a name; or
/// `{ periodic = [0, 1, 2, 3] }`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct KnotList(pub(super) Knots);

/// The ways to write knots, for messages.
const KINDS: &str =
    "a list of knots, \"clamped\", \"standard\", \"uniform\", \"periodic\" or { periodic = [...] }";

impl<'de> Deserialize<'de> for KnotList {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Visit)
    }
}

struct Visit;

impl<'de> Visitor<'de> for Visit {
    type Value = KnotList;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(KINDS)
    }

    fn visit_str<E: Error>(self, name: &str) -> Result<KnotList, E> {
        match name {
            "clamped" => Ok(KnotList(Knots::ClampedUniform)),
            "standard" => Ok(KnotList(Knots::Standard)),
            "uniform" => Ok(KnotList(Knots::Uniform)),
            "periodic" => Ok(KnotList(Knots::PeriodicUniform)),
            _ => Err(E::custom(format!("found \"{}\", needed {KINDS}", name.escape_debug()))),
        }
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<KnotList, A::Error> {
        let PeriodKeys { periodic } = Deserialize::deserialize(MapAccessDeserializer::new(map))?;
        Ok(KnotList(Knots::Periodic(periodic.into_iter().map(|knot| knot.0).collect())))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<KnotList, A::Error> {
        let entries = Vec::<KnotEntry>::deserialize(SeqAccessDeserializer::new(list))?;
        if entries.iter().all(|entry| matches!(entry, KnotEntry::Pair(..))) && !entries.is_empty() {
            let pairs = entries.iter().map(|entry| entry.pair()).collect();
            return Ok(KnotList(Knots::Multiplicities(pairs)));
        }
        let values: Option<_> = entries.iter().map(KnotEntry::single).collect();
        values.map(Knots::Values).map(KnotList).ok_or_else(|| {
            A::Error::custom("knots are listed either all as numbers or all as [knot, times]")
        })
    }
}

/// The table `{ periodic = […] }` with the knots of one period.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PeriodKeys {
    periodic: Vec<Number>,
}

/// An entry of a list of knots.
#[derive(Clone, Copy, Debug)]
enum KnotEntry {
    Single(f64),
    Pair(f64, usize),
}

impl KnotEntry {
    fn single(&self) -> Option<f64> {
        match *self {
            Self::Single(knot) => Some(knot),
            Self::Pair(..) => None,
        }
    }

    fn pair(&self) -> (f64, usize) {
        match *self {
            Self::Single(knot) => (knot, 1),
            Self::Pair(knot, times) => (knot, times),
        }
    }
}

impl TryFrom<Loose> for KnotEntry {
    type Error = String;

    fn try_from(value: Loose) -> Result<Self, String> {
        match &value {
            Loose::Number(knot) => Ok(Self::Single(*knot)),
            Loose::List(list) => match *list.as_slice() {
                // `as` saturates: an absurd multiplicity stays absurd and is refused later.
                [knot, times] if times.fract() == 0.0 && times >= 0.0 => {
                    Ok(Self::Pair(knot, times as usize))
                }
                [_, times] => {
                    let times = Shown(times);
                    Err(format!(
                        "found {times} as the times of a knot, needed [knot, times] with a whole \
                         number from 1 on"
                    ))
                }
                _ => Err(value.but_needed("a knot, or [knot, times]")),
            },
            Loose::Text(_) | Loose::Lists => Err(value.but_needed("a knot, or [knot, times]")),
        }
    }
}

impl<'de> Deserialize<'de> for KnotEntry {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        loosely(deserializer)
    }
}
