//! Faces among many arcs that lie on one another, or so near that doubles cannot tell them apart anywhere: no
//! part of such an arc has fewer others than the whole, so a search that halves until few are left must
//! see that it gains nothing. Counts are by hand: what is wrong here does not end in this lifetime.

#![allow(clippy::unwrap_used)]

use snapfit::face::{ArcFile, Method, SourceArc, face};
use snapfit::number::Rat;

/// An arc t = P(u)/Q from `from`/den to `to`/den.
fn arc(p: [&str; 3], q: &str, (from, to, den): (i64, i64, i64)) -> String {
    let [p0, p1, p2] = p;
    format!(
        "{p0} {p1} {p2} {q} 0 0 {} {den} 0 0 {} {den} 0 0",
        -from, -to
    )
}

fn arcs(lines: &[String]) -> Vec<SourceArc> {
    let text = format!("{} 0 0\n{}\n", lines.len(), lines.join("\n"));
    ArcFile::parse(&text).unwrap().arcs
}

/// Half-edges and components by walking and by merging.
fn counts(arcs: &[SourceArc]) -> [(u64, u64); 2] {
    [Method::Walk, Method::Merge].map(|way| {
        let found = face(arcs, &(Rat::zero(), Rat::zero()), way).unwrap();
        (found.half_edges, found.components)
    })
}

/// n arcs on one line, each reaching a little farther to both sides than the one before: 2n ends cut it into
/// 2n − 1 parts, each seen from both sides, and four half-edges stand for the frame.
#[test]
fn nested_arcs_on_one_line() {
    for n in [2i64, 17, 64, 200] {
        let nested = |i: i64| arc(["2", "0", "0"], "1", (-(i + 1), 2 * i + 1, 1000));
        let lines: Vec<String> = (0..n).map(nested).collect();
        let want = (2 * (2 * n as u64 - 1) + 4, 2);
        assert_eq!(counts(&arcs(&lines)), [want; 2], "{n} nested arcs");
    }
}

/// n arcs 2⁻⁸⁰ above one another, level, slanting by as little, or bowed: each is a component of two half-edges.
#[test]
fn arcs_closer_than_doubles() {
    let base = 1i128 << 80;
    for n in [2i64, 30, 100] {
        for (slant, bow) in [(0, 0), (1, 0), (0, base)] {
            let near = |i: i64| {
                let p =
                    [2 * base + i128::from(i), i128::from(i) * slant, bow].map(|v| v.to_string());
                let p = [&p[0], &p[1], &p[2]].map(String::as_str);
                arc(p, &base.to_string(), (-(n + i), n + (7 * i) % n, 3 * n))
            };
            let lines: Vec<String> = (0..n).map(near).collect();
            let want = (2 * n as u64 + 4, n as u64 + 1);
            assert_eq!(counts(&arcs(&lines)), [want; 2], "{n} arcs, {slant} {bow}");
        }
    }
}
