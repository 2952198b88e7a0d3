//! The audit's result as a table and as JSON.

use serde_json::{Value, json};

use super::super::table::{count, table};
use super::class::Class;
use super::tally::Tally;

/// The tallies of all classes, to be shown.
#[derive(Debug)]
pub(crate) struct Report {
    rows: Vec<(String, Row)>,
    total: Row,
}

#[derive(Clone, Copy, Debug)]
struct Row {
    rays: u64,
    hits: u64,
    misses: u64,
    wrong_roots: u64,
    false_hits: u64,
    doubtful: u64,
    undecided: u64,
    /// The quantiles of the error that are reported: 50 %, 99 % and the largest.
    errors: [Option<f64>; 3],
}

impl Row {
    fn new(tally: &mut Tally) -> Self {
        Self {
            rays: tally.rays,
            hits: tally.hits,
            misses: tally.misses,
            wrong_roots: tally.wrong_roots,
            false_hits: tally.false_hits,
            doubtful: tally.doubtful,
            undecided: tally.undecided,
            errors: [0.5, 0.99, 1.0].map(|share| tally.error_quantile(share)),
        }
    }

    fn json(&self) -> Value {
        let [error_50, error_99, error_max] = self.errors;
        json!({
            "rays": self.rays,
            "hits": self.hits,
            "misses": self.misses,
            "wrong_roots": self.wrong_roots,
            "false_hits": self.false_hits,
            "doubtful": self.doubtful,
            "undecided": self.undecided,
            "error_50": error_50,
            "error_99": error_99,
            "error_max": error_max,
        })
    }
}

impl Report {
    /// Adds up the classes.
    pub(crate) fn new(classes: Vec<(Class, Tally)>) -> Self {
        let mut total = Tally::default();
        let rows = classes
            .into_iter()
            .map(|(class, mut tally)| {
                let row = Row::new(&mut tally);
                total.merge(tally);
                (class.name(), row)
            })
            .collect();
        Self { rows, total: Row::new(&mut total) }
    }

    /// Misses, wrong roots and false hits of all classes.
    pub(crate) fn faults(&self) -> u64 {
        self.total.misses + self.total.wrong_roots + self.total.false_hits
    }

    /// How the answers without faults stand, in one sentence.
    pub(crate) fn verdict(&self) -> String {
        let Row { rays, doubtful, .. } = self.total;
        let share = 100.0 * doubtful as f64 / rays.max(1) as f64;
        let faults = match self.faults() {
            0 => "no unflagged miss, no wrong root, no false hit; ",
            _ => "",
        };
        format!("{faults}{doubtful} of {} doubtful ({share:.3} %)\n", count(rays, "ray"))
    }

    /// What is at fault, in one sentence; `None` if nothing is.
    pub(crate) fn accusation(&self) -> Option<String> {
        let Row { rays, misses, wrong_roots, false_hits, .. } = self.total;
        (self.faults() > 0).then(|| {
            format!(
                "of {} without doubt: {misses} missed, {wrong_roots} with a wrong root, \
                 {false_hits} with a false hit",
                count(rays, "ray")
            )
        })
    }

    /// `classes`, one object each, and `total`.
    pub(crate) fn json(&self) -> (Value, Value) {
        let classes = self.rows.iter().map(|(name, row)| {
            let mut object = row.json();
            object["class"] = json!(name);
            object
        });
        (classes.collect(), self.total.json())
    }

    /// One line a class and one for all of them.
    pub(crate) fn table(&self) -> String {
        let heading = [
            "class",
            "rays",
            "hits",
            "misses",
            "wrong",
            "false",
            "doubtful",
            "undecided",
            "error 50%",
            "99%",
            "max",
        ];
        let mut lines = vec![heading.map(str::to_owned).to_vec()];
        let total = [("total".to_owned(), self.total)];
        lines.extend(self.rows.iter().chain(&total).map(|(name, row)| {
            let counts = [
                row.rays,
                row.hits,
                row.misses,
                row.wrong_roots,
                row.false_hits,
                row.doubtful,
                row.undecided,
            ];
            let errors = row.errors.map(|error| match error {
                Some(error) => format!("{error:.1e}"),
                None => "-".into(),
            });
            let counts = counts.iter().map(u64::to_string);
            [name.clone()].into_iter().chain(counts).chain(errors).collect()
        }));
        table(&lines, &[0])
    }
}

#[cfg(test)]
mod tests {
    use super::super::judge::{Fault, Finding};
    use super::*;
    use glam::DVec3;
    use nurbray::math::Ray;

    fn report() -> Report {
        let ray = Ray::new(DVec3::ZERO, DVec3::X).unwrap();
        let mut tally = Tally::default();
        tally.add(&ray, Finding { fault: None, error: Some(1.5e-16) });
        tally.add(&ray, Finding { fault: Some(Fault::Miss), error: None });
        Report::new(vec![(Class::Random, tally), (Class::Grazing(10), Tally::default())])
    }

    #[test]
    fn the_table_has_a_line_a_class_and_a_total() {
        let table = report().table();
        let lines: Vec<&str> = table.lines().collect();
        assert_eq!(lines.len(), 4);
        let words = |line: &str| line.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
        let random = ["random", "2", "1", "1", "0", "0", "0", "0", "1.5e-16", "1.5e-16", "1.5e-16"];
        assert_eq!(words(lines[1]), random);
        assert_eq!(
            words(lines[2]),
            "grazing-10 0 0 0 0 0 0 0 - - -".split(' ').collect::<Vec<_>>()
        );
        assert!(lines[3].starts_with("total"));
        assert!(lines.iter().all(|line| line.len() == lines[0].len()));
    }

    #[test]
    fn the_object_has_the_same_numbers() {
        let (classes, total) = report().json();
        assert_eq!(classes[0]["class"], "random");
        assert_eq!(classes[0]["misses"], 1);
        assert_eq!(classes[0]["error_max"], 1.5e-16);
        assert_eq!(classes[1]["error_max"], Value::Null);
        assert_eq!(total["rays"], 2);
        assert_eq!(report().faults(), 1);
    }
}
