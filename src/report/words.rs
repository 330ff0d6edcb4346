//! The words that tables and pictures share: numbers abbreviated, contacts and outcomes named.

use super::json::{
    ContactDocument, EventContact, EventDocument, OutcomeDocument, ResultDocument,
    RootContactDocument,
};
use super::num::{Exact, Num};

/// What a reader of results in doubles has to know.
pub(crate) const UNPROVEN: &str =
    "computed in doubles with a tolerance: not proven, and may be wrong";

/// A double to so many significant digits, without trailing zeros.
pub(crate) fn digits(x: f64, significant: usize) -> String {
    if x == 0.0 || !x.is_finite() {
        return if x == 0.0 {
            "0".to_owned()
        } else {
            minus(&x.to_string())
        };
    }
    let scientific = format!("{x:.*e}", significant.saturating_sub(1));
    let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let text = if (-5..significant.max(7) as i32).contains(&exponent) {
        let places = (significant as i32 - 1 - exponent).max(0) as usize;
        trim(&format!("{x:.places$}")).to_owned()
    } else {
        format!("{}e{exponent}", trim(mantissa))
    };
    minus(&text)
}

fn trim(text: &str) -> &str {
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        text
    }
}

/// A true minus sign, as wide as a plus.
pub(crate) fn minus(text: &str) -> String {
    text.replace('-', "−")
}

/// θ in degrees.
pub(crate) fn degrees(theta: f64) -> String {
    let rounded = format!("{:.2}", theta.to_degrees());
    minus(if rounded == "-0.00" { "0.00" } else { &rounded }) + "°"
}

/// A number in a sentence: exactly if that is short, else to six digits.
pub(crate) fn short(n: &Num) -> String {
    match &n.exact {
        Some(Exact::Rational { rational }) if rational.len() <= 7 => minus(rational),
        _ => format!("≈{}", approx(n)),
    }
}

/// `= 7/2`, or `≈ 1.41421`.
pub(crate) fn equals(n: &Num) -> String {
    match short(n).strip_prefix('≈') {
        Some(rounded) => format!("≈ {rounded}"),
        None => format!("= {}", short(n)),
    }
}

/// A number to six digits.
pub(crate) fn approx(n: &Num) -> String {
    match n.value {
        Some(x) => digits(x, 6),
        None => "past the double range".to_owned(),
    }
}

/// What a number exactly is, in a few columns.
pub(crate) fn exactly(n: &Num) -> String {
    match &n.exact {
        None => String::new(),
        Some(Exact::Rational { rational }) if rational.len() <= 15 => minus(rational),
        Some(Exact::Rational { rational }) => {
            let digits = rational.bytes().filter(u8::is_ascii_digit).count();
            format!("rational, {digits} digits")
        }
        Some(Exact::Root { polynomial, .. }) => polynomial_text(polynomial)
            .unwrap_or_else(|| format!("degree {}", polynomial.len() - 1)),
    }
}

/// A short polynomial equation, such as `t²−2=0`.
fn polynomial_text(coefficients: &[String]) -> Option<String> {
    const POWERS: [&str; 5] = ["", "t", "t²", "t³", "t⁴"];
    let mut text = String::new();
    for (i, c) in coefficients.iter().enumerate().rev() {
        let power = POWERS.get(i)?;
        let (sign, size) = match c.strip_prefix('-') {
            Some(size) => ("−", size),
            None => ("+", c.as_str()),
        };
        if size == "0" {
            continue;
        }
        if !(text.is_empty() && sign == "+") {
            text.push_str(sign);
        }
        if size != "1" || i == 0 {
            text.push_str(size);
        }
        text.push_str(power);
    }
    text.push_str("=0");
    (text.chars().count() <= 22).then_some(text)
}

/// A pawl's contact, seen from the pawl.
pub(crate) fn contact(c: &ContactDocument) -> String {
    match c {
        ContactDocument::B {
            pawl_vertex,
            obstacle,
            obstacle_edge,
            hole,
        } => format!(
            "vertex {pawl_vertex} on {obstacle}{} edge {obstacle_edge}",
            within(*hole)
        ),
        ContactDocument::A {
            pawl_edge,
            obstacle,
            obstacle_vertex,
            hole,
        } => format!(
            "edge {pawl_edge} on {obstacle}{} vertex {obstacle_vertex}",
            within(*hole)
        ),
        ContactDocument::Limit { limit: 0 } => "lower stop".to_owned(),
        ContactDocument::Limit { .. } => "upper stop".to_owned(),
    }
}

fn within(hole: Option<u32>) -> String {
    hole.map_or_else(String::new, |h| format!(" hole {h}"))
}

