//! The slice, and the shop behind it that makes exact numbers when they are asked for.
//!
//! A state meets few of the arcs within its reach. So which arcs there are is found in certified doubles where those
//! can tell (`scout.rs`), and a patch is worked out exactly (`build.rs`) when a question is first put to one
//! of its arcs that enclosures do not answer. Where doubles cannot tell, or may not (`--arithmetic exact`), a patch is
//! worked out at once. Both ways give the same arcs; nothing depends on which was gone.

use super::arc::{Arc, ArcId, Curve, CurveId, Exact};
use super::breaks::Truth;
use super::build::Builder;
use super::predicates::CrossCache;
use super::scout::{self, Function, Seen};
use crate::contact::{Chart, Frame, ObstacleShape, Pair, Patch, PawlShape, pairs_within};
use crate::kernel::{Filtered, Kernel, Position};
use crate::number::{Interval, Scalar};
use std::cell::{Cell, OnceCell, RefCell};
use std::rc::Rc;
use std::sync::Mutex;

/// How many units of work are done between looks at the clock.
const ASKED: u32 = 2048;

/// The slice of one pawl over one phase: its arcs, and what is known of their crossings.
#[derive(Debug)]
pub struct Slice<K: Kernel = Filtered> {
    /// The phase as the hinge sees it.
    pub frame: Frame<K::Num>,
    arcs: Vec<Arc<K>>,
    by_chart: [Vec<ArcId>; 2],
    /// The patch that each arc was cut from (none for a limit stop).
    patch_of: Vec<Option<u32>>,
    /// Per patch its C-function in certified doubles, where doubles may settle anything; that of the phase
    /// as it was first run, since only common zeros are looked for.
    rough: Rc<[Function]>,
    /// Whether that phase ran the other way.
    turned: bool,
    pub(super) shop: Rc<Shop<K>>,
    pub(super) crossings: Mutex<CrossCache<K>>,
}

impl<K: Kernel> Slice<K> {
    /// The arcs of a pawl against the obstacles over a phase, with its angular stops.
    ///
    /// Cost: O(n) patches within reach, each a few dozen operations on intervals of doubles; exact numbers for
    /// those that these leave open, and for what is asked of the others later.
    pub fn new(
        frame: Frame<K::Num>,
        pawl: &PawlShape<K::Num>,
        obstacles: &[ObstacleShape<K::Num>],
        limits: Option<&(K::Num, K::Num)>,
    ) -> Slice<K> {
        match Slice::unless(frame, pawl, obstacles, limits, &|| false) {
            Some(slice) => slice,
            None => unreachable!("nothing stops it"),
        }
    }

