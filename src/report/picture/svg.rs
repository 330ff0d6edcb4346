//! A pen that writes SVG: shapes, markers and text, escaped, with few digits.

use std::fmt::Write;

/// Text and outlines.
pub(crate) const INK: &str = "#1f2933";
/// Secondary text.
pub(crate) const MUTED: &str = "#52606d";
/// Axes and frames.
pub(crate) const RULE: &str = "#9aa5b1";
/// Contact points.
pub(crate) const CONTACT: &str = "#c1121f";

/// A point of the page, y downwards, or of the plane, y upwards.
pub(crate) type Point = [f64; 2];

/// A document being written.
pub(crate) struct Svg {
    body: String,
    clips: usize,
}

/// About how wide a text is: a fair estimate for sans-serif faces.
pub(crate) fn text_width(text: &str, size: f64) -> f64 {
    let wide = |c: char| match c {
        'i' | 'j' | 'l' | '.' | ',' | ':' | '\'' | '|' | '(' | ')' | ' ' | 't' | 'f' | 'r' => 0.38,
        'm' | 'w' | 'M' | 'W' | '…' | '→' | '≈' | '−' => 0.9,
        c if c.is_ascii_uppercase() => 0.7,
        c if c.is_ascii() => 0.61,
        _ => 1.0,
    };
    text.chars().map(wide).sum::<f64>() * size
}

