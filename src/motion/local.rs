//! The local picture at a point of the cylinder: which arcs meet there, whether the state's
//! interval survives, and where its near end is just after.

use super::sight::Sight;
use crate::contact::{Chart, Contact};
use crate::kernel::{Instant, Kernel, Polynomial, Position};
use crate::number::Scalar;
use crate::slice::{ArcId, Germs, Point, Shape, Side, Slice, cmp_horizontal};
use std::cmp::Ordering;

/// Where the state is while nothing happens.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum State {
    /// θ = 0, touching or not.
    Rest,
    /// Held by an arc; `lower` if the arc is the lower end of the state's interval.
    On {
        arc: ArcId,
        half_turn: i64,
        lower: bool,
    },
}

/// An arc at a point, with the way it leaves it.
#[derive(Clone, Debug)]
pub(super) struct Incident {
    pub(super) arc: ArcId,
    pub(super) half_turn: i64,
    pub(super) germs: Germs,
    /// Which of the point's two representations (they differ only on the seam between charts);
    /// the higher one lies above.
    rank: usize,
}

/// A point with the second representation it has on a seam.
pub(super) struct Place<K: Kernel> {
    reps: [Option<(Point<K>, i64)>; 2],
}

impl<K: Kernel> Place<K> {
    /// The place of a point in a half-turn.
    pub(super) fn new(z: Point<K>, half_turn: i64) -> Place<K> {
        let one = K::Num::one();
        let minus_one = one.negated();
        // On the seam x is rational, and with it every time that is a function of x.
        let mirrored = |x: &K::Num| Point {
            chart: z.chart.other(),
            x: K::Root::of(x.clone()),
            t: match z.t.known() {
                Some(_) => z.t.clone(),
                None => z.t.decided().map_or_else(|| z.t.clone(), K::Time::of),
            },
            on: z.on.clone(),
        };
        if z.x.cmp_num(&one).is_eq() {
            let above = mirrored(&minus_one);
            Place {
                reps: [Some((z, half_turn)), Some((above, half_turn + 1))],
            }
        } else if z.x.cmp_num(&minus_one).is_eq() {
            let below = mirrored(&one);
            Place {
                reps: [Some((below, half_turn - 1)), Some((z, half_turn))],
            }
        } else {
            Place {
                reps: [Some((z, half_turn)), None],
            }
        }
    }
    fn reps(&self) -> impl Iterator<Item = (usize, &Point<K>, i64)> {
        self.reps
            .iter()
            .enumerate()
            .filter_map(|(i, r)| r.as_ref().map(|(p, h)| (i, p, *h)))
    }
    fn point(&self, rank: usize) -> Option<&Point<K>> {
        self.reps.get(rank).and_then(|r| r.as_ref()).map(|(p, _)| p)
    }
}

/// What follows an event, by the clamp.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) enum Next {
    /// The state is at rest.
    Rest,
    /// The state follows an arc.
    Follow {
        arc: ArcId,
        half_turn: i64,
        lower: bool,
    },
    /// The near end has jumped: the state snaps downward (−1) or upward (+1).
    Snap(i32),
    /// No way on; the arcs that closed the interval, and whether one curve alone (or a wall) did.
    Jam { arcs: Vec<ArcId>, single: bool },
    /// At rest, with both ways round open.
    Fork { up: ArcId, down: ArcId },
}

/// All arcs that hold a place.
pub(super) fn incident<K: Kernel>(
    slice: &Slice<K>,
    sight: &dyn Sight<K>,
    place: &Place<K>,
) -> Vec<Incident> {
    let mut out = Vec::new();
    for (rank, z, half_turn) in place.reps() {
        for &id in sight.at(z).iter() {
            let arc = slice.arc(id);
            if arc.is_barrier() && slice.holds(arc, z) {
                out.push(Incident {
                    arc: id,
                    half_turn,
                    germs: slice.germs(arc, z),
                    rank,
                });
            }
        }
    }
    out
}

fn cmp_germs<K: Kernel>(
    slice: &Slice<K>,
    place: &Place<K>,
    a: &Incident,
    b: &Incident,
    after: bool,
) -> Ordering {
    if a.rank != b.rank {
        return a.rank.cmp(&b.rank);
    }
    match place.point(a.rank) {
        Some(z) if after => slice.cmp_after(a.arc, b.arc, z),
        Some(z) => slice.cmp_before(a.arc, b.arc, z),
        None => Ordering::Equal,
    }
}

