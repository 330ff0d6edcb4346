//! Bounds without a vertex: an interior point made exact.
//!
//! For a program of inequalities the interior-point method ends with slacks and prices that are
//! all positive, so both have room. The point is rounded to short integers over a power of two
//! and still satisfies every bound. The prices are rounded too and miss the costs of the free
//! columns by something like 10⁻¹⁶; this remainder is computed exactly, a correction for it in
//! doubles, and so on until the remainder is far below the room that the prices have. That exact
//! prices exist this near is what the checker proves (`certificate::lp_near`), and it is the
//! checker's word that is taken for both ends: nothing here decides anything.

use super::budget::Budget;
use super::digits::{ldexp, mantissa};
use super::float::central::Central;
use super::float::program::Program;
use super::model::{Model, Range};
use super::outcome::{Repair, Vector};
use super::problem::Problem;
use crate::certificate::lp::{Prices, worth};
use crate::certificate::lp_near::Near;
use crate::number::{Int, Rat};

/// Share of the relative gap that may be left which the interior point is to leave.
const GAP: f64 = 2.5e-10;
/// Bits of the largest value of a column, first and where it must be mended.
const POINT_BITS: i64 = 62;
const MENDED_BITS: i64 = 100;
/// Bits of the largest price. The first is quick, as products with coefficients of 45 bits fit
/// into 128; the second leaves room for programs that are worse conditioned.
const PRICE_BITS: [i64; 2] = [76, 120];
/// Corrections of the point and of the prices.
const CORRECTIONS: usize = 4;
const PRICE_CORRECTIONS: usize = 16;
/// A correction leaves a price at least 2 to the power of minus this of itself.
const KEPT: u64 = 3;
/// Margins that are tried, as powers of 1/2.
const MARGINS: [u32; 8] = [10, 14, 18, 22, 26, 30, 34, 38];

/// Two proven ends.
pub(crate) struct Enclosure {
    /// A feasible point and its objective.
    pub(crate) primal: (Vector, Rat),
    /// Prices and the bound that they prove, with what that proof needs.
    pub(crate) dual: (Vector, Rat),
    pub(crate) repair: Option<Repair>,
    /// Steps of the interior-point method.
    pub(crate) steps: u64,
    /// The point in doubles.
    pub(crate) near: Vec<f64>,
}

/// Encloses the optimum of a program of inequalities; None where this way does not lead there.
pub(crate) fn enclose(model: &Model, problem: &Problem, budget: &Budget) -> Option<Enclosure> {
    let program = Program::new(problem);
    let mut central = Central::new(&program)?;
    budget.allow(central.bytes()).ok()?;
    let constant = model.constant.nearest_f64()?;
    let turn = if model.maximise { -1.0 } else { 1.0 };
    let gap = |objective: f64| {
        let value = constant + turn * program.unscaled_objective(objective);
        let shift = program.bound_shift + program.cost_shift;
        ldexp(GAP * value.abs().max(1.0), shift)
    };
    if !central.run(gap, budget) {
        return None;
    }
    let (x, y) = program.unscaled(problem, &central.x, &central.prices());
    let (point, value) = inside(model, problem, &program, &mut central, &x)?;
    let free = |j: &u32| {
        let r = &model.columns[*j as usize].range;
        r.lower.is_none() && r.upper.is_none()
    };
    let order: Vec<u32> = central.order().iter().copied().filter(free).collect();
    central.weigh_prices();
    for bits in PRICE_BITS {
        let mut prices = rounded(&y, bits)?;
        correct(model, problem, &program, &central, &mut prices, budget)?;
        let dual = prices.vector();
        let near = Near::new(model, Prices::new(model, &dual).ok()?).ok()?;
        let Ok(matrix) = near.matrix(&order) else {
            continue;
        };
        for margin in MARGINS {
            budget.check().ok()?;
            if let Ok(bound) = near.bound_with(&matrix, margin) {
                return Some(Enclosure {
                    primal: (point, value),
                    dual: (dual, bound),
                    repair: (!near.exact()).then_some(Repair { order, margin }),
                    steps: central.steps,
                    near: x,
                });
            }
        }
    }
    None
}