    /// The same, unless `stop`, asked every few thousand pairs of features, says that it is too late.
    pub fn unless(
        frame: Frame<K::Num>,
        pawl: &PawlShape<K::Num>,
        obstacles: &[ObstacleShape<K::Num>],
        limits: Option<&(K::Num, K::Num)>,
        stop: &dyn Fn() -> bool,
    ) -> Option<Slice<K>> {
        let (mut met, mut late) = (0u32, false);
        // Patches with the arcs that doubles see of them; None where they cannot tell.
        let mut pairs: Vec<(Pair, [bool; 2], Option<std::ops::Range<usize>>)> = Vec::new();
        let mut seen: Vec<Seen> = Vec::new();
        let near = K::ENCLOSES.then(|| frame.enclosed());
        let mut roughs: Vec<Function> = Vec::new();
        // Exact patches that were made to tell what coincides.
        let mut asked: Vec<(usize, Box<Patch<K::Num>>)> = Vec::new();
        pairs_within(&frame, pawl, obstacles, &mut |pair, rough| {
            met = met.wrapping_add(1);
            late = late || met.is_multiple_of(ASKED) && stop();
            if late {
                return;
            }
            let (Some(near), Some(rough)) = (&near, rough) else {
                pairs.push((pair, [true; 2], None));
                return;
            };
            let from = seen.len();
            let known = pairs.len();
            let make = || {
                let patch = pair.patch(&frame, pawl, obstacles);
                Patch {
                    charts: rough.charts,
                    ..patch
                }
            };
            let truth = Truth::new(&frame, &make);
            match scout::look(&rough, near, &truth, &mut seen) {
                Some(()) if seen.len() == from => {}
                Some(()) => pairs.push((pair, rough.charts, Some(from..seen.len()))),
                None => {
                    seen.truncate(from);
                    pairs.push((pair, rough.charts, None));
                }
            }
            if pairs.len() > known {
                asked.extend(truth.into_patch().map(|p| (known, p)));
                roughs.push((rough.f0, rough.f1));
            }
        });
        if late {
            return None;
        }
        let end = Scalar::interval(&frame.duration).hi;
        let shop = Rc::new(Shop {
            builder: RefCell::new(Builder::new(
                frame.clone(),
                pawl.clone(),
                obstacles.to_vec().into(),
            )),
            curves: Curves::new(pairs.len() + LIMITS),
            patches: {
                let mut all: Vec<_> = pairs.iter().map(|_| OnceCell::new()).collect();
                for (i, patch) in asked {
                    all[i] = OnceCell::from(patch);
                }
                all
            },
            made: pairs.iter().map(|_| OnceCell::new()).collect(),
            pairs: pairs.iter().map(|p| (p.0, p.1)).collect(),
        });
        let (mut arcs, mut patch_of) = (Vec::with_capacity(seen.len()), Vec::new());
        for (i, (.., range)) in pairs.iter().enumerate() {
            let i = i as u32;
            if (i + 1).is_multiple_of(ASKED) && stop() {
                return None;
            }
            match range {
                Some(range) => {
                    let whole = seen[range.clone()].iter();
                    arcs.extend(whole.map(|s| s.arc(shop.clone(), i)));
                }
                None => {
                    arcs.extend(shop.within(i, end));
                }
            }
            patch_of.resize(arcs.len(), Some(i));
        }
        if let Some((lo, hi)) = limits {
            for (which, u) in [(0, lo), (1, hi)] {
                arcs.push(shop.limit(u, which));
                patch_of.push(None);
            }
        }
        let rough = (roughs.into(), false);
        Some(Slice::of(frame, arcs, patch_of, rough, shop))
    }
    fn of(
        frame: Frame<K::Num>,
        arcs: Vec<Arc<K>>,
        patch_of: Vec<Option<u32>>,
        (rough, turned): (Rc<[Function]>, bool),
        shop: Rc<Shop<K>>,
    ) -> Slice<K> {
        let mut by_chart = [Vec::new(), Vec::new()];
        for (i, a) in arcs.iter().enumerate() {
            by_chart[a.chart.index()].push(i as ArcId);
        }
        Slice {
            frame,
            arcs,
            by_chart,
            patch_of,
            rough,
            turned,
            shop,
            crossings: Mutex::default(),
        }
    }
    /// The same patches with other arcs, as many and in the same order.
    pub(super) fn with_arcs(
        &self,
        frame: Frame<K::Num>,
        arcs: Vec<Arc<K>>,
        shop: Rc<Shop<K>>,
    ) -> Slice<K> {
        // With time turned round f₀g₁ − g₀f₁ changes its sign and nothing else.
        let rough = (self.rough.clone(), !self.turned);
        Slice::of(frame, arcs, self.patch_of.clone(), rough, shop)
    }
    /// Which patch an arc was cut from; None for a limit stop.
    pub(super) fn patch_id(&self, id: ArcId) -> Option<u32> {
        self.patch_of[id as usize]
    }
    /// All arcs.
    pub fn arcs(&self) -> &[Arc<K>] {
        &self.arcs
    }
    /// One arc.
    pub fn arc(&self, id: ArcId) -> &Arc<K> {
        &self.arcs[id as usize]
    }
    /// One curve.
    pub fn curve(&self, id: CurveId) -> &Curve<K> {
        self.shop.curves.get(id)
    }
    /// The arcs of one chart.
    pub fn arcs_in(&self, chart: Chart) -> &[ArcId] {
        &self.by_chart[chart.index()]
    }
    /// Whether doubles prove that two graphs of one chart do not meet.
    pub(super) fn apart(&self, a: ArcId, b: ArcId) -> bool {
        let of = |id: ArcId| self.rough.get(self.patch_of[id as usize]? as usize);
        let (Some(f), Some(g)) = (of(a), of(b)) else {
            return false;
        };
        let (x, y) = (self.arc(a), self.arc(b));
        let range = [x.x_span.lo.max(y.x_span.lo), x.x_span.hi.min(y.x_span.hi)];
        scout::apart(f, g, x.chart, range)
    }
    /// The C-function of an arc's patch in doubles, and the time t by its clock.
    pub(super) fn rough_at(&self, id: ArcId, t: Interval) -> Option<(&Function, Interval)> {
        let f = self.rough.get(self.patch_of[id as usize]? as usize)?;
        let end = Scalar::interval(&self.frame.duration);
        Some((f, if self.turned { end - t } else { t }))
    }
    /// The patch an arc was cut from; None for a limit stop.
    pub fn patch(&self, id: ArcId) -> Option<&Patch<K::Num>> {
        self.patch_of[id as usize].map(|i| self.shop.patch(i))
    }
}

/// Angular stops of a pawl, at most.
const LIMITS: usize = 2;

/// Curves by their ids; there is room for one a patch from the beginning, so that none ever moves.
#[derive(Debug)]
pub(super) struct Curves<K: Kernel> {
    all: Box<[OnceCell<Box<Curve<K>>>]>,
    len: Cell<usize>,
}

