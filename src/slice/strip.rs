//! The cylinder cut open: every barrier of a slice as an arc of one strip of the plane.
//!
//! The face algorithm works in the plane, so the circle of orientations is cut at θ = −π/2 and unrolled: the
//! rest chart keeps its x ∈ [−1, 1], the back chart is moved by 2 to [1, 3], an integer substitution
//! in coefficients of degree two. The cut is a place of the coordinates and not of the scene, so it is no
//! barrier: its two sides are pairs of verticals ([`Strip::glue`]), one for each stretch between
//! points where anything can end on the cut, and the face is glued along them. The window of the phase adds
//! two arcs, t = 0 and t = T.
//!
//! *The other way* would have been one projective parameter for the whole circle: no cut, but then u = ∞
//! is a place where curves go to infinity, and the algorithm that serves bare arcs would have to
//! learn of it. *A face per chart*, glued along both seams, cuts F twice as often. One integer shift costs a few
//! bits of the coefficients and nothing else.

use super::{Arc, ArcId, Shape, Slice};
use crate::contact::Chart;
use crate::face::{Glue, RootOf, SourceArc, Upright};
use crate::kernel::{Instant, Kernel, Position};
use crate::number::{Algebraic, Int, Poly, Rat, Scalar};
use crate::slice::Time;

/// What an arc of the strip stands for.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Owner {
    /// An arc of the slice.
    Arc(ArcId),
    /// The start of the phase.
    Start,
    /// Its end.
    End,
    /// A stretch of the cut.
    Cut,
}

/// The barriers of a slice, unrolled.
pub(super) struct Strip {
    pub(super) graphs: Vec<SourceArc>,
    pub(super) uprights: Vec<Upright>,
    pub(super) glue: Vec<Glue>,
    /// For each upright of an arc whether it is the other side of the one before it.
    pub(super) second: Vec<bool>,
    /// Names of the ends of each graph, then of each upright: arcs that end in one named point share its instant.
    pub(super) names: Vec<[u64; 2]>,
    /// What each graph, then each upright stands for.
    pub(super) owners: Vec<Owner>,
    /// Where anything can end on the cut, ascending.
    pub(super) stops: Vec<Rat>,
    /// What ends there, by time: on either side of the cut, though F may border one side alone.
    pub(super) at_cut: Vec<(Rat, ArcId)>,
}

/// c₀ + c₁x + c₂x² with x = s − 2·turns.
fn shifted(c: &[Int; 3], back: bool) -> [Int; 3] {
    if !back {
        return c.clone();
    }
    let twice = &c[1] + &c[1];
    let four = c[2].shl(2);
    [&(&c[0] - &twice) + &four, &c[1] - &four, c[2].clone()]
}

fn three(p: &Poly) -> Option<[Int; 3]> {
    (p.degree().unwrap_or(0) <= 2).then(|| std::array::from_fn(|i| p.coeff(i)))
}

/// A position as a root of a polynomial of degree two at most.
fn root_of(x: &Algebraic, back: bool) -> Option<RootOf> {
    if let Some(r) = x.known_rat() {
        let c = [-r.numer(), r.denom().clone(), Int::zero()];
        return Some(RootOf {
            c: shifted(&c, back),
            k: 0,
        });
    }
    let c = three(&x.defining_polynomial())?;
    let k = if c[2].is_zero() {
        0
    } else {
        // Of two roots the middle −c₁/2c₂ tells which.
        let middle = Rat::new(-&c[1], &c[2] + &c[2]);
        u8::from(x.cmp_rat(&middle).is_gt())
    };
    Some(RootOf {
        c: shifted(&c, back),
        k,
    })
}

fn constant(t: &Rat) -> [[Int; 3]; 2] {
    let of = |n: &Int| [n.clone(), Int::zero(), Int::zero()];
    [of(t.numer()), of(t.denom())]
}

/// A curve that passes over a level at an instant that is a function of its position.
fn curve_at(t: &Time, back: bool) -> Option<[[Int; 3]; 2]> {
    if let Some(r) = t.as_rat() {
        return Some(constant(r));
    }
    let (num, den) = t.parts();
    Some([shifted(&three(&num)?, back), shifted(&three(&den)?, back)])
}