/// The topmost and the bottommost of the arcs that leave to the right; of coincident ones the
/// first contact.
pub(super) fn right_extremes<K: Kernel>(
    slice: &Slice<K>,
    place: &Place<K>,
    inc: &[Incident],
) -> Option<(Incident, Incident)> {
    let right: Vec<&Incident> = inc.iter().filter(|i| i.germs.right).collect();
    let contact = |i: &Incident| slice.arc(i.arc).contact;
    let mut top = *right.first()?;
    let mut bottom = top;
    for &g in &right[1..] {
        match cmp_germs(slice, place, g, top, true) {
            Ordering::Greater => top = g,
            Ordering::Equal if contact(g) < contact(top) => top = g,
            _ => {}
        }
        match cmp_germs(slice, place, g, bottom, true) {
            Ordering::Less => bottom = g,
            Ordering::Equal if contact(g) < contact(bottom) => bottom = g,
            _ => {}
        }
    }
    Some((top.clone(), bottom.clone()))
}

/// All arcs that leave to the right, from the bottom up.
pub(super) fn right_sorted<K: Kernel>(
    slice: &Slice<K>,
    place: &Place<K>,
    inc: &[Incident],
) -> Vec<Incident> {
    let mut right: Vec<Incident> = inc.iter().filter(|i| i.germs.right).cloned().collect();
    right.sort_by(|a, b| cmp_germs(slice, place, a, b, true));
    right
}

/// Position of an arc at rest's own place just after (or before), against θ = 0.
fn against_rest<K: Kernel>(slice: &Slice<K>, i: &Incident, after: bool) -> Ordering {
    cmp_horizontal(slice.arc(i.arc), after)
}

/// Decides what follows at a place that the state reaches (DP §9.2; see the module's opening).
///
/// `at_rest` says whether the place is θ = 0. `free` tells by the polygons whether the side above
/// (true) or below an arc is free just after; it is asked only where the interval splits at the
/// state's own place.
pub(super) fn resolve<K: Kernel>(
    slice: &Slice<K>,
    place: &Place<K>,
    inc: &[Incident],
    state: State,
    at_rest: bool,
    free: &dyn Fn(ArcId, bool) -> bool,
) -> Next {
    let own = match state {
        State::On { arc, .. } => inc.iter().find(|i| i.arc == arc),
        State::Rest => None,
    };
    // The side of each left germ on which the state does not lie.
    let left_of = |i: &Incident| match own {
        Some(o) => cmp_germs(slice, place, i, o, false),
        None => against_rest(slice, i, false),
    };
    let (mut above, mut below) = (Vec::new(), Vec::new());
    let (mut wall_up, mut wall_down) = (Vec::new(), Vec::new());
    for i in inc {
        if i.germs.up {
            wall_up.push(i.arc);
        }
        if i.germs.down {
            wall_down.push(i.arc);
        }
        if i.germs.left {
            match left_of(i) {
                Ordering::Greater => above.push(i.arc),
                Ordering::Less => below.push(i.arc),
                Ordering::Equal => match slice.arc(i.arc).side {
                    Side::Above => below.push(i.arc),
                    Side::Below => above.push(i.arc),
                    Side::Neither => {
                        above.push(i.arc);
                        below.push(i.arc);
                    }
                    _ => {}
                },
            }
        }
    }
    let up_open = above.is_empty() && wall_up.is_empty();
    let down_open = below.is_empty() && wall_down.is_empty();
    let jam = |closing: &[ArcId], wall: &[ArcId], own: Option<ArcId>| {
        if !wall.is_empty() {
            return Next::Jam {
                arcs: wall.to_vec(),
                single: true,
            };
        }
        let mut arcs: Vec<ArcId> = closing.to_vec();
        arcs.extend(own);
        let curve = |a: ArcId| slice.arc(a).curve;
        let single = arcs.windows(2).all(|w| curve(w[0]) == curve(w[1]));
        Next::Jam { arcs, single }
    };
    let ends = right_extremes(slice, place, inc);
    match state {
        State::On { arc, lower, .. } => {
            let open = if lower { up_open } else { down_open };
            if !open {
                let (closing, wall) = if lower {
                    (&above, &wall_up)
                } else {
                    (&below, &wall_down)
                };
                return jam(closing, wall, Some(arc));
            }
            let near = ends.map(|(top, bottom)| if lower { top } else { bottom });
            let kept = if at_rest {
                None
            } else {
                kept_part(slice, place, inc, arc, lower, free)
            };
            settle(slice, kept.or(near), lower, at_rest)
        }
        State::Rest => {
            if !up_open && !down_open {
                let wall: Vec<ArcId> = wall_up.iter().chain(&wall_down).copied().collect();
                let closing: Vec<ArcId> = above.iter().chain(&below).copied().collect();
                return jam(&closing, &wall, None);
            }
            let next = at_rest_next(slice, ends, up_open, down_open);
            match next {
                Next::Rest => next,
                _ if rests_on_level(slice, place, inc, true, free) => Next::Rest,
                _ => next,
            }
        }
    }
}