impl<K: Kernel> Curves<K> {
    fn new(most: usize) -> Curves<K> {
        Curves {
            all: (0..most).map(|_| OnceCell::new()).collect(),
            len: Cell::new(0),
        }
    }
    pub(super) fn add(&self, curve: Curve<K>) -> CurveId {
        let id = self.len.get();
        self.len.set(id + 1);
        self.all[id].get_or_init(|| Box::new(curve));
        id as CurveId
    }
    pub(super) fn get(&self, id: CurveId) -> &Curve<K> {
        match self.all[id as usize].get() {
            Some(c) => c,
            // `add` alone makes ids, and nothing is ever taken out.
            None => unreachable!("an id is given out with its curve"),
        }
    }
}

/// Makes exact patches and arcs, each once.
pub(super) struct Shop<K: Kernel> {
    builder: RefCell<Builder<K>>,
    curves: Curves<K>,
    /// The features of each patch, and the charts in which it may be met.
    pairs: Vec<(Pair, [bool; 2])>,
    patches: Vec<OnceCell<Box<Patch<K::Num>>>>,
    /// All arcs of a patch, also those outside of the phase.
    made: Vec<OnceCell<Box<[Arc<K>]>>>,
}

impl<K: Kernel> std::fmt::Debug for Shop<K> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let made = self.made.iter().filter(|m| m.get().is_some()).count();
        write!(f, "Shop({made} of {} patches made)", self.made.len())
    }
}

impl<K: Kernel> Shop<K> {
    /// A patch, which is kept: friction asks for those that the state follows.
    fn patch(&self, i: u32) -> &Patch<K::Num> {
        self.patches[i as usize].get_or_init(|| Box::new(self.make(i)))
    }
    fn make(&self, i: u32) -> Patch<K::Num> {
        let b = self.builder.borrow();
        let (pair, charts) = &self.pairs[i as usize];
        let patch = pair.patch(&b.frame, &b.pawl, &b.obstacles);
        Patch {
            charts: *charts,
            ..patch
        }
    }
    /// The arcs of a patch; the patch itself, a quarter of all that an arc needs, is not kept for them, but used
    /// where it is there.
    fn made(&self, i: u32) -> &[Arc<K>] {
        self.made[i as usize].get_or_init(|| {
            let known = self.patches[i as usize].get();
            let made = known.is_none().then(|| self.make(i));
            let patch = known.map(|p| &**p).or(made.as_ref());
            let cut = |p| self.builder.borrow_mut().cut(&self.curves, p);
            patch.map(cut).unwrap_or_default().into()
        })
    }
    /// The arcs of a patch, worked out, but for those that lie wholly before the phase or wholly after its
    /// end: they can never be met.
    pub(super) fn within(&self, i: u32, end: f64) -> Vec<Arc<K>> {
        let made = self.made(i).iter();
        made.filter(|a| a.t_span.hi >= 0.0 && a.t_span.lo <= end)
            .cloned()
            .collect()
    }
    /// The arc of an angular stop.
    pub(super) fn limit(&self, u: &K::Num, which: u8) -> Arc<K> {
        self.builder.borrow_mut().limit(&self.curves, u, which)
    }
    /// A shop for the same patches along another path.
    pub(super) fn reversed(&self, frame: Frame<K::Num>) -> Shop<K> {
        let b = self.builder.borrow();
        Shop {
            builder: RefCell::new(Builder::new(frame, b.pawl.clone(), b.obstacles.clone())),
            curves: Curves::new(self.pairs.len() + LIMITS),
            patches: self.pairs.iter().map(|_| OnceCell::new()).collect(),
            made: self.pairs.iter().map(|_| OnceCell::new()).collect(),
            pairs: self.pairs.clone(),
        }
    }
    /// The exact part of the k-th arc of a patch.
    pub(super) fn exact(&self, patch: u32, k: u32, seen: &Arc<K>) -> Exact<K> {
        let arc = &self.made(patch)[k as usize];
        debug_assert_eq!(
            (arc.contact, arc.chart, arc.shape, arc.side),
            (seen.contact, seen.chart, seen.shape, seen.side),
            "doubles and exact numbers see the same arcs"
        );
        Exact::clone(arc)
    }
    /// The points whose names are known to lie on both curves, as far as their patches have been made.
    pub(super) fn named_on_both(
        &self,
        a: CurveId,
        b: CurveId,
        chart: Chart,
    ) -> Vec<(K::Root, K::Time)> {
        let through = &self.builder.borrow().through;
        let on = |c: CurveId| through.get(c as usize).map_or(&[][..], |v| v);
        let mut both = Vec::new();
        for (c, n) in on(a) {
            if *c == chart
                && let Some(t) = n.t.get()
                && on(b).iter().any(|(_, o)| o.x.same(&n.x))
            {
                both.push((n.x.clone(), t.clone()));
            }
        }
        both
    }
}
