//! Tables of a report: a column for us, one for each tolerance.

/// A Markdown table.
#[derive(Clone, Debug)]
pub(super) struct Table {
    text: String,
    columns: usize,
}

impl Table {
    /// A table with its heading.
    pub(super) fn new(tolerances: &[f64]) -> Self {
        let names: String = tolerances.iter().map(|t| format!(" {t:e} |")).collect();
        let line = "--:|".repeat(tolerances.len() + 1);
        let columns = tolerances.len();
        Self { text: format!("| tolerance | nurbray |{names}\n|---|{line}\n"), columns }
    }

    /// Adds a row; `theirs` gives the cell of tolerance number `k`.
    pub(super) fn row(&mut self, name: &str, ours: &str, theirs: impl Fn(usize) -> String) {
        let cells: String = (0..self.columns).map(|k| format!(" {} |", theirs(k))).collect();
        self.text += &format!("| {name} | {ours} |{cells}\n");
    }

    /// The Markdown.
    pub(super) fn text(self) -> String {
        self.text
    }
}

/// The cell for what is not measured, or does not exist.
pub(super) const NONE: &str = "–";

/// `1.2e-7`, or a dash.
pub(super) fn fraction(number: Option<f64>) -> String {
    number.map_or_else(|| NONE.into(), |number| format!("{number:.1e}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_for_us_and_each_tolerance() {
        let mut table = Table::new(&[1e-3, 1e-5]);
        table.row("size", "7", |k| format!("{k}"));
        let text =
            "| tolerance | nurbray | 1e-3 | 1e-5 |\n|---|--:|--:|--:|\n| size | 7 | 0 | 1 |\n";
        assert_eq!(table.text(), text);
        assert_eq!([fraction(None), fraction(Some(1.234e-7))], ["–", "1.2e-7"]);
    }
}