/// The germ next above (`up`) or below another one to the right.
fn neighbour<'a, K: Kernel>(
    slice: &Slice<K>,
    place: &Place<K>,
    inc: &'a [Incident],
    of: &Incident,
    up: bool,
) -> Option<&'a Incident> {
    let side = if up {
        Ordering::Greater
    } else {
        Ordering::Less
    };
    let beyond = inc
        .iter()
        .filter(|i| i.germs.right && cmp_germs(slice, place, i, of, true) == side);
    beyond.reduce(|best, i| {
        if cmp_germs(slice, place, i, best, true) == side.reverse() {
            i
        } else {
            best
        }
    })
}

/// Where the state's own curve goes on and the part beside it is still free, although something
/// else begins at this very place: "away from rest the state keeps to the part that still borders
/// its curve".
fn kept_part<K: Kernel>(
    slice: &Slice<K>,
    place: &Place<K>,
    inc: &[Incident],
    own: ArcId,
    lower: bool,
    free: &dyn Fn(ArcId, bool) -> bool,
) -> Option<Incident> {
    let a = slice.arc(own);
    let goes_on = |i: &&Incident| {
        let b = slice.arc(i.arc);
        i.germs.right
            && (i.arc == own
                || slice.coincide(own, i.arc)
                || (a.curve == b.curve && a.branch == b.branch && a.shape != Shape::Level))
    };
    let on = inc
        .iter()
        .filter(goes_on)
        .min_by_key(|i| slice.arc(i.arc).contact)?;
    let next = neighbour(slice, place, inc, on, lower)?;
    let facing = if lower { Side::Below } else { Side::Above };
    (slice.arc(next.arc).side == facing && free(on.arc, lower)).then(|| on.clone())
}

/// Whether rest touches a level that goes on and the part beside that level is still free. With
/// `before`, only a level that was there already counts.
pub(super) fn rests_on_level<K: Kernel>(
    slice: &Slice<K>,
    place: &Place<K>,
    inc: &[Incident],
    before: bool,
    free: &dyn Fn(ArcId, bool) -> bool,
) -> bool {
    inc.iter().any(|i| {
        let arc = slice.arc(i.arc);
        let lower = arc.side == Side::Above;
        let facing = if lower { Side::Below } else { Side::Above };
        arc.shape == Shape::Level
            && i.germs.right
            && (i.germs.left || !before)
            && matches!(arc.side, Side::Above | Side::Below)
            && neighbour(slice, place, inc, i, lower)
                .is_some_and(|n| slice.arc(n.arc).side == facing)
            && free(i.arc, lower)
    })
}

/// The near end of an interval whose side above (`lower`) or below the place is open.
pub(super) fn settle<K: Kernel>(
    slice: &Slice<K>,
    near: Option<Incident>,
    lower: bool,
    at_rest: bool,
) -> Next {
    let Some(i) = near else {
        return if at_rest {
            Next::Rest
        } else {
            Next::Snap(if lower { -1 } else { 1 })
        };
    };
    let drives = if lower {
        Ordering::Greater
    } else {
        Ordering::Less
    };
    if at_rest && against_rest(slice, &i, true) != drives {
        return Next::Rest;
    }
    Next::Follow {
        arc: i.arc,
        half_turn: i.half_turn,
        lower,
    }
}

