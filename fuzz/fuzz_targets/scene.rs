//! The reader never panics, whatever the bytes; what it accepts it writes and reads back equal,
//! in both notations; and every diagnostic can be shown.
#![no_main]

mod shown;

use libfuzzer_sys::fuzz_target;
use shown::shown;
use snapfit::scene::{Scene, SceneFile, check, read_scene, read_scene_bytes};

fuzz_target!(|data: &[u8]| {
    match read_scene_bytes("fuzz", data, &[]) {
        Ok(file) => comes_back(&file),
        Err(diagnostics) => shown(&diagnostics),
    }
});

fn comes_back(file: &SceneFile) {
    let _report = check(file).to_string();
    let json = read_scene("fuzz.json", &file.tree().to_json()).expect("the tree as JSON");
    assert_eq!(json.scene(), file.scene());
    if printable(file.scene()) {
        let toml = read_scene("fuzz.toml", &file.scene().to_toml()).expect("the scene as TOML");
        assert_eq!(toml.scene(), file.scene());
    }
}

/// A number such as 1e100000 is read, but written out it is longer than what is read.
fn printable(scene: &Scene) -> bool {
    let text = scene.to_toml();
    let longest = text.split('"').map(str::len).max();
    longest.is_none_or(|n| n < snapfit::number::literal::MAX_DIGITS)
}
