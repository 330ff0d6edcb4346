//! From patches to arcs: break points along x, one sample in every gap.

use super::arc::Exact;
use super::names::{Lines, Name, Named, Names};
use super::shop::Curves;
use super::valid::{Filter, valid_graph, wedge_ok};
use super::{Arc, Curve, CurveId, End, Shape, Side};
use crate::contact::{
    Chart, Cones, Contact, ContactKind, Frame, ObstacleShape, Patch, PawlShape, Trig,
};
use crate::geometry::Vec2;
use crate::kernel::{Instant, Kernel, Polynomial, Position};
use crate::number::Scalar;
use crate::number::filter::{self, Stage};
use std::collections::HashMap;
use std::rc::Rc;

/// Turns patches into arcs, and knows the names of what it has met.
pub(super) struct Builder<K: Kernel> {
    pub(super) frame: Frame<K::Num>,
    pub(super) pawl: PawlShape<K::Num>,
    pub(super) obstacles: Rc<[ObstacleShape<K::Num>]>,
    curve_ids: HashMap<K::Key, CurveId>,
    /// Those of the patch at hand.
    arcs: Vec<Arc<K>>,
    named: HashMap<Name<K::Num>, Names<K>>,
    pawl_lines: Lines<K>,
    obstacle_lines: Lines<K>,
    minus_one: K::Num,
    one: K::Num,
    speed2: K::Num,
    /// The named points on each curve, by its id.
    pub(super) through: Vec<Vec<(Chart, Rc<Named<K>>)>>,
}

/// One break point of a patch in a chart.
struct Break<K: Kernel> {
    x: K::Root,
    point: Option<Rc<Named<K>>>,
}

fn in_chart<K: Kernel>(c: &[K::Coef; 3], chart: Chart) -> K::Poly {
    K::Poly::of_curve(c, chart == Chart::Back)
}

/// A C-function's part as a polynomial of the chart's x, up to a positive factor.
fn poly<K: Kernel>(f: &Trig<K::Num>, chart: Chart) -> K::Poly {
    K::Poly::of(&f.form(chart))
}

impl<K: Kernel> Builder<K> {
    pub(super) fn new(
        frame: Frame<K::Num>,
        pawl: PawlShape<K::Num>,
        obstacles: Rc<[ObstacleShape<K::Num>]>,
    ) -> Builder<K> {
        let pawl_lines = Lines::new(std::iter::once(&pawl.ring));
        let obstacle_lines = Lines::new(obstacles.iter().flat_map(|o| &o.rings));
        let speed2 = frame.v.norm2();
        Builder {
            frame,
            pawl,
            obstacles,
            curve_ids: HashMap::new(),
            arcs: Vec::new(),
            named: HashMap::new(),
            pawl_lines,
            obstacle_lines,
            minus_one: K::Num::one().negated(),
            one: K::Num::one(),
            speed2,
            through: Vec::new(),
        }
    }

    fn named_roots(&mut self, name: Name<K::Num>, poly: impl FnOnce() -> K::Poly) -> Names<K> {
        if K::names()
            && let Some(r) = self.named.get(&name)
        {
            return r.clone();
        }
        let list: Names<K> = poly()
            .chart_roots()
            .into_iter()
            .map(|x| {
                Rc::new(Named {
                    x,
                    t: std::cell::OnceCell::new(),
                })
            })
            .collect();
        self.named.insert(name, list.clone());
        list
    }

    /// Where a pawl vertex at a (about the hinge) meets an obstacle vertex at q: R a lies on the
    /// line through q − p₀ along v. Its time is (q − p₀ − R a)·v/|v|².
    fn vertex_vertex(&mut self, a: &Vec2<K::Num>, q: &Vec2<K::Num>, chart: Chart) -> Names<K> {
        if a.is_zero() {
            return Rc::new([]);
        }
        let key = Name::VertexVertex(Box::new((a.clone(), q.clone())), chart);
        let w = q - &self.frame.p0;
        let v = self.frame.v.clone();
        let list = self.named_roots(key, || {
            poly::<K>(
                &Trig::new(a.cross(&v), a.dot(&v).negated(), w.cross(&v).negated()),
                chart,
            )
        });
        for n in list.iter() {
            n.t.get_or_init(|| {
                let num =
                    Trig::new(a.dot(&v).negated(), a.cross(&v).negated(), w.dot(&v)).form(chart);
                let den = Trig::constant(self.speed2.clone()).form(chart);
                let (num, den) = K::Poly::pair(&num, &den);
                K::Time::ratio(&n.x, num, den)
            });
        }
        list
    }