/// What follows at rest, given the sides that are open and the extreme arcs to the right.
pub(super) fn at_rest_next<K: Kernel>(
    slice: &Slice<K>,
    ends: Option<(Incident, Incident)>,
    up_open: bool,
    down_open: bool,
) -> Next {
    let Some((top, bottom)) = ends else {
        return Next::Rest;
    };
    let up = settle(slice, Some(top.clone()), true, true);
    let down = settle(slice, Some(bottom.clone()), false, true);
    match (up_open, down_open) {
        (true, true) if up != Next::Rest && down != Next::Rest => Next::Fork {
            up: top.arc,
            down: bottom.arc,
        },
        (true, true) => Next::Rest,
        (true, false) => up,
        (false, _) => down,
    }
}

/// Where a snap ends.
#[derive(Clone, Debug)]
pub(super) enum Landing {
    /// At rest, nothing in the way.
    Rest,
    /// On an arc.
    On { arc: ArcId, half_turn: i64 },
}

/// The first arc that a snap meets from `place` on its way to rest, among those that exist just
/// after its time; `dir` is −1 downward, +1 upward. `skip` holds the arcs at the place itself.
pub(super) fn snap<K: Kernel>(
    slice: &Slice<K>,
    sight: &dyn Sight<K>,
    x: &K::Root,
    mut half_turn: i64,
    t: &K::Time,
    dir: i32,
    skip: &[Incident],
) -> Landing {
    let zero = K::Root::of(K::Num::zero());
    let toward = if dir < 0 {
        Ordering::Less
    } else {
        Ordering::Greater
    };
    let mut first = true;
    loop {
        let chart = Chart::of_half_turn(half_turn);
        let mut best: Option<ArcId> = None;
        let from = first.then_some(x);
        for &id in sight.across(chart, t, from, dir, half_turn == 0).iter() {
            let arc = slice.arc(id);
            if !arc.is_barrier() || !slice.alive_after(arc, t) {
                continue;
            }
            if first {
                if skip.iter().any(|i| i.arc == id) || slice.cmp_after_const(id, t, x) != toward {
                    continue;
                }
            } else if skip.iter().any(|i| i.arc == id && i.half_turn == half_turn) {
                continue;
            }
            if half_turn == 0 && slice.cmp_after_const(id, t, &zero) != toward.reverse() {
                continue;
            }
            let nearer = match best {
                None => true,
                Some(b) => {
                    let o = slice.cmp_heights_after(id, b, t);
                    o == toward.reverse()
                        || (o.is_eq() && slice.arc(id).contact < slice.arc(b).contact)
                }
            };
            if nearer {
                best = Some(id);
            }
        }
        if let Some(arc) = best {
            return Landing::On { arc, half_turn };
        }
        if half_turn == 0 {
            return Landing::Rest;
        }
        half_turn += i64::from(dir);
        first = false;
    }
}

/// The arcs that coincide with `arc` just after t, itself included, by contact.
pub(super) fn group<K: Kernel>(
    slice: &Slice<K>,
    sight: &dyn Sight<K>,
    arc: ArcId,
    t: &K::Time,
) -> Vec<ArcId> {
    let span = slice.arc(arc).x_span;
    let holds = |&b: &ArcId| {
        let other = slice.arc(b);
        // Cheapest first: most arcs are elsewhere, and nothing exact is made to see it.
        b == arc
            || (other.is_barrier()
                && other.x_span.meets(&span)
                && slice.alive_after(other, t)
                && slice.coincide(arc, b))
    };
    let mut ids: Vec<ArcId> = sight.twins(arc).iter().copied().filter(holds).collect();
    ids.sort_by_key(|&b| slice.arc(b).contact);
    ids
}

/// The contacts of some arcs, sorted and without repetition.
pub(super) fn contacts<K: Kernel>(slice: &Slice<K>, arcs: &[ArcId]) -> Vec<Contact> {
    let mut c: Vec<Contact> = arcs.iter().map(|&a| slice.arc(a).contact).collect();
    c.sort();
    c.dedup();
    c
}

/// Whether a graph arc's curve has a vertical tangency at x.
pub(super) fn is_tangency<K: Kernel>(slice: &Slice<K>, arc: ArcId, x: &K::Root) -> bool {
    let a = slice.arc(arc);
    if !matches!(a.shape, Shape::Graph { .. }) {
        return false;
    }
    let (p, q) = slice.curve(a.curve).reduced(a.chart);
    let bend = p.derivative().times(q).minus(&p.times(&q.derivative()));
    x.sign_of(&bend) == 0
}
