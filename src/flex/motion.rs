//! Proof that a whole motion is free of collision, or its exact first contact.
//!
//! Between two rational configurations every body moves along one curve: its reference point on a
//! straight line, its angle so that tan of half the turn grows in proportion to s ∈ [0, 1]. With
//! E = 1 + w²s² for each body, the signed distance of a vertex from an edge's line is
//! F(s) / (E₁E₂) with a polynomial F of degree at most 5 and rational coefficients; so is the
//! place of the vertex's foot along the edge. A sign of such a function on an interval is proven
//! by its Bernstein coefficients.
//!
//! **What is proven.** Bodies whose interiors are disjoint at s = 0 can only come to overlap if
//! some vertex of one passes from the outer to the inner side of the line of an edge of the other
//! while its foot is on the closed edge (even where two corners meet exactly: of the lines through
//! that point one is passed so). So it suffices that for every vertex and edge, on every piece of
//! a subdivision of [0, 1], one of these holds: the distance is nowhere negative; the foot is
//! nowhere on the closed edge; or the distance is nowhere positive and at the piece's start
//! negative, or the foot off the edge there.
//!
//! Doubles with proven error bounds settle what is clear; the rest is decided in rationals. Where
//! subdivision ends without a proof the exact roots tell when the vertex passes.

use super::model::{Scaffold, turned_by};
use super::pairs::{box_of, meeting};
use super::shape::{Placed, Pose, cross, dot, double};
use crate::geometry::{Box2, Corner};
use crate::number::{Algebraic, Int, Interval, Poly, Rat};
use std::ops::{Add, Mul, Sub};

/// A moment at which a vertex passes into a body.
#[derive(Clone, Debug)]
pub struct Contact {
    /// The edge: its body and index.
    pub edge: (usize, usize),
    /// The vertex: its body and index.
    pub vertex: (usize, usize),
    /// When, as a part of the motion.
    pub time: Algebraic,
}

/// What a proof looked at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ProofSize {
    /// Pairs of bodies that may come near each other.
    pub bodies: usize,
    /// Vertices against edges.
    pub pairs: usize,
    /// Of these, decided in rationals.
    pub exact: usize,
}

/// Deepest subdivision of the motion.
const DEPTH: u32 = 12;

/// A motion of all bodies between two configurations.
pub(crate) struct Motion<'a> {
    scaffold: &'a Scaffold,
    placed: Vec<Placed>,
    /// Displacements of the reference points, and tan of half the turns.
    shift: Vec<[Rat; 2]>,
    turn: Vec<Rat>,
    near_shift: Vec<[f64; 2]>,
    near_turn: Vec<f64>,
}

