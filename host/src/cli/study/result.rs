//! What a study says, for a person and as JSON.

use crate::cli::output;
use crate::cli::table::{table, wrapped};
use crate::number::with_spread;
use crate::operations::json::named;
use crate::study::between::Between;
use crate::study::database::Diagnosed;
use crate::study::folder::Problem;
use crate::study::rig::{Finding, Mean, RigView};
use crate::study::{Done, Study};
use serde::Serialize;
use std::path::Path;

/// More problems than so many are counted.
const MOST_NAMED: usize = 20;

#[derive(Serialize)]
struct Shown<'a> {
    /// `None` where there was nothing to keep.
    database: Option<String>,
    /// Recordings found in the folder now; absent with `--as-is`.
    n_found: Option<usize>,
    /// Those studied now.
    n_studied: Option<usize>,
    rigs: Vec<ShownRig<'a>>,
    between: &'a [Between],
    problems: Vec<Problem>,
}

#[derive(Serialize)]
struct ShownRig<'a> {
    rig: &'a str,
    n_recordings: usize,
    n_fitted: usize,
    order: &'a str,
    friction: Vec<ShownFriction<'a>>,
    findings: &'a [Finding],
    diagnosis: Option<&'a Diagnosed>,
}

#[derive(Serialize)]
struct ShownFriction<'a> {
    symbol: &'a str,
    unit: &'a str,
    #[serde(flatten)]
    mean: Mean,
}

/// Prints it.
pub(super) fn show(as_json: bool, database: Option<&Path>, study: &Study, done: Option<&Done>) {
    let mut problems = done.map_or(Vec::new(), |done| done.problems.clone());
    problems.extend(study.problems());
    if as_json {
        output::json("study", &shown(database, study, done, problems));
    } else {
        output::result(&in_words(database, study, done, &problems));
    }
}

fn shown<'a>(database: Option<&Path>, study: &'a Study, done: Option<&Done>, problems: Vec<Problem>) -> Shown<'a> {
    let rig = |view: &'a RigView| ShownRig {
        rig: &view.name,
        n_recordings: view.rows.len(),
        n_fitted: view.n_fitted(),
        order: view.order,
        friction: view
            .friction
            .iter()
            .map(|each| ShownFriction { symbol: each.symbol, unit: &each.unit, mean: each.mean })
            .collect(),
        findings: &view.findings,
        diagnosis: study.diagnoses.get(&view.name),
    };
    Shown {
        database: database.map(named),
        n_found: done.map(|done| done.n_found),
        n_studied: done.map(|done| done.n_studied),
        rigs: study.rigs.iter().map(rig).collect(),
        between: &study.between,
        problems,
    }
}

fn in_words(database: Option<&Path>, study: &Study, done: Option<&Done>, problems: &[Problem]) -> String {
    let mut parts = Vec::new();
    if !study.rigs.is_empty() {
        parts.push(rigs(study));
    }
    let findings = findings(study);
    if !findings.is_empty() {
        parts.push(format!("{}\n{}", output::heading("Found"), findings.join("\n")));
    }
    if !problems.is_empty() {
        parts.push(format!("{}\n{}", output::heading("Left out"), left_out(problems).join("\n")));
    }
    let kept = database.map_or("nothing is kept".to_owned(), |path| format!("kept in {}", path.display()));
    parts.push(match done {
        Some(done) => format!("{} recordings, {} of them studied now; {kept}", done.n_found, done.n_studied),
        None => format!("as {kept}"),
    });
    parts.join("\n\n")
}

fn rigs(study: &Study) -> String {
    let number = |view: &RigView, symbol: &str| {
        view.friction_of(symbol)
            .map_or("–".to_owned(), |friction| with_spread(friction.mean.value, friction.mean.std_error))
    };
    let row = |view: &RigView| {
        let left_out = view.left_out.len();
        let left_out = if left_out > 0 { format!(", {left_out} left out") } else { String::new() };
        let recordings = format!("{} of {}{left_out}", view.n_fitted(), view.rows.len());
        vec![view.name.clone(), recordings, number(view, "Mc"), number(view, "Mw")]
    };
    table(["rig", "fitted", "Mc (N·m)", "Mw (N·m·s/rad)"], study.rigs.iter().map(row).collect(), 1)
}

fn findings(study: &Study) -> Vec<String> {
    let of_rig = |view: &RigView| {
        let diagnosis = study.diagnoses.get(&view.name).map(|diagnosis| diagnosis.words.clone());
        let words = view.findings.iter().map(|finding| finding.words.clone()).chain(diagnosis);
        words.map(|words| wrapped(&format!("  {}: {words}", view.name), 4)).collect::<Vec<_>>()
    };
    let differs = study.standing_out();
    let differs = differs.iter().map(|(rig, words)| wrapped(&format!("  {rig}: {words}"), 4));
    differs.chain(study.rigs.iter().flat_map(of_rig)).collect()
}

fn left_out(problems: &[Problem]) -> Vec<String> {
    let line = |problem: &Problem| wrapped(&format!("  {}: {}", problem.what, problem.why), 4);
    let mut lines: Vec<String> = problems.iter().take(MOST_NAMED).map(line).collect();
    if problems.len() > MOST_NAMED {
        lines.push(format!("  and {} more; --json names them all", problems.len() - MOST_NAMED));
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::rig::tests::row;
    use crate::study::row::Row;
    use std::collections::BTreeMap;

    #[test]
    fn each_number_of_a_rig_stands_under_its_name() {
        let rows = [("1.csv", 1.0), ("2.csv", 1.1)].map(|(name, value)| row(name, value, 0.1));
        let mut rows = rows.to_vec();
        rows.push(Row { outcome: Err("broken".to_owned()), ..row("3.csv", 1.0, 0.1) });
        let study = Study { rigs: vec![RigView::new("rig", rows)], diagnoses: BTreeMap::new(), between: Vec::new() };
        let table = rigs(&study);
        let line = table.lines().last().unwrap().split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(line, "rig 2 of 3 1.050 ± 0.050 0.1050 ± 0.0050", "{table}");
        assert!(table.contains("Mc (N·m)") && table.contains("Mw (N·m·s/rad)"), "{table}");
    }

    #[test]
    fn what_is_fitted_and_left_out_is_told_beside_what_is_fitted() {
        let rows = ["1.csv", "2.csv", "3.csv"].map(|name| row(name, 1.0, 0.1));
        let mut view = RigView::new("rig", rows.to_vec());
        view.left_out = vec![(2, "it has the same bytes".to_owned())];
        let study = Study { rigs: vec![view], diagnoses: BTreeMap::new(), between: Vec::new() };
        assert!(rigs(&study).contains("3 of 3, 1 left out"), "{}", rigs(&study));
    }

    #[test]
    fn twenty_problems_are_named_and_the_rest_counted() {
        let problem = |k: usize| Problem { what: format!("{k}.csv"), why: "it is empty".to_owned() };
        let told = left_out(&(0..23).map(problem).collect::<Vec<_>>());
        assert_eq!(told.len(), 21);
        assert_eq!(told[20], "  and 3 more; --json names them all");
    }
}
