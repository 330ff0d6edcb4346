//! What one contact puts on the root: a force, its torque, and the work of the drive.
//!
//! The balance of [`super::stretch`] with its vectors. With N the direction in which the obstacle
//! pushes (n for type B, −R m for type A, unnormalised), N⊥ = (N_y, −N_x) and r from the hinge to
//! the contact,
//!
//! ```text
//! f = k|θ|·(N − μσN⊥) / (|r·N⊥| + μ·sgn(d)·r·N),      σ = sgn(d)·sgn(θ),  d = ṗ·r
//! ```
//!
//! The pawl has no mass, so f acts on the root too, and its torque about the root's reference point
//! is (hinge − reference) × f + kθ. The drive has to push with −f; along the travel that is
//! the resistance W = −f·ṗ/|ṗ|, which is negative where the pawl pulls the root along. The drive's
//! power is −f·ṗ = kθθ̇ + μλ|s|: what goes into the spring and what rubs off.
//!
//! Every quantity is a [`Jet`] in the position x of the stretch's chart, or in t where θ stands
//! still.

use super::fix::{Bits, Fix};
use super::jet::Jet;
use super::peak::theta;
use super::stretch::{Law, Stretch, Touch};
use crate::contact::Chart;
use crate::geometry::Vec2;
use crate::number::{Algebraic, Rat};
use crate::slice::Time;

/// A part of a stretch on which the sliding keeps its direction.
#[derive(Clone, Debug)]
pub(super) struct Part<'a> {
    pub(super) stretch: &'a Stretch,
    /// Sign of d.
    drag: i32,
    /// Begin and end, from the start of the phase.
    pub(super) t: [Time; 2],
    /// The variable at both ends: x, or t where θ stands still.
    ends: [Algebraic; 2],
}

/// What is fixed along a phase.
pub(super) struct Rig {
    pub(super) stiffness: Rat,
    pub(super) mu: Rat,
    /// From the root's reference point to the hinge.
    pub(super) arm: Vec2,
}

/// The load at a place, or over a stretch of places.
pub(super) struct Load {
    /// Force on the root.
    pub(super) force: [Jet; 2],
    /// Its size.
    pub(super) size: Jet,
    /// Torque on the root about its reference point.
    pub(super) torque: Jet,
    /// Against the travel.
    pub(super) resistance: Jet,
    /// The time.
    pub(super) clock: Jet,
    /// Power times the clock's rate: what the drive's work grows by.
    pub(super) work: Jet,
}

/// Numerators and the denominator of the balance.
struct Terms {
    /// kθ.
    spring: Jet,
    /// |r·N⊥| + μ·sgn(d)·r·N, positive where the contact slides.
    den: Jet,
    /// The way of the force, N − μσN⊥.
    way: [Jet; 2],
    /// (hinge − reference) × way.
    moment: Jet,
    /// |way|.
    size: Fix,
    clock: Jet,
}

