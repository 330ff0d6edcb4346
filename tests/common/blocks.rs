//! Structures by hand: rectangles, and what is asked of them.

use snapfit::flex::{Body, Hold, StepRules, Structure, Term};
use snapfit::geometry::Vec2;
use snapfit::number::Rat;

pub(crate) fn r(n: i64, d: i64) -> Rat {
    Rat::frac(n, d)
}

pub(crate) fn v(x: Rat, y: Rat) -> Vec2 {
    Vec2::new(x, y)
}

pub(crate) fn rectangle(name: &str, [x0, y0, x1, y1]: [i64; 4], hold: Hold) -> Body {
    let at = |x, y| v(r(x, 10), r(y, 10));
    Body {
        name: name.to_owned(),
        vertices: vec![at(x0, y0), at(x1, y0), at(x1, y1), at(x0, y1)],
        position: Vec2::default(),
        tan_half: Rat::zero(),
        hold,
    }
}

pub(crate) fn plain(bodies: Vec<Body>, objective: Vec<Term>) -> Structure {
    let epsilon = r(3, 5);
    Structure {
        name: "by hand".to_owned(),
        step: StepRules::for_epsilon(&epsilon),
        epsilon,
        bodies,
        joints: None,
        nearest: None,
        views: Vec::new(),
        objective,
    }
}

pub(crate) fn moves(body: usize, dx: i64, dy: i64) -> Term {
    Term::Body {
        body,
        dx: Rat::from(dx),
        dy: Rat::from(dy),
        dtheta: Rat::zero(),
    }
}
