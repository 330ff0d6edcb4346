//! What both readers owe of whatever they refuse.

use snapfit::scene::{Diagnostic, Rendering};

/// Something is said, each time with a place, and it can be shown.
pub fn shown(diagnostics: &[Diagnostic]) {
    assert!(!diagnostics.is_empty());
    for diagnostic in diagnostics.iter().take(20) {
        assert!(diagnostic.line() >= 1 && diagnostic.column() >= 1);
        let place = format!("fuzz:{}:{}", diagnostic.line(), diagnostic.column());
        assert!(diagnostic.render(Rendering::Plain).contains(&place));
    }
}
