//! Another start on a slice that is there already: the trajectory from any orientation, without building anything
//! again.

use super::phase::{Method, Run, Setting, run};
use super::plan::Seen;
use super::solids::Solids;
use super::trajectory::Angle;
use crate::contact::PawlShape;
use crate::geometry::{Polygon, Vec2, interiors_intersect};
use crate::kernel::Kernel;
use crate::number::{Rat, Scalar};
use crate::scene::Scene;

impl<K: Kernel> Seen<K> {
    /// The pawl's run through this phase from another orientation, as if nothing had been known to touch
    /// before. The slice is used as it is, and F too if it holds the new start: `faces.reused` of the
    /// outcome tells. `scene` is the one that was simulated.
    ///
    /// Cost: that of the motion alone; a start in another component costs that component once.
    ///
    /// # Panics
    /// If the scene has no such pawl.
    pub fn run_from(&self, scene: &Scene, start: &Angle<K>, method: Method) -> Run<K> {
        let pawl = &scene.pawls[self.pawl];
        let shape = PawlShape::<Rat>::new(pawl);
        let turning = Polygon::new(shape.ring.vertices.to_vec(), Vec::new());
        let solids = Solids::new(&scene.obstacles);
        let set = Setting {
            shape: &turning,
            obstacles: &solids,
            limits: pawl.limits.as_ref(),
            friction: scene.friction.as_ref(),
            phase: self.phase,
            probe: None,
            stop: &|| false,
            method,
            known: self.free.clone(),
            face: crate::face::Method::Auto,
        };
        run(&self.slice, &set, start, &[])
    }

    /// Whether the pawl may start this phase at tan(θ/2): within its stops, and its interior clear of the obstacles.
    ///
    /// # Panics
    /// If the scene has no such pawl.
    pub fn may_start(&self, scene: &Scene, tan_half: &Rat) -> bool {
        let pawl = &scene.pawls[self.pawl];
        let within = |(lo, hi): &(Rat, Rat)| lo <= tan_half && tan_half <= hi;
        if !pawl.limits.as_ref().is_none_or(within) {
            return false;
        }
        let p0 = &self.slice.frame.p0;
        let hinge = Vec2::new(p0.x.to_rat(), p0.y.to_rat());
        let turned = |v: &Vec2| &(v - &pawl.hinge).rotate_tan_half(tan_half) + &hinge;
        let placed = Polygon::new(pawl.vertices.iter().map(turned).collect(), Vec::new());
        !Solids::new(&scene.obstacles)
            .iter()
            .any(|o| interiors_intersect(&placed, o))
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::motion::plan::{Options, slices};
    use crate::scene::read_scene;
    use crate::slice::Free;
    use std::rc::Rc;

    /// An F that contradicts itself is given up: the run goes on by the simple algorithm, tells what that tells
    /// from the start, and the ledger's count says so.
    #[test]
    fn a_contradictory_f_is_given_up_and_counted() {
        let text = r#"
[scene]
name = "two steps"
[[obstacle]]
name = "A"
vertices = [["1", "-1"], ["4", "-1"], ["4", "1"], ["1", "1"]]
[[obstacle]]
name = "B"
vertices = [["3", "1"], ["5", "1"], ["5", "3/2"], ["3", "3/2"]]
[[pawl]]
name = "p"
hinge = ["-3", "3"]
vertices = [["-3", "3"], ["-3", "0"], ["-13/4", "0"]]
[[motion]]
velocity = ["1", "0"]
duration = "12"
"#;
        let file = read_scene("scene", text).unwrap();
        let mut seen = None;
        slices(file.scene(), &Options::default(), &mut |s| seen = Some(s)).unwrap();
        let mut seen = seen.unwrap();
        let start = seen.start.clone();
        let whole = seen.run_from(file.scene(), &start, Method::Sweep);
        assert_eq!((whole.method, whole.faces.abandoned), (Method::Sweep, 0));
        assert!(whole.events.len() > 2, "something happens");
        let naive = seen.run_from(file.scene(), &start, Method::Naive);
        assert_eq!(naive.faces, Default::default());
        let told = |r: &Run| (r.events.clone(), r.segments.clone());
        let whole = seen.free.clone().unwrap();
        let mut abandoned = 0;
        for arc in 0..seen.slice.arcs().len() as u32 {
            let way = crate::face::Method::Walk;
            let mut damaged = Free::new(&*seen.slice, whole.start(), way).unwrap();
            damaged.forget_owner(arc);
            seen.free = Some(Rc::new(damaged));
            let swept = seen.run_from(file.scene(), &start, Method::Sweep);
            assert!(swept.faces.reused > 0, "the damaged F was looked through");
            assert_eq!(told(&swept), told(&naive), "arc {arc}");
            assert_eq!(swept.faces.abandoned > 0, swept.method == Method::Naive);
            abandoned += swept.faces.abandoned;
        }
        assert!(abandoned > 0, "one of them was found out and counted");
    }
}