/// Corrects prices until they miss the costs of the free columns by next to nothing.
fn correct(
    model: &Model,
    problem: &Problem,
    program: &Program,
    central: &Central<'_>,
    prices: &mut Fixed,
    budget: &Budget,
) -> Option<()> {
    let rest = Remainder::new(model);
    let (mut best, mut held_back) = (f64::INFINITY, false);
    let nothing = vec![0.0; problem.n];
    for _ in 0..PRICE_CORRECTIONS {
        budget.check().ok()?;
        let (scaled, size) = program.scaled_costs(problem, &rest.of(prices));
        // Doubles gain several digits in each round, until the last digit held is reached.
        if size == 0.0 || !held_back && size > 0.1 * best {
            break;
        }
        (best, held_back) = (best.min(size), false);
        let change = program
            .unscaled(problem, &nothing, &central.mend(&scaled))
            .1;
        for ((y, d), r) in prices.values.iter_mut().zip(&change).zip(&model.rows) {
            if *d == 0.0 {
                continue;
            }
            let mut there = &*y + &fixed(*d, prices.places);
            // A price must not change its sign; what that costs the correction is for the next.
            let one_sided = r.range.lower.is_none() || r.range.upper.is_none();
            let kept = y.shr(KEPT);
            if one_sided && (&there - &kept).sign() * y.sign() <= 0 {
                (there, held_back) = (kept, true);
            }
            *y = there;
        }
    }
    Some(())
}

/// A feasible point in short rationals near the one in doubles, and its objective.
fn inside(
    model: &Model,
    problem: &Problem,
    program: &Program,
    central: &mut Central<'_>,
    x: &[f64],
) -> Option<(Vector, Rat)> {
    let point = rounded(x, POINT_BITS)?.vector();
    if let Ok(value) = worth(model, &point) {
        return Some((point, value));
    }
    // Doubles do not resolve the slacks; the point must be mended where they are small.
    let mut point = rounded(x, MENDED_BITS)?;
    let rooms = Rooms::new(model);
    for _ in 0..CORRECTIONS {
        let room = rooms.of(model, &point);
        let change = central.mend_point(&program.scaled_rooms(problem, &room));
        let change = program.unscaled(problem, &change, &vec![0.0; problem.m]).0;
        for (v, d) in point.values.iter_mut().zip(&change) {
            if *d != 0.0 {
                *v += &fixed(*d, point.places);
            }
        }
        let found = point.vector();
        if let Ok(value) = worth(model, &found) {
            return Some((found, value));
        }
    }
    None
}

/// Integers over 2 to the power of `places`.
struct Fixed {
    values: Vec<Int>,
    places: i64,
}

/// v·2ᵖˡᵃᶜᵉˢ, rounded towards zero.
fn fixed(v: f64, places: i64) -> Int {
    let exact = Rat::from_f64(v);
    let m = exact.numer();
    let shift = places + 1 - exact.denom().bits() as i64;
    if shift >= 0 {
        m.shl(shift as u64)
    } else {
        let size = m.abs().shr(shift.unsigned_abs());
        if m.sign() < 0 { -size } else { size }
    }
}

/// Doubles as integers, the largest of them with so many bits.
fn rounded(v: &[f64], bits: i64) -> Option<Fixed> {
    let largest = v.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    if v.iter().any(|v| !v.is_finite()) || !(largest == 0.0 || largest > 1e-200) {
        return None;
    }
    let exponent = if largest == 0.0 {
        0
    } else {
        largest.log2().floor() as i64
    };
    let places = bits - exponent;
    (0..2000).contains(&places).then(|| Fixed {
        values: v.iter().map(|&v| fixed(v, places)).collect(),
        places,
    })
}

impl Fixed {
    fn vector(&self) -> Vector {
        let entries = (0..).zip(&self.values).filter(|(_, v)| !v.is_zero());
        Vector {
            denominator: Int::one().shl(self.places as u64),
            numerators: entries.map(|(k, v)| (k, Rat::from(v.clone()))).collect(),
        }
    }
}