impl<'a> Motion<'a> {
    pub(crate) fn new(scaffold: &'a Scaffold, from: &[Pose], to: &[Pose]) -> Motion<'a> {
        let shift: Vec<[Rat; 2]> = from
            .iter()
            .zip(to)
            .map(|(a, b)| [&b.place.x - &a.place.x, &b.place.y - &a.place.y])
            .collect();
        let turn: Vec<Rat> = from.iter().zip(to).map(|(a, b)| turned_by(a, b)).collect();
        Motion {
            placed: scaffold.place(from),
            near_shift: shift
                .iter()
                .map(|d| [double(&d[0]), double(&d[1])])
                .collect(),
            near_turn: turn.iter().map(double).collect(),
            scaffold,
            shift,
            turn,
        }
    }

    /// Proves the motion free of collision.
    ///
    /// # Errors
    /// Contacts, one of each pair of bodies that meet.
    pub(crate) fn prove(&self) -> Result<ProofSize, Vec<Contact>> {
        self.look(false)
    }

    /// The contact that comes first, if there is any; of contacts at one time the one of the first
    /// bodies. Costs the roots of every passing, which [`Motion::prove`] ends at.
    pub(crate) fn first_contact(&self) -> Option<Contact> {
        let contacts = self.look(true).err()?;
        contacts.into_iter().min_by(|a, b| a.time.cmp(&b.time))
    }

    /// Looks at every pair of bodies: for any contact, or for the first.
    fn look(&self, first: bool) -> Result<ProofSize, Vec<Contact>> {
        let mut size = ProofSize::default();
        let mut contacts = Vec::new();
        let boxes: Vec<Box2> = (0..self.placed.len()).map(|b| self.swept(b)).collect();
        let still = |b: usize| self.turn[b].is_zero() && self.shift[b].iter().all(Rat::is_zero);
        for (a, b) in meeting(&boxes, 0.0) {
            if still(a) && still(b) {
                continue;
            }
            size.bodies += 1;
            for (one, two) in [(a, b), (b, a)] {
                if let Err(contact) = self.one_way(one, two, first, &mut size) {
                    contacts.push(contact);
                    if !first {
                        break;
                    }
                }
            }
        }
        if contacts.is_empty() {
            Ok(size)
        } else {
            Err(contacts)
        }
    }

    /// A box that a body never leaves.
    fn swept(&self, b: usize) -> Box2 {
        let still = box_of(&self.placed[b]);
        let [dx, dy] = self.near_shift[b];
        // A point turns through at most 2|w| radians.
        let turned = 2.0 * self.near_turn[b].abs() * self.scaffold.shapes[b].reach;
        let grow = (dx.abs().max(dy.abs()) + turned) * (1.0 + 1e-9) + 1e-9;
        let wide = |i: Interval| Interval {
            lo: i.lo - grow,
            hi: i.hi + grow,
        };
        Box2 {
            x: wide(still.x),
            y: wide(still.y),
        }
    }

    /// Vertices of `two` against edges of `one`; a contact that is found ends it, unless the first
    /// is asked for.
    fn one_way(
        &self,
        one: usize,
        two: usize,
        first: bool,
        size: &mut ProofSize,
    ) -> Result<(), Contact> {
        let mut earliest: Option<Contact> = None;
        let (s1, s2) = (&self.scaffold.shapes[one], &self.scaffold.shapes[two]);
        let (p1, p2) = (&self.placed[one], &self.placed[two]);
        let (w1, w2) = (self.near_turn[one], self.near_turn[two]);
        // The vertex as seen from body one, at both ends of the motion; between them it strays
        // from the straight way by no more than `stray`.
        let local = |w1: f64, w2: f64, s: f64, v: &[f64; 2]| {
            let turned = |cos: f64, sin: f64, w: f64, [x, y]: [f64; 2]| {
                let e = 1.0 + w * w;
                let (c, k) = ((1.0 - w * w) / e, 2.0 * w / e);
                let (c, k) = (c * cos - k * sin, k * cos + c * sin);
                ([c * x - k * y, k * x + c * y], c, k)
            };
            let (r, _, _) = turned(p2.cos, p2.sin, w2, *v);
            let (_, c, k) = turned(p1.cos, p1.sin, w1, [0.0, 0.0]);
            let at = |i: usize| {
                let shift = self.near_shift[two][i] - self.near_shift[one][i];
                p2.centre[i] - p1.centre[i] + s * shift + r[i]
            };
            let (x, y) = (at(0), at(1));
            [c * x + k * y, c * y - k * x]
        };
        // How far apart the reference points ever are, and how far one moves past the other.
        let (far, drift) = {
            let d = |i: usize| (p2.centre[i] - p1.centre[i]).abs();
            let m = |i: usize| (self.near_shift[two][i] - self.near_shift[one][i]).abs();
            (d(0) + d(1) + m(0) + m(1), m(0) + m(1))
        };
        // |ρ″| of ρ(s) = R₁(s)ᵀ(Δ(s) + R₂(s)r): angles have |φ′| ≤ 2|w|, |φ″| ≤ 2|w|².
        let (a1, a12) = (2.0 * w1.abs(), 2.0 * (w1.abs() + w2.abs()));
        let bend =
            (a1 * a1 + w1 * w1 * 2.0) * far + 2.0 * a1 * drift + (a12 * a12 * 1.5) * s2.reach;
        let size_of_all = far + s1.reach + s2.reach + p1.centre[0].abs() + p1.centre[1].abs();
        let stray = bend / 8.0 * (1.0 + 1e-6) + 1e-9 * (1.0 + size_of_all);
        let reach = |ring: &[[f64; 2]], i: usize| {
            ring.iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), p| {
                    (l.min(p[i]), h.max(p[i]))
                })
        };
        let (bx, by) = (reach(&s1.local, 0), reach(&s1.local, 1));
        for v in 0..s2.len() {
            if s2.corners[v] != Corner::Convex {
                continue;
            }
            let start = local(0.0, 0.0, 0.0, &s2.local[v]);
            let end = local(w1, w2, 1.0, &s2.local[v]);
            let span = |i: usize| (start[i].min(end[i]) - stray, start[i].max(end[i]) + stray);
            let (x, y) = (span(0), span(1));
            let apart = |a: (f64, f64), b: (f64, f64)| a.1 < b.0 || b.1 < a.0;
            // NaN compares false: what is not surely apart is looked at.
            if apart(x, bx) || apart(y, by) {
                continue;
            }
            for k in 0..s1.len() {
                let (p, q) = (s1.local[k], s1.local[(k + 1) % s1.len()]);
                let pad = 1e-9 * (1.0 + s1.reach);
                let side = |i: usize| (p[i].min(q[i]) - pad, p[i].max(q[i]) + pad);
                if apart(x, side(0)) || apart(y, side(1)) {
                    continue;
                }
                size.pairs += 1;
                let quick = self.functions(one, k, two, v, &|r: &Rat| r.interval());
                if cleared(&quick, 0) {
                    continue;
                }
                size.exact += 1;
                let exact = self.functions(one, k, two, v, &Rat::clone);
                if cleared(&exact, 0) {
                    continue;
                }
                let Some(time) = entry(&exact) else {
                    continue;
                };
                if earliest.as_ref().is_none_or(|c| time < c.time) {
                    earliest = Some(Contact {
                        edge: (one, k),
                        vertex: (two, v),
                        time,
                    });
                }
                if !first {
                    return earliest.map_or(Ok(()), Err);
                }
            }
        }
        earliest.map_or(Ok(()), Err)
    }

    /// The three functions of a vertex and an edge, times E₁E₂ and positive constants.
    fn functions<T: Number>(
        &self,
        one: usize,
        k: usize,
        two: usize,
        v: usize,
        number: &dyn Fn(&Rat) -> T,
    ) -> Functions<T> {
        let shape = &self.scaffold.shapes[one];
        let (p1, p2) = (&self.placed[one], &self.placed[two]);
        let next = (k + 1) % shape.len();
        let rat = |v: &Int, d: &Int| number(&Rat::new(v.clone(), d.clone()));
        let offset = &p2.offsets[v];
        let r = [rat(&offset[0], &p2.den), rat(&offset[1], &p2.den)];
        let at = |p: &Placed, i: usize| Rat::new(p.place[i].clone(), p.q.clone());
        let part = |i: usize| number(&(at(p2, i) - at(p1, i)));
        let delta = [part(0), part(1)];
        let part = |i: usize| number(&(&self.shift[two][i] - &self.shift[one][i]));
        let shift = [part(0), part(1)];
        let (w1, w2) = (number(&self.turn[one]), number(&self.turn[two]));
        let function = |g: &[Int; 2], base: usize| {
            let turned = p1.turn.apply(g);
            let d = &p1.turn.d;
            let constant = rat(&dot(g, &shape.vertices[base]), &shape.h);
            line_function(
                [rat(&turned[0], d), rat(&turned[1], d)],
                constant,
                [&delta, &shift, &r],
                (&w1, &w2),
                &number(&Rat::zero()),
                &number(&Rat::one()),
            )
        };
        let (a, b) = (&shape.vertices[k], &shape.vertices[next]);
        let along = [&b[0] - &a[0], &b[1] - &a[1]];
        let normal = &shape.normals[k];
        debug_assert!(cross(normal, &along).sign() * shape.sense > 0);
        let back = [-&along[0], -&along[1]];
        Functions {
            distance: function(normal, k),
            // Positive where the foot lies before the start, past the end.
            before: function(&back, k),
            past: function(&along, next),
        }
    }
}

