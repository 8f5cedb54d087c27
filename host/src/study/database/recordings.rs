//! A recording as rows of the tables: its own, and one for each of its numbers.

use super::super::row::{Key, Number, Origin, Outcome, Row};
use rusqlite::{Connection, params};

const PUT: &str = "INSERT OR REPLACE INTO recording VALUES \
                   (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15, ?16, ?17)";

const PUT_NUMBER: &str = "INSERT INTO number VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10)";

pub(super) fn put(on: &Connection, row: &Row) -> rusqlite::Result<()> {
    let Row { key, origin, program, studied, recorded, outcome } = row;
    let found = row.found();
    on.prepare_cached(PUT)?.execute(params![
        key.rig,
        key.recording,
        origin.file_hash,
        origin.model_hash,
        origin.options,
        program,
        studied,
        recorded,
        outcome.as_ref().err(),
        found.map(|found| found.n_samples),
        found.map(|found| found.duration_s),
        found.map(|found| found.amplitude_rad),
        found.and_then(|found| found.period_s),
        found.map(|found| found.noise_rad),
        found.map(|found| found.error_rad),
        found.map(|found| &found.left),
        found.map(|found| found.notes.join("\n")),
    ])?;
    on.prepare_cached("DELETE FROM number WHERE rig = ?1 AND recording = ?2")?.execute([&key.rig, &key.recording])?;
    let mut query = on.prepare_cached(PUT_NUMBER)?;
    for (place, number) in found.iter().flat_map(|found| &found.numbers).enumerate() {
        let Number { symbol, effect, unit, value, std, upper, status } = number;
        query.execute(params![key.rig, key.recording, place, symbol, effect, unit, value, std, upper, status])?;
    }
    Ok(())
}

pub(super) fn rows(on: &Connection, rig: &str) -> rusqlite::Result<Vec<Row>> {
    let mut query = on.prepare_cached("SELECT * FROM recording WHERE rig = ?1 ORDER BY recording")?;
    let mut rows: Vec<Row> = query.query_map([rig], row)?.collect::<rusqlite::Result<_>>()?;
    let mut query = on.prepare_cached("SELECT * FROM number WHERE rig = ?1 ORDER BY recording, place")?;
    let mut numbers = query.query([rig])?;
    let mut at = 0;
    while let Some(line) = numbers.next()? {
        let recording: String = line.get("recording")?;
        at += rows[at..].iter().take_while(|row| row.key.recording < recording).count();
        if let Some(Row { key, outcome: Ok(outcome), .. }) = rows.get_mut(at)
            && key.recording == recording
        {
            outcome.numbers.push(number(line)?);
        }
    }
    Ok(rows)
}

fn row(line: &rusqlite::Row) -> rusqlite::Result<Row> {
    let problem: Option<String> = line.get("problem")?;
    let outcome = match problem {
        Some(problem) => Err(problem),
        None => Ok(outcome(line)?),
    };
    Ok(Row {
        key: Key { rig: line.get("rig")?, recording: line.get("recording")? },
        origin: Origin {
            file_hash: line.get("file_hash")?,
            model_hash: line.get("model_hash")?,
            options: line.get("options")?,
        },
        program: line.get("program")?,
        studied: line.get("studied")?,
        recorded: line.get("recorded")?,
        outcome,
    })
}

fn outcome(line: &rusqlite::Row) -> rusqlite::Result<Outcome> {
    let notes: String = line.get("notes")?;
    Ok(Outcome {
        n_samples: line.get("samples")?,
        duration_s: line.get("duration_s")?,
        amplitude_rad: line.get("amplitude_rad")?,
        period_s: line.get("period_s")?,
        noise_rad: line.get("noise")?,
        error_rad: line.get("error")?,
        left: line.get("left_over")?,
        notes: notes.lines().map(str::to_owned).collect(),
        numbers: Vec::new(),
    })
}

fn number(line: &rusqlite::Row) -> rusqlite::Result<Number> {
    Ok(Number {
        symbol: line.get("symbol")?,
        effect: line.get("effect")?,
        unit: line.get("unit")?,
        value: line.get("value")?,
        std: line.get("std")?,
        upper: line.get("upper")?,
        status: line.get("status")?,
    })
}
