//! `face`: the face of bare arcs.

use super::{DECIDED, Failure, UNDECIDED, limit, output};
use std::io::Write;
use std::path::PathBuf;
use std::time::Duration;

#[derive(clap::Args)]
pub(crate) struct FaceArgs {
    #[command(flatten)]
    face: snapfit::face::Args,
    /// Write to a file instead of standard output
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Give up, undecided, after so many seconds
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, value_parser = super::args::seconds)]
    time_limit: Option<Duration>,
}

/// Prints the face, or nothing within the limit.
pub(crate) fn run(args: &FaceArgs) -> Result<u8, Failure> {
    output::prepare(&args.face.file, args.out.as_deref())?;
    let asked = args.face.clone();
    let Some(report) = limit::within(args.time_limit, move || snapfit::face::run_cli(&asked))?
    else {
        let _ = writeln!(
            std::io::stderr(),
            "snapfit: undecided: --time-limit came before the face was found"
        );
        return Ok(UNDECIDED);
    };
    let text = serde_json::to_string(&report?).map_err(|e| e.to_string())?;
    output::write(args.out.as_deref(), &(text + "\n"))?;
    Ok(DECIDED)
}
