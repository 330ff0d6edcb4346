//! The face of bare arcs as a question with an answer, for the library and for the command line.

use super::kernel::{Defect, Kernel, Stats};
use super::merge::{Face, divide, walk, walk_within};
use super::read::{ArcFile, ReadError, SourceArc, Upright};
use super::trace::{Carrier, Item, NONE, OnArc, Point};
use crate::geometry::index::EMPTY;
use crate::number::Rat;
use serde::Serialize;
use std::fmt;
use std::path::PathBuf;

/// Which way leads to the face. The answer does not depend on it.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, clap::ValueEnum)]
pub enum Method {
    /// Walk, unless that tests too many pairs for the number of arcs; then merge.
    #[default]
    Auto,
    /// Walk round the boundary among all arcs.
    Walk,
    /// Divide, and merge the faces of the halves.
    Merge,
}

/// The face that holds the start.
#[derive(Clone, Copy, Debug)]
pub struct Answer {
    /// Half-edges of its boundary: edges cut at every arc end and crossing, both sides of an antenna. An
    /// unbounded face is bounded by the plane's frame at infinity, which counts as in CGAL: a cycle of
    /// four half-edges.
    pub half_edges: u64,
    /// Boundary cycles, the frame included.
    pub components: u64,
    /// Whether no cycle of arcs encloses it.
    pub unbounded: bool,
    /// What ran: walk or merge.
    pub method: Method,
    /// How many merges were made.
    pub merges: u64,
    /// How the filters fared.
    pub stats: Stats,
}

/// Why arcs have no face that holds the start.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FaceError {
    /// The arc of this index (and line) is none, and why.
    BadArc(usize, usize, &'static str),
    /// The start lies on the arc of this index (and line).
    StartOnArc(usize, usize),
}

impl fmt::Display for FaceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = |f: &mut fmt::Formatter<'_>, i: usize, line: usize| {
            if line > 0 {
                write!(f, "{line}:1: ")
            } else {
                write!(f, "arc {i}: ")
            }
        };
        match *self {
            FaceError::BadArc(i, line, why) => {
                name(f, i, line)?;
                f.write_str(why)
            }
            FaceError::StartOnArc(i, line) => {
                name(f, i, line)?;
                f.write_str("the start lies on this arc, so no face holds it")
            }
        }
    }
}
impl std::error::Error for FaceError {}

/// Arcs a leaf of the merge tree. From 32 to 512 it made no difference on the sets of arcs; the number of ways
/// does.
const LEAF: usize = 128;

/// How many pairs the walk may test among n arcs before merging is expected to be faster: n log n times what
/// separates, on the sets of arcs and the families of `benches/growth.rs`, walks whose searches find what is
/// near (at most 20 n log n) from walks that search in vain (more the larger n is). Giving up so
/// late costs a tenth of the merge that follows.
fn patience(n: usize) -> u64 {
    let n = n as u64 + 64;
    40 * n * u64::from(n.ilog2())
}

/// The face of the arcs that holds the start: a [`Question`] with graphs only.
///
/// # Errors
/// See [`Question::answer`].
///
/// # Example
/// ```
/// use snapfit::face::{ArcFile, Method, face};
/// // Two parabolas t = ±(u² − 1) from −1 to 1 close a lens round the origin.
/// let text = "2 0 0\n-1 0 1 1 0 0  1 1 0 0  -1 1 0 0\n1 0 -1 1 0 0  1 1 0 0  -1 1 0 0\n";
/// let file = ArcFile::parse(text)?;
/// let lens = face(&file.arcs, &file.start, Method::Auto)?;
/// assert_eq!((lens.half_edges, lens.components), (2, 1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn face(arcs: &[SourceArc], start: &(Rat, Rat), method: Method) -> Result<Answer, FaceError> {
    Question {
        arcs,
        uprights: &[],
        start,
        method,
        leaf: LEAF,
    }
    .answer()
}

/// Arcs and a start, and how to look for the face.
#[derive(Clone, Copy, Debug)]
pub struct Question<'a> {
    /// The graphs.
    pub arcs: &'a [SourceArc],
    /// The verticals; they are numbered after the graphs.
    pub uprights: &'a [Upright],
    /// The point (u, t) whose face is asked for.
    pub start: &'a (Rat, Rat),
    /// The way to it.
    pub method: Method,
    /// How many arcs a leaf of the merge tree takes.
    pub leaf: usize,
}

/// A face found, and how.
pub(super) struct Found {
    pub(super) kernel: Kernel,
    pub(super) face: Face,
    method: Method,
    merges: u64,
}

