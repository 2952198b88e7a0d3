//! The audit's result as a table and as JSON.

use serde_json::{Value, json};

use super::super::table::{count, table};
use super::class::{Class, Group};
use super::tally::{DoubtCount, Tally};

/// The tallies of all classes, to be shown.
#[derive(Debug)]
pub(crate) struct Report {
    rows: Vec<(Class, Row)>,
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
    doubtful_any: u64,
    /// Rays that are exactly tangent.
    tangent: DoubtCount,
    undecided: u64,
    /// The quantiles of the error that are reported: 50 %, 99 % and the largest.
    errors: [Option<f64>; 3],
    /// The largest error of a doubtful answer's hit.
    doubtful_error: Option<f64>,
}

impl Row {
    fn new(tally: &Tally) -> Self {
        Self {
            rays: tally.rays,
            hits: tally.hits,
            misses: tally.misses,
            wrong_roots: tally.wrong_roots,
            false_hits: tally.false_hits,
            doubtful: tally.doubtful,
            doubtful_any: tally.doubtful_any,
            tangent: tally.tangent,
            undecided: tally.undecided,
            errors: [0.5, 0.99, 1.0].map(|share| tally.error_quantile(share)),
            doubtful_error: tally.doubtful_error(),
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
            "doubtful_any": self.doubtful_any,
            "undecided": self.undecided,
            "error_50": error_50,
            "error_99": error_99,
            "error_max": error_max,
            "error_doubtful": self.doubtful_error,
        })
    }
}

impl Report {
    /// Adds up the classes.
    pub(crate) fn new(classes: Vec<(Class, Tally)>) -> Self {
        let mut total = Tally::default();
        let rows = classes
            .into_iter()
            .map(|(class, tally)| {
                let row = Row::new(&tally);
                total.merge(tally);
                (class, row)
            })
            .collect();
        Self { rows, total: Row::new(&total) }
    }

    /// Misses, wrong roots and false hits of all classes.
    pub(crate) fn faults(&self) -> u64 {
        self.total.misses + self.total.wrong_roots + self.total.false_hits
    }

    /// Two lines about doubtful answers; before them, if there are no faults, a line that says so.
    pub(crate) fn verdict(&self) -> String {
        let faults = match self.faults() {
            0 => "no unflagged miss, no wrong root, no false hit\n",
            _ => "",
        };
        let groups = Group::ALL.map(|group| {
            let DoubtCount { rays, doubtful } = self.doubts(group);
            let share = 100.0 * doubtful as f64 / rays.max(1) as f64;
            let which = match group {
                Group::Random => "random or aimed",
                Group::Nasty => "nasty",
                Group::Apart => "exactly tangent or starting on a surface",
            };
            format!("{doubtful} of {rays} {which} ({share:.2} %)")
        });
        let Row { rays, doubtful_any, .. } = self.total;
        format!(
            "{faults}doubtful: {}\ndoubtful whether anything is hit: {doubtful_any} of {rays}\n",
            groups.join(", ")
        )
    }

