//! Numbers too near for doubles, told apart from a point close by.
//!
//! The idea: two numbers 2⁻²⁰⁰ apart have the same enclosures, but seen from a dyadic point a close to both, their
//! distances x − a are doubles with all their digits. The distance of a root x of h from a is −h(a)/h'(ξ)
//! with ξ between: h(a) is computed exactly, once, in integers, and the slope with error bounds over the
//! enclosure that holds x and a. That takes a few long products a number, where an isolation takes
//! hundreds. One point, a *frame*, serves a whole cluster; it comes from the first number that had a neighbour.
//! For a crossing h(a) comes from doubles too: how far its two curves are from a third one at a, exactly and once a
//! curve, is known with all digits however near one another all of them are.
//! The second level is for numbers that even the first frame does not tell apart.

use super::approx::{Approx, horner};
use super::compare::slope_of;
use super::kernel::{Coeffs, CurveId, Def, Kernel, NumId};
use crate::number::{Int, Rat};
use std::cmp::Ordering;

/// The dyadic point `at`·2^-bits.
pub(super) struct Frame {
    /// The number that it was made for.
    owner: NumId,
    at: Int,
    bits: u64,
    /// It lies in [lo, hi].
    lo: f64,
    hi: f64,
    /// The curve from which others are seen there: the first that came.
    reference: Option<CurveId>,
}

/// A difference of two curves is taken from doubles if its error is at most so large a part of it.
const SHARP: f64 = 1.0 / (1u64 << 32) as f64;

/// How many bits after the point the frames of each level have.
const LEVELS: [u32; 2] = [320, 1280];

/// How many of the last frames are tried for numbers of a cluster that goes by another key.
const LAST: usize = 8;

impl Kernel {
    /// The order of two numbers by frames of a level; None where these do not tell (equal numbers, above all).
    pub(super) fn cmp_in_frames(&mut self, x: NumId, y: NumId, level: usize) -> Option<Ordering> {
        for id in [x, y] {
            if let Some(&(f, _)) = self.local.get(&id)
                && self.frames[f as usize].bits > u64::from(LEVELS[level])
            {
                return self.cmp_from(x, y, f);
            }
        }
        let old = self.old_frame(x, y, level);
        if let Some(f) = old {
            if let Some(o) = self.are_owner(x, y, f).or_else(|| self.cmp_from(x, y, f)) {
                return Some(o);
            }
            if self.is_at(x, f) || self.is_at(y, f) {
                // Another frame there would not tell more.
                return None;
            }
        }
        let f = self.new_frame(x, LEVELS[level]);
        self.frame_near.insert(self.frame_key(x, level), f);
        self.are_owner(x, y, f).or_else(|| self.cmp_from(x, y, f))
    }

    /// The same by a frame that is there already: the finest, which tells more than any other and costs, once each
    /// curve was seen from it, no more.
    pub(super) fn cmp_in_old_frame(&mut self, x: NumId, y: NumId) -> Option<Ordering> {
        for level in (0..LEVELS.len()).rev() {
            if let Some(f) = self.old_frame(x, y, level) {
                return self.are_owner(x, y, f).or_else(|| self.cmp_from(x, y, f));
            }
        }
        None
    }

    fn frame_key(&self, x: NumId, level: usize) -> (u64, usize) {
        (self.nums[x as usize].lo.to_bits() >> 16, level)
    }

    /// The frame made last near two numbers.
    fn old_frame(&mut self, x: NumId, y: NumId, level: usize) -> Option<u32> {
        let key = self.frame_key(x, level);
        if let Some(&f) = self.frame_near.get(&key) {
            return Some(f);
        }
        // The cluster may straddle the keys.
        let f = self.frame_beside(x, y, level)?;
        self.frame_near.insert(key, f);
        Some(f)
    }

    /// One of the last frames made, of this level, that lies about as near to two numbers as they are known.
    fn frame_beside(&self, x: NumId, y: NumId, level: usize) -> Option<u32> {
        let (x, y) = (self.enclosure(x), self.enclosure(y));
        let (lo, hi) = (x.0.min(y.0), x.1.max(y.1));
        let room = hi - lo;
        let near = |f: &Frame| {
            f.bits == u64::from(LEVELS[level]) && f.lo <= hi + room && lo - room <= f.hi
        };
        let last = self.frames.len().saturating_sub(LAST);
        let at = self.frames[last..].iter().rposition(near)?;
        Some((last + at) as u32)
    }

