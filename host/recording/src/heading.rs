//! The names of the columns in the lines above the rows: plain lines or comments, parted like the rows or otherwise, with
//! units in a line of their own or without, and below those of bodies.

use super::cell::is_missing;
use super::row::{SEPARATORS, Separator, is_comment, looks_like_number, n_numbers, split};
use super::words::{Meaning, is_unit, meaning};

/// Fewer strokes are cells in which nothing was measured.
const SHORTEST_RULE: usize = 5;

/// Names from the lines above the first row: the last line with as many cells, else one whose words are known.
pub(super) fn names(lines_above: &[&str], separator: Separator, n_columns: usize) -> Option<Vec<String>> {
    let filled = |is_wanted: bool| {
        let is_filled = |line: &&&str| is_comment(line) == is_wanted && !bare(line).is_empty() && !is_rule(line);
        lines_above.iter().filter(is_filled).copied().collect::<Vec<_>>()
    };
    let (mut plain, comments) = (filled(false), filled(true));
    while plain.last().is_some_and(|line| is_row_without_values(line, separator, n_columns)) {
        plain.pop();
    }
    like_the_rows(&plain, separator, n_columns)
        .or_else(|| of_known_words(&plain, separator, n_columns))
        .or_else(|| of_known_words(&comments, separator, n_columns))
        .or_else(|| before_a_remark(&comments, n_columns))
        .map(of_oscilloscope)
}

/// Keysight's oscilloscopes call the time `x-axis` and the voltages by the numbers of their channels, with `second,Volt` in a line below
/// that people take away.
fn of_oscilloscope(names: Vec<String>) -> Vec<String> {
    let are_channels = |names: &[String]| !names.is_empty() && names.iter().all(|name| name.parse::<u8>().is_ok());
    match names.split_first() {
        Some((time, channels)) if time == "x-axis" && are_channels(channels) => {
            let volts = channels.iter().map(|channel| format!("{channel} (V)"));
            std::iter::once(format!("{time} (s)")).chain(volts).collect()
        }
        _ => names,
    }
}

/// A line that is drawn below the names: `-------`, `=====,=====` or `-+-+-`.
fn is_rule(line: &str) -> bool {
    let n_drawn = line.chars().filter(|letter| matches!(letter, '-' | '=' | '_' | '~' | '*')).count();
    n_drawn >= SHORTEST_RULE && !line.chars().any(char::is_alphanumeric)
}

/// Is it one of the rows of a camera that sees nothing yet, `3,0.1,,,,640,480,vfr`, or of Tracker, `,,`?
fn is_row_without_values(line: &str, separator: Separator, n_columns: usize) -> bool {
    let cells = split(line, separator);
    let filled = || cells.iter().filter(|cell| !cell.is_empty());
    if filled().count() == 0 {
        return true;
    }
    let n = filled().filter(|cell| looks_like_number(cell, separator)).count();
    cells.len() == n_columns && filled().count() < n_columns && n > 1 && 2 * n >= filled().count()
}

/// The last line, if it has a name for each column.
fn like_the_rows(lines: &[&str], separator: Separator, n_columns: usize) -> Option<Vec<String>> {
    let last = lines.last()?;
    let cells = wide_cells(last, separator, n_columns).unwrap_or_else(|| cells(last, separator));
    // A row behind the prompt of a terminal has numbers.
    let is_row = n_columns > 1 && n_numbers(last, separator) > 0 && !is_known(&cells);
    // A unit may stand below the first name alone.
    let names = with_units(lines, separator, cells);
    let n_names = names.iter().filter(|name| !name.is_empty()).count();
    let is_whole = n_columns == 1 || (n_names > 1 && names.len() >= n_columns);
    (is_whole && !is_row).then_some(names)
}

