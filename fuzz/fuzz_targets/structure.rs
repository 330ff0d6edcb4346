//! The reader of structures never panics, whatever the bytes; what it accepts it writes and reads back
//! equal; every diagnostic can be shown.
#![no_main]

mod shown;

use libfuzzer_sys::fuzz_target;
use shown::shown;
use snapfit::flex::{read_structure, structure_to_toml};

fuzz_target!(|data: &[u8]| {
    match read_structure("fuzz", data, &[]) {
        Ok(file) => {
            let text = structure_to_toml(file.structure());
            // A number such as 1e100000 is read, but written out it is longer than what is read.
            let longest = text.split('"').map(str::len).max().unwrap_or(0);
            if longest < snapfit::number::literal::MAX_DIGITS {
                let again = read_structure("fuzz.toml", text.as_bytes(), &[]).expect("as written");
                assert_eq!(again.structure(), file.structure());
            }
        }
        Err(diagnostics) => shown(&diagnostics),
    }
});