impl Strip {
    /// Unrolls a slice; None where an end is no root of a quadratic (which certified kernels
    /// never make).
    pub(super) fn new<K: Kernel>(slice: &Slice<K>) -> Option<Strip> {
        let end = slice.frame.duration.to_rat();
        let zero = Rat::zero();
        let mut s = Strip {
            graphs: Vec::with_capacity(slice.arcs().len() + 2),
            uprights: Vec::new(),
            glue: Vec::new(),
            second: Vec::new(),
            names: Vec::with_capacity(slice.arcs().len() + 2),
            owners: Vec::with_capacity(slice.arcs().len() + 2),
            stops: vec![zero.clone(), end.clone()],
            at_cut: Vec::new(),
        };
        let mut levels = Vec::new();
        for (id, arc) in slice.arcs().iter().enumerate() {
            if !arc.is_barrier() {
                continue;
            }
            if arc.shape == Shape::Level {
                s.level(arc, id as ArcId, &mut levels)?;
            } else {
                s.graph(slice, arc, id as ArcId)?;
            }
        }
        let (from, to) = (Int::from(-1), Int::from(3));
        let at = |x: &Int| RootOf {
            c: [-x, Int::one(), Int::zero()],
            k: 0,
        };
        for (t, owner) in [(&zero, Owner::Start), (&end, Owner::End)] {
            let [p, q] = constant(t);
            let (left, right, line) = (at(&from), at(&to), 0);
            s.graphs.push(SourceArc {
                p,
                q,
                left,
                right,
                line,
            });
            s.owners.push(owner);
        }
        // The borders of the window end where no arc need.
        let names = [&zero, &end].map(|t| [Time::from(t.clone()).name(); 2]);
        s.names.extend(names);
        s.names.extend(levels.iter().map(|(_, names)| *names));
        s.owners.extend(levels.into_iter().map(|(owner, _)| owner));
        s.stops.retain(|t| *t >= zero && *t <= end);
        s.stops.sort();
        s.stops.dedup();
        s.at_cut.sort();
        for w in s.stops.windows(2) {
            let [low, high] = [constant(&w[0]), constant(&w[1])];
            s.glue.push((s.uprights.len(), s.uprights.len() + 1));
            for x in [&from, &to] {
                let (low, high) = (low.clone(), high.clone());
                s.uprights.push(Upright {
                    u: at(x),
                    low,
                    high,
                });
                s.owners.push(Owner::Cut);
            }
        }
        Some(s)
    }

    fn graph<K: Kernel>(&mut self, slice: &Slice<K>, arc: &Arc<K>, id: ArcId) -> Option<()> {
        let back = arc.chart == Chart::Back;
        let curve = slice.curve(arc.curve);
        let [p, q] = [&curve.p, &curve.q].map(|c| {
            let [a, b, c] = [0, 1, 2].map(|i| K::publish(&c[i]));
            // In the back chart x = −1/u.
            if back { [c, -b, a] } else { [a, b, c] }
        });
        let mut ends = [&arc.lo, &arc.hi].map(|e| (e.x.publish(), &e.t));
        for (x, t) in &mut ends {
            let cut = if back { Rat::one() } else { Rat::from(-1) };
            if x.cmp_rat(&cut).is_eq() {
                *x = Algebraic::from(cut);
                let t = t.decided()?.to_rat();
                self.at_cut.push((t.clone(), id));
                self.stops.push(t);
            }
        }
        self.graphs.push(SourceArc {
            p: shifted(&p.map(|c| -c), back),
            q: shifted(&q, back),
            left: root_of(&ends[0].0, back)?,
            right: root_of(&ends[1].0, back)?,
            line: 0,
        });
        self.owners.push(Owner::Arc(id));
        self.names
            .push([&arc.lo, &arc.hi].map(|e| e.t.publish().name()));
        Some(())
    }

    fn level<K: Kernel>(
        &mut self,
        arc: &Arc<K>,
        id: ArcId,
        owners: &mut Vec<(Owner, [u64; 2])>,
    ) -> Option<()> {
        let back = arc.chart == Chart::Back;
        let x = arc.lo.x.publish();
        let cut = !back && x.cmp_rat(&Rat::from(-1)).is_eq();
        let times = [&arc.lo, &arc.hi].map(|e| e.t.publish());
        let names = [times[0].name(), times[1].name()];
        let mut up = Upright {
            u: root_of(&x, back)?,
            low: curve_at(&times[0], back)?,
            high: curve_at(&times[1], back)?,
        };
        if cut {
            let [lo, hi] = [arc.lo.t.decided()?.to_rat(), arc.hi.t.decided()?.to_rat()];
            // The cut has two sides, and the level lies on both.
            up.low = constant(&lo);
            up.high = constant(&hi);
            let three = [Int::from(-3), Int::one(), Int::zero()];
            let u = RootOf { c: three, k: 0 };
            self.uprights.push(Upright { u, ..up.clone() });
            self.second.push(false);
            owners.push((Owner::Arc(id), names));
            self.at_cut.extend([(lo.clone(), id), (hi.clone(), id)]);
            self.stops.extend([lo, hi]);
        }
        self.uprights.push(up);
        self.second.push(cut);
        owners.push((Owner::Arc(id), names));
        Some(())
    }
}
