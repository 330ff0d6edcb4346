//! Whatever the bytes, the readers of linear programs refuse with a place or read; what is small enough
//! is solved, and separate code accepts its certificate, also after a way through JSON.
#![no_main]

use libfuzzer_sys::fuzz_target;
use snapfit::certificate::lp::{Claim, verify};
use snapfit::lp::{Model, Options, Status, read_model, report, solve};
use std::time::Duration;

fuzz_target!(|data: &[u8]| {
    for name in ["fuzz.mps", "fuzz.lp"] {
        match read_model(name, data) {
            Ok(model) => solved(&model, data.len()),
            Err(error) => {
                assert_eq!(error.file, name);
                assert!(!error.message.is_empty());
            }
        }
    }
});

fn solved(model: &Model, bytes: usize) {
    if bytes > 1500 || model.rows.len() + model.columns.len() > 60 {
        return;
    }
    let options = Options {
        time_limit: Some(Duration::from_secs(5)),
        ..Options::default()
    };
    let outcome = solve(model, &options);
    if outcome.status == Status::Undecided {
        return;
    }
    let claim = Claim::of(&outcome).expect("a decided program has a certificate");
    verify(model, &claim).expect("the certificate holds");
    let read = report::from_json(model, &report::to_json(model, "fuzz", &outcome));
    verify(model, &read.expect("the result reads back")).expect("it holds still");
}
