//! How recordings of others are to be read; shared by every command that reads some.

use super::output;
use super::values::{finite, point, positive};
use crate::compare::measurement::Measurement;
use crate::error::Failure;
use crate::operations::reading;
use crate::recording::segment::SegmentOptions;
use crate::recording::{AngleUnit, Columns, Measured, ReadOptions, Recording};
use crate::rigfile::RigFile;
use crate::swing::Swing;
use clap::Args;
use rayon::prelude::*;
use std::path::PathBuf;
use std::str::FromStr;

/// A choice of columns, and how it was typed.
#[derive(Clone, Debug)]
struct Typed {
    text: String,
    columns: Columns,
}

impl FromStr for Typed {
    type Err = <Columns as FromStr>::Err;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(Self { text: text.to_owned(), columns: text.parse()? })
    }
}

/// Options for reading recordings.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Reading recordings")]
pub(super) struct Reading {
    /// Columns by number from 0 or by name, such as t=0,theta=2 or t=0:ms,theta=angle:deg or t=0,rate=2:deg/s
    #[arg(long, value_name = "COLUMNS")]
    columns: Option<Typed>,
    /// The angles are in degrees, rates in degrees a second
    #[arg(long, conflicts_with = "radians")]
    degrees: bool,
    /// The angles are in radians, however large they are; rates in radians a second
    #[arg(long)]
    radians: bool,
    /// Samples per second, for files without a time column
    #[arg(long, value_name = "HZ", value_parser = positive, allow_negative_numbers = true)]
    rate: Option<f64>,
    /// What the sensor reads while the pendulum hangs, in the file's unit
    #[arg(long, value_name = "ANGLE", value_parser = finite, allow_negative_numbers = true)]
    zero: Option<f64>,
    /// The pivot in the file's x and y, for a point that was followed in a video
    #[arg(long, value_name = "X,Y", value_parser = point, allow_hyphen_values = true)]
    pivot: Option<[f64; 2]>,
    /// The sensor counts the other way, clockwise positive
    #[arg(long)]
    mirror: bool,
    /// The free swing begins here, s by the recording's own clock
    #[arg(long, value_name = "S", value_parser = finite, allow_negative_numbers = true)]
    from: Option<f64>,
    /// The free swing ends here, s by the same clock
    #[arg(long, value_name = "S", value_parser = finite, allow_negative_numbers = true)]
    to: Option<f64>,
    /// Of files that hold several runs only these, by name or by number from 1, such as 2 or 1,3
    #[arg(long, value_name = "RUN", value_delimiter = ',')]
    run: Vec<String>,
    /// What the model file says of recordings that do not say it.
    #[arg(skip)]
    measured: Option<Measured>,
}

impl Reading {
    /// What only both limits together tell.
    pub(super) fn check(&self) -> Result<(), Failure> {
        self.rules().check()
    }

    /// The same, for recordings of the sensor that a model file tells of.
    pub(super) fn of(&self, model: &RigFile) -> Self {
        Self { measured: model.measured(), ..self.clone() }
    }

    /// The same options for a line to copy, each with a space before it.
    pub(super) fn words(&self) -> String {
        let flags = [(self.degrees, "--degrees"), (self.radians, "--radians"), (self.mirror, "--mirror")];
        let number = |option: &'static str, value: Option<f64>| value.map(|value| (option, value.to_string()));
        let values = [
            self.columns.as_ref().map(|typed| ("--columns", typed.text.clone())),
            number("--rate", self.rate),
            number("--zero", self.zero),
            self.pivot.map(|[x, y]| ("--pivot", format!("{x},{y}"))),
            number("--from", self.from),
            number("--to", self.to),
            (!self.run.is_empty()).then(|| ("--run", self.run.join(","))),
        ];
        let flags = flags.into_iter().filter(|(is_given, _)| *is_given).map(|(_, flag)| format!(" {flag}"));
        let valued = |(option, value): (&str, String)| format!(" {option} {}", output::command(&[&value]));
        flags.chain(values.into_iter().flatten().map(valued)).collect()
    }

    /// How files are read.
    pub(super) fn options(&self) -> ReadOptions {
        let angle_unit = match (self.degrees, self.radians) {
            (true, _) => Some(AngleUnit::Degrees),
            (_, true) => Some(AngleUnit::Radians),
            _ => None,
        };
        ReadOptions {
            columns: self.columns.as_ref().map(|typed| typed.columns.clone()),
            rate_hz: self.rate,
            angle_unit,
            zero: self.zero,
            pivot: self.pivot,
            within_s: [self.from, self.to],
            mirrored: self.mirror,
            runs: self.run.clone(),
            measured: self.measured,
        }
    }

    /// Where the free swing lies, if the user knows it better.
    pub(super) fn segment(&self) -> SegmentOptions {
        SegmentOptions { from_s: self.from, to_s: self.to }
    }

    /// Reads the swings of several recordings and says what was noticed.
    pub(super) fn swings(&self, paths: &[PathBuf]) -> Result<Vec<Swing>, Failure> {
        let (swings, notes) = self.swings_quietly(paths)?;
        notes.iter().for_each(|note| output::warn(note));
        Ok(swings)
    }

    /// The same; gives what was noticed.
    pub(super) fn swings_quietly(&self, paths: &[PathBuf]) -> Result<(Vec<Swing>, Vec<String>), Failure> {
        let read = self.each_run(paths, |rules, name, recording| rules.swings(name, recording))?;
        let (swings, notes): (Vec<Swing>, Vec<Vec<String>>) = read.into_iter().unzip();
        Ok((swings, notes.concat()))
    }

    /// Reads recordings and finds their free swings, with what is known around them.
    pub(super) fn measurements(&self, paths: &[PathBuf]) -> Result<Vec<Measurement>, Failure> {
        self.each_run(paths, |rules, name, recording| rules.measurements(name, recording))
    }

    /// What the runs of these files give, in their order.
    fn each_run<T: Send>(
        &self,
        paths: &[PathBuf],
        find: impl Fn(&reading::Reading, &str, &Recording) -> Result<Vec<T>, Failure> + Sync,
    ) -> Result<Vec<T>, Failure> {
        let rules = self.rules();
        let of_file = |path: &PathBuf| {
            let file = path.display().to_string();
            let mut found = Vec::new();
            for run in rules.runs(path)? {
                found.extend(find(&rules, &run.name_in(&file), &run.recording)?);
            }
            Ok(found)
        };
        let read: Vec<Result<Vec<T>, Failure>> = paths.par_iter().map(of_file).collect();
        Ok(read.into_iter().collect::<Result<Vec<Vec<T>>, Failure>>()?.into_iter().flatten().collect())
    }

    fn rules(&self) -> reading::Reading {
        reading::Reading { options: self.options(), segment: self.segment() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        reading: Reading,
    }

    #[test]
    fn a_line_to_copy_reads_recordings_as_they_were_read() {
        let words = |line: &[&str]| Line::parse_from(std::iter::once(&"host").chain(line)).reading.words();
        assert_eq!(words(&[]), "");
        let typed = ["--columns", "t=0,theta=my angle", "--zero", "-1.5", "--mirror", "--run", "1,3", "--degrees"];
        assert_eq!(words(&typed), " --degrees --mirror --columns 't=0,theta=my angle' --zero -1.5 --run '1,3'");
        let others = ["--radians", "--rate", "200", "--pivot", "320,40", "--from", "0.5", "--to", "7"];
        assert_eq!(words(&others), " --radians --rate 200 --pivot '320,40' --from 0.5 --to 7");
    }
}