/// The last line, parted like the rows or otherwise, if each column has a name and some of them are known.
fn of_known_words(lines: &[&str], separator: Separator, n_columns: usize) -> Option<Vec<String>> {
    let last = lines.last()?;
    // One word, or `measured: rate`, is no list of names.
    let may_be_otherwise = n_columns > 1 && !last.contains([':', '=']);
    let others = SEPARATORS.into_iter().filter(|other| may_be_otherwise && *other != separator);
    let found = std::iter::once(separator).chain(others).find_map(|separator| {
        let cells = cells(last, separator);
        let names = (cells.len() == n_columns).then(|| with_units(lines, separator, cells))?;
        is_known(&names).then_some(names)
    });
    found.or_else(|| dotted(last, n_columns).filter(|_| may_be_otherwise))
}

/// `Tempo.Forzante.Pendolo`: words alone, because names hold dots too.
fn dotted(line: &str, n_columns: usize) -> Option<Vec<String>> {
    let names: Vec<String> = bare(line).split('.').map(str::to_owned).collect();
    let are_words = names.iter().all(|name| !name.is_empty() && name.chars().all(char::is_alphabetic));
    (names.len() == n_columns && are_words && is_known(&names)).then_some(names)
}

/// The first words of the last line, if there is a known one for each column: `t theta_deg | from a video`.
fn before_a_remark(lines: &[&str], n_columns: usize) -> Option<Vec<String>> {
    let last = lines.last()?;
    let words = last.trim_start_matches(['#', '%', '/', ' ']).split([' ', '\t', ',', ';', '|']);
    let names: Vec<String> = words.filter(|word| !word.is_empty()).take(n_columns).map(str::to_owned).collect();
    let are_known = names.len() == n_columns && names.iter().all(|name| meaning(name) != Meaning::Other);
    (n_columns > 1 && are_known).then_some(names)
}

/// The last line, if it has three names and more for half of the columns and more, but not for all: the first is a time, another one an
/// angle or a rate.
pub(super) fn of_fewer(lines_above: &[&str], separator: Separator, n_columns: usize) -> Option<Vec<String>> {
    let last = lines_above.iter().rfind(|line| !bare(line).is_empty() && !is_rule(line))?;
    let names = cells(last, separator);
    let means = |name: &String| meaning(name);
    let is_measured = |name: &String| matches!(means(name), Meaning::Angle { .. } | Meaning::Rate { .. });
    let is_one = (3..n_columns).contains(&names.len())
        && 2 * names.len() >= n_columns
        && names.iter().all(|name| !name.is_empty() && !looks_like_number(name, separator))
        && names.first().is_some_and(|name| matches!(means(name), Meaning::Time { .. }))
        && names.iter().any(is_measured);
    is_one.then_some(names)
}

/// Is this line one of names, of which some are known?
pub(super) fn says_columns(line: &[&str], separator: Separator, n_columns: usize) -> bool {
    like_the_rows(line, separator, n_columns).is_some_and(|names| is_known(&names))
}

fn is_known(names: &[String]) -> bool {
    names.iter().any(|name| meaning(name) != Meaning::Other)
}

/// The cells of the last line, behind those of the line above where the last has units.
fn with_units(lines: &[&str], separator: Separator, last: Vec<String>) -> Vec<String> {
    let Some(above) = lines.len().checked_sub(2).map(|idx| cells(lines[idx], separator)) else { return last };
    if above.len() == last.len() && are_units(&last, &above) {
        return above.iter().zip(&last).map(|(name, unit)| format!("{name} {unit}")).collect();
    }
    if are_groups(&above, &last) { behind_groups(&above, &last) } else { last }
}

/// Bodies, each above the first of its columns: Tracker's `,mass A,,mass B,,` above `t,x,y,x,y,`, where nothing else tells
/// one body's `x` from the other's.
fn are_groups(above: &[String], names: &[String]) -> bool {
    let places: Vec<usize> = (0..above.len()).filter(|idx| !above[*idx].is_empty()).collect();
    let is_word = |idx: &usize| above[*idx].chars().any(char::is_alphabetic) && meaning(&above[*idx]) == Meaning::Other;
    // Empty cells at the end of the line may be missing.
    if above.len() > names.len() || places.len() < 2 || places[0] == 0 || !places.iter().all(is_word) {
        return false;
    }
    let ends = places.iter().skip(1).copied().chain([names.len()]);
    let filled = |group: &[String]| group.iter().filter(|name| !name.is_empty()).cloned().collect::<Vec<_>>();
    let groups: Vec<Vec<String>> =
        places.iter().copied().zip(ends).map(|(begin, end)| filled(&names[begin..end])).collect();
    groups[0].len() > 1 && groups.iter().all(|group| *group == groups[0])
}

