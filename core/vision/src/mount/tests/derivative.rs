//! Derivatives against differences.

use nalgebra::DVector;
use plumbline_model::Unattended;

use super::world::{World, board};
use crate::mount::optimizer::converge;
use crate::mount::prepare::prepare;
use crate::mount::problem::Problem;
use crate::mount::{MountOptions, Target};

#[test]
fn the_gradient_is_the_derivative_of_the_cost() {
    let mut world = World::new(2);
    let views = world.board_views(5);
    let points = world.corners();
    let options = MountOptions { head_zero_sd_rad: Some(0.01), ..MountOptions::default() };
    for (target, robust_px) in [
        (Target::UnknownBoard(board()), None),
        (Target::UnknownBoard(board()), Some(0.5)),
        (Target::KnownPoints(points), Some(0.5)),
    ] {
        let cameras = world.rig.eyes.cameras;
        let prepared = prepare(&world.rig, &cameras, &views, &target, &options).expect("usable");
        let problem = Problem { robust_px, ..prepared.problem };
        let state = prepared.state;
        let (_, right) = problem.normal_equations(&state);
        for i in 0..problem.layout().total {
            let step = 1e-6;
            let at = |sign: f64| {
                let mut change = DVector::zeros(problem.layout().total);
                change[i] = sign * step;
                problem.cost(&problem.moved(&state, &change))
            };
            let slope = (at(1.0) - at(-1.0)) / (2.0 * step);
            // Cost is twice the negative log-likelihood, the right-hand side its falling slope.
            let scale = right.amax().max(1.0);
            assert!((slope + 2.0 * right[i]).abs() < 1e-4 * scale, "{i}: {slope} {}", right[i]);
        }
        let solved = converge(&problem, state.clone(), &Unattended).expect("not cancelled");
        assert!(problem.cost(&solved) < problem.cost(&state));
    }
}