    /// The curve of a patch and the sign by which the C-function differs from it.
    fn curve_of(&mut self, curves: &Curves<K>, patch: &Patch<K::Num>) -> Option<(CurveId, i32)> {
        let p = patch.f0.form(Chart::Rest);
        let q = patch.f1.form(Chart::Rest);
        let all: Vec<K::Num> = p.into_iter().chain(q).collect();
        let (prim, flip) = K::primitive(&all)?;
        let key = K::key(&prim);
        if let Some(&id) = self.curve_ids.get(&key) {
            return Some((id, flip));
        }
        let p: [K::Coef; 3] = std::array::from_fn(|i| prim[i].clone());
        let q: [K::Coef; 3] = std::array::from_fn(|i| prim[i + 3].clone());
        let common = has_common_root(patch);
        let pairs = Chart::BOTH.map(|c| {
            let (cp, cq) = (in_chart::<K>(&p, c), in_chart::<K>(&q, c));
            if cq.is_zero() || !common {
                return (cp, cq);
            }
            if cp.is_zero() {
                return (cp, K::Poly::one());
            }
            // By one common factor, so that P/Q is unchanged.
            let g = cp.common(&cq);
            (cp.quotient(&g), cq.quotient(&g))
        });
        let [(rp0, rq0), (rp1, rq1)] = pairs;
        let id = curves.add(Curve {
            p,
            q,
            rp: [rp0, rp1],
            rq: [rq0, rq1],
            factored: common,
        });
        self.curve_ids.insert(key, id);
        Some((id, flip))
    }

    /// All arcs of a patch: chart by chart, those along levels first, then ascending.
    pub(super) fn cut(&mut self, curves: &Curves<K>, patch: &Patch<K::Num>) -> Vec<Arc<K>> {
        let Some((curve, flip)) = self.curve_of(curves, patch) else {
            return Vec::new(); // f ≡ 0: the hinge's own vertex runs along the edge; its neighbours bound it
        };
        let c = curves.get(curve);
        for chart in Chart::BOTH {
            if !patch.charts[chart.index()] {
                continue;
            }
            let (p, q) = (in_chart::<K>(&c.p, chart), in_chart::<K>(&c.q, chart));
            let (rp, rq) = c.reduced(chart);
            if q.is_zero() {
                self.add_levels(patch, curve, flip, chart, &p, None);
                continue;
            }
            let flat = rp.degree().unwrap_or(0) == 0 && rq.degree() == Some(0);
            if rq.degree() < q.degree() || rp.degree() < p.degree() {
                let g = if p.is_zero() { q.clone() } else { p.common(&q) };
                self.add_levels(patch, curve, flip, chart, &g, Some((rp, rq)));
            }
            if flat {
                self.add_wall(patch, curve, chart, rp, rq);
            } else {
                self.add_graph(patch, curve, flip, chart, (&p, &q), (rp, rq));
            }
        }
        std::mem::take(&mut self.arcs)
    }

    fn wedge_breaks(&mut self, patch: &Patch<K::Num>, chart: Chart, out: &mut Vec<Break<K>>) {
        for k in 0..2 {
            let (pe, oe) = patch.flush[k];
            let key = Name::Flush(
                self.pawl_lines.number(pe),
                self.obstacle_lines.number(oe),
                chart,
            );
            for n in self
                .named_roots(key, || poly::<K>(&patch.wedge[k], chart))
                .iter()
            {
                out.push(Break {
                    x: n.x.clone(),
                    point: Some(n.clone()),
                });
            }
        }
    }

    fn plain_breaks(&self, p: &K::Poly, out: &mut Vec<Break<K>>) {
        for x in p.chart_roots() {
            out.push(Break { x, point: None });
        }
    }

    fn seams(&self, out: &mut Vec<Break<K>>) {
        for r in [&self.minus_one, &self.one] {
            out.push(Break {
                x: K::Root::of(r.clone()),
                point: None,
            });
        }
    }

