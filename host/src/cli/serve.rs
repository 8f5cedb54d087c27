//! `host serve`: the page.

use super::columns::Reading;
use super::values::speed;
use super::{output, rig};
use crate::error::Failure;
use crate::recording::check_readable;
use crate::rigfile::RigFile;
use crate::serve::{self, Settings, Stop};
use clap::Args;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::process::{Command, Stdio};

/// Open the page: see the swing live, see where the model fails, click the missing effect in.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
pub(super) struct Options {
    /// Recordings to begin with; more can be loaded on the page
    #[arg(value_name = "RECORDING")]
    recordings: Vec<PathBuf>,
    /// The rig: serial device or its serial number, sim, or sim:NAME
    #[arg(long, value_name = "PORT")]
    port: Option<String>,
    /// The model file; ./rig.toml if there is one, else what the rig reports
    #[arg(long, value_name = "FILE")]
    rig: Option<PathBuf>,
    /// Where the page is served; port 0 takes a free one
    #[arg(long, value_name = "ADDRESS", default_value = "127.0.0.1:7878")]
    listen: SocketAddr,
    /// Do not open a browser
    #[arg(long)]
    no_open: bool,
    /// The simulated rig runs so many times faster than real time
    #[arg(long, value_name = "TIMES", value_parser = speed, allow_negative_numbers = true, default_value = "1")]
    sim_speed: f64,
    #[command(flatten)]
    reading: Reading,
}

const EXAMPLE: &str = "\
Example:
  host serve --port sim:mystery-1                  without hardware
  host serve --rig rig.toml swing1.csv swing2.csv
  host serve --port /dev/ttyACM0

The page is for this computer only. --listen with another address lets others in who have the token
that is printed; what they send is not encrypted. Ctrl-C ends the program.";

pub(super) fn run(options: &Options) -> Result<(), Failure> {
    options.reading.check()?;
    // A name that is misspelt is told here, not on the page alone, which reads them.
    options.recordings.iter().try_for_each(|path| check_readable(path)).map_err(Failure::failed)?;
    let stop = Stop::default();
    let asked = stop.clone();
    ctrlc::set_handler(move || asked.now()).map_err(Failure::failed)?;
    serve::run(settings(options)?, &stop, |url| {
        output::result(url);
        output::say("Ctrl-C ends the program");
        if !options.no_open {
            open(url);
        }
    })
}

fn settings(options: &Options) -> Result<Settings, Failure> {
    let model = model(options)?;
    let reading = model.as_ref().map_or_else(|| options.reading.clone(), |(file, _)| options.reading.of(file));
    Ok(Settings {
        listen: options.listen,
        token: token(options.listen)?,
        port: options.port.clone(),
        sim_speed: options.sim_speed,
        model,
        recordings: options.recordings.clone(),
        folder: std::env::current_dir().map_err(Failure::failed)?,
        reading: reading.options(),
        segment: reading.segment(),
    })
}

/// The named file or `rig.toml` here; without either, the rig or the page tells.
fn model(options: &Options) -> Result<Option<(RigFile, String)>, Failure> {
    let load = |path: PathBuf| Ok((RigFile::load(&path)?, path.display().to_string()));
    rig::chosen_path(options.rig.as_deref()).map(load).transpose()
}

/// Others are let in with a token only.
fn token(listen: SocketAddr) -> Result<Option<String>, Failure> {
    if listen.ip().is_loopback() {
        return Ok(None);
    }
    output::warn(&format!(
        "{listen} can be reached by other computers; whoever has the token may load recordings and write to the rig"
    ));
    serve::new_token().map(Some).map_err(|error| Failure::failed(format!("the system gives no random token: {error}")))
}

/// Shows the page; where there is no browser the address stands on the screen all the same.
fn open(url: &str) {
    let (program, arguments) = match std::env::consts::OS {
        "macos" => ("open", vec![url]),
        "windows" => ("cmd", vec!["/C", "start", "", url]),
        _ => ("xdg-open", vec![url]),
    };
    let quiet = || Stdio::null();
    let _ = Command::new(program).args(arguments).stdin(quiet()).stdout(quiet()).stderr(quiet()).spawn();
}
