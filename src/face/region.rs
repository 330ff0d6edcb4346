//! A face as something to ask: what lies in it?
//!
//! The idea: a point that is on no arc lies in the face just if the first edge of the face's boundary straight below
//! it has the face above itself; with no edge below, if the face is unbounded. Where the line down meets
//! vertices, it is moved a little to the right, which changes neither answer.

use super::kernel::Kernel;
use super::merge::Face;
use super::run::{FaceError, Question};
use super::trace::Carrier;
use crate::number::Rat;
use std::cmp::Ordering;

/// The face that holds the start, for queries.
pub struct Region {
    kernel: Kernel,
    face: Face,
}

impl Question<'_> {
    /// Finds the face and keeps it. Costs what [`Question::answer`] costs.
    ///
    /// # Errors
    /// See [`Question::answer`].
    ///
    /// # Example
    /// ```
    /// use snapfit::face::{ArcFile, Method, Question};
    /// use snapfit::number::Rat;
    /// // Two parabolas t = ±(u² − 1) from −1 to 1 close a lens round the origin.
    /// let text = "2 0 0\n-1 0 1 1 0 0  1 1 0 0  -1 1 0 0\n1 0 -1 1 0 0  1 1 0 0  -1 1 0 0\n";
    /// let file = ArcFile::parse(text)?;
    /// let mut lens = Question {
    ///     arcs: &file.arcs,
    ///     uprights: &[],
    ///     start: &file.start,
    ///     method: Method::Auto,
    ///     leaf: 128,
    /// }
    /// .region()?;
    /// assert_eq!(lens.holds(&(Rat::frac(1, 2), Rat::frac(1, 2))), Some(true));
    /// assert_eq!(lens.holds(&(Rat::frac(1, 2), Rat::frac(3, 4))), None);
    /// assert_eq!(lens.holds(&(Rat::frac(1, 2), Rat::from(2))), Some(false));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn region(&self) -> Result<Region, FaceError> {
        let found = self.find()?;
        Ok(Region {
            kernel: found.kernel,
            face: found.face,
        })
    }
}

impl Region {
    /// Vertices of its boundary.
    pub fn vertices(&self) -> usize {
        self.face.points.len()
    }

    /// Edges of its boundary, each once.
    pub fn edges(&self) -> usize {
        self.face.items.len()
    }

    /// Whether a point (u, t) lies in the face; None on its boundary. Points on arcs that do not bound it lie
    /// outside. O(edges).
    pub fn holds(&mut self, p: &(Rat, Rat)) -> Option<bool> {
        let k = &mut self.kernel;
        let (x, c) = (k.rational(&p.0), k.constant(&p.1));
        let mut below: Option<(u32, bool)> = None;
        for (item, sides) in self.face.items.iter().zip(&self.face.sides) {
            let (from, to) = (k.cmp(item.l, x), k.cmp(x, item.r));
            if from.is_gt() || to.is_gt() {
                continue;
            }
            match item.carrier {
                Carrier::Vertical(low, high) => {
                    if k.cmp_at(low, c, x).is_le() && k.cmp_at(c, high, x).is_le() {
                        return None;
                    }
                }
                Carrier::Graph(d) => match k.cmp_at(d, c, x) {
                    Ordering::Equal => return None,
                    Ordering::Less if to.is_lt() => {
                        let higher = below.is_none_or(|(e, _)| {
                            k.cmp_at(e, d, x)
                                .then_with(|| k.cmp_beside(e, d, x, true))
                                .is_lt()
                        });
                        if higher {
                            below = Some((d, sides[0]));
                        }
                    }
                    _ => {}
                },
            }
        }
        Some(below.map_or(self.face.unbounded, |b| b.1))
    }
}