/// The names with those of their groups, as long as they still say what they are.
fn behind_groups(above: &[String], names: &[String]) -> Vec<String> {
    let group = |idx: usize| above[..above.len().min(idx + 1)].iter().rfind(|group| !group.is_empty());
    let joined = |idx: usize| group(idx).map(|group| format!("{group} {}", names[idx]));
    let says_the_same = |idx: usize, joined: &String| !names[idx].is_empty() && meaning(joined) == meaning(&names[idx]);
    let named = |idx: usize| joined(idx).filter(|joined| says_the_same(idx, joined));
    (0..names.len()).map(|idx| named(idx).unwrap_or_else(|| names[idx].clone())).collect()
}

/// All are units; or at least half of them, below a name that is known, and the others have no word that is known.
fn are_units(cells: &[String], above: &[String]) -> bool {
    let is_unit = |cell: &str| is_unit(cell) || cell.starts_with('[') && cell.ends_with(']');
    let filled = || cells.iter().zip(above).filter(|(cell, _)| !is_missing(cell));
    let (n_units, n_filled) = (filled().filter(|(cell, _)| is_unit(cell)).count(), filled().count());
    let others_are_unknown = || filled().all(|(cell, _)| is_unit(cell) || meaning(cell) == Meaning::Other);
    let is_below_a_name = |(cell, name): (&String, &String)| is_unit(cell) && meaning(name) != Meaning::Other;
    n_units > 0
        && (n_units == n_filled || (2 * n_units >= n_filled && others_are_unknown() && filled().any(is_below_a_name)))
}

fn bare(line: &str) -> &str {
    line.trim_start_matches(['#', '%', '/', ' ']).trim()
}

/// Names of several words stand two spaces or more apart: `time (s)   ang. vel. (rad/s)`.
fn wide_cells(line: &str, separator: Separator, n_columns: usize) -> Option<Vec<String>> {
    let cells = bare(line).split("  ").map(str::trim).filter(|cell| !cell.is_empty());
    let cells: Vec<String> = cells.map(str::to_owned).collect();
    (separator == Separator::Space && cells.len() == n_columns).then_some(cells)
}