/// Any contact.
pub(super) fn any_contact(c: &EventContact) -> String {
    match c {
        EventContact::Pawl(c) => contact(c),
        EventContact::Root(RootContactDocument::B {
            root_vertex,
            obstacle,
            obstacle_edge,
            hole,
        }) => format!(
            "root vertex {root_vertex} on {obstacle}{} edge {obstacle_edge}",
            within(*hole)
        ),
        EventContact::Root(RootContactDocument::A {
            root_edge,
            obstacle,
            obstacle_vertex,
            hole,
        }) => format!(
            "root edge {root_edge} on {obstacle}{} vertex {obstacle_vertex}",
            within(*hole)
        ),
    }
}

/// Several contacts in a row.
pub(super) fn contacts(list: &[EventContact]) -> String {
    let words: Vec<String> = list.iter().map(any_contact).collect();
    words.join(", ")
}

/// The last event of a kind that brings the motion to the end that the outcome tells.
pub(super) fn last_cause(result: &ResultDocument) -> Option<&EventDocument> {
    let causes: &[&str] = match result.outcome.kind {
        "jammed" => &["jam-incompatible", "jam-single"],
        "stuck" => &["stick"],
        "bifurcated" => &["bifurcation"],
        "root-collision" => &["root-collision"],
        _ => return None,
    };
    result
        .pawls
        .iter()
        .filter(|p| {
            result
                .outcome
                .pawl
                .as_ref()
                .is_none_or(|name| *name == p.name)
        })
        .filter_map(|p| p.events.iter().rev().find(|e| causes.contains(&e.kind)))
        .next()
}

/// What happened, in one sentence: how, when, where.
pub(super) fn headline(result: &ResultDocument) -> String {
    let o = &result.outcome;
    let verb = match o.kind {
        "completed" => "completes its plan",
        "jammed" => "jams",
        "stuck" => "sticks",
        "root-collision" => "stops: the root collides",
        "bifurcated" => "comes to a fork",
        _ => "is undecided: a limit was reached",
    };
    format!(
        "{} {verb} at t {}{}, the root displaced by {}",
        result.scene,
        equals(&o.time),
        in_phase(result, o),
        place(o)
    )
}

fn in_phase(result: &ResultDocument, o: &OutcomeDocument) -> String {
    match (o.kind, result.phases.len()) {
        ("completed", 1) => String::new(),
        ("completed", n) => format!(" after {n} phases"),
        _ => format!(" in phase {}", o.phase),
    }
}

fn place(o: &OutcomeDocument) -> String {
    format!("({}, {})", short(&o.position[0]), short(&o.position[1]))
}

/// Why it ended, if there is more to say than the headline does.
pub(super) fn reason(result: &ResultDocument) -> Option<String> {
    let o = &result.outcome;
    let cause = last_cause(result)?;
    let who = format!("“{}”", o.pawl.as_deref().unwrap_or_default());
    let what = contacts(&cause.contacts);
    let theta = degrees(cause.theta);
    Some(match (o.kind, cause.kind) {
        ("jammed", "jam-incompatible") => {
            format!("pawl {who}, turned by {theta}, has no way on between its contacts: {what}")
        }
        ("jammed", _) => {
            format!("pawl {who}, turned by {theta}, has no way on past its contact: {what}")
        }
        ("stuck", _) => format!("friction holds pawl {who}, turned by {theta}: {what}"),
        ("bifurcated", _) => {
            format!("pawl {who} is struck so that both ways round are open: {what}")
        }
        _ => what,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_abbreviated() {
        assert_eq!(digits(1.0 / 3.0, 6), "0.333333");
        assert_eq!(digits(-1234567.0, 6), "−1234567");
        assert_eq!(digits(-1.5e-9, 6), "−1.5e−9");
        assert_eq!(digits(2.5e12, 6), "2.5e12");
        assert_eq!(digits(0.1 + 0.2, 6), "0.3");
        assert_eq!(degrees(-1e-9), "0.00°");
        assert_eq!(degrees(std::f64::consts::FRAC_PI_6), "30.00°");
    }

    #[test]
    fn polynomials_spelled_out() {
        let poly =
            |c: &[&str]| polynomial_text(&c.iter().map(|s| s.to_string()).collect::<Vec<_>>());
        assert_eq!(poly(&["-2", "0", "1"]).as_deref(), Some("t²−2=0"));
        assert_eq!(poly(&["1", "-1", "3"]).as_deref(), Some("3t²−t+1=0"));
        assert_eq!(poly(&["1", "0", "0", "0", "0", "1"]), None);
    }
}