    /// The order of two numbers that were asked about before, which mostly are in one frame.
    pub(super) fn framed_apart(&self, x: NumId, y: NumId) -> Option<Ordering> {
        match (self.local.get(&x), self.local.get(&y)) {
            (Some(&(f, a)), Some(&(g, b))) if f == g => apart(a, b),
            _ => None,
        }
    }

    /// The frame that a number was seen from, or a new one there.
    pub(super) fn frame_of(&mut self, x: NumId) -> u32 {
        let x = self.find(x);
        if let Some(&(f, _)) = self.local.get(&x) {
            return f;
        }
        let f = self.new_frame(x, LEVELS[0]);
        self.frame_near.insert(self.frame_key(x, 0), f);
        f
    }

    /// Where a frame lies, in doubles.
    pub(super) fn frame_range(&self, f: u32) -> (f64, f64) {
        let frame = &self.frames[f as usize];
        (frame.lo, frame.hi)
    }

    /// Exact order of a number and the point at a distance from a frame.
    pub(super) fn cmp_framed(&mut self, x: NumId, f: u32, off: f64) -> Ordering {
        let point = Approx::exact(off);
        let x = self.find(x);
        let order = self.distance_from(x, f).and_then(|d| apart(d, point));
        order.unwrap_or_else(|| {
            let frame = &self.frames[f as usize];
            let at = Rat::new(frame.at.clone(), Int::one().shl(frame.bits)) + Rat::from_f64(off);
            self.exact(x).cmp_rat(&at)
        })
    }

    /// How far a curve lies above the one that others are compared with at a frame, there.
    pub(super) fn height_in_frame(&mut self, c: CurveId, f: u32) -> Option<Approx> {
        let from = *self.frames[f as usize].reference.get_or_insert(c);
        let (value, q) = self.curve_beside(c, from, f)?;
        let (_, r) = self.curve_beside(from, from, f)?;
        Some(value.over(q * r))
    }

    /// Where a number lies, roughly: a double for it, or for the frame that it was seen from and its distance.
    pub(super) fn rough(&mut self, x: NumId) -> [f64; 2] {
        let x = self.find(x);
        match self.local.get(&x) {
            Some(&(f, d)) => [self.frames[f as usize].lo, d.v],
            None => [self.enclosure(x).0, 0.0],
        }
    }

    /// Equal, if both are proven to be the number that a frame was made for, whose equation is known if it has one
    /// of low degree.
    fn are_owner(&mut self, x: NumId, y: NumId, f: u32) -> Option<Ordering> {
        let owner = self.frames[f as usize].owner;
        for id in [x, y] {
            let owner = self.find(owner);
            if self.find(id) != owner && self.same_root(owner, id) {
                self.unite(owner, id);
            }
        }
        (self.find(x) == self.find(y)).then_some(Ordering::Equal)
    }

    /// Whether a frame hardly differs from a number, as far as frames of its level go: its distance is not told from
    /// nought, is no more than another frame's would be, or was not found.
    fn is_at(&self, x: NumId, f: u32) -> bool {
        match self.local.get(&x) {
            Some(&(g, d)) => {
                let grain = 2f64.powi(8 - self.frames[f as usize].bits as i32);
                g == f && (d.sign().is_none_or(|s| s == 0) || d.v.abs() <= grain)
            }
            None => true,
        }
    }

    fn cmp_from(&mut self, x: NumId, y: NumId, f: u32) -> Option<Ordering> {
        let a = self.distance_from(x, f)?;
        let b = self.distance_from(y, f)?;
        apart(a, b)
    }

    fn new_frame(&mut self, x: NumId, bits: u32) -> u32 {
        let (lo, _) = self.exact(x).enclosure(bits);
        self.add_hub(x);
        let bits = u64::from(bits);
        let at = lo.numer().shl(bits).div_rem_floor(lo.denom()).0;
        let i = Rat::new(at.clone(), Int::one().shl(bits)).interval();
        self.frames.push(Frame {
            owner: x,
            at,
            bits,
            lo: i.lo,
            hi: i.hi,
            reference: None,
        });
        self.frames.len() as u32 - 1
    }