    #[allow(clippy::too_many_arguments)]
    fn add_graph(
        &mut self,
        patch: &Patch<K::Num>,
        curve: CurveId,
        flip: i32,
        chart: Chart,
        (p, q): (&K::Poly, &K::Poly),
        (rp, rq): (&K::Poly, &K::Poly),
    ) {
        let mut breaks = Vec::new();
        // Vertex on vertex first: where several names fall on one point the first is kept.
        for (a, qv) in &patch.ends {
            for n in self.vertex_vertex(a, qv, chart).iter() {
                breaks.push(Break {
                    x: n.x.clone(),
                    point: Some(n.clone()),
                });
            }
        }
        self.wedge_breaks(patch, chart, &mut breaks);
        // A name may lie on the curve's level instead, at another time.
        let factored = rq.degree() != q.degree() || rp.degree() != p.degree();
        if !factored && K::names() {
            if self.through.len() <= curve as usize {
                self.through.resize_with(curve as usize + 1, Vec::new);
            }
            let known = &mut self.through[curve as usize];
            for n in breaks.iter().filter_map(|b| b.point.as_ref()) {
                if !known.iter().any(|(_, o)| o.x.same(&n.x)) {
                    known.push((chart, n.clone()));
                }
            }
        }
        // dt/dx = −(P'Q − PQ')/Q².
        let bend = rp.derivative().times(rq).minus(&rp.times(&rq.derivative()));
        for n in self
            .named_roots(Name::Tangency(curve, chart), || bend.clone())
            .iter()
        {
            breaks.push(Break {
                x: n.x.clone(),
                point: Some(n.clone()),
            });
        }
        self.plain_breaks(rq, &mut breaks);
        if factored {
            self.plain_breaks(
                &if p.is_zero() { q.clone() } else { p.common(q) },
                &mut breaks,
            );
        }
        self.seams(&mut breaks);
        breaks.sort_by(|a, b| a.x.cmp(&b.x));
        breaks.dedup_by(|b, a| a.x == b.x);
        let filter = K::ENCLOSES.then(|| Filter::new(patch, chart));
        for w in breaks.windows(2) {
            let s = K::Root::between(&w[0].x, &w[1].x);
            let settled = filter.as_ref();
            if !settled
                .and_then(|f| f.valid_graph(Scalar::interval(&s)))
                .inspect(|_| filter::settled(Stage::Double))
                .unwrap_or_else(|| valid_graph(patch, chart, &s))
            {
                continue;
            }
            let bend_sign = bend.sign_at(&s);
            // The full P'Q − PQ' is that of the reduced pair times the square of the factor.
            let f1 = q.sign_at(&s) * flip;
            let up = bend_sign * f1;
            let end = |b: &Break<K>| {
                let t = || K::Time::ratio(&b.x, rp.negated(), rq.clone());
                let t = match &b.point {
                    Some(n) if !factored && K::names() => n.t.get_or_init(t).clone(),
                    _ => t(),
                };
                End { x: b.x.clone(), t }
            };
            self.arcs.push(Arc::made(
                patch.contact,
                chart,
                Shape::Graph {
                    rising: bend_sign < 0,
                },
                if up > 0 { Side::Above } else { Side::Below },
                Exact {
                    curve,
                    branch: up * flip,
                    lo: end(&w[0]),
                    hi: end(&w[1]),
                },
            ));
        }
    }

