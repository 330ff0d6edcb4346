//! The least friction that locks: an exact algebraic number.
//!
//! Where a contact slides without friction, the motion is the same at every μ up to the one at
//! which it first sticks, so that one can be read off the frictionless path. A contact sticks at a
//! point of it if ε·sgn(d)·ρ_y < 0 (the direction of motion makes it possible; see
//! [`super::stretch`]) and μ > |F_θ|/|ρ_y|. Between the roots of d and ρ_y that ratio is monotone:
//! for type B it is the tangent of an angle that turns with θ, for type A ρ_y is constant and
//! F_θ² is a parabola in t with its vertex at d = 0. So the infimum over the path lies at the end
//! of a stretch or at one of those roots, and is a quotient of polynomials there.
//! It is an infimum: at that very μ the contact still slides (the cone is open).

use super::qpoly::QPoly;
use super::stretch::{Law, Stretch};
use crate::number::{Algebraic, Poly, Rat};

/// The infimum of the μ at which one of the stretches sticks, and the index of a stretch that
/// attains it; None if none sticks at any μ. The stretches are those of a frictionless motion.
pub fn least_friction(stretches: &[Stretch]) -> Option<(Algebraic, usize)> {
    let mut best: Option<(Algebraic, usize)> = None;
    for (i, s) in stretches.iter().enumerate() {
        for c in ratios(s) {
            if best.as_ref().is_none_or(|b| c < b.0) {
                best = Some((c, i));
            }
        }
    }
    best
}

fn ratios(s: &Stretch) -> Vec<Algebraic> {
    match &s.law {
        Law::Stop => Vec::new(),
        Law::Graph {
            turn,
            rise,
            drag,
            epsilon,
            ..
        } => {
            let (lo, hi) = if s.x[0] <= s.x[1] {
                (&s.x[0], &s.x[1])
            } else {
                (&s.x[1], &s.x[0])
            };
            let (drag, up) = (drag.poly(), rise.poly());
            let sticky = |sign: &dyn Fn(&Poly) -> i32| epsilon * sign(&drag) * sign(&up) < 0;
            let (num, den) = QPoly::pair(turn, rise);
            let ratio = |x: &Algebraic| (x.sign_of(&den) != 0).then(|| abs(x.ratio(&num, &den)));
            if lo == hi {
                let here = sticky(&|p| lo.sign_of(p));
                return here.then(|| ratio(lo)).flatten().into_iter().collect();
            }
            let mut breaks = vec![lo.clone(), hi.clone()];
            for p in [&drag, &up] {
                if !p.is_zero() {
                    let roots = p.real_roots_in(&Rat::from(-1), &Rat::one());
                    breaks.extend(roots.into_iter().filter(|x| lo < x && x < hi));
                }
            }
            breaks.sort();
            breaks.dedup();
            let mut out = Vec::new();
            for gap in breaks.windows(2) {
                let mid = Algebraic::between(&gap[0], &gap[1]);
                if sticky(&|p| p.sign_at(&mid)) {
                    out.extend(ratio(&gap[0]));
                    out.extend(ratio(&gap[1]));
                }
            }
            out
        }
        Law::Level { turn2, e, drag, .. } => {
            if e.is_zero() {
                return Vec::new();
            }
            let [from, to] = &s.t;
            let mut breaks = vec![from.exact().clone(), to.exact().clone()];
            let roots = drag.poly().real_roots();
            let (begin, end) = (from.exact(), to.exact());
            breaks.extend(roots.into_iter().filter(|t| t > begin && t < end));
            breaks.sort();
            let mut out = Vec::new();
            for gap in breaks.windows(2) {
                let mid = Algebraic::between(&gap[0], &gap[1]);
                if drag.eval(&mid).sign() * e.sign() > 0 {
                    let (num, den) = QPoly::pair(turn2, &QPoly(vec![e.square()]));
                    out.extend(gap.iter().map(|t| root(&t.ratio(&num, &den))));
                }
            }
            out
        }
    }
}

fn abs(x: Algebraic) -> Algebraic {
    if x.sign() < 0 {
        x.ratio(&Poly::from_i64(&[0, -1]), &Poly::from_i64(&[1]))
    } else {
        x
    }
}

/// √x for x ≥ 0.
fn root(x: &Algebraic) -> Algebraic {
    let square = Poly::from_i64(&[0, 0, -1]);
    x.root_over(&square, &Poly::from_i64(&[1]), &mut |bits| {
        let (lo, hi) = x.enclosure(2 * bits);
        let fix = super::fix::Bits(u64::from(2 * bits)).hull(&lo, &hi);
        fix.sqrt()
            .map_or_else(|| (Rat::zero(), hi), |r| (r.lo(), r.hi()))
    })
}