/// Cells separated by spaces keep their unit in brackets: `Time [s] Angle [deg]` are two.
fn cells(line: &str, separator: Separator) -> Vec<String> {
    let line = line.trim_start_matches(['#', '%', '/', ' ']);
    // A line that begins with a bracket has nothing but units.
    let line = match separator {
        Separator::Space if !line.starts_with(['[', '(']) => line.replace(" [", "[").replace(" (", "("),
        _ => line.to_owned(),
    };
    split(&line, separator).into_iter().map(str::to_owned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(lines: &[&str], separator: Separator, n_columns: usize, expected: &[&str]) {
        let found = names(lines, separator, n_columns).unwrap_or_default();
        assert_eq!(found, expected, "{lines:?}");
    }

    #[test]
    fn names_and_units_in_two_lines_are_one() {
        use Separator::{Comma, Space, Tab};
        let two = ["#Logger", "#Time A\tPos A\tTime B\tPos B", "#[s]\t[au]\t[s]\t[au]"];
        check(&two, Tab, 4, &["Time A [s]", "Pos A [au]", "Time B [s]", "Pos B [au]"]);
        check(&["# Time (S)  LR  TB", "#"], Space, 3, &["Time(S)", "LR", "TB"]);
        check(&["# t theta", "# [s] [rad]"], Space, 2, &["t [s]", "theta [rad]"]);
        let some = ["Time,Event Time,State at A,State at B,Comment", "s,s,State,State,", ""];
        let joined = ["Time s", "Event Time s", "State at A State", "State at B State", "Comment "];
        check(&some, Comma, 5, &joined);
        let runs = ["Length,1st run (second),2nd run (second)", "(m),,"];
        check(&runs, Comma, 3, &["Length (m)", "1st run (second) ", "2nd run (second) "]);
        check(&["run 7,a", "s,deg"], Comma, 2, &["run 7 s", "a deg"]);
        check(&["what,who", "t,theta"], Comma, 2, &["t", "theta"]);
        check(&["what,who", "s,State"], Comma, 2, &["s", "State"]);
        // A line drawn below them is none of them.
        let drawn = ["Timestamp, Time_Elapsed(s), Angle(deg)", "-------------------------------------"];
        check(&drawn, Comma, 3, &["Timestamp", "Time_Elapsed(s)", "Angle(deg)"]);
        check(&["t theta", "---- ------"], Space, 2, &["t", "theta"]);
        check(&["# t theta", "# ======="], Space, 2, &["t", "theta"]);
        check(&["time,angle", "s,deg", "====,====="], Comma, 2, &["time s", "angle deg"]);
        // A half is enough, a third is not.
        check(&["time,a,b,c", "s,foo,bar,deg"], Comma, 4, &["time s", "a foo", "b bar", "c deg"]);
        check(&["time,a,b", "s,foo,bar"], Comma, 3, &["s", "foo", "bar"]);
    }

    #[test]
    fn columns_have_the_names_of_the_bodies_above_them() {
        use Separator::Comma;
        let tracker = ["#multi:", ",mass A,,mass B,,", "t,x,y,x,y,"];
        check(&tracker, Comma, 6, &["t", "mass A x", "mass A y", "mass B x", "mass B y", ""]);
        let three = [",mass A,,,mass B", "t,x,y,v,x,y,v"];
        check(&three, Comma, 7, &["t", "mass A x", "mass A y", "mass A v", "mass B x", "mass B y", "mass B v"]);
        // One body tells nothing, a title is none, and columns that differ have names of their own.
        check(&[",mass A,", "t,x,y"], Comma, 3, &["t", "x", "y"]);
        check(&["run,of,may,9,", "t,x,y,x,y"], Comma, 5, &["t", "x", "y", "x", "y"]);
        check(&[",mass A,,mass B,", "t,x,y,u,v"], Comma, 5, &["t", "x", "y", "u", "v"]);
    }

    #[test]
    fn names_parted_otherwise_than_the_rows_are_found_and_a_prompt_is_none() {
        use Separator::{Comma, Tab};
        check(&["--- Pendolo ---", "Tempo,Forzante,Pendolo"], Tab, 3, &["Tempo", "Forzante", "Pendolo"]);
        check(&["--- Pendolo ---", "Tempo.Forzante.Pendolo"], Tab, 3, &["Tempo", "Forzante", "Pendolo"]);
        check(&["a rig of ours. v1.2"], Tab, 3, &[]);
        check(&["t,x,y", ",,"], Comma, 3, &["t", "x", "y"]);
        check(&["# t; theta; omega"], Comma, 3, &["t", "theta", "omega"]);
        check(&["Sensor, ready, go"], Tab, 3, &[]);
        check(&["# measured: rate"], Comma, 2, &[]);
        use Separator::Space;
        let wide = ["time (s)   angle (rad)    ang. vel. (rad/s)"];
        check(&wide, Space, 3, &["time (s)", "angle (rad)", "ang. vel. (rad/s)"]);
        check(&["  t   angle [rad]"], Space, 2, &["t", "angle [rad]"]);
        check(&["# t theta_deg | from a video"], Space, 2, &["t", "theta_deg"]);
        check(&["# time of release: noon"], Space, 2, &[]);
        check(&["[ dpc ] >>> 6.2,6.1,-0.7,15352"], Comma, 4, &[]);
        check(&["t,1,2,3"], Comma, 4, &["t", "1", "2", "3"]);
        check(&["t,x,y,fps,mode", "0.0,,,30,vfr", "0.1,,,30,vfr"], Comma, 5, &["t", "x", "y", "fps", "mode"]);
    }
}