    /// The distance of a number from a frame.
    fn distance_from(&mut self, x: NumId, f: u32) -> Option<Approx> {
        if let Some(&(g, d)) = self.local.get(&x)
            && g == f
        {
            return Some(d);
        }
        // The exact value of h at the frame, and h.
        let (value, h) = match self.nums[x as usize].def {
            Def::Root(i) => {
                let (m, _) = self.roots[i as usize];
                let frame = &self.frames[f as usize];
                let value = at_frame(&m.map(Int::from), frame);
                let value = scaled(&value, 2 * frame.bits)?;
                let mut h = [Approx::default(); 5];
                for (h, &c) in h.iter_mut().zip(&m) {
                    *h = Approx::from_word(c);
                }
                (value, h)
            }
            Def::Cross(c, d) => {
                let value = match self.difference_beside(c, d, f) {
                    Some(v) => v,
                    None => self.difference_at(c, d, f)?,
                };
                (value, self.full_difference(c, d))
            }
            Def::Known => return None,
        };
        let (frame, n) = (&self.frames[f as usize], &self.nums[x as usize]);
        let around = Approx::between(frame.lo.min(n.lo), frame.hi.max(n.hi));
        let steep = slope_of(&h);
        let slope = horner(&steep, around);
        // One root where h is steep; it is x if anything is.
        if !matches!(slope.sign(), Some(-1 | 1)) {
            return None;
        }
        let mut d = (-value).over(slope);
        // Now that x is known to be so near, its own enclosure, perhaps a wide one, no longer matters.
        let reach = d.v.abs() + d.e;
        let nearer = Approx::between((frame.lo - reach).next_down(), (frame.hi + reach).next_up());
        let slope = horner(&steep, nearer);
        if matches!(slope.sign(), Some(-1 | 1)) {
            let again = (-value).over(slope);
            if again.e < d.e {
                d = again;
            }
        }
        if !(d.v.is_finite() && d.e.is_finite()) {
            return None;
        }
        self.local.insert(x, (f, d));
        Some(d)
    }

    /// h of two curves at a frame, in long integers.
    fn difference_at(&mut self, c: CurveId, d: CurveId, f: u32) -> Option<Approx> {
        let bits = self.frames[f as usize].bits;
        let scale = self.curves[c as usize].scale + self.curves[d as usize].scale;
        for curve in [c, d] {
            self.top_at_frame(curve, f);
        }
        if self.proportional(c, d)
            && let Some(below) = self.rough_below(c, f)
        {
            // h is its part of low degree times the common denominator, which doubles tell well enough.
            let (p, r) = (&self.framed[&(c, f)], &self.framed[&(d, f)]);
            let value = p * self.lead(d) - r * self.lead(c);
            let lead = scaled(&self.lead(c), self.curves[c as usize].scale)?;
            return Some(scaled(&value, 2 * bits + scale)? * below.over(lead));
        }
        let (q, s) = (self.below_at_frame(c, f), self.below_at_frame(d, f));
        let (p, r) = (&self.framed[&(c, f)], &self.framed[&(d, f)]);
        scaled(&(p * s - r * q), 4 * bits + scale)
    }

    /// The last coefficient of a denominator.
    fn lead(&self, c: CurveId) -> Int {
        match &self.curves[c as usize].exact {
            Coeffs::Small(c) => c[3..]
                .iter()
                .rev()
                .find(|x| **x != 0)
                .copied()
                .map(Int::from),
            Coeffs::Big(c) => c[3..].iter().rev().find(|x| !x.is_zero()).cloned(),
        }
        .expect("a curve has a denominator")
    }

    /// A denominator at a frame, in doubles, where these know it sharply.
    fn rough_below(&self, c: CurveId, f: u32) -> Option<Approx> {
        let frame = &self.frames[f as usize];
        let q = &self.curves[c as usize].q;
        let value = horner(q, Approx::between(frame.lo, frame.hi));
        (value.e <= value.v.abs() * SHARP).then_some(value)
    }

    /// The same in doubles, from what lies between each of the two and a third one: long products only once a
    /// curve and not once a pair. None where the two are much nearer to each other than to that.
    fn difference_beside(&mut self, c: CurveId, d: CurveId, f: u32) -> Option<Approx> {
        let from = *self.frames[f as usize].reference.get_or_insert(c);
        let [(v, q), (w, s)] = [
            self.curve_beside(c, from, f)?,
            self.curve_beside(d, from, f)?,
        ];
        // With R the denominator of the third: h(c, d)·R = h(c, from)·Q_d − h(d, from)·Q_c.
        let (_, r) = self.curve_beside(from, from, f)?;
        let value = (v * s - w * q).over(r);
        (value.e <= value.v.abs() * SHARP).then_some(value)
    }

    /// h of a curve and the frame's own there, and the curve's denominator.
    fn curve_beside(&mut self, c: CurveId, from: CurveId, f: u32) -> Option<(Approx, Approx)> {
        if let Some(&known) = self.beside.get(&(c, f)) {
            return known;
        }
        let value = self.difference_at(c, from, f);
        let denominator = self.rough_below(c, f).or_else(|| {
            let bits = 2 * self.frames[f as usize].bits + self.curves[c as usize].scale;
            scaled(&self.below_at_frame(c, f), bits)
        });
        let known = value.zip(denominator);
        self.beside.insert((c, f), known);
        known
    }