impl<'a> Part<'a> {
    /// Cuts a stretch where its sliding turns round; only friction minds that.
    pub(super) fn cut(s: &'a Stretch, rubs: bool) -> Vec<Part<'a>> {
        let whole = |drag| Part {
            stretch: s,
            drag,
            t: s.t.clone(),
            ends: if s.still() {
                s.t.each_ref().map(|t| t.exact().clone())
            } else {
                s.x.clone()
            },
        };
        if !rubs || s.touch.is_none() {
            return vec![whole(0)];
        }
        let mut parts = Vec::new();
        let breaks = s.reversals();
        let mut ends = vec![(whole(0).ends[0].clone(), s.t[0].clone())];
        ends.extend(breaks);
        ends.push((whole(0).ends[1].clone(), s.t[1].clone()));
        for pair in ends.windows(2) {
            parts.push(Part {
                stretch: s,
                drag: s.drag_between(&pair[0].0, &pair[1].0),
                t: [pair[0].1.clone(), pair[1].1.clone()],
                ends: [pair[0].0.clone(), pair[1].0.clone()],
            });
        }
        parts
    }

    /// The variable at an end.
    pub(super) fn end(&self, late: bool, b: Bits) -> Fix {
        let (lo, hi) = self.ends[usize::from(late)].enclosure(b.0 as u32);
        b.hull(&lo, &hi)
    }

    /// The variable at an enclosed instant.
    pub(super) fn place(&self, t: &Fix, b: Bits) -> Option<Fix> {
        let s = self.stretch;
        if s.still() {
            return Some(t.clone());
        }
        let x = s.curve().enclosed(Chart::of_half_turn(s.half_turn), t, b)?;
        // Between its ends by definition, which helps where the curve is steep.
        let (a, z) = (self.end(false, b), self.end(true, b));
        Some(x.clamp(&a.join(&z)))
    }

    /// The balance over an enclosed variable, to n orders of a parameter in which the variable
    /// moves by `pace`, not yet divided.
    fn terms(&self, x: &Fix, pace: &Fix, rig: &Rig, n: usize, b: Bits) -> Option<Terms> {
        let s = self.stretch;
        let constant = |f: Fix| Jet::constant(f, n, b);
        let rat = |r: &Rat| constant(b.rat(r));
        let pair = |v: &Vec2| [b.rat(&v.x), b.rat(&v.y)];
        let var = Jet::moving(x.clone(), pace.clone(), n, b);
        let (place, still) = if s.still() {
            let (lo, hi) = s.x[0].enclosure(b.0 as u32);
            (constant(b.hull(&lo, &hi)), true)
        } else {
            (var.clone(), false)
        };
        let turned = place.atan()?.scale(&b.int(2));
        let angle = match s.half_turn {
            0 => turned,
            h => turned.add(&constant(b.pi().mul(&b.int(h)))),
        };
        let torque = angle.scale(&b.rat(&rig.stiffness));
        let zero = || constant(b.int(0));
        let clock = if still {
            var
        } else {
            let (p, q) = s.clock()?;
            let at = |f: &super::qpoly::QPoly| {
                f.0.iter()
                    .rev()
                    .fold(zero(), |v, c| v.mul(&place).add(&rat(c)))
            };
            at(p).div(&at(q))?.neg()
        };
        let Some(touch) = &s.touch else {
            // On an angular stop the pawl is held by the root itself: nothing comes from outside.
            return Some(Terms {
                spring: zero(),
                den: constant(b.int(1)),
                way: [zero(), zero()],
                moment: zero(),
                size: b.int(0),
                clock,
            });
        };
        let one = rat(&Rat::one());
        let square = place.mul(&place);
        let round = one.add(&square);
        let flip = b.int(if Chart::of_half_turn(s.half_turn) == Chart::Rest {
            1
        } else {
            -1
        });
        let cos = one.sub(&square).div(&round)?.scale(&flip);
        let sin = place.add(&place).div(&round)?.scale(&flip);
        let turn = |v: &Vec2| {
            let [x, y] = pair(v);
            [
                cos.scale(&x).sub(&sin.scale(&y)),
                sin.scale(&x).add(&cos.scale(&y)),
            ]
        };
        let (push, r, length2) = match touch {
            Touch::B { a, n } => {
                let [nx, ny] = pair(n);
                ([constant(nx), constant(ny)], turn(a), n.norm2())
            }
            Touch::A { m, w } => {
                let [mx, my] = turn(m);
                let [wx, wy] = pair(w);
                let [vx, vy] = pair(&s.velocity);
                let r = [
                    constant(wx).sub(&clock.scale(&vx)),
                    constant(wy).sub(&clock.scale(&vy)),
                ];
                ([mx.neg(), my.neg()], r, m.norm2())
            }
        };
        let dot = |a: &[Jet; 2], c: &[Jet; 2]| a[0].mul(&c[0]).add(&a[1].mul(&c[1]));
        let across = [push[1].clone(), push[0].neg()];
        let (lever, height) = (dot(&r, &across), dot(&r, &push));
        let side = b.int(i64::from(s.side));
        let rub = &rig.mu * &Rat::from(i64::from(self.drag));
        let den = lever.scale(&side).add(&height.scale(&b.rat(&rub)));
        let slip = b.rat(&(&rub * &Rat::from(i64::from(s.side))));
        let way = [0, 1].map(|i| push[i].sub(&across[i].scale(&slip)));
        let [hx, hy] = pair(&rig.arm);
        let size = length2 * (Rat::one() + rig.mu.square());
        Some(Terms {
            moment: way[1].scale(&hx).sub(&way[0].scale(&hy)),
            size: b.rat(&size).sqrt()?,
            spring: torque,
            den,
            way,
            clock,
        })
    }

    /// The loads over an enclosed variable, to n orders; None where the balance may be singular.
    pub(super) fn load(&self, x: &Fix, rig: &Rig, n: usize, b: Bits) -> Option<Load> {
        self.load_at(x, &b.int(1), rig, n, b)
    }

    /// As [`Part::load`], in a parameter in which the variable moves by `pace`: on a cell of half
    /// width `pace` the orders are then the terms of its Taylor sum, and none grows past what
    /// fixed-point numbers hold.
    pub(super) fn load_at(
        &self,
        x: &Fix,
        pace: &Fix,
        rig: &Rig,
        n: usize,
        b: Bits,
    ) -> Option<Load> {
        let t = self.terms(x, pace, rig, n, b)?;
        let scale = t
            .spring
            .scale(&b.int(i64::from(self.stretch.side)))
            .div(&t.den)?;
        self.divided(t, scale, b)
    }

    /// The loads with the size of the push given.
    fn divided(&self, t: Terms, scale: Jet, b: Bits) -> Option<Load> {
        let s = self.stretch;
        let force = t.way.each_ref().map(|w| scale.mul(w));
        let [vx, vy] = [b.rat(&s.velocity.x), b.rat(&s.velocity.y)];
        let power = force[0].scale(&vx).add(&force[1].scale(&vy)).neg();
        let speed = b.rat(&s.velocity.norm2()).sqrt()?;
        let resistance = power.scale(&b.int(1).div(&speed)?);
        let rate = t.clock.derivative();
        let work = power.clone().cut(rate.len()).mul(&rate);
        Some(Load {
            force,
            size: scale.scale(&t.size),
            torque: scale.mul(&t.moment).add(&t.spring),
            resistance,
            clock: t.clock,
            work,
        })
    }

    /// Where the balance may be singular, upper bounds of the resistance, its opposite, and the
    /// torque either way; None where the load may grow that way. The factor in front is never
    /// negative, so the way of the force decides.
    pub(super) fn tops(&self, x: &Fix, rig: &Rig, b: Bits) -> Option<[Option<Rat>; 4]> {
        let t = self.terms(x, &b.int(1), rig, 1, b)?;
        let v = &self.stretch.velocity;
        let [wx, wy] = t.way.each_ref().map(|w| w.order(0));
        let along = wx.mul(&b.rat(&v.x)).add(&wy.mul(&b.rat(&v.y)));
        let (moment, spring) = (t.moment.order(0), t.spring.order(0));
        let top = |grows: Rat, base: Rat| (grows.sign() <= 0).then_some(base);
        Some([
            top(-along.lo(), Rat::zero()),
            top(along.hi(), Rat::zero()),
            top(moment.hi(), spring.hi()),
            top(-moment.lo(), -spring.lo()),
        ])
    }

    /// Whether at an end the pawl is at rest and the balance's denominator vanishes too, exactly:
    /// the contact begins, or ends, on the edge of its sticking cone.
    fn balances(&self, late: bool, rig: &Rig) -> bool {
        let s = self.stretch;
        let zero = Rat::zero();
        let Law::Graph {
            turn,
            rise,
            epsilon,
            ..
        } = &s.law
        else {
            return false;
        };
        let rub = &rig.mu * &Rat::from(i64::from(epsilon * self.drag));
        s.half_turn == 0
            && self.ends[usize::from(late)].sign() == 0
            && (turn.eval(&zero).abs() + rise.eval(&zero) * rub).is_zero()
    }

    /// The loads over the sliver between an end at which θ and the balance's denominator both
    /// vanish and a place near it: by Cauchy's mean value theorem their quotient is that of their
    /// slopes somewhere between. None where they do not both vanish, or the slopes do not tell.
    pub(super) fn sliver(&self, late: bool, place: &Fix, rig: &Rig, b: Bits) -> Option<Load> {
        if !self.balances(late, rig) {
            return None;
        }
        let x = self.end(late, b).join(place);
        let t = self.terms(&x, &b.int(1), rig, 2, b)?;
        let side = b.int(i64::from(self.stretch.side));
        let push = t.spring.order(1).mul(&side).div(&t.den.order(1))?;
        self.divided(t, Jet::constant(push, 1, b), b)
    }

    /// Whether the work grows past every bound towards an end at which the contact force does: the
    /// spring is wound there, the push resists, and the clock runs.
    pub(super) fn diverges(&self, end: &Fix, rig: &Rig, b: Bits) -> bool {
        let Some(t) = self.terms(end, &b.int(1), rig, 2, b) else {
            return false;
        };
        let v = &self.stretch.velocity;
        let [wx, wy] = t.way.each_ref().map(|w| w.order(0));
        let along = wx.mul(&b.rat(&v.x)).add(&wy.mul(&b.rat(&v.y)));
        let apart = |f: &Fix| f.sign().is_some_and(|s| s != 0);
        t.den.order(0).sign().is_none_or(|s| s == 0)
            && apart(&t.spring.order(0))
            && along.hi().sign() < 0
            && apart(&t.clock.order(1))
    }

    /// θ over an enclosed variable.
    pub(super) fn angle(&self, x: &Fix, b: Bits) -> Fix {
        let s = self.stretch;
        if s.still() {
            let (lo, hi) = s.x[0].enclosure(b.0 as u32);
            return theta(&b.hull(&lo, &hi), s.half_turn, b);
        }
        theta(x, s.half_turn, b)
    }
}
