//! The results of one model, as JSON and as tables.

use serde_json::{Value, json};

use super::super::race::{
    KernelResult, Measurement, Model, Preparation, Question, REACH, RaySet, Rival, RivalResult,
    Speed, Steps,
};
use super::super::table::{count, short, short_bytes, table, three_digits, time};

/// Everything measured of one model on one number of threads.
#[derive(Clone, Copy, Debug)]
pub(super) struct Report<'a> {
    pub(super) model: &'a Model,
    pub(super) threads: u16,
    /// What the rival is called: its name, a space, its version.
    pub(super) rival: &'a str,
    /// One for each tolerance.
    pub(super) rivals: &'a [Rival],
    pub(super) measurements: &'a [Measurement],
}

impl Report<'_> {
    /// One object for each ray set, kernel and tolerance.
    pub(super) fn json(&self) -> Vec<Value> {
        let mut lines = Vec::new();
        for measured in self.measurements {
            for (index, ours) in measured.kernels.iter().enumerate() {
                if measured.rivals.is_empty() {
                    lines.push(self.json_ours(measured, ours));
                }
                for (rival, result) in self.rivals.iter().zip(&measured.rivals) {
                    let mut line = self.json_ours(measured, ours);
                    self.add_rival(&mut line, (measured, index), (rival, result));
                    lines.push(line);
                }
            }
        }
        lines
    }

    fn json_ours(&self, measured: &Measurement, ours: &KernelResult) -> Value {
        let mut line = json!({
            "model": self.model.name,
            "rays": measured.set.name(),
            "count": measured.count,
            "kernel": ours.kernel.name(),
            "threads": self.threads,
            "mrays_per_s": ours.speed.mrays_per_s,
            "spread": ours.speed.spread,
            "hits": ours.hits,
            "doubtful": ours.doubtful,
            "file_seconds": self.model.preparation.total(),
            "build_seconds": self.model.preparation.build,
            "total_seconds": measured.our_steps(self.model, ours).total(),
            "bytes": self.model.world.bvh().bytes(),
            "pieces": self.model.world.bvh().patches().pieces().len(),
        });
        if measured.set == RaySet::AmbientOcclusion {
            line["radius"] = json!(REACH * self.model.diagonal);
        }
        line
    }

    fn add_rival(
        &self,
        line: &mut Value,
        (measured, kernel): (&Measurement, usize),
        (rival, result): (&Rival, &RivalResult),
    ) {
        let ours = measured.kernels[kernel].speed.mrays_per_s;
        let disagreements = result.disagreements[kernel];
        let (name, version) = self.rival.split_once(' ').unwrap_or((self.rival, ""));
        line["rival"] = json!(name);
        line["rival_version"] = json!(version);
        line["rival_width"] = json!(result.width);
        line["tolerance"] = json!(result.tolerance);
        line["rival_mrays_per_s"] = json!(result.speed.mrays_per_s);
        line["rival_spread"] = json!(result.speed.spread);
        line["rival_hits"] = json!(result.hits);
        line["rival_triangles"] = json!(rival.triangles);
        line["rival_build_seconds"] = json!(rival.build_seconds);
        line["rival_commit_seconds"] = json!(rival.commit_seconds);
        line["rival_plan_seconds"] = json!(rival.plan_seconds);
        line["rival_total_seconds"] =
            json!(measured.rival_steps(self.model, rival, result).total());
        line["rival_bytes"] = json!(rival.bytes);
        line["rival_tnear"] = json!(0.0);
        line["rival_offset"] = json!(result.offset);
        line["hit_disagreements"] = json!(disagreements.hit);
        if measured.set.question() == Question::FirstHit {
            line["t_disagreements"] = json!(disagreements.distance);
        }
        line["ratio"] = json!(ours / result.speed.mrays_per_s);
    }

    /// Tables for people.
    pub(super) fn text(&self) -> String {
        let mut text = self.preparation();
        text.push('\n');
        text.push_str(&table(&self.speeds(), &[0]));
        if !self.rivals.is_empty() {
            text.push('\n');
            text.push_str(&table(&self.comparison(), &[0, 1]));
            let totals = self.totals();
            if !totals.is_empty() {
                text.push('\n');
                text.push_str(&table(&totals, &[0]));
            }
        }
        text
    }

    /// One row for a table of several models: what the model takes, and our fastest kernel's speed
    /// for each of these ray sets.
    pub(super) fn row(&self, sets: &[RaySet]) -> Vec<String> {
        let bvh = self.model.world.bvh();
        let pieces = bvh.patches().pieces().len();
        let mut row = vec![self.model.name.clone(), self.threads.to_string(), pieces.to_string()];
        row.push(short_bytes(bvh.bytes() / pieces.max(1)));
        row.extend(sets.iter().map(|&set| {
            let measured = self.measurements.iter().find(|measured| measured.set == set);
            let fastest = measured.and_then(Measurement::fastest);
            fastest.map_or("-".to_owned(), |ours| three_digits(ours.speed.mrays_per_s))
        }));
        row
    }

    /// What the model holds, how large it is, how long it took to prepare.
    fn preparation(&self) -> String {
        let Self { model, .. } = self;
        let bvh = model.world.bvh();
        let pieces = bvh.patches().pieces().len();
        let mut text = format!(
            "{}, {}: {}, {}, {}, {} ({} a Bézier patch); {} from the surfaces, {} from the file\n",
            model.name,
            count(self.threads.into(), "thread"),
            count(bvh.surface_count() as u64, "surface"),
            count(pieces as u64, "Bézier patch"),
            count(bvh.leaves().len() as u64, "leaf"),
            short_bytes(bvh.bytes()),
            short_bytes(bvh.bytes() / pieces.max(1)),
            time(model.preparation.build),
            time(model.preparation.total()),
        );
        if self.measurements.iter().any(|measured| measured.set == RaySet::AmbientOcclusion) {
            let length = short(REACH * model.diagonal);
            text.push_str(&format!("rays of ao are {length} long, {REACH} of the diagonal\n"));
        }
        for rival in self.rivals {
            text.push_str(&format!(
                "{}, tolerance {:e} of the diagonal, {}: {}, {}; {} to plan, {} from the surfaces, {} of \
                 it to commit\n",
                self.rival,
                rival.tolerance,
                short(rival.tolerance * model.diagonal),
                count(rival.triangles as u64, "triangle"),
                short_bytes(rival.bytes),
                time(rival.plan_seconds),
                time(rival.build_seconds),
                time(rival.commit_seconds),
            ));
        }
        text
    }

    /// Speeds: a row a ray set, kernels side by side, then the rival.
    fn speeds(&self) -> Vec<Vec<String>> {
        let Some(first) = self.measurements.first() else { return Vec::new() };
        let mut heading = vec!["Mrays/s (spread)".to_owned(), "rays".into(), "hits".into()];
        heading.push("doubtful".into());
        heading.extend(first.kernels.iter().map(|ours| ours.kernel.to_string()));
        for rival in &first.rivals {
            heading.extend([
                format!("at {:e}", rival.tolerance),
                "packet".into(),
                "speed / rival's".into(),
            ]);
        }
        let mut rows = vec![heading];
        for measured in self.measurements {
            let Some(fastest) = measured.fastest() else { continue };
            let share = 100.0 * fastest.hits as f64 / measured.count as f64;
            let mut row = vec![measured.set.to_string(), measured.count.to_string()];
            row.extend([format!("{share:.1} %"), fastest.doubtful.to_string()]);
            row.extend(measured.kernels.iter().map(|ours| rate(ours.speed)));
            for rival in &measured.rivals {
                let ratio = fastest.speed.mrays_per_s / rival.speed.mrays_per_s;
                row.extend([rate(rival.speed), rival.width.to_string(), three_digits(ratio)]);
            }
            rows.push(row);
        }
        rows
    }

    /// What the rival finds that we do not, and the other way round.
    fn comparison(&self) -> Vec<Vec<String>> {
        let heading = ["rays that differ", "tolerance", "offset", "hit or miss", "t"];
        let mut rows = vec![heading.map(str::to_owned).to_vec()];
        for measured in self.measurements {
            for rival in &measured.rivals {
                let Some(differ) = rival.disagreements.first() else { continue };
                let t = match measured.set.question() {
                    Question::FirstHit => differ.distance.to_string(),
                    Question::AnyHit => "-".into(),
                };
                let tolerance = format!("{:e}", rival.tolerance);
                let offset = short(rival.offset);
                rows.push(vec![
                    measured.set.to_string(),
                    tolerance,
                    offset,
                    differ.hit.to_string(),
                    t,
                ]);
            }
        }
        rows
    }

    /// From the file to the last primary ray, step by step: all have the same file to read.
    fn totals(&self) -> Vec<Vec<String>> {
        let primary = self.measurements.iter().find(|measured| measured.set == RaySet::Primary);
        let Some((measured, ours)) =
            primary.and_then(|measured| Some((measured, measured.usual()?)))
        else {
            return Vec::new();
        };
        let model = self.model;
        let our_steps = measured.our_steps(model, ours);
        let row = |name: String, steps: Steps| {
            let Preparation { read, build } = steps.preparation;
            let cells = [read, build, steps.trace, steps.total()].map(time);
            std::iter::once(name).chain(cells).collect::<Vec<_>>()
        };
        let rays = count(measured.count as u64, "primary ray");
        let heading =
            ["from the file", "read", "build", &rays, "in all", "nurbray's time / rival's"];
        let mut rows = vec![heading.map(str::to_owned).to_vec()];
        rows.push(row(format!("nurbray {}", ours.kernel), our_steps));
        for (rival, result) in self.rivals.iter().zip(&measured.rivals) {
            let theirs = measured.rival_steps(model, rival, result);
            let name = format!("{} at {:e}", self.rival, rival.tolerance);
            let mut cells = row(name, theirs);
            cells.push(three_digits(our_steps.total() / theirs.total()));
            rows.push(cells);
        }
        rows
    }
}

/// A table of the rows that `Report::row` returns.
pub(super) fn summary(sets: &[RaySet], rows: Vec<Vec<String>>) -> String {
    let mut heading = vec!["Mrays/s of the fastest kernel".to_owned(), "threads".into()];
    heading.extend(["Bézier patches".into(), "bytes a patch".into()]);
    heading.extend(sets.iter().map(RaySet::to_string));
    let rows: Vec<Vec<String>> = std::iter::once(heading).chain(rows).collect();
    table(&rows, &[0])
}

fn rate(speed: Speed) -> String {
    format!("{} ({:.0} %)", three_digits(speed.mrays_per_s), 100.0 * speed.spread)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_have_a_spread() {
        assert_eq!(rate(Speed { mrays_per_s: 70.23, spread: 0.034 }), "70.2 (3 %)");
    }
}
