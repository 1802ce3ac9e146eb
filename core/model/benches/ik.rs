//! Times of the inverse kinematics and of the collision check: `cargo bench -p plumbline-model`.
//! Shares and residuals over many targets: the example `ik_bench`.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use plumbline_model::robot::ik::{Options, Solver, Target};
use plumbline_model::robot::{Reach, ReachOptions, Rig};
use plumbline_model::{Point, Pose};

const TIP: &str = "right_palm_center";

fn kinematics(criterion: &mut Criterion) {
    let rig = Rig::built_in("nico").expect("a valid rig");
    let solver = Solver::of_rig(&rig, TIP).expect("a tip");
    let chain = rig.chain(TIP).expect("a tip");
    let start = rig.home().of(solver.joints());
    // Joint angles in the middle third of every range, one after the other.
    let angles = |k: usize| -> Vec<f64> {
        let share = |i: usize| 0.35 + 0.3 * ((k * (2 * i + 3)) % 17) as f64 / 17.0;
        let of = |(i, l): (usize, &plumbline_model::robot::Limits)| l.lower_rad + share(i) * l.span_rad();
        solver.limits().iter().enumerate().map(of).collect()
    };
    let places: Vec<_> = (0..64).map(|k| chain.robot_from_tip(&angles(k)).isometry).collect();
    let point = |k: usize| Point::from(nalgebra::Point3::from(places[k % 64].translation.vector));
    let yaw_rad = |k: usize| places[k % 64].rotation.euler_angles().2;
    let plain = Options::default();
    let mut group = criterion.benchmark_group("ik");
    let mut k = 0;
    let mut next = || {
        k += 1;
        k
    };
    group.bench_function("position", |b| {
        b.iter(|| solver.solve(black_box(&Target::Position(point(next()))), &start, &plain));
    });
    group.bench_function("position and yaw", |b| {
        b.iter(|| {
            let k = next();
            let target = Target::PositionYaw { point: point(k), yaw_rad: yaw_rad(k) };
            solver.solve(black_box(&target), &start, &plain)
        });
    });
    group.bench_function("pose", |b| {
        b.iter(|| solver.solve(black_box(&Target::Pose(Pose::new(places[next() % 64]))), &start, &plain));
    });
    let far = Target::Position(Point::new(1.2, -0.3, 0.3));
    group.bench_function("out of reach", |b| b.iter(|| solver.solve(black_box(&far), &start, &plain)));
    group.finish();
}

fn collision(criterion: &mut Criterion) {
    let rig = Rig::built_in("nico").expect("a valid rig");
    let reach = Reach::new(&rig, TIP).expect("a tip");
    let target = Target::Position(Point::new(0.3, -0.2, 0.25));
    let options = ReachOptions::default();
    let plan = reach.plan(&rig.home(), &target, &options).expect("a proper question");
    let mut group = criterion.benchmark_group("collision");
    group
        .bench_function("posture", |b| b.iter(|| reach.model().check_posture(black_box(&plan.posture), &[])));
    group.bench_function("path", |b| {
        b.iter(|| reach.model().check_path(&rig.home(), black_box(&plan.posture), &[]));
    });
    group.bench_function("plan", |b| b.iter(|| reach.plan(&rig.home(), black_box(&target), &options)));
    group.bench_function("model of a rig", |b| b.iter(|| Reach::new(black_box(&rig), TIP)));
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .warm_up_time(std::time::Duration::from_millis(300))
        .measurement_time(std::time::Duration::from_secs(1))
        .sample_size(20);
    targets = kinematics, collision
}
criterion_main!(benches);