/// What the two kinds of arithmetic share.
pub(crate) trait Number:
    Clone + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self>
{
    /// Surely not negative.
    fn at_least_zero(&self) -> bool;
    /// Surely positive.
    fn positive(&self) -> bool;
    /// Surely not positive.
    fn at_most_zero(&self) -> bool;
    /// Half.
    fn half(self) -> Self;
}

impl Number for Interval {
    fn at_least_zero(&self) -> bool {
        self.lo >= 0.0
    }
    fn positive(&self) -> bool {
        self.lo > 0.0
    }
    fn at_most_zero(&self) -> bool {
        self.hi <= 0.0
    }
    fn half(self) -> Interval {
        self * Interval::point(0.5)
    }
}

impl Number for Rat {
    fn at_least_zero(&self) -> bool {
        self.sign() >= 0
    }
    fn positive(&self) -> bool {
        self.sign() > 0
    }
    fn at_most_zero(&self) -> bool {
        self.sign() <= 0
    }
    fn half(self) -> Rat {
        self * Rat::frac(1, 2)
    }
}

/// Polynomials in s, coefficients in the Bernstein basis of degree 5 on [0, 1] or a piece.
#[derive(Clone)]
struct Functions<T> {
    distance: [T; 6],
    before: [T; 6],
    past: [T; 6],
}