    /// Level arcs at the roots of g, where f = g·(rp + t·rq), or f = g alone.
    fn add_levels(
        &mut self,
        patch: &Patch<K::Num>,
        curve: CurveId,
        flip: i32,
        chart: Chart,
        g: &K::Poly,
        rest: Option<(&K::Poly, &K::Poly)>,
    ) {
        for x in g.chart_roots() {
            // At the seam one copy is enough: the one at x = −1.
            if x.cmp_num(&self.one).is_eq()
                || patch
                    .wedge
                    .iter()
                    .any(|w| x.sign_of(&poly::<K>(w, chart)) < 0)
            {
                continue;
            }
            let (mut lo, mut hi) = (None, None);
            for (k, (l0, l1)) in patch.location.iter().enumerate() {
                let slope = x.sign_of(&poly::<K>(l1, chart));
                if slope == 0 {
                    continue;
                }
                let (a, qv) = &patch.ends[k];
                let point = self
                    .vertex_vertex(a, qv, chart)
                    .iter()
                    .find(|n| n.x == x)
                    .cloned();
                let end = match point.as_ref().and_then(|n| n.t.get().map(|t| (n, t))) {
                    Some((n, t)) => End {
                        x: n.x.clone(),
                        t: t.clone(),
                    },
                    None => {
                        let (num, den) = K::Poly::pair(&l0.form(chart), &l1.form(chart));
                        End {
                            x: x.clone(),
                            t: K::Time::ratio(&x, num.negated(), den),
                        }
                    }
                };
                if slope > 0 {
                    lo = Some(end);
                } else {
                    hi = Some(end);
                }
            }
            let (Some(lo), Some(hi)) = (lo, hi) else {
                continue;
            };
            if lo.t >= hi.t {
                continue;
            }
            let slope = x.sign_of(&g.derivative());
            // Where the other factor vanishes f changes sign along the level: cut there.
            let mut ends = vec![lo];
            if let Some((rp, rq)) = rest
                && x.sign_of(rq) != 0
            {
                let cut = K::Time::ratio(&x, rp.negated(), rq.clone());
                if ends[0].t < cut && cut < hi.t {
                    ends.push(End {
                        x: x.clone(),
                        t: cut,
                    });
                }
            }
            ends.push(hi);
            for w in ends.windows(2) {
                let factor = match rest {
                    None => 1,
                    Some((rp, rq)) => {
                        let s = K::Time::between(&w[0].t, &w[1].t);
                        x.sign_of(&K::Poly::at_time(rp, rq, &s))
                    }
                };
                let branch = slope * factor;
                let side = match branch * flip {
                    1 => Side::Above,
                    -1 => Side::Below,
                    _ => {
                        let bend = x.sign_of(&g.derivative().derivative()) * factor * flip;
                        if bend > 0 { Side::Both } else { Side::Neither }
                    }
                };
                self.arcs.push(Arc::made(
                    patch.contact,
                    chart,
                    Shape::Level,
                    side,
                    Exact {
                        curve,
                        branch,
                        lo: w[0].clone(),
                        hi: w[1].clone(),
                    },
                ));
            }
        }
    }

    /// The contact is at the hinge: it happens at one time, over a range of orientations.
    fn add_wall(
        &mut self,
        patch: &Patch<K::Num>,
        curve: CurveId,
        chart: Chart,
        rp: &K::Poly,
        rq: &K::Poly,
    ) {
        let c = K::Poly::constant_ratio(rp, rq);
        let at = |(l0, l1): &(Trig<K::Num>, Trig<K::Num>)| l0.add(&l1.scale(&c));
        let location = [at(&patch.location[0]), at(&patch.location[1])];
        let (mine, theirs) = self.cones_at_hinge(patch, &c);
        let mut breaks = Vec::new();
        self.wedge_breaks(patch, chart, &mut breaks);
        for l in &location {
            self.plain_breaks(&poly::<K>(l, chart), &mut breaks);
        }
        // Where a pawl edge lies along an obstacle edge, or along the motion.
        for g in mine.generators() {
            for o in theirs.generators().chain([&self.frame.v]) {
                let cross = Trig::new(g.cross(o), g.dot(o).negated(), K::Num::zero());
                self.plain_breaks(&poly::<K>(&cross, chart), &mut breaks);
            }
        }
        self.seams(&mut breaks);
        breaks.sort_by(|a, b| a.x.cmp(&b.x));
        breaks.dedup_by(|b, a| a.x == b.x);
        let t = K::Time::of(c);
        for w in breaks.windows(2) {
            let s = K::Root::between(&w[0].x, &w[1].x);
            if !wedge_ok(patch, chart, &s) || location.iter().any(|l| l.value(chart, &s).sign() < 0)
            {
                continue;
            }
            let turned = mine.map(|g| {
                let g = g.rotate_tan_half(&s);
                if chart == Chart::Back { -&g } else { g }
            });
            let v = &self.frame.v;
            let (before, after) = (turned.overlap(&-v, &theirs), turned.overlap(v, &theirs));
            let side = match (before, after) {
                (false, true) => Side::Before,
                (true, false) => Side::After,
                (false, false) => Side::Both,
                (true, true) => Side::Neither,
            };
            let end = |b: &Break<K>| End {
                x: b.x.clone(),
                t: t.clone(),
            };
            self.arcs.push(Arc::made(
                patch.contact,
                chart,
                Shape::Wall,
                side,
                Exact {
                    curve,
                    branch: 0,
                    lo: end(&w[0]),
                    hi: end(&w[1]),
                },
            ));
        }
    }

