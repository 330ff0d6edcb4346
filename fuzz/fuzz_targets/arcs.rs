//! Whatever the bytes, the reader of bare arcs refuses or reads; and of arcs made from the bytes the
//! walk and the merge find the same face, or refuse for the same reason.
#![no_main]

use libfuzzer_sys::fuzz_target;
use snapfit::face::{ArcFile, Method, face};
use std::fmt::Write;

/// Arcs made of bytes: more would only make a run slower.
const MOST: usize = 16;

fuzz_target!(|data: &[u8]| {
    if let Ok(text) = std::str::from_utf8(data)
        && let Err(error) = ArcFile::parse(text)
    {
        assert!(!error.to_string().is_empty());
    }
    let text = drawn(data);
    let file = ArcFile::parse(&text).expect("arcs as they are written");
    let walked = face(&file.arcs, &file.start, Method::Walk);
    let merged = face(&file.arcs, &file.start, Method::Merge);
    match (walked, merged) {
        (Ok(a), Ok(b)) => assert_eq!(
            (a.half_edges, a.components, a.unbounded),
            (b.half_edges, b.components, b.unbounded),
            "{text}"
        ),
        (Err(_), Err(_)) => {}
        (a, b) => panic!("walk {a:?}, merge {b:?}:\n{text}"),
    }
});

/// Ten bytes an arc, each a small integer: P, Q, and the two linear or quadratic ends. The ends' last
/// field, which root, is made of the sign of what stands before it.
fn drawn(data: &[u8]) -> String {
    let small = |byte: u8| i64::from(byte % 9) - 4;
    let arcs: Vec<&[u8]> = data.chunks_exact(10).take(MOST).collect();
    let mut text = format!("{} 1/7 1/11\n", arcs.len());
    for arc in arcs {
        let n: Vec<i64> = arc.iter().map(|&b| small(b)).collect();
        // A constant Q never vanishes: the arc has no pole between its ends.
        let q = if n[3] > 0 {
            [1 + n[4].abs(), 0, 1]
        } else {
            [1, 0, 0]
        };
        let (from, to) = (n[6].min(n[7]), n[6].max(n[7]) + 1);
        let end = |at: i64, curved: bool| {
            if curved {
                // (u − at)² = 2: the lower root.
                format!("{} {} 1 0", at * at - 2, -2 * at)
            } else {
                format!("{} 1 0 0", -at)
            }
        };
        let _ = writeln!(
            text,
            "{} {} {} {} {} {} {} {}",
            n[0],
            n[1],
            n[2],
            q[0],
            q[1],
            q[2],
            end(from, n[8] > 2),
            end(to, n[9] > 2),
        );
    }
    text
}
