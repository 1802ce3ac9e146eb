//! Speed and residual of the inverse kinematics on random reachable targets of NICO's right arm:
//! `cargo run --release -p plumbline-model --example ik_bench [-- COUNT [--json] [--write FILE]]`.
//!
//! Targets are the places of the tip at random joint angles inside the limits; every solve starts
//! from the home posture. `--write` leaves the targets as a table for other solvers.

use std::fmt::Write as _;
use std::time::Instant;

use plumbline_model::robot::ik::{Answer, Options, Solver, Target};
use plumbline_model::robot::{Chain, Rig};
use plumbline_model::{Point, Robot};

const TIP: &str = "right_palm_center";

struct Figures {
    name: &'static str,
    targets: usize,
    solved: usize,
    within_limits: bool,
    median_us: f64,
    mean_us: f64,
    p99_us: f64,
    from_start: f64,
    mean_iterations: f64,
    median_position_m: f64,
    mean_position_m: f64,
    largest_position_m: f64,
    largest_orientation_rad: f64,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let count = arguments.first().and_then(|count| count.parse().ok()).unwrap_or(10_000);
    let rig = Rig::built_in("nico")?;
    let solver = Solver::of_rig(&rig, TIP)?;
    let chain = rig.chain(TIP)?;
    let poses = random_poses(&chain, &solver, count);
    if let Some(place) = arguments.iter().position(|argument| argument == "--write") {
        let file = arguments.get(place + 1).ok_or("--write needs a file")?;
        std::fs::write(file, table(&poses))?;
    }
    let start = rig.home().of(solver.joints());
    let middle: Vec<f64> = solver.limits().iter().map(|limits| limits.middle_rad()).collect();
    let plain = Options::default();
    let rested = Options { rest: Some(middle), ..Options::default() };
    let point = |pose: &Pose| Target::Position(point_of(pose));
    let yaw =
        |pose: &Pose| Target::PositionYaw { point: point_of(pose), yaw_rad: pose.rotation.euler_angles().2 };
    let upright = Options::upright();
    let cases: [Case<'_>; 6] = [
        ("position", &plain, &point),
        ("position, rest posture", &rested, &point),
        ("position, upright", &upright, &point),
        ("position and yaw", &plain, &yaw),
        ("position and yaw, upright", &upright, &yaw),
        ("pose", &plain, &|pose| Target::Pose(plumbline_model::Pose::new(*pose))),
    ];
    let all: Vec<Figures> = cases
        .iter()
        .map(|(name, options, target)| measure(name, &solver, &start, &poses, options, target))
        .collect();
    let text = if arguments.iter().any(|argument| argument == "--json") { json(&all) } else { lines(&all) };
    std::io::Write::write_all(&mut std::io::stdout(), text.as_bytes())?;
    Ok(())
}

fn point_of(pose: &Pose) -> Point<Robot> {
    Point::from(nalgebra::Point3::from(pose.translation.vector))
}

type Pose = nalgebra::Isometry3<f64>;
/// Name, how to solve, what is asked at a place of the tip.
type Case<'a> = (&'static str, &'a Options, &'a dyn Fn(&Pose) -> Target);

/// Places of the tip at random angles; the same ones every time.
fn random_poses(chain: &Chain, solver: &Solver, count: usize) -> Vec<Pose> {
    let mut state = 0x1234_5678_9abc_def0_u64;
    let mut uniform = move || {
        // SplitMix64.
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    };
    let pose = |_| {
        let angles: Vec<f64> =
            solver.limits().iter().map(|limits| limits.lower_rad + limits.span_rad() * uniform()).collect();
        chain.robot_from_tip(&angles).isometry
    };
    (0..count).map(pose).collect()
}

fn measure(
    name: &'static str,
    solver: &Solver,
    start: &[f64],
    poses: &[Pose],
    options: &Options,
    target: &dyn Fn(&Pose) -> Target,
) -> Figures {
    let targets: Vec<Target> = poses.iter().map(target).collect();
    let mut answers: Vec<(f64, Answer)> = Vec::with_capacity(targets.len());
    for target in &targets {
        let began = Instant::now();
        let answer = solver.solve(target, start, options).expect("targets and start are numbers");
        answers.push((began.elapsed().as_secs_f64() * 1e6, answer));
    }
    let n = answers.len() as f64;
    let mut times: Vec<f64> = answers.iter().map(|(time, _)| *time).collect();
    times.sort_by(f64::total_cmp);
    let mut errors: Vec<f64> = answers.iter().map(|(_, answer)| answer.best().position_error_m).collect();
    errors.sort_by(f64::total_cmp);
    let best = || answers.iter().map(|(_, answer)| answer.best());
    Figures {
        name,
        targets: answers.len(),
        solved: answers.iter().filter(|(_, answer)| answer.is_reached()).count(),
        within_limits: best().all(|s| s.joints.iter().zip(solver.limits()).all(|(q, l)| l.contain(*q))),
        median_us: times[times.len() / 2],
        mean_us: times.iter().sum::<f64>() / n,
        p99_us: times[times.len() * 99 / 100],
        from_start: best().filter(|solution| solution.starts == 1).count() as f64 / n,
        mean_iterations: best().map(|solution| f64::from(solution.iterations)).sum::<f64>() / n,
        median_position_m: errors[errors.len() / 2],
        mean_position_m: errors.iter().sum::<f64>() / n,
        largest_position_m: errors.last().copied().unwrap_or_default(),
        largest_orientation_rad: best().map(|s| s.orientation_error_rad).fold(0.0, f64::max),
    }
}

/// One target per line, as `plumbline ik` reads them.
fn table(poses: &[Pose]) -> String {
    let mut text = "x_m,y_m,z_m,roll_rad,pitch_rad,yaw_rad\n".to_owned();
    for pose in poses {
        let (at, (roll, pitch, yaw)) = (pose.translation.vector, pose.rotation.euler_angles());
        let _ = writeln!(text, "{},{},{},{roll},{pitch},{yaw}", at.x, at.y, at.z);
    }
    text
}

fn lines(all: &[Figures]) -> String {
    let mut text = String::new();
    for f in all {
        let _ = writeln!(
            text,
            "{:26} {} of {} reached; µs median {:.2}, mean {:.2}, 99 % {:.1}; from the start {:.1} %; \
             iterations {:.1}; position error m: median {:.1e}, mean {:.1e}, largest {:.1e}; \
             orientation largest {:.1e} rad; limits held: {}",
            f.name,
            f.solved,
            f.targets,
            f.median_us,
            f.mean_us,
            f.p99_us,
            f.from_start * 100.0,
            f.mean_iterations,
            f.median_position_m,
            f.mean_position_m,
            f.largest_position_m,
            f.largest_orientation_rad,
            f.within_limits
        );
    }
    text
}

fn json(all: &[Figures]) -> String {
    let parts: Vec<String> = all
        .iter()
        .map(|f| {
            format!(
                "  {{\"name\": \"{}\", \"targets\": {}, \"reached\": {}, \"within_limits\": {}, \
                 \"median_us\": {}, \"mean_us\": {}, \"p99_us\": {}, \"median_position_m\": {:e}, \
                 \"mean_position_m\": {:e}, \"largest_position_m\": {:e}, \"largest_orientation_rad\": {:e}}}",
                f.name,
                f.targets,
                f.solved,
                f.within_limits,
                f.median_us,
                f.mean_us,
                f.p99_us,
                f.median_position_m,
                f.mean_position_m,
                f.largest_position_m,
                f.largest_orientation_rad
            )
        })
        .collect();
    format!("[\n{}\n]\n", parts.join(",\n"))
}