/// g(s)·(Δ(s) + r(s)) − c times E₁E₂, in the Bernstein basis.
fn line_function<T: Number>(
    g: [T; 2],
    constant: T,
    [delta, shift, r]: [&[T; 2]; 3],
    (w1, w2): (&T, &T),
    zero: &T,
    one: &T,
) -> [T; 6] {
    let mul = |a: &[T], b: &[T]| -> Vec<T> {
        let mut out = vec![zero.clone(); a.len() + b.len() - 1];
        for (i, x) in a.iter().enumerate() {
            for (j, y) in b.iter().enumerate() {
                out[i + j] = out[i + j].clone() + x.clone() * y.clone();
            }
        }
        out
    };
    let add = |a: Vec<T>, b: &[T]| -> Vec<T> {
        let n = a.len().max(b.len());
        let at = |v: &[T], k: usize| v.get(k).cloned().unwrap_or_else(|| zero.clone());
        (0..n).map(|k| at(&a, k) + at(b, k)).collect()
    };
    let square = |w: &T| w.clone() * w.clone();
    let twice = |v: T| v.clone() + v;
    let e = |w: &T| vec![one.clone(), zero.clone(), square(w)];
    let (e1, e2) = (e(w1), e(w2));
    // (1 − w²s²) v + 2ws v⊥.
    let turned = |v: &[T; 2], w: &T| -> [Vec<T>; 2] {
        let ww = square(w);
        let minus = |a: T| zero.clone() - a;
        [
            vec![
                v[0].clone(),
                minus(twice(w.clone() * v[1].clone())),
                minus(ww.clone() * v[0].clone()),
            ],
            vec![
                v[1].clone(),
                twice(w.clone() * v[0].clone()),
                minus(ww * v[1].clone()),
            ],
        ]
    };
    let (gs, rs) = (turned(&g, w1), turned(r, w2));
    let mut sum = vec![zero.clone(); 6];
    for i in 0..2 {
        let way = [delta[i].clone(), shift[i].clone()];
        let inner = add(mul(&way, &e2), &rs[i]);
        sum = add(sum, &mul(&gs[i], &inner));
    }
    let ee = mul(&e1, &e2);
    for (slot, v) in sum.iter_mut().zip(&ee) {
        *slot = slot.clone() - constant.clone() * v.clone();
    }
    bernstein(&sum, zero)
}

/// From powers to the Bernstein basis of degree 5: bⱼ = Σᵢ (j choose i)/(5 choose i) aᵢ, with all
/// coefficients times ten.
fn bernstein<T: Number>(powers: &[T], zero: &T) -> [T; 6] {
    const CHOOSE: [[u32; 6]; 6] = [
        [1, 0, 0, 0, 0, 0],
        [1, 1, 0, 0, 0, 0],
        [1, 2, 1, 0, 0, 0],
        [1, 3, 3, 1, 0, 0],
        [1, 4, 6, 4, 1, 0],
        [1, 5, 10, 10, 5, 1],
    ];
    let times = |v: &T, n: u32| {
        let mut out = zero.clone();
        let mut power = v.clone();
        let mut n = n;
        while n > 0 {
            if n & 1 == 1 {
                out = out + power.clone();
            }
            power = power.clone() + power;
            n >>= 1;
        }
        out
    };
    std::array::from_fn(|j| {
        (0..=j).fold(zero.clone(), |sum, i| {
            sum + times(&powers[i], 10 / CHOOSE[5][i] * CHOOSE[j][i])
        })
    })
}

