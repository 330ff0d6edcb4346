//! What the readers of MPS and LP files make of bounds, ranges and infinities, and where they say
//! that an error is.

use super::rat;
use snapfit::lp::{Range, read_model};
use snapfit::number::{Int, Rat};

#[test]
fn readers_say_where() {
    let place = |name: &str, text: &str| {
        let e = read_model(name, text.as_bytes()).expect_err("an error");
        (e.line, e.column, e.message)
    };
    let mps = "NAME t\nROWS\n N obj\n L r\nCOLUMNS\n x obj 1 r 2\n x r 3\nRHS\nENDATA\n";
    assert_eq!(place("a.mps", mps).0, 7);
    assert!(place("a.mps", mps).2.contains("second entry"));
    assert_eq!(place("a.mps", &mps.replace("x r 3", "y r 0x3")).1, 6);
    assert_eq!(
        place(
            "a.mps",
            &mps.replace(" x r 3\n", "").replace("ENDATA\n", "")
        )
        .0,
        7
    );
    assert_eq!(place("a.mps", &mps.replace("x r 3", "y q 3")).1, 4);
    assert_eq!(place("a.lp", "min x + x\nst\nend").0, 1);
    assert_eq!(place("a.lp", "min x\nst\n x + >= 2\nend").0, 3);
    assert_eq!(place("a.lp", "min x\nst\n x >= 1/0\nend").0, 3);
    for text in ["min nan x\nst\nend", "min y\nst\n c: inf x >= 1\nend"] {
        let (line, column, message) = place("a.lp", text);
        assert!(message.ends_with("is not a number"), "{message}");
        let word = if line == 1 { "nan" } else { "inf" };
        let before = text.lines().nth(line - 1).and_then(|l| l.find(word));
        assert_eq!(Some(column - 1), before, "{message}");
    }
    let (line, column, message) = place("a.lp", "min x y\nst\nend");
    assert_eq!((line, column), (1, 7), "{message}");
    assert!(message.contains("an operator"), "{message}");
    assert!(read_model("a.mps", &[0x1f, 0x8b, 1, 2]).is_err());
    assert_eq!(
        read_model("a.mps", b"NAME\n\xff").expect_err("bytes").line,
        2
    );
    assert!(read_model("a.lp", b"").is_err() && read_model("a.mps", b"").is_err());
}

#[test]
fn mps_bounds_and_ranges() {
    let text = "NAME          t\nOBJSENSE\n    MAX\nROWS\n N  obj\n E  e\n G  g\n L  l\nCOLUMNS\n\
        \x20   x  obj  1.5  e  1.\n    x  g  .5\n    y  e  -1  l  2D0\n    z  l  1\n    w  obj  1\n\
        RHS\n    e  3  g  1\n    obj  7\nRANGES\n    R  e  -2  g  4\n    R  l  5\nBOUNDS\n\
        \x20UP B  x  -2\n FR B  y\n MI B  z\n UP B  z  8\n FX B  w  1/3\nENDATA\n";
    let m = read_model("t.mps", text.as_bytes()).unwrap_or_else(|e| panic!("{e}"));
    let range = |l: Option<i64>, u: Option<i64>| Range {
        lower: l.map(rat),
        upper: u.map(rat),
    };
    assert!(m.maximise);
    assert_eq!(m.rows[0].range, range(Some(1), Some(3)));
    assert_eq!(m.rows[1].range, range(Some(1), Some(5)));
    assert_eq!(m.rows[2].range, range(Some(-5), Some(0)));
    assert_eq!(m.columns[0].range, range(None, Some(-2)));
    assert_eq!(m.freed, [0]);
    assert_eq!(m.columns[1].range, Range::free());
    assert_eq!(m.columns[2].range, range(None, Some(8)));
    assert_eq!(m.columns[3].range, Range::fixed(Rat::frac(1, 3)));
    assert_eq!(m.columns[1].entries[1].1, rat(2));
    assert_eq!(m.ignored_rhs, Some(rat(7)));
}

/// 10³⁰ as a bound is the format's word for none; next to it lie numbers.
#[test]
fn mps_infinity() {
    let text = "NAME\nROWS\n N obj\n L r\nCOLUMNS\n x obj 1 r 1\n y obj 1 r 1\n z obj 1 r 1\n\
        RHS\n rhs r 1e30\nBOUNDS\n LO b x -1e30\n UP b x 1.0e+30\n LO b y 1e30\n\
        \x20UP b y 1000000000000000000000000000001\n MI b z\n UP b z Inf\nENDATA\n";
    let m = read_model("t.mps", text.as_bytes()).unwrap_or_else(|e| panic!("{e}"));
    let big = Rat::from(Int::from(10i64).pow(30));
    assert_eq!(m.columns[0].range, Range::free());
    assert_eq!(m.columns[1].range.lower, Some(big.clone()));
    assert_eq!(m.columns[1].range.upper, Some(&big + &Rat::one()));
    assert_eq!(m.columns[2].range, Range::free());
    assert_eq!(m.rows[0].range.upper, Some(big));
}
