//! The reader of structures never panics, whatever the bytes; what it accepts it writes and reads back
//! equal; every diagnostic can be shown.
#![no_main]

use libfuzzer_sys::fuzz_target;
use snapfit::flex::{read_structure, structure_to_toml};
use snapfit::scene::Rendering;

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
        Err(diagnostics) => {
            assert!(!diagnostics.is_empty());
            for diagnostic in diagnostics.iter().take(20) {
                assert!(diagnostic.line() >= 1 && diagnostic.column() >= 1);
                let place = format!("fuzz:{}:{}", diagnostic.line(), diagnostic.column());
                assert!(diagnostic.render(Rendering::Plain).contains(&place));
            }
        }
    }
});