    /// The pawl and the obstacle beside the hinge, at θ = 0, when a wall's contact is made at time
    /// c. Past a corner of the obstacle the hinge may be free on both sides of its edge's line, so
    /// the C-function's sign alone does not tell.
    fn cones_at_hinge(&self, patch: &Patch<K::Num>, c: &K::Num) -> (Cones<K::Num>, Cones<K::Num>) {
        let Contact::Obstacle {
            obstacle,
            kind,
            ring,
            obstacle_feature,
            pawl_feature,
        } = patch.contact
        else {
            // Walls are cut from patches, whose contacts are between features.
            unreachable!("limit stops are no walls")
        };
        let body = &self.pawl.ring;
        let fixed = &self.obstacles[obstacle as usize].rings[ring as usize];
        let (i, j) = (pawl_feature as usize, obstacle_feature as usize);
        match kind {
            ContactKind::B => {
                let p = &self.frame.p0 + &self.frame.v.scale(c);
                let at = |k: usize| (fixed.vertices[k] == p).then(|| Cones::at_vertex(fixed, k));
                let theirs = at(j)
                    .or_else(|| at(fixed.next(j)))
                    .unwrap_or_else(|| Cones::at_edge(fixed, j));
                (Cones::at_vertex(body, i), theirs)
            }
            ContactKind::A => {
                let at = |k: usize| {
                    body.vertices[k]
                        .is_zero()
                        .then(|| Cones::at_vertex(body, k))
                };
                let mine = at(i)
                    .or_else(|| at(body.next(i)))
                    .unwrap_or_else(|| Cones::at_edge(body, i));
                (mine, Cones::at_vertex(fixed, j))
            }
        }
    }

    /// An angular stop: a level at u for the whole phase and a little more.
    pub(super) fn limit(&mut self, curves: &Curves<K>, u: &K::Num, which: u8) -> Arc<K> {
        let (chart, x) = if u.abs() <= self.one {
            (Chart::Rest, u.clone())
        } else {
            (Chart::Back, self.minus_one.over(u))
        };
        // At the seam the copy at x = −1 serves.
        let (chart, x) = if x == self.one {
            (chart.other(), self.minus_one.clone())
        } else {
            (chart, x)
        };
        let p = K::stop(u);
        let q = [K::zero_coef(), K::zero_coef(), K::zero_coef()];
        let rp = Chart::BOTH.map(|c| in_chart::<K>(&p, c));
        let rq = [K::Poly::zero(), K::Poly::zero()];
        let curve = curves.add(Curve {
            p,
            q,
            rp,
            rq,
            factored: false,
        });
        let x = K::Root::of(x);
        let end = |t: K::Num| End {
            x: x.clone(),
            t: K::Time::of(t),
        };
        let side = if which == 0 { Side::Above } else { Side::Below };
        let exact = Exact {
            curve,
            branch: 1,
            lo: end(self.minus_one.clone()),
            hi: end(self.frame.duration.plus(&self.one)),
        };
        Arc::made(Contact::Limit(which), chart, Shape::Level, side, exact)
    }
}

/// Whether f₀ and f₁ vanish at a common orientation.
fn has_common_root<R: Scalar>(patch: &Patch<R>) -> bool {
    let (f0, f1) = (&patch.f0, &patch.f1);
    if f1.c.is_zero() && f1.s.is_zero() {
        // Type B: f₁ is a constant; a common factor only if f₀ is one too.
        return f0.c.is_zero() && f0.s.is_zero();
    }
    // Type A: f₁ vanishes at (cos, sin) = ±(−s₁, c₁)/ρ.
    let cross = f0.s.times(&f1.c).minus(&f0.c.times(&f1.s)).square();
    let other = f0.k.square().times(&f1.c.square().plus(&f1.s.square()));
    cross.minus(&other).vanishes_beside(&cross.plus(&other))
}
