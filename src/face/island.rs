//! The other boundary components of a face: a plane sweep over what is already traced.
//!
//! The idea: the leftmost point of a boundary component is the left end of some arc, and the sweep meets
//! it before any other point of that component. So sweep the traced boundary from left to right (its
//! edges do not cross, so there is nothing to discover) together with the left ends of untouched arcs. An
//! end just above an edge that has the face on its upper side lies in the face: trace its component
//! and let the sweep take up its edges too. What is nested in an island, or hidden outside, is met
//! with the face nowhere near, and skipped.

use super::index::{EMPTY, hull, meet};
use super::trace::{Carrier, Dir, NONE, Point, Tracer};
use std::cmp::Ordering;

/// What the sweep meets; vertices first where they coincide with a candidate.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum What {
    Vertex(u32),
    Candidate(u32),
}

#[derive(Clone, Copy)]
struct Event {
    at: Point,
    what: What,
}

/// Edges from bottom to top, in chunks, so that an insertion moves few of them.
#[derive(Default)]
struct Status {
    chunks: Vec<Vec<u32>>,
}

const CHUNK: usize = 128;

impl Status {
    /// The place of the first edge for which `less` fails.
    fn search(&self, mut less: impl FnMut(u32) -> bool) -> (usize, usize) {
        let at = self.chunks.partition_point(|c| less(c[0]));
        if at == 0 {
            return (0, 0);
        }
        let chunk = &self.chunks[at - 1];
        (at - 1, 1 + chunk[1..].partition_point(|&e| less(e)))
    }
    /// The edge at a place, which may be one past the end of a chunk.
    fn get(&self, (chunk, at): (usize, usize)) -> Option<u32> {
        let c = self.chunks.get(chunk)?;
        match c.get(at) {
            Some(&e) => Some(e),
            None => self.chunks.get(chunk + 1).map(|c| c[0]),
        }
    }
    fn before(&self, (chunk, at): (usize, usize)) -> Option<u32> {
        if at > 0 { Some(self.chunks[chunk][at - 1]) } else { None }
    }
    fn remove(&mut self, (mut chunk, mut at): (usize, usize)) {
        if at == self.chunks[chunk].len() {
            (chunk, at) = (chunk + 1, 0);
        }
        self.chunks[chunk].remove(at);
        if self.chunks[chunk].is_empty() {
            self.chunks.remove(chunk);
        }
    }
    fn insert(&mut self, (chunk, at): (usize, usize), edges: &[u32]) {
        if edges.is_empty() {
            return;
        }
        if self.chunks.is_empty() {
            self.chunks.push(Vec::new());
        }
        let (chunk, at) = if chunk == self.chunks.len() { (chunk - 1, self.chunks[chunk - 1].len()) } else { (chunk, at) };
        self.chunks[chunk].splice(at..at, edges.iter().copied());
        if self.chunks[chunk].len() > CHUNK {
            let all = std::mem::take(&mut self.chunks[chunk]);
            let parts = all.chunks(CHUNK / 2).map(<[u32]>::to_vec);
            self.chunks.splice(chunk..=chunk, parts);
        }
    }
}