/// A coordinate to a hundredth of a pixel.
fn n(x: f64) -> String {
    let x = if x.is_finite() {
        x.clamp(-1e6, 1e6)
    } else {
        0.0
    };
    let text = format!("{x:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" {
        "0".to_owned()
    } else {
        text.to_owned()
    }
}

/// Text safe between tags and within quotes.
fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            // XML 1.0 has no place for control characters, nor for these two.
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

impl Svg {
    pub(crate) fn new() -> Svg {
        Svg {
            body: String::new(),
            clips: 0,
        }
    }

    pub(crate) fn finish(self, width: f64, height: f64, title: &str, about: &str) -> String {
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" width=\"{w}\" height=\"{h}\" \
             viewBox=\"0 0 {w} {h}\" font-family=\"Helvetica, Arial, 'DejaVu Sans', sans-serif\">\n\
             <title>{}</title>\n<desc>{}</desc>\n\
             <rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n{}</svg>\n",
            escape(title),
            escape(about),
            self.body,
            w = n(width),
            h = n(height),
        )
    }

    fn tag(&mut self, text: std::fmt::Arguments<'_>) {
        // Writing to a string cannot fail.
        let _ = self.body.write_fmt(text);
        self.body.push('\n');
    }

    #[allow(
        clippy::too_many_arguments,
        reason = "a line of text has as many properties"
    )]
    pub(crate) fn text(
        &mut self,
        x: f64,
        y: f64,
        size: f64,
        fill: &str,
        anchor: &str,
        bold: bool,
        text: &str,
    ) {
        let weight = if bold { " font-weight=\"bold\"" } else { "" };
        self.tag(format_args!(
            "<text x=\"{}\" y=\"{}\" font-size=\"{}\" fill=\"{fill}\" text-anchor=\"{anchor}\"{weight}>{}</text>",
            n(x),
            n(y),
            n(size),
            escape(text)
        ));
    }

    /// A line of text that reads upwards, about its middle.
    pub(crate) fn upward(&mut self, [x, y]: Point, size: f64, colour: &str, text: &str) {
        self.tag(format_args!(
            "<g transform=\"translate({} {}) rotate(-90)\">",
            n(x),
            n(y)
        ));
        self.text(0.0, 0.0, size, colour, "middle", false, text);
        self.end();
    }

    /// A rectangle by its corner, width and height.
    pub(crate) fn rect(&mut self, [x, y, w, h]: [f64; 4], fill: &str, stroke: &str) {
        self.tag(format_args!(
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"{fill}\" stroke=\"{stroke}\"/>",
            n(x),
            n(y),
            n(w.max(0.0)),
            n(h.max(0.0))
        ));
    }

    pub(crate) fn line(&mut self, a: Point, b: Point, stroke: &str, width: f64, dash: &str) {
        self.polyline(&[a, b], stroke, width, dash);
    }

    pub(crate) fn polyline(&mut self, points: &[Point], stroke: &str, width: f64, dash: &str) {
        let style = format!(
            "fill=\"none\" stroke=\"{stroke}\" stroke-width=\"{}\"",
            n(width)
        );
        let dash = if dash.is_empty() {
            String::new()
        } else {
            format!(" stroke-dasharray=\"{dash}\"")
        };
        self.tag(format_args!(
            "<path d=\"{}\" {style}{dash} stroke-linejoin=\"round\" stroke-linecap=\"round\"/>",
            path(points, false)
        ));
    }

    /// Closed rings as one shape, holes by the even-odd rule.
    pub(crate) fn shape(&mut self, rings: &[Vec<Point>], style: &str) {
        let d: Vec<String> = rings
            .iter()
            .filter(|r| r.len() > 2)
            .map(|r| path(r, true))
            .collect();
        if !d.is_empty() {
            self.tag(format_args!(
                "<path d=\"{}\" fill-rule=\"evenodd\" stroke-linejoin=\"round\" {style}/>",
                d.join("")
            ));
        }
    }

    pub(crate) fn circle(&mut self, [x, y]: Point, r: f64, fill: &str, stroke: &str, width: f64) {
        self.tag(format_args!(
            "<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{fill}\" stroke=\"{stroke}\" stroke-width=\"{}\"/>",
            n(x),
            n(y),
            n(r),
            n(width)
        ));
    }

    /// An arrow from a to b.
    pub(crate) fn arrow(&mut self, a: Point, b: Point, stroke: &str) {
        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
        let l = dx.hypot(dy).max(1e-9);
        let (ux, uy) = (dx / l, dy / l);
        let foot = [b[0] - 7.0 * ux, b[1] - 7.0 * uy];
        self.line(a, foot, stroke, 1.6, "");
        let side = |s: f64| [foot[0] - 3.2 * s * uy, foot[1] + 3.2 * s * ux];
        self.shape(
            &[vec![side(1.0), b, side(-1.0)]],
            &format!("fill=\"{stroke}\""),
        );
    }

    /// Opens a group that shows only what lies in a rectangle; close it with [`Svg::end`].
    pub(crate) fn clip(&mut self, rect: [f64; 4]) {
        self.clips += 1;
        let id = self.clips;
        let [x, y, w, h] = rect.map(n);
        self.tag(format_args!(
            "<clipPath id=\"c{id}\"><rect x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\"/></clipPath>\n\
             <g clip-path=\"url(#c{id})\">"
        ));
    }

    pub(crate) fn end(&mut self) {
        self.tag(format_args!("</g>"));
    }

    /// The mark of an event of some kind.
    pub(crate) fn marker(&mut self, kind: &str, at: Point, colour: &str) {
        let [x, y] = at;
        let white = "#ffffff";
        let poly = |points: &[Point]| -> Vec<Vec<Point>> {
            vec![points.iter().map(|p| [x + p[0], y + p[1]]).collect()]
        };
        let filled = format!("fill=\"{colour}\" stroke=\"{white}\" stroke-width=\"0.8\"");
        match kind {
            "translational-collision" => self.circle(at, 4.2, colour, white, 0.8),
            "sliding-collision" => {
                self.shape(
                    &poly(&[[0.0, -5.0], [5.0, 0.0], [0.0, 5.0], [-5.0, 0.0]]),
                    &filled,
                );
            }
            "release" => self.circle(at, 3.8, white, colour, 1.6),
            "graze" => self.circle(at, 2.4, white, colour, 1.0),
            "snap-free" => {
                self.shape(&poly(&[[-4.8, -3.8], [4.8, -3.8], [0.0, 4.8]]), &filled);
            }
            "snap-free-vertex" => {
                let hollow = format!("fill=\"{white}\" stroke=\"{colour}\" stroke-width=\"1.6\"");
                self.shape(&poly(&[[-4.6, -3.6], [4.6, -3.6], [0.0, 4.6]]), &hollow);
            }
            "snap-landing" => {
                self.shape(&poly(&[[-4.8, 3.8], [4.8, 3.8], [0.0, -4.8]]), &filled);
            }
            "limit-stop" => {
                self.shape(
                    &poly(&[[-4.0, -4.0], [4.0, -4.0], [4.0, 4.0], [-4.0, 4.0]]),
                    &filled,
                );
            }
            "stick" => {
                let hold = format!("fill=\"{INK}\" stroke=\"{white}\" stroke-width=\"0.8\"");
                self.shape(
                    &poly(&[[-4.6, -4.6], [4.6, -4.6], [4.6, 4.6], [-4.6, 4.6]]),
                    &hold,
                );
            }
            "jam-incompatible" | "jam-single" => {
                for s in [-1.0, 1.0] {
                    let (a, b) = ([x - 4.6, y - 4.6 * s], [x + 4.6, y + 4.6 * s]);
                    self.line(a, b, white, 4.6, "");
                }
                for s in [-1.0, 1.0] {
                    let (a, b) = ([x - 4.6, y - 4.6 * s], [x + 4.6, y + 4.6 * s]);
                    self.line(a, b, CONTACT, 2.4, "");
                }
            }
            "bifurcation" => {
                for tip in [[4.5, -5.0], [4.5, 5.0], [-6.0, 0.0]] {
                    self.line(at, [x + tip[0], y + tip[1]], CONTACT, 2.2, "");
                }
            }
            _ => {
                self.line([x - 5.0, y], [x + 5.0, y], INK, 2.2, "");
                self.line([x, y - 5.0], [x, y + 5.0], INK, 2.2, "");
            }
        }
    }
}

