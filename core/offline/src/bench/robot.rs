//! Kinematics, the twin's eyes, and the servo bus: figures that need no measured data.

use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_hardware::dynamixel::open_port;
use plumbline_hardware::joints::{ArmDriver, ArmOptions};
use plumbline_model::robot::Rig;
use plumbline_model::robot::ik::{Options, Solver, Target};
use plumbline_twin::eyes::{EyeOptions, EyeRenderer, Sensor};
use plumbline_twin::{Scenario, Twin, TwinSettings};

use super::{Figure, looking};

/// Targets of the inverse kinematics.
const TARGETS: u32 = 10_000;
/// Pairs that are drawn.
const PAIRS: u32 = 40;

/// All of them; what cannot be measured here says why.
pub fn figures() -> Vec<Figure> {
    let mut figures = kinematics();
    let twin = Scenario::built_in("lab").map_err(|error| error.to_string()).and_then(|scenario| {
        let rig = Arc::new(rig());
        Twin::start(TwinSettings { rig, scenario, seed: 1, pace: 1.0 }).map_err(|error| error.to_string())
    });
    match twin {
        Ok(twin) => {
            figures.push(bus(&twin).unwrap_or_else(|why| Figure::missing("the servo bus", why)));
            figures.push(eyes(&twin).unwrap_or_else(|why| Figure::missing("the twin's eyes", why)));
            figures.extend(looking::figures(&twin, &Arc::new(rig())));
        }
        Err(why) => figures.push(Figure::missing("the twin", why)),
    }
    figures
}

fn rig() -> Rig {
    Rig::built_in("nico").expect("the rig that comes with the program is tested")
}

/// Random reachable places of the right palm, from joint angles inside the limits.
fn kinematics() -> Vec<Figure> {
    let rig = rig();
    let tip = &rig.arms[0].tips[0].link;
    let (Ok(chain), Ok(solver)) = (rig.chain(tip), Solver::of_rig(&rig, tip)) else {
        return vec![Figure::missing("inverse kinematics", "the arm of the rig cannot be solved")];
    };
    let start = rig.home().of(solver.joints());
    let (mut times_us, mut missed) = (Vec::new(), 0);
    for i in 1..=TARGETS {
        // Halton's sequence fills the joint ranges evenly.
        let primes = [2, 3, 5, 7, 11, 13];
        let angle = |(limits, prime): (&plumbline_model::robot::Limits, u32)| {
            limits.lower_rad + limits.span_rad() * halton(i, prime)
        };
        let angles: Vec<f64> = solver.limits().iter().zip(primes).map(angle).collect();
        let target = Target::Pose(chain.robot_from_tip(&angles));
        let began = Instant::now();
        let answer = solver.solve(&target, &start, &Options::default());
        times_us.push(began.elapsed().as_secs_f64() * 1e6);
        let solved = answer.is_ok_and(|answer| answer.is_reached() && answer.best().position_error_m <= 1e-4);
        missed += u32::from(!solved);
    }
    times_us.sort_by(f64::total_cmp);
    let share = 100.0 * f64::from(missed) / f64::from(TARGETS);
    vec![
        Figure::new("inverse kinematics, 10 000 poses, not solved to 0.1 mm", share, "%").at_most(0.1),
        Figure::new("inverse kinematics, median per pose", times_us[times_us.len() / 2], "µs").at_most(20.0),
    ]
}

fn halton(mut index: u32, base: u32) -> f64 {
    let (mut fraction, mut value) = (1.0, 0.0);
    while index > 0 {
        fraction /= f64::from(base);
        value += fraction * f64::from(index % base);
        index /= base;
    }
    value
}

/// One complete cycle over all servos, by the time that its bytes take on the wire.
fn bus(twin: &Twin) -> Result<Figure, String> {
    let rig = Arc::new(rig());
    let port = open_port(&twin.port().to_string_lossy(), rig.bus.baud).map_err(|error| error.to_string())?;
    let servos = rig.servos.len();
    let driver = ArmDriver::connect(port, rig, ArmOptions::default()).map_err(|error| error.to_string())?;
    std::thread::sleep(Duration::from_secs(2));
    let state = driver.state();
    if state.bus.complete_cycles == 0 {
        return Err("no cycle was complete".to_owned());
    }
    let what = format!("one cycle over {servos} servos, on the wire (50 cycles/s are 20 ms)");
    Ok(Figure::new(what, state.bus.last_wire_s * 1e3, "ms").at_most(20.0))
}

/// Drawing what the twin sees, on whatever device there is.
fn eyes(twin: &Twin) -> Result<Figure, String> {
    let (scenery, snapshot) = twin.scene().newest();
    let mut renderer = EyeRenderer::new(EyeOptions::default()).map_err(|error| error.to_string())?;
    let sensor = Sensor::default();
    renderer.render(&scenery, &snapshot, &sensor, 0).map_err(|error| error.to_string())?;
    let began = Instant::now();
    for i in 1..=PAIRS {
        renderer.render(&scenery, &snapshot, &sensor, u64::from(i)).map_err(|error| error.to_string())?;
    }
    let each_ms = began.elapsed().as_secs_f64() * 1e3 / f64::from(PAIRS);
    let what = format!("a pair of the twin's eyes, on {} (15 pairs/s are 66.7 ms)", renderer.adapter_name());
    Ok(Figure::new(what, each_ms, "ms").at_most(66.7))
}