impl Tracer<'_> {
    /// Traces every island of the face whose outline is known.
    ///
    /// O((b + c) log b) comparisons for b edges traced and c components of the input.
    pub(crate) fn islands(&mut self) {
        let mut around = EMPTY;
        for e in 0..self.edges.len() {
            around = hull(&around, &self.bounds(self.edges[e].item));
        }
        let mut queued = vec![false; self.vertices.len()];
        let mut events = Vec::new();
        for comp in 0..self.touched.len() as u32 {
            if self.touched[comp as usize] {
                continue;
            }
            let at = self.begin_of(comp);
            let (x, t) = (self.k.enclosure(at.x), self.k.height(at.c, at.x));
            let bounds = [x.0, x.1, t.lo(), t.hi()];
            if self.unbounded || t.lo().is_nan() || t.hi().is_nan() || meet(&bounds, &around) {
                events.push(Event { at, what: What::Candidate(comp) });
            }
        }
        if events.is_empty() {
            return;
        }
        self.queue(0, &mut queued, |e| events.push(e));
        {
            let t = &mut *self;
            events.sort_by(|a, b| t.order(a, b));
        }
        // Vertices of islands come up while the sweep runs: a heap of their own.
        let mut later: Vec<Event> = Vec::new();
        let mut status = Status::default();
        let mut right = Vec::new();
        let mut last_vertex: Option<Point> = None;
        let mut next = 0;
        loop {
            let from_heap = match (events.get(next), later.first()) {
                (None, None) => break,
                (Some(_), None) => false,
                (None, Some(_)) => true,
                (Some(a), Some(b)) => self.order(b, a).is_lt(),
            };
            let event = if from_heap {
                self.pop(&mut later)
            } else {
                next += 1;
                events[next - 1]
            };
            match event.what {
                What::Vertex(v) => {
                    let place = status.search(|e| self.side(e, v, event.at).is_lt());
                    while let Some(e) = status.get(place)
                        && self.side(e, v, event.at).is_eq()
                    {
                        status.remove(place);
                    }
                    right.clear();
                    let (from, to) = self.germs_of(v);
                    right.extend(
                        self.germs[from..to].iter().filter(|g| g.dir == Dir::Right && g.edge != NONE).map(|g| g.edge),
                    );
                    // Removing may have emptied a chunk.
                    let place = status.search(|e| self.side(e, v, event.at).is_lt());
                    status.insert(place, &right);
                    last_vertex = Some(event.at);
                }
                What::Candidate(comp) => {
                    if self.touched[comp as usize] {
                        continue;
                    }
                    if let Some(p) = last_vertex
                        && self.cmp_points(p, event.at).is_eq()
                    {
                        continue;
                    }
                    let place = status.search(|e| self.side(e, NONE, event.at).is_lt());
                    if status.get(place).is_some_and(|e| self.side(e, NONE, event.at).is_eq()) {
                        continue;
                    }
                    let inside = match status.before(place) {
                        Some(e) => self.edges[e as usize].above,
                        None => self.unbounded,
                    };
                    if inside {
                        let first = self.edges.len();
                        self.trace_island(comp);
                        queued.resize(self.vertices.len(), false);
                        let mut fresh = Vec::new();
                        self.queue(first, &mut queued, |e| fresh.push(e));
                        for e in fresh {
                            self.push(&mut later, e);
                        }
                    }
                }
            }
        }
    }

    /// Queues the vertices of the edges from `first` on.
    fn queue(&mut self, first: usize, queued: &mut [bool], mut push: impl FnMut(Event)) {
        for e in first..self.edges.len() {
            for v in [self.edges[e].low, self.edges[e].high] {
                if !std::mem::replace(&mut queued[v as usize], true) {
                    push(Event { at: self.vertices[v as usize].at, what: What::Vertex(v) });
                }
            }
        }
    }

    fn order(&mut self, a: &Event, b: &Event) -> Ordering {
        if a.what == b.what {
            return Ordering::Equal;
        }
        self.cmp_points(a.at, b.at).then(a.what.cmp(&b.what))
    }

    /// Where an active edge lies with respect to a point, which is vertex `v` if that is one.
    fn side(&mut self, edge: u32, v: u32, at: Point) -> Ordering {
        let e = self.edges[edge as usize];
        if e.high == v {
            return Ordering::Equal;
        }
        match self.items[e.item as usize].carrier {
            Carrier::Graph(c) => self.k.cmp_at(c, at.c, at.x),
            // Verticals are never active.
            Carrier::Vertical(..) => Ordering::Less,
        }
    }

    fn push(&mut self, heap: &mut Vec<Event>, e: Event) {
        heap.push(e);
        let mut i = heap.len() - 1;
        while i > 0 {
            let up = (i - 1) / 2;
            if !self.order(&heap[i], &heap[up]).is_lt() {
                break;
            }
            heap.swap(i, up);
            i = up;
        }
    }

    fn pop(&mut self, heap: &mut Vec<Event>) -> Event {
        let top = heap.swap_remove(0);
        let mut i = 0;
        loop {
            let mut least = i;
            for child in [2 * i + 1, 2 * i + 2] {
                if child < heap.len() && self.order(&heap[child], &heap[least]).is_lt() {
                    least = child;
                }
            }
            if least == i {
                return top;
            }
            heap.swap(i, least);
            i = least;
        }
    }
}