fn path(points: &[Point], closed: bool) -> String {
    let mut d = String::new();
    for (i, p) in points.iter().enumerate() {
        let _ = write!(
            d,
            "{}{} {}",
            if i == 0 { "M" } else { "L" },
            n(p[0]),
            n(p[1])
        );
    }
    if closed {
        d.push('Z');
    }
    d
}

/// What of a ring lies in a rectangle [x0, y0, x1, y1] (Sutherland and Hodgman): keeps a wall of a
/// thousand units from reaching a renderer.
pub(crate) fn clipped(ring: &[Point], [x0, y0, x1, y1]: [f64; 4]) -> Vec<Point> {
    let sides = [(0, x0, 1.0), (0, x1, -1.0), (1, y0, 1.0), (1, y1, -1.0)];
    let mut ring = ring.to_vec();
    for (axis, bound, sign) in sides {
        let inside = |p: &Point| (p[axis] - bound) * sign >= 0.0;
        let mut next = Vec::with_capacity(ring.len() + 4);
        for i in 0..ring.len() {
            let (a, b) = (ring[i], ring[(i + 1) % ring.len()]);
            if inside(&a) {
                next.push(a);
            }
            if inside(&a) != inside(&b) {
                let s = (bound - a[axis]) / (b[axis] - a[axis]);
                let mut p = [a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1])];
                p[axis] = bound;
                next.push(p);
            }
        }
        ring = next;
    }
    ring
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_cannot_break_out() {
        assert_eq!(
            escape("<a & \"b\">\u{1}"),
            "&lt;a &amp; &quot;b&quot;&gt;\u{fffd}"
        );
    }

    #[test]
    fn a_long_wall_is_cut() {
        let wall = [[-1e9, 0.0], [1e9, 0.0], [1e9, 1.0], [-1e9, 1.0]];
        let cut = clipped(&wall, [-2.0, -2.0, 2.0, 2.0]);
        assert_eq!(cut.len(), 4);
        assert!(
            cut.iter()
                .all(|p| p[0].abs() <= 2.0 && (0.0..=1.0).contains(&p[1]))
        );
        assert!(clipped(&wall, [0.0, 5.0, 1.0, 6.0]).is_empty());
    }
}