impl Question<'_> {
    /// Finds the face.
    ///
    /// The walk takes time about linear in the arcs plus what its boundary meets; the merge O(λ(n) log² n)
    /// in the spirit of Lemma 9.2, with an index in place of the sweep.
    ///
    /// # Errors
    /// If an arc is none (no such root, ends in the wrong order, a pole inside), or the start lies on one.
    pub fn answer(&self) -> Result<Answer, FaceError> {
        let found = self.find()?;
        let frame = u64::from(found.face.unbounded);
        Ok(Answer {
            half_edges: found.face.half_edges + 4 * frame,
            components: found.face.comps.len() as u64 + frame,
            unbounded: found.face.unbounded,
            method: found.method,
            merges: found.merges,
            stats: found.kernel.stats,
        })
    }

    /// Finds the face, with all that is known of it.
    pub(super) fn find(&self) -> Result<Found, FaceError> {
        let line = |i: usize| self.arcs.get(i).map_or(0, |a| a.line);
        let bad = |i: usize| move |why| FaceError::BadArc(i, line(i), why);
        let mut k = Kernel::default();
        let mut items = Vec::with_capacity(self.arcs.len() + self.uprights.len());
        for (i, arc) in self.arcs.iter().enumerate() {
            items.push(graph(&mut k, arc, i).map_err(bad(i))?);
        }
        for (i, arc) in self.uprights.iter().enumerate() {
            let i = self.arcs.len() + i;
            items.push(upright(&mut k, arc, i).map_err(bad(i))?);
        }
        let start = Point {
            x: k.rational(&self.start.0),
            c: k.constant(&self.start.1),
        };
        let mut merges = 0;
        let mut method = self.method;
        let found = match method {
            Method::Merge => divide(&mut k, &items, start, self.leaf, &mut merges),
            Method::Walk => walk(&mut k, &items, start),
            Method::Auto => match walk_within(&mut k, &items, start, patience(items.len())) {
                Ok(None) => {
                    method = Method::Merge;
                    divide(&mut k, &items, start, self.leaf, &mut merges)
                }
                walked => {
                    method = Method::Walk;
                    walked.map(|f| f.expect("not given up"))
                }
            },
        };
        Ok(Found {
            face: found.map_err(|OnArc(i)| FaceError::StartOnArc(i as usize, line(i as usize)))?,
            kernel: k,
            method,
            merges,
        })
    }
}

pub(super) fn why(d: Defect) -> &'static str {
    match d {
        Defect::NoSuchRoot => "an end names a root that its equation does not have",
        Defect::NoDenominator => "the denominator is zero",
    }
}

pub(super) fn graph(k: &mut Kernel, arc: &SourceArc, index: usize) -> Result<Item, &'static str> {
    let c = k.curve(&arc.p, &arc.q).map_err(why)?;
    let l = k.root(&arc.left.c, arc.left.k).map_err(why)?;
    let r = k.root(&arc.right.c, arc.right.k).map_err(why)?;
    if !k.cmp(l, r).is_lt() {
        return Err("the left end is not left of the right one");
    }
    if !k.bounded(c, l, r) {
        return Err("the denominator vanishes on the arc");
    }
    Ok(Item {
        carrier: Carrier::Graph(c),
        l,
        r,
        vl: NONE,
        vr: NONE,
        color: 0,
        comp: 0,
        arc: index as u32,
        bounds: EMPTY,
    })
}

pub(super) fn upright(k: &mut Kernel, arc: &Upright, index: usize) -> Result<Item, &'static str> {
    let x = k.root(&arc.u.c, arc.u.k).map_err(why)?;
    let low = k.curve(&arc.low[0], &arc.low[1]).map_err(why)?;
    let high = k.curve(&arc.high[0], &arc.high[1]).map_err(why)?;
    if k.denominator_sign(low, x) == 0 || k.denominator_sign(high, x) == 0 {
        return Err("a curve that ends a vertical has a pole there");
    }
    if !k.cmp_at(low, high, x).is_lt() {
        return Err("the lower end is not below the upper one");
    }
    let carrier = Carrier::Vertical(low, high);
    Ok(Item {
        carrier,
        l: x,
        r: x,
        vl: NONE,
        vr: NONE,
        color: 0,
        comp: 0,
        arc: index as u32,
        bounds: EMPTY,
    })
}

/// What `snapfit face` takes.
#[derive(Clone, Debug, clap::Args)]
pub struct Args {
    /// The arcs, `.arcs` or `.arcs.gz`; `-` is standard input
    pub file: PathBuf,
    /// Which way leads to the face
    #[arg(long = "face", value_enum, default_value_t = Method::Auto)]
    pub method: Method,
    /// Also say on standard error how the filters fared
    #[arg(long)]
    pub ledger: bool,
}

/// What `snapfit face` prints.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Half-edges of the face's boundary, see [`Answer::half_edges`].
    pub half_edges: u64,
    /// Boundary cycles.
    pub components: u64,
    /// CPU seconds from parsed arcs to the answer.
    pub seconds: f64,
    /// What ran.
    pub method: &'static str,
    /// Whether the face is unbounded.
    pub unbounded: bool,
}

/// Reads the file, finds the face and says what it found.
///
/// # Errors
/// Bad input, as one line `file:line:column: what is wrong`.
pub fn run_cli(args: &Args) -> Result<Report, String> {
    let place = |e: &dyn fmt::Display| {
        let separator = if e.to_string().starts_with(|c: char| c.is_ascii_digit()) {
            ":"
        } else {
            ": "
        };
        format!("{}{separator}{e}", args.file.display())
    };
    let file = ArcFile::open(&args.file).map_err(|e: ReadError| place(&e))?;
    let from = cpu_seconds();
    let answer = face(&file.arcs, &file.start, args.method).map_err(|e| place(&e))?;
    let seconds = cpu_seconds() - from;
    if args.ledger {
        eprintln!("{answer:?}");
    }
    Ok(Report {
        half_edges: answer.half_edges,
        components: answer.components,
        seconds,
        method: if answer.method == Method::Merge {
            "merge"
        } else {
            "walk"
        },
        unbounded: answer.unbounded,
    })
}

/// CPU seconds that this process has used.
fn cpu_seconds() -> f64 {
    let t = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    t.tv_sec as f64 + t.tv_nsec as f64 * 1e-9
}