    /// The rays of a group: those of its classes; tangent ones count apart, whatever their class.
    fn doubts(&self, group: Group) -> DoubtCount {
        let mut sum = DoubtCount::default();
        for (class, row) in &self.rows {
            let (own, tangent) = (class.group() == group, row.tangent);
            let (rays, doubtful) = match class.group() {
                Group::Apart if own => (row.rays, row.doubtful),
                _ if own => (row.rays - tangent.rays, row.doubtful - tangent.doubtful),
                Group::Random | Group::Nasty if group == Group::Apart => {
                    (tangent.rays, tangent.doubtful)
                }
                _ => (0, 0),
            };
            sum.rays += rays;
            sum.doubtful += doubtful;
        }
        sum
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

    /// `classes` and `groups`, one object each, and `total`.
    pub(crate) fn json(&self) -> [Value; 3] {
        let classes = self.rows.iter().map(|(class, row)| {
            let mut object = row.json();
            object["class"] = json!(class.name());
            object["group"] = json!(class.group().name());
            object
        });
        let groups = Group::ALL.map(|group| {
            let DoubtCount { rays, doubtful } = self.doubts(group);
            json!({ "group": group.name(), "rays": rays, "doubtful": doubtful })
        });
        [classes.collect(), groups.into_iter().collect(), self.total.json()]
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
            "if doubtful",
        ];
        let mut lines = vec![heading.map(str::to_owned).to_vec()];
        let rows = self.rows.iter().map(|(class, row)| (class.name(), row));
        lines.extend(rows.chain([("total".to_owned(), &self.total)]).map(|(name, row)| {
            let counts = [
                row.rays,
                row.hits,
                row.misses,
                row.wrong_roots,
                row.false_hits,
                row.doubtful,
                row.undecided,
            ];
            let errors = row.errors.into_iter().chain([row.doubtful_error]);
            let errors = errors.map(|error| match error {
                Some(error) => format!("{error:.1e}"),
                None => "-".into(),
            });
            let counts = counts.iter().map(u64::to_string);
            [name].into_iter().chain(counts).chain(errors).collect()
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
        let sure = Finding {
            fault: None,
            error: Some(1.5e-16),
            doubtful: false,
            doubtful_any: false,
            tangent: false,
        };
        tally.add(&ray, sure);
        tally.add(&ray, Finding { fault: Some(Fault::Miss), error: None, ..sure });
        let mut apart = Tally::default();
        apart.add(&ray, Finding { error: Some(2e-9), doubtful: true, ..sure });
        let mut tangent = Tally::default();
        let doubtful = Finding { error: None, doubtful: true, doubtful_any: true, ..sure };
        tangent.add(&ray, Finding { tangent: true, ..doubtful });
        let grazing = (Class::Grazing(10), tangent);
        Report::new(vec![(Class::Random, tally), grazing, (Class::Origins, apart)])
    }

    #[test]
    fn the_table_has_a_line_a_class_and_a_total() {
        let table = report().table();
        let lines: Vec<&str> = table.lines().collect();
        assert_eq!(lines.len(), 5);
        let words = |line: &str| line.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
        for (line, text) in [
            (1, "random 2 1 1 0 0 0 0 1.5e-16 1.5e-16 1.5e-16 -"),
            (2, "grazing-10 1 0 0 0 0 1 0 - - - -"),
            (3, "origins 1 1 0 0 0 1 0 - - - 2.0e-9"),
            (4, "total 4 2 1 0 0 2 0 1.5e-16 1.5e-16 1.5e-16 2.0e-9"),
        ] {
            assert_eq!(words(lines[line]).join(" "), text);
        }
        assert!(lines.iter().all(|line| line.len() == lines[0].len()));
    }

    #[test]
    fn doubt_is_told_for_each_group() {
        assert_eq!(
            report().verdict(),
            "doubtful: 0 of 2 random or aimed (0.00 %), 0 of 0 nasty (0.00 %), \
             2 of 2 exactly tangent or starting on a surface (100.00 %)\n\
             doubtful whether anything is hit: 1 of 4\n"
        );
        assert!(Report::new(Vec::new()).verdict().starts_with("no unflagged miss, "));
    }

    #[test]
    fn the_object_has_the_same_numbers() {
        let [classes, groups, total] = report().json();
        assert_eq!(groups[2], json!({ "group": "apart", "rays": 2, "doubtful": 2 }));
        assert_eq!(
            (&classes[2]["group"], &classes[2]["error_max"]),
            (&json!("apart"), &Value::Null)
        );
        assert_eq!(total["error_doubtful"], 2e-9);
        assert_eq!(classes[0]["class"], "random");
        assert_eq!(classes[0]["misses"], 1);
        assert_eq!(classes[0]["error_max"], 1.5e-16);
        assert_eq!(classes[1]["error_max"], Value::Null);
        assert_eq!([&total["rays"], &total["doubtful_any"]], [&json!(4), &json!(1)]);
        assert_eq!(report().faults(), 1);
    }
}