    /// P at a frame, times 2^(2·bits), is in `framed` then.
    fn top_at_frame(&mut self, c: CurveId, f: u32) {
        if self.framed.contains_key(&(c, f)) {
            return;
        }
        let value = self.part_at_frame(c, f, 0);
        self.framed.insert((c, f), value);
    }

    /// Q at a frame, times 2^(2·bits).
    fn below_at_frame(&self, c: CurveId, f: u32) -> Int {
        self.part_at_frame(c, f, 3)
    }

    fn part_at_frame(&self, c: CurveId, f: u32, from: usize) -> Int {
        let frame = &self.frames[f as usize];
        match &self.curves[c as usize].exact {
            Coeffs::Small(c) => at_frame(&c.map(Int::from)[from..from + 3], frame),
            Coeffs::Big(c) => at_frame(&c[from..from + 3], frame),
        }
    }
}

/// A quadratic at a frame, times 2^(2·bits).
fn at_frame(m: &[Int], frame: &Frame) -> Int {
    let linear = &m[2] * &frame.at + m[1].shl(frame.bits);
    linear * &frame.at + m[0].shl(2 * frame.bits)
}

/// v·2^-bits; None where that is too large for doubles. What is too small is enclosed: the number for which a fine
/// frame was made lies so near to it.
pub(super) fn scaled(v: &Int, bits: u64) -> Option<Approx> {
    if v.is_zero() {
        return Some(Approx::exact(0.0));
    }
    let (top, below, _) = v.abs().top64();
    let exponent = i64::try_from(below).ok()? - i64::try_from(bits).ok()?;
    if exponent >= 900 {
        return None;
    }
    if exponent < -900 {
        // The top is below 2⁶⁴.
        let e = 2f64.powi(64 - 900);
        return Some(Approx { v: 0.0, e });
    }
    let size = top as f64 * 2f64.powi(exponent as i32);
    Some(Approx {
        v: if v.sign() < 0 { -size } else { size },
        // The bits cut off, and the rounding to a double.
        e: size * f64::EPSILON,
    })
}

fn apart(a: Approx, b: Approx) -> Option<Ordering> {
    if a.hi() < b.lo() {
        Some(Ordering::Less)
    } else if b.hi() < a.lo() {
        Some(Ordering::Greater)
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// t = 1 + s·(u − 1/2) + k/2^(bits + 1).
    fn line(kernel: &mut Kernel, bits: u64, s: i64, k: i64) -> CurveId {
        let scale = Int::one().shl(bits);
        let p = [
            Int::from(2 - s) * &scale + Int::from(k),
            Int::from(2 * s) * &scale,
            Int::zero(),
        ];
        let q = [Int::from(2) * &scale, Int::zero(), Int::zero()];
        kernel.curve(&p, &q).expect("a denominator")
    }

    /// A cluster that only the finest frame tells apart: once there is one, nothing is seen from a coarser one first.
    #[test]
    fn the_finest_frame_is_asked_first() {
        let mut kernel = Kernel::default();
        let k = &mut kernel;
        let lines: Vec<(i64, i64, CurveId)> = (0..12)
            .map(|i| {
                let (s, h) = (3 * i - 17, i * i % 7);
                (s, h, line(k, 700, s, h))
            })
            .collect();
        // Each with the one before it: at −Δh/Δs, in units of 2⁻⁷⁰¹.
        let mut known: Vec<(Rat, NumId)> = Vec::new();
        for (i, pair) in lines.windows(2).enumerate() {
            let ((s, h, c), (r, g, d)) = (pair[0], pair[1]);
            let mut found = Vec::new();
            k.crossings(c, d, (0.0, 1.0), &[], &mut found);
            assert_eq!(found.len(), 1);
            let place = Rat::frac(g - h, s - r);
            for (other, y) in &known {
                assert_eq!(k.cmp(found[0], *y), place.cmp(other), "{place} {other}");
            }
            known.push((place, found[0]));
            let coarse = |f: u32, k: &Kernel| k.frames[f as usize].bits == u64::from(LEVELS[0]);
            let seen = k.framed.keys().filter(|at| coarse(at.1, k)).count();
            if i == 2 {
                assert!(seen > 0, "the first ones were seen from a coarse frame");
            }
            // The lines of the first two crossings that differ.
            assert!(seen <= 4, "{seen} lines were seen from a coarse frame");
        }
        assert_eq!(k.frames.len(), LEVELS.len(), "one frame a level");
    }
}
