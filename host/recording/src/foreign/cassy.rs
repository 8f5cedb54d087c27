//! Projects of CASSY Lab 2 (`.labx`): an archive with one file of XML, or that file itself. In groups of channels each run has a channel, with its quantity,
//! symbol, unit and values.

use super::as_text::{refused, text_of};
use crate::error::Fault;

/// The text is that of a project, as nothing else begins.
const PROJECT: &str = "<cassylab";

/// A channel of one run.
struct Channel {
    name: String,
    values: Vec<f64>,
}

/// Is it such a project?
pub(super) fn is_project(xml: &str) -> bool {
    xml.chars().take(PROJECT.len() + 200).collect::<String>().contains(PROJECT)
}

/// The longest of its runs.
pub(super) fn table(xml: &str, notes: &mut Vec<String>) -> Result<Vec<u8>, Fault> {
    let groups: Vec<Vec<Channel>> = xml.split("<channels ").skip(1).map(channels).collect();
    let n_runs = groups.iter().map(Vec::len).max().unwrap_or(0);
    let run = |idx: usize| full(groups.iter().filter_map(|group| group.get(idx)).collect());
    let runs = (0..n_runs).map(|idx| (idx, run(idx))).filter(|(_, run)| run.len() > 1);
    let longest = runs.max_by_key(|(_, run)| run[0].values.len());
    let Some((idx, run)) = longest else {
        return Err(refused(
            "project of CASSY Lab",
            "no run in it has two channels with values; measure anew, with the time",
        ));
    };
    if n_runs > 1 {
        notes.push(format!(
            "run {} of {n_runs} taken, the longest one; for another delete the others in CASSY Lab, or export its table",
            idx + 1
        ));
    }
    let (names, columns): (Vec<String>, Vec<Vec<f64>>) =
        run.into_iter().map(|channel| (channel.name.clone(), channel.values.clone())).unzip();
    Ok(text_of(&names, &columns))
}

/// Those with as many values as the longest has.
fn full(channels: Vec<&Channel>) -> Vec<&Channel> {
    let most = channels.iter().map(|channel| channel.values.len()).max().unwrap_or(0);
    channels.into_iter().filter(|channel| most > 0 && channel.values.len() == most).collect()
}

fn channels(group: &str) -> Vec<Channel> {
    group.split("<channel ").skip(1).map(channel).collect()
}

fn channel(xml: &str) -> Channel {
    let text = |tag: &str| between(xml, &format!("<{tag}>"), &format!("</{tag}>")).unwrap_or_default();
    let (quantity, symbol, unit) = (text("quantity"), text("symbol"), text("unit"));
    let in_unit = if unit.is_empty() { String::new() } else { format!(" ({unit})") };
    let values = xml.split("<value>").skip(1).filter_map(|value| value.split_once("</value>"));
    let number = |(value, _): (&str, &str)| value.trim().parse().unwrap_or(f64::NAN);
    Channel { name: format!("{quantity} {symbol}{in_unit}"), values: values.map(number).collect() }
}

/// The text between two tags; Greek letters are marked with an ampersand.
fn between(xml: &str, begin: &str, end: &str) -> Option<String> {
    let (_, behind) = xml.split_once(begin)?;
    let (text, _) = behind.split_once(end)?;
    Some(text.replace("&amp;", ""))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn group(runs: &[(&str, &str, &str, &[f64])]) -> String {
        let channel = |(quantity, symbol, unit, values): &(&str, &str, &str, &[f64])| {
            let unit = if unit.is_empty() { "<unit />".to_owned() } else { format!("<unit>{unit}</unit>") };
            let values: String = values.iter().map(|value| format!("<value>{value}</value>")).collect();
            format!(
                "<channel dec=\"2\"><quantity>{quantity}</quantity><symbol>{symbol}</symbol>{unit}\
                 <range min=\"0\" max=\"9\" /><values count=\"9\">{values}</values></channel>"
            )
        };
        format!("<channels count=\"2\" runs=\"true\">{}</channels>", runs.iter().map(channel).collect::<String>())
    }

    #[test]
    fn the_longest_run_of_a_project_is_a_table_with_names_and_units() {
        let xml = format!(
            "\u{feff}<?xml version=\"1.0\"?><cassylab xml:lang=\"de-DE\">{}{}{}</cassylab>",
            group(&[("Zeit", "t", "s", &[0.0, 1.0]), ("Zeit", "t", "s", &[0.0, 0.5, 1.0])]),
            group(&[("Frequenz", "f", "Hz", &[]), ("Frequenz", "f", "Hz", &[])]),
            group(&[("Winkel", "&amp;aA1", "°", &[3.0, 4.0]), ("Winkel", "&amp;aA1", "°", &[1.5, -1.0, 0.5])]),
        );
        let mut notes = Vec::new();
        let text = String::from_utf8(table(&xml, &mut notes).unwrap()).unwrap();
        assert!(is_project(&xml));
        assert_eq!(text, "\"Zeit t (s)\";\"Winkel aA1 (°)\"\n0;1.5\n0.5;-1\n1;0.5\n");
        assert!(notes[0].starts_with("run 2 of 2 taken"), "{notes:?}");
        let empty = table("<cassylab></cassylab>", &mut notes).unwrap_err().to_string();
        assert!(empty.contains("no run in it"), "{empty}");
    }

    #[test]
    fn a_project_that_is_not_packed_is_read() {
        let times_s: Vec<f64> = (0..400).map(|idx| 0.05 * f64::from(idx)).collect();
        let angles: Vec<f64> =
            times_s.iter().map(|time_s| 2.0 * (-0.05 * time_s).exp() * (5.0 * time_s).cos()).collect();
        let xml = format!(
            "\u{feff}<?xml version=\"1.0\" encoding=\"utf-8\"?><cassylab xml:lang=\"de-DE\">{}{}</cassylab>",
            group(&[("Zeit", "t", "s", &times_s)]),
            group(&[("Winkel", "&amp;aA1", "°", &angles)]),
        );
        let recording = crate::read_bytes("pendel.labx", xml.as_bytes(), &crate::ReadOptions::default()).unwrap();
        assert_eq!(recording.len(), 400);
        assert!((recording.angles_rad()[0] - 2_f64.to_radians()).abs() < 1e-9);
    }
}