impl<T: Number> Functions<T> {
    /// The two halves (de Casteljau).
    fn split(&self) -> (Functions<T>, Functions<T>) {
        fn halves<T: Number>(b: &[T; 6]) -> ([T; 6], [T; 6]) {
            let mut work = b.clone();
            let mut left = b.clone();
            for (level, first) in left.iter_mut().enumerate().skip(1) {
                for k in 0..6 - level {
                    work[k] = (work[k].clone() + work[k + 1].clone()).half();
                }
                *first = work[0].clone();
            }
            // Now work[k] is the point of level 5 − k that ends at the right.
            (left, work)
        }
        let (d1, d2) = halves(&self.distance);
        let (b1, b2) = halves(&self.before);
        let (p1, p2) = halves(&self.past);
        let make = |distance, before, past| Functions {
            distance,
            before,
            past,
        };
        (make(d1, b1, p1), make(d2, b2, p2))
    }
}

/// Whether the vertex surely does not pass the edge inwards on this piece.
fn cleared<T: Number>(f: &Functions<T>, depth: u32) -> bool {
    let all = |b: &[T; 6], test: fn(&T) -> bool| b.iter().all(test);
    if all(&f.distance, T::at_least_zero)
        || all(&f.before, T::positive)
        || all(&f.past, T::positive)
    {
        return true;
    }
    if all(&f.distance, T::at_most_zero) {
        // Behind the line all along: it matters only how that begins.
        let off = f.before[0].positive() || f.past[0].positive();
        if off || surely_negative(&f.distance[0]) {
            return true;
        }
    }
    if depth == DEPTH {
        return false;
    }
    let (left, right) = f.split();
    cleared(&left, depth + 1) && cleared(&right, depth + 1)
}

/// Surely negative: not positive, and its opposite is.
fn surely_negative<T: Number>(v: &T) -> bool {
    let opposite = (v.clone() - v.clone()) - v.clone();
    opposite.positive()
}

/// The first time at which the distance turns from non-negative to negative with the foot on the
/// closed edge.
fn entry(f: &Functions<Rat>) -> Option<Algebraic> {
    let poly = |b: &[Rat; 6]| Poly::from_rats(&powers(b));
    let (d, before, past) = (poly(&f.distance), poly(&f.before), poly(&f.past));
    let on_edge = |t: &Algebraic| t.sign_of(&before) <= 0 && t.sign_of(&past) <= 0;
    if d.is_zero() {
        return None;
    }
    let (zero, one) = (Rat::zero(), Rat::one());
    let roots = d.real_roots_in(&zero, &one);
    // Signs between consecutive roots, at rational points.
    let mut walls: Vec<Algebraic> = vec![Algebraic::from(zero.clone())];
    walls.extend(roots);
    walls.push(Algebraic::from(one));
    walls.dedup();
    let mut sign_before = 1;
    for pair in walls.windows(2) {
        let middle = Algebraic::between(&pair[0], &pair[1]);
        let sign = d.sign_at(&middle);
        let turns = sign < 0 && sign_before >= 0;
        let starts_behind = pair[0].sign_of(&d) < 0;
        if turns && !starts_behind && on_edge(&pair[0]) {
            return Some(pair[0].clone());
        }
        sign_before = sign;
    }
    None
}

/// From the Bernstein basis of degree 5 back to powers.
fn powers(b: &[Rat; 6]) -> Vec<Rat> {
    const CHOOSE: [i64; 6] = [1, 5, 10, 10, 5, 1];
    // aᵢ = (5 choose i) Δⁱb₀.
    let mut differences = b.to_vec();
    let mut out = Vec::with_capacity(6);
    for (i, choose) in CHOOSE.iter().enumerate() {
        out.push(&differences[0] * &Rat::from(*choose));
        if i < 5 {
            differences = differences.windows(2).map(|w| &w[1] - &w[0]).collect();
        }
    }
    out
}