/// Free columns in integers.
struct Remainder {
    columns: Vec<Integral>,
    all: usize,
}

/// A column, its scale, and its cost and entries times that.
struct Integral {
    column: usize,
    scale: Int,
    cost: Int,
    entries: Vec<(u32, Int)>,
}

impl Remainder {
    fn new(model: &Model) -> Remainder {
        let free = model.columns.iter().enumerate();
        let free = free.filter(|(_, c)| c.range.lower.is_none() && c.range.upper.is_none());
        let columns = free.map(|(j, c)| {
            let denominators = c.entries.iter().map(|e| e.1.denom());
            let scale = denominators.fold(c.cost.denom().clone(), |l, d| l.lcm(d));
            let integral = |v: &Rat| {
                if *v.denom() == scale {
                    v.numer().clone()
                } else {
                    v.numer() * &scale.div_exact(v.denom())
                }
            };
            let entries = c.entries.iter().map(|(i, a)| (*i, integral(a))).collect();
            let cost = integral(&c.cost);
            Integral {
                column: j,
                scale,
                cost,
                entries,
            }
        });
        Remainder {
            columns: columns.collect(),
            all: model.columns.len(),
        }
    }

    /// c − Aᵀy in the free columns as doubles, zero in the others.
    fn of(&self, y: &Fixed) -> Vec<f64> {
        let mut out = vec![0.0; self.all];
        for c in &self.columns {
            let mut sum = c.cost.shl(y.places as u64);
            for (i, a) in &c.entries {
                sum -= &(a * &y.values[*i as usize]);
            }
            if !sum.is_zero() {
                let ((v, e), (d, f)) = (mantissa(&sum), mantissa(&c.scale));
                out[c.column] = ldexp(v / d, e - f - y.places);
            }
        }
        out
    }
}

/// What exact distances from all bounds need.
struct Rooms {
    /// The common denominator of each row's coefficients.
    scale: Vec<Int>,
}

impl Rooms {
    fn new(model: &Model) -> Rooms {
        let mut scale = vec![Int::one(); model.rows.len()];
        for c in &model.columns {
            for (i, a) in &c.entries {
                let l = &mut scale[*i as usize];
                if *a.denom() != *l {
                    *l = l.lcm(a.denom());
                }
            }
        }
        Rooms { scale }
    }

    /// How far columns, then rows, are above their lower and below their upper bounds.
    fn of(&self, model: &Model, x: &Fixed) -> Vec<[f64; 2]> {
        let mut activity = vec![Int::zero(); model.rows.len()];
        for (c, v) in model.columns.iter().zip(&x.values) {
            for (i, a) in &c.entries {
                let i = *i as usize;
                let a = if *a.denom() == self.scale[i] {
                    a.numer() * v
                } else {
                    a.numer() * &self.scale[i].div_exact(a.denom()) * v.clone()
                };
                activity[i] += &a;
            }
        }
        let one = Int::one();
        let distance = |v: &Int, scale: &Int, range: &Range| {
            let from = |end: &Option<Rat>, side: f64| {
                let Some(end) = end else {
                    return f64::INFINITY;
                };
                // v/(scale·2^places) − end, over the common denominator.
                let top = v * end.denom() - (end.numer() * scale).shl(x.places as u64);
                let ((t, e), (s, f), (d, g)) =
                    (mantissa(&top), mantissa(scale), mantissa(end.denom()));
                side * ldexp(t / (s * d), e - f - g - x.places)
            };
            [from(&range.lower, 1.0), from(&range.upper, -1.0)]
        };
        let columns = model.columns.iter().zip(&x.values);
        let columns = columns.map(|(c, v)| distance(v, &one, &c.range));
        let rows = model.rows.iter().zip(activity.iter().zip(&self.scale));
        let rows = rows.map(|(r, (v, s))| distance(v, s, &r.range));
        columns.chain(rows).collect()
    }
}
